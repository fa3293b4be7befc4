"""From and to the messages of simulators, by their fields alone: no message package is needed.

A message may be an object with attributes, as a ROS client library gives it, or nested dicts and lists, as a log or
JSON does. The functions return dicts. The codes of colours are in docs/messages.md.

>>> from conelane import Detector
>>> from conelane.messages import from_fs_track, to_fs_track
>>> message = to_fs_track([[0, 1.5], [0, -1.5], [4, 1.5], [4, -1.5]], colors=["blue", "yellow"] * 2)
>>> message["track"][1]
{'location': {'x': 0.0, 'y': -1.5, 'z': 0.0}, 'color': 1}
>>> lane = Detector("clc").detect(**from_fs_track(message)._asdict(), pose=(-1, 0, 0))
>>> lane.left
array([0, 2])
"""
from __future__ import annotations

from typing import Any, Dict, Iterable, List, NamedTuple, Optional, Tuple, Union

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import Color

__all__ = [
    "Cones",
    "from_eufs",
    "from_fs_track",
    "from_pacsim",
    "to_eufs",
    "to_fs_track",
    "to_pacsim",
]

FloatArray = NDArray[np.float64]


class Cones(NamedTuple):
    """Cones as `Detector.detect` takes them: `detect(**cones._asdict(), pose=pose)`.

    Attributes
    ----------
    cones : (N, 2) ndarray of float64
        Positions [m], in the frame of the message.
    colors : (N,) ndarray of uint8, or (N, 5) ndarray of float64
        Codes of `Color`; or, where the message has them, probabilities of unknown, blue, yellow, small and big
        orange.
    confidences : (N,) ndarray of float64, or None
        None where the message has none.
    ids : (N,) ndarray of int64, or None
        None where the message has none.
    covariances : (N, 2, 2) ndarray of float64, or None
        Of the positions [m^2]. None where the message has none, or only zeros, which is what a message holds that
        nobody filled.
    """

    cones: FloatArray
    colors: Union[NDArray[np.uint8], FloatArray]
    confidences: Optional[FloatArray] = None
    ids: Optional[NDArray[np.int64]] = None
    covariances: Optional[FloatArray] = None

    @property
    def labels(self) -> NDArray[np.uint8]:
        """Codes of `Color` of shape (N,): the most probable ones, big orange cones with the small ones, and unknown
        where two are equally probable."""
        if self.colors.ndim == 1:
            return self.colors.astype(np.uint8)
        of_labels = np.column_stack([self.colors[:, :3], self.colors[:, 3:].sum(axis=1)])
        best = of_labels.max(axis=1, keepdims=True)
        is_tie = (of_labels == best).sum(axis=1) > 1
        return np.where(is_tie, int(Color.unknown), of_labels.argmax(axis=1)).astype(np.uint8)


def _field(message: Any, path: str) -> Any:
    """A field of a field of a message, such as "pose.pose.position"."""
    value = message
    for name in path.split("."):
        try:
            value = value[name] if isinstance(value, dict) else getattr(value, name)
        except (KeyError, AttributeError):
            raise ValueError(f"{path}: the message has no field '{name}'") from None
    return value


def _has(message: Any, name: str) -> bool:
    return name in message if isinstance(message, dict) else hasattr(message, name)


def _positions(points: Iterable[Any]) -> FloatArray:
    rows = [(float(_field(point, "x")), float(_field(point, "y"))) for point in points]
    return np.array(rows, dtype=np.float64).reshape(-1, 2)


def _point(position: FloatArray) -> Dict[str, float]:
    return {"x": float(position[0]), "y": float(position[1]), "z": 0.0}


def _covariances(rows: List[FloatArray]) -> Optional[FloatArray]:
    """Matrices of the rows xx, xy, yx, yy; None where all are 0."""
    matrices = np.array(rows, dtype=np.float64).reshape(-1, 2, 2)
    return matrices if matrices.any() else None


def _color(color: Any) -> Color:
    return Color[color] if isinstance(color, str) else Color(int(color))


def _given(cones: ArrayLike, colors: Optional[ArrayLike]) -> Tuple[FloatArray, List[Color]]:
    """Positions and colours of what is to become a message."""
    positions = np.asarray(cones, dtype=np.float64)
    if positions.size == 0:
        positions = positions.reshape(0, 2)
    if positions.ndim != 2 or positions.shape[1] != 2:
        raise ValueError(f"cones: has shape {positions.shape}, not (N, 2)")
    if colors is None:
        return positions, [Color.unknown] * len(positions)
    given = np.asarray(colors).tolist()
    if len(given) != len(positions):
        raise ValueError(f"colors: {len(given)} of them, not {len(positions)} as cones")
    try:
        return positions, [_color(color) for color in given]
    except (KeyError, ValueError):
        raise ValueError("colors: only " + ", ".join(color.name for color in Color) + " and their codes") from None


_EUFS_LISTS = {
    "blue_cones": Color.blue,
    "yellow_cones": Color.yellow,
    "orange_cones": Color.orange,
    "big_orange_cones": Color.orange,
    "unknown_color_cones": Color.unknown,
}
_EUFS_LIST_OF = {
    Color.blue: "blue_cones",
    Color.yellow: "yellow_cones",
    Color.orange: "orange_cones",
    Color.big_orange: "big_orange_cones",
    Color.unknown: "unknown_color_cones",
}


def from_eufs(message: Any) -> Cones:
    """Cones of eufs_msgs/ConeArrayWithCovariance, in the order of its lists; small and big orange ones are orange.

    Parameters
    ----------
    message : object or dict
        With the lists blue_cones, yellow_cones, orange_cones, big_orange_cones and unknown_color_cones of cones that
        have a `point` and, if they know it, a `covariance`: xx, xy, yx, yy.

    Returns
    -------
    Cones
        Without confidences and ids.

    Raises
    ------
    ValueError
        Naming the field that is missing, or a covariance of other than four numbers.

    Examples
    --------
    >>> cones = from_eufs(to_eufs([[3, 1], [3, -2]], colors=["blue", "orange"]))
    >>> cones.cones.tolist(), cones.colors.tolist()
    ([[3.0, 1.0], [3.0, -2.0]], [1, 3])
    """
    positions: List[FloatArray] = []
    colors: List[int] = []
    spread: List[FloatArray] = []
    for name, color in _EUFS_LISTS.items():
        of_list = _positions(_field(cone, "point") for cone in _field(message, name))
        positions.append(of_list)
        colors += [int(color)] * len(of_list)
        for i, cone in enumerate(_field(message, name)):
            given = _field(cone, "covariance") if _has(cone, "covariance") else np.zeros(4)
            spread.append(np.asarray(given, dtype=np.float64))
            if spread[-1].shape != (4,):
                raise ValueError(f"{name}[{i}].covariance: {spread[-1].size} numbers, not 4")
    return Cones(np.concatenate(positions), np.array(colors, dtype=np.uint8), covariances=_covariances(spread))


def to_eufs(cones: ArrayLike, colors: Optional[ArrayLike] = None,
            covariances: Optional[ArrayLike] = None) -> Dict[str, Any]:
    """A eufs_msgs/ConeArrayWithCovariance as dict, without header.

    Parameters
    ----------
    cones : (N, 2) array_like of float
        Positions [m].
    colors : (N,) array_like of str or int, optional
        As `Detector.detect` takes them; cones that are orange and not big_orange become small ones.
    covariances : (N, 2, 2) or (N, 4) array_like of float, optional
        Row by row [m^2]; by default 0.

    Returns
    -------
    dict

    Raises
    ------
    ValueError
        For wrong shapes and colours.

    Examples
    --------
    >>> to_eufs([[3, 1]], colors=["blue"])["blue_cones"]
    [{'point': {'x': 3.0, 'y': 1.0, 'z': 0.0}, 'covariance': [0.0, 0.0, 0.0, 0.0]}]
    """
    positions, kinds = _given(cones, colors)
    spread = np.zeros((len(positions), 4)) if covariances is None else np.asarray(covariances, dtype=np.float64)
    if spread.shape == (len(positions), 2, 2):
        spread = spread.reshape(-1, 4)
    if spread.shape != (len(positions), 4):
        raise ValueError(f"covariances: has shape {spread.shape}, not ({len(positions)}, 4)")
    message: Dict[str, Any] = {name: [] for name in _EUFS_LISTS}
    for position, color, covariance in zip(positions, kinds, spread):
        message[_EUFS_LIST_OF[color]].append({"point": _point(position), "covariance": covariance.tolist()})
    return message


_FS_COLORS = [Color.blue, Color.yellow, Color.orange, Color.orange, Color.unknown]
_FS_CODE_OF = {Color.blue: 0, Color.yellow: 1, Color.big_orange: 2, Color.orange: 3, Color.unknown: 4}


def from_fs_track(message: Any) -> Cones:
    """Cones of fs_msgs/Track, in its order; small and big orange ones are orange.

    Parameters
    ----------
    message : object or dict
        With a list `track` of cones that have `location` and `color`.

    Returns
    -------
    Cones
        Without confidences and ids.

    Raises
    ------
    ValueError
        Naming a missing field, or a colour that fs_msgs/Cone does not have.

    Examples
    --------
    >>> from_fs_track({"track": [{"location": {"x": 1, "y": 2, "z": 0}, "color": 2}]}).colors
    array([3], dtype=uint8)
    """
    track = list(_field(message, "track"))
    colors = []
    for i, cone in enumerate(track):
        code = int(_field(cone, "color"))
        if not 0 <= code < len(_FS_COLORS):
            raise ValueError(f"track[{i}].color: {code} is not one of fs_msgs/Cone, which are 0 to 4")
        colors.append(int(_FS_COLORS[code]))
    return Cones(_positions(_field(cone, "location") for cone in track), np.array(colors, dtype=np.uint8))


def to_fs_track(cones: ArrayLike, colors: Optional[ArrayLike] = None) -> Dict[str, Any]:
    """A fs_msgs/Track as dict; see `to_eufs` for the parameters.

    Examples
    --------
    >>> to_fs_track([[1, 2]])
    {'track': [{'location': {'x': 1.0, 'y': 2.0, 'z': 0.0}, 'color': 4}]}
    """
    positions, kinds = _given(cones, colors)
    return {"track": [{"location": _point(position), "color": _FS_CODE_OF[color]}
                      for position, color in zip(positions, kinds)]}


_PACSIM_CLASSES = 7
_PACSIM_COLORS = {0: Color.unknown, 2: Color.blue, 3: Color.yellow, 4: Color.orange, 5: Color.orange}
_PACSIM_SURE = 1e-9  # how far the probability of a class may be below 1 that counts as a label
_PACSIM_CLASS_OF = {Color.unknown: 0, Color.blue: 2, Color.yellow: 3, Color.orange: 4, Color.big_orange: 5}


def _of_pacsim_classes(probabilities: FloatArray) -> List[float]:
    """Of unknown, blue, yellow, small and big orange; unknown where all are 0."""
    if not probabilities.any():
        return [1.0, 0.0, 0.0, 0.0, 0.0]
    unknown, invisible, blue, yellow, orange, big_orange, time_keeping = (probabilities / probabilities.sum()).tolist()
    return [unknown + invisible + time_keeping, blue, yellow, orange, big_orange]


def from_pacsim(message: Any) -> Cones:
    """Cones of pacsim/PerceptionDetections, of pacsim/Track, or of a list of their landmarks.

    Landmarks whose most probable class is invisible or time keeping are no cones and are left out. `colors` are codes
    if each cone is of one class with probability 1; small and big orange ones are orange. Else they are the
    probabilities, divided by their sum, with those of invisible and of time keeping added to unknown.

    Parameters
    ----------
    message : object, dict or sequence
        With a list `detections`, or with `left_lane`, `right_lane` and `unknown`, of landmarks that have
        `pose.pose.position`, `class_probabilities`, `detection_probability` and, in a track, `id`. If they know it,
        `pose.covariance` with 36 numbers, row by row: x, y, z and three angles.

    Returns
    -------
    Cones
        With confidences; with ids if each landmark has one.

    Raises
    ------
    ValueError
        Naming the field that is missing; for other than seven classes, for a covariance of other than 36 numbers, and
        for probabilities that are negative or not finite.

    Examples
    --------
    >>> cones = from_pacsim(to_pacsim([[3, 1]], colors=["yellow"], confidences=[0.5]))
    >>> cones.colors.tolist(), cones.confidences.tolist(), cones.ids
    ([2], [0.5], None)
    """
    if isinstance(message, (list, tuple)):
        landmarks = list(message)
    elif _has(message, "left_lane"):
        landmarks = [one for name in ("left_lane", "right_lane", "unknown") for one in _field(message, name)]
    else:
        landmarks = list(_field(message, "detections"))
    kept, colors, soft = [], [], []
    spread: List[FloatArray] = []
    for i, landmark in enumerate(landmarks):
        probabilities = np.asarray(_field(landmark, "class_probabilities"), dtype=np.float64)
        if probabilities.shape != (_PACSIM_CLASSES,):
            raise ValueError(f"landmark {i}: class_probabilities: {probabilities.size} of them, not {_PACSIM_CLASSES}")
        if not (np.isfinite(probabilities).all() and (probabilities >= 0.0).all()):
            raise ValueError(f"landmark {i}: class_probabilities: must be finite and at least 0")
        color = _PACSIM_COLORS.get(int(probabilities.argmax()))
        if color is not None:
            kept.append(landmark)
            colors.append(int(color))
            soft.append(_of_pacsim_classes(probabilities))
            has_spread = _has(_field(landmark, "pose"), "covariance")
            given = np.asarray(_field(landmark, "pose.covariance") if has_spread else np.zeros(36), dtype=np.float64)
            if given.shape != (36,):
                raise ValueError(f"landmark {i}: pose.covariance: {given.size} numbers, not 36")
            spread.append(given[[0, 1, 6, 7]])
    is_sure = all(max(one) >= 1.0 - _PACSIM_SURE for one in soft)
    has_ids = bool(kept) and all(_has(landmark, "id") for landmark in kept)
    return Cones(
        _positions(_field(landmark, "pose.pose.position") for landmark in kept),
        np.array(colors, dtype=np.uint8) if is_sure else np.array(soft, dtype=np.float64),
        np.array([float(_field(landmark, "detection_probability")) for landmark in kept]),
        np.array([int(_field(landmark, "id")) for landmark in kept], dtype=np.int64) if has_ids else None,
        _covariances(spread),
    )


def to_pacsim(cones: ArrayLike, colors: Optional[ArrayLike] = None, confidences: Optional[ArrayLike] = None,
              ids: Optional[ArrayLike] = None) -> Dict[str, Any]:
    """A pacsim/PerceptionDetections as dict, without headers and covariances.

    Parameters
    ----------
    cones : (N, 2) array_like of float
        Positions [m].
    colors : (N,) array_like of str or int, optional
        As `Detector.detect` takes them; cones that are orange and not big_orange become small ones.
    confidences : (N,) array_like of float, optional
        By default 1.
    ids : (N,) array_like of int, optional
        With them the entries are landmarks, as pacsim/Track has them.

    Returns
    -------
    dict

    Raises
    ------
    ValueError
        For wrong shapes and colours.

    Examples
    --------
    >>> to_pacsim([[3, 1]], colors=["blue"])["detections"][0]["class_probabilities"]
    [0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0]
    """
    positions, kinds = _given(cones, colors)
    sure = np.ones(len(positions)) if confidences is None else np.asarray(confidences, dtype=np.float64)
    names = None if ids is None else np.asarray(ids)
    if sure.shape != (len(positions),) or (names is not None and names.shape != (len(positions),)):
        raise ValueError(f"confidences and ids: not {len(positions)} of them as cones")
    detections: List[Dict[str, Any]] = []
    for i, (position, color) in enumerate(zip(positions, kinds)):
        probabilities = [0.0] * _PACSIM_CLASSES
        probabilities[_PACSIM_CLASS_OF[color]] = 1.0
        detection = {
            "pose": {"pose": {"position": _point(position),
                              "orientation": {"x": 0.0, "y": 0.0, "z": 0.0, "w": 1.0}}},
            "class_probabilities": probabilities,
            "detection_probability": float(sure[i]),
        }
        if names is not None:
            detection["id"] = int(names[i])
        detections.append(detection)
    return {"detections": detections}
