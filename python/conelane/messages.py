"""From and to the messages of simulators, by their fields alone: no message package is needed.

A message may be an object with attributes, as a ROS client library gives it, or nested dicts and lists, as a log or
JSON does. `from_...` return `Cones`, `to_...` dicts. The codes of colours are in docs/messages.md.

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

from operator import attrgetter
from typing import Any, Dict, Iterable, List, Mapping, NamedTuple, Optional, Sequence, Tuple, Union

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import Color

__all__ = ["Cones", "Fields", "from_eufs", "from_fs_track", "from_pacsim", "to_eufs", "to_fs_track", "to_pacsim"]

FloatArray = NDArray[np.float64]


class Cones(NamedTuple):
    """Cones as `Detector.detect` takes them: `detect(**cones._asdict(), pose=pose)`.

    cones: (N, 2), positions [m], in the message's frame of reference.
    colors: (N,), codes of `Color`; or, from PacSim, (N, 5), probabilities of unknown, blue, yellow, small and big
        orange.
    confidences: (N,), None where the message has none.
    ids: (N,), None where the message has none.
    covariances: (N, 2, 2), of the positions [m^2]. None where the message has none, or only zeros, as in a field
        that nobody filled.
    """

    cones: FloatArray
    colors: Union[NDArray[np.uint8], FloatArray]
    confidences: Optional[FloatArray] = None
    ids: Optional[NDArray[np.int64]] = None
    covariances: Optional[FloatArray] = None

    @property
    def labels(self) -> NDArray[np.uint8]:
        """Codes of `Color` of shape (N,): the most probable ones, unknown where two are equally probable. Both sizes of
        orange count together, then the likelier one."""
        if self.colors.ndim == 1:
            return self.colors.astype(np.uint8)
        of_labels = np.column_stack([self.colors[:, :3], self.colors[:, 3:].sum(axis=1)])
        best = of_labels.max(axis=1, keepdims=True)
        is_tie = (of_labels == best).sum(axis=1) > 1
        most = of_labels.argmax(axis=1)
        most += (most == Color.orange) & (self.colors[:, 4] > self.colors[:, 3])
        return np.where(is_tie, int(Color.unknown), most).astype(np.uint8)


def _field(message: Any, path: str) -> Any:
    """A field of a field of a message, such as "pose.pose.position", or an item of an array, such as "at.0"."""
    value = message
    for name in path.split("."):
        try:
            value = value[int(name)] if name.isdigit() else value[name] if isinstance(value, dict) else getattr(value, name)
        except (KeyError, AttributeError, IndexError):
            raise ValueError(f"{path}: the message has no field '{name}'") from None
    return value


def _has(message: Any, name: str) -> bool:
    return name in message if isinstance(message, dict) else hasattr(message, name)


def _column(cones: Sequence[Any], path: str) -> List[Any]:
    """A field of each cone; `_field` names the field that is missing."""
    if not len(cones) or not isinstance(cones[0], dict):
        try:
            return list(map(attrgetter(path), cones))
        except AttributeError:
            pass
    return [_field(cone, path) for cone in cones]


def _positions(cones: Sequence[Any], path: str) -> FloatArray:
    columns = [_column(cones, f"{path}.{axis}".lstrip(".")) for axis in "xy"]
    return np.array(columns, dtype=np.float64).T.reshape(-1, 2)


def _codes(colors: Iterable[Color]) -> NDArray[np.uint8]:
    """Of colours that were read: big orange cones with the small ones."""
    return np.array([min(color, Color.orange) for color in colors], dtype=np.uint8)


def _point(position: FloatArray) -> Dict[str, float]:
    return {"x": float(position[0]), "y": float(position[1]), "z": 0.0}


_OF_XY = {4: [0, 1, 2, 3], 9: [0, 1, 3, 4], 36: [0, 1, 6, 7]}  # by the size of a covariance: xx, xy, yx, yy


def _spread(cone: Any, path: str, size: Optional[int], where: str) -> FloatArray:
    """xx, xy, yx, yy of a covariance with this many numbers; zeros where the cone has none."""
    holder, _, name = path.rpartition(".")
    if not _has(_field(cone, holder) if holder else cone, name):
        return np.zeros(4)
    given = np.asarray(_field(cone, path), dtype=np.float64)
    if given.ndim != 1 or given.size not in ((size,) if size else _OF_XY):
        raise ValueError(f"{where}{path}: {given.size} numbers, not {size or '4, 9 or 36'}")
    return given[_OF_XY[given.size]]


def _covariances(rows: List[FloatArray]) -> Optional[FloatArray]:
    """Matrices of the rows xx, xy, yx, yy; None where all are 0."""
    matrices = np.array(rows, dtype=np.float64).reshape(-1, 2, 2)
    return matrices if matrices.any() else None


def _given(cones: ArrayLike, colors: Optional[ArrayLike]) -> List[Tuple[FloatArray, Color]]:
    """Positions and colours of what is to become a message."""
    positions = np.asarray(cones, dtype=np.float64)
    if positions.size == 0:
        positions = positions.reshape(0, 2)
    if positions.ndim != 2 or positions.shape[1] != 2:
        raise ValueError(f"cones: has shape {positions.shape}, not (N, 2)")
    given = [Color.unknown] * len(positions) if colors is None else np.asarray(colors).tolist()
    if len(given) != len(positions):
        raise ValueError(f"colors: {len(given)} of them, not {len(positions)} as cones")
    try:
        return list(zip(positions, [Color[one] if isinstance(one, str) else Color(int(one)) for one in given]))
    except (KeyError, ValueError):
        raise ValueError("colors: only " + ", ".join(color.name for color in Color) + " and their codes") from None


# What a colour is in eufs_msgs (a list), fs_msgs/Cone and pacsim (codes). PacSim's classes 1 and 6 are no cones.
_EUFS_LISTS = {Color.blue: "blue_cones", Color.yellow: "yellow_cones", Color.orange: "orange_cones",
               Color.big_orange: "big_orange_cones", Color.unknown: "unknown_color_cones"}
_FS_CODES = {Color.blue: 0, Color.yellow: 1, Color.big_orange: 2, Color.orange: 3, Color.unknown: 4}
_PACSIM_CLASSES = {Color.unknown: 0, Color.blue: 2, Color.yellow: 3, Color.orange: 4, Color.big_orange: 5}
_PACSIM_COUNT = 7
_PACSIM_SURE = 1e-9  # how far the probability of a class may be below 1 that counts as a label


class Fields(NamedTuple):
    """Where a message has its cones: how `conelane.bags` and the ROS 2 node read types that conelane does not know.

    lists: For each field with a list of cones, the colour of these cones: a name of `Color`, or None where each cone has
        its own. Empty for a sensor_msgs/PointCloud2: its points are the cones, and the fields of a point are those of a cone.
    x, y: The position in a cone [m], such as "point.x".
    color, colors: Where a cone has its colour, and the name of `Color` for each value. Without `colors` the colour has
        the fields r, g, b. Without `color` it is unknown.
    confidence, id: Where a cone has them, if it does.
    covariance: Where a cone has the covariance of its position [m^2], row by row: 4 numbers (x, y), 9 (x, y, z) or 36
        (also three angles).

    >>> fields = Fields({"cones": None}, x="at.x", y="at.y", color="kind", colors={"b": "blue"})
    >>> fields.read({"cones": [{"at": {"x": 1, "y": 2}, "kind": "b"}]}).colors.tolist()
    [1]
    """

    lists: Mapping[str, Optional[str]] = {}
    x: str = "x"
    y: str = "y"
    color: Optional[str] = None
    colors: Mapping[Any, str] = {}
    confidence: Optional[str] = None
    id: Optional[str] = None
    covariance: Optional[str] = None

    def read(self, message: Any) -> Cones:
        """The cones of a message, list by list.

        Raises ValueError, naming a field that is missing, a colour that `colors` does not have, or a covariance of
        a wrong size.
        """
        if self.lists:
            parts = [self._part(f"{name}[", _field(message, name), color) for name, color in self.lists.items()]
        else:
            parts = [self._part("point[", _points_of_cloud(message), None)]
        x, y, codes, confidences, ids, spread = ([value for part in parts for value in part[key]] for key in range(6))
        return Cones(np.array([x, y], dtype=np.float64).T.reshape(-1, 2), np.array(codes, dtype=np.uint8),
                     np.array(confidences, dtype=np.float64) if self.confidence else None,
                     np.array(ids, dtype=np.int64) if self.id else None, _covariances(spread) if spread else None)

    def _part(self, place: str, cones: Sequence[Any], color: Optional[str]) -> Tuple[Sequence[Any], ...]:
        if len(cones) and _has(cones[0], "action"):  # markers, of which some delete others
            cones = [cone for cone in cones if _field(cone, "action") not in (2, 3)]

        def column(path: Optional[str]) -> Sequence[Any]:
            if path is None:
                return []
            return cones[path].tolist() if isinstance(cones, np.ndarray) else _column(cones, path)

        codes = [Color[color or "unknown"]] * len(cones)
        if color is None and self.color is not None and not self.colors:
            codes = [_color_of_marker(one) for one in column(self.color)]
        elif color is None and self.color is not None:
            known = {_as_text(value): Color[name] for value, name in self.colors.items()}
            values = [_as_text(value) for value in column(self.color)]
            for i, value in enumerate(values):
                if value not in known:
                    raise ValueError(f"{place}{i}].{self.color}: {value} is not one of {', '.join(known)}")
            codes = [known[value] for value in values]
        covariances: Sequence[FloatArray] = []
        try:  # all at once, which is fast
            given = np.array(column(self.covariance), dtype=np.float64)
            covariances = given[:, _OF_XY[given.shape[1]]] if len(given) else []
        except (ValueError, KeyError, IndexError):  # one is missing, or of another size
            covariances = [_spread(cone, self.covariance, None, f"{place}{i}].") for i, cone in enumerate(cones)]
        return (column(self.x), column(self.y), _codes(codes), column(self.confidence), column(self.id), covariances)


def _as_text(value: Any) -> str:
    """1, 1.0 and "1" are the same value of a field."""
    return str(int(value)) if isinstance(value, float) and value.is_integer() else str(value)


_CLOUD_TYPES = {1: "i1", 2: "u1", 3: "i2", 4: "u2", 5: "i4", 6: "u4", 7: "f4", 8: "f8"}


def _points_of_cloud(message: Any) -> NDArray[Any]:
    """The points of a sensor_msgs/PointCloud2, with its fields as columns."""
    order = ">" if _field(message, "is_bigendian") else "<"
    fields = [(str(_field(one, "name")), int(_field(one, "offset")), int(_field(one, "datatype"))) for one in _field(message, "fields")]
    names, offsets, kinds = zip(*fields) if fields else ((), (), ())
    layout = {"names": names, "offsets": offsets, "formats": [order + _CLOUD_TYPES[kind] for kind in kinds],
              "itemsize": int(_field(message, "point_step"))}
    data = np.ascontiguousarray(_field(message, "data"), dtype=np.uint8).tobytes()
    count, row = int(_field(message, "width")), int(_field(message, "row_step"))
    if not {"x", "y"} <= set(names) or len(data) < row * int(_field(message, "height")):
        raise ValueError("fields: a point cloud needs x and y, and data of row_step x height bytes")
    rows = [np.frombuffer(data, np.dtype(layout), count, i * row) for i in range(int(_field(message, "height")))]
    return np.concatenate(rows) if rows else np.zeros(0, np.dtype(layout))


_EUFS = Fields({name: color.name for color, name in _EUFS_LISTS.items()}, "point.x", "point.y", covariance="covariance")
_FS_TRACK = Fields({"track": None}, "location.x", "location.y", "color",
                   {code: color.name for color, code in _FS_CODES.items()})


def from_eufs(message: Any) -> Cones:
    """Cones of eufs_msgs/ConeArrayWithCovariance, in the order of its lists; small and big orange ones are orange.

    message: With the lists blue_cones, yellow_cones, orange_cones, big_orange_cones and unknown_color_cones of cones
        that have a `point` and perhaps a `covariance`: xx, xy, yx, yy.
    Returns without confidences and ids.
    Raises ValueError as `Fields.read`.

    >>> cones = from_eufs(to_eufs([[3, 1], [3, -2]], colors=["blue", "orange"]))
    >>> cones.cones.tolist(), cones.colors.tolist()
    ([[3.0, 1.0], [3.0, -2.0]], [1, 3])
    """
    return _EUFS.read(message)


def to_eufs(cones: ArrayLike, colors: Optional[ArrayLike] = None,
            covariances: Optional[ArrayLike] = None) -> Dict[str, Any]:
    """An eufs_msgs/ConeArrayWithCovariance as dict, without header.

    cones: (N, 2), positions [m].
    colors: (N,), names or codes of `Color`, no probabilities; orange cones become small ones. By default unknown.
    covariances: (N, 2, 2) or, row by row, (N, 4) [m^2]; by default 0.
    Raises ValueError for wrong shapes and colours.

    >>> to_eufs([[3, 1]], colors=["blue"])["blue_cones"]
    [{'point': {'x': 3.0, 'y': 1.0, 'z': 0.0}, 'covariance': [0.0, 0.0, 0.0, 0.0]}]
    """
    given = _given(cones, colors)
    spread = np.zeros((len(given), 4)) if covariances is None else np.asarray(covariances, dtype=np.float64)
    if spread.shape not in ((len(given), 2, 2), (len(given), 4)):
        raise ValueError(f"covariances: has shape {spread.shape}, not ({len(given)}, 4)")
    message: Dict[str, Any] = {name: [] for name in _EUFS_LISTS.values()}
    for (position, color), covariance in zip(given, spread.reshape(-1, 4)):
        message[_EUFS_LISTS[color]].append({"point": _point(position), "covariance": covariance.tolist()})
    return message


def from_fs_track(message: Any) -> Cones:
    """Cones of fs_msgs/Track, in its order, without confidences and ids; small and big orange ones are orange.

    message: With a list `track` of cones that have `location` and `color`.
    Raises ValueError as `Fields.read`.

    >>> from_fs_track({"track": [{"location": {"x": 1, "y": 2, "z": 0}, "color": 2}]}).colors
    array([3], dtype=uint8)
    """
    return _FS_TRACK.read(message)


def _color_of_marker(rgba: Any) -> Color:
    """Blue if blue is the strongest part, yellow if red and green are about equal, orange if there is less green; else unknown."""
    red, green, blue = (float(_field(rgba, part)) for part in "rgb")
    if max(red, green, blue) - min(red, green, blue) < 0.25:
        return Color.unknown
    if blue >= max(red, green):
        return Color.blue
    if red < 0.75 * green or green < 0.2 * red:
        return Color.unknown
    return Color.yellow if green >= 0.75 * red else Color.orange


def to_fs_track(cones: ArrayLike, colors: Optional[ArrayLike] = None) -> Dict[str, Any]:
    """An fs_msgs/Track as dict; see `to_eufs` for the parameters.

    >>> to_fs_track([[1, 2]])
    {'track': [{'location': {'x': 1.0, 'y': 2.0, 'z': 0.0}, 'color': 4}]}
    """
    return {"track": [{"location": _point(position), "color": _FS_CODES[color]} for position, color in _given(cones, colors)]}


def from_pacsim(message: Any) -> Cones:
    """Cones of pacsim/PerceptionDetections, of pacsim/Track, or of a list of their landmarks.

    Landmarks whose most probable class is invisible or time keeping are no cones and are left out. `colors` are codes
    if each cone is of one class with probability 1; small and big orange ones are orange. Else they are (N, 5), the
    probabilities divided by their sum, with those of invisible and of time keeping added to unknown.

    message: With a list `detections`, or with `left_lane`, `right_lane` and `unknown`, of landmarks that have
        `pose.pose.position`, `class_probabilities`, `detection_probability`, in a track `id`, and perhaps
        `pose.covariance` with 36 numbers, row by row: x, y, z and three angles.
    Returns with confidences; with ids if each landmark has one.
    Raises ValueError, naming the field that is missing; for other than seven classes, for a covariance of other than 36
        numbers, and for probabilities that are negative or not finite.

    >>> cones = from_pacsim(to_pacsim([[3, 1]], colors=["yellow"], confidences=[0.5]))
    >>> cones.colors.tolist(), cones.confidences.tolist(), cones.ids
    ([2], [0.5], None)
    """
    landmarks = message
    if not isinstance(message, (list, tuple)):
        names = ("left_lane", "right_lane", "unknown") if _has(message, "left_lane") else ("detections",)
        landmarks = [one for name in names for one in _field(message, name)]
    kept, colors, soft = [], [], []
    spread: List[FloatArray] = []
    color_of = {code: color for color, code in _PACSIM_CLASSES.items()}
    for i, landmark in enumerate(landmarks):
        probabilities = np.asarray(_field(landmark, "class_probabilities"), dtype=np.float64)
        if probabilities.shape != (_PACSIM_COUNT,):
            raise ValueError(f"landmark {i}: class_probabilities: {probabilities.size} of them, not {_PACSIM_COUNT}")
        if not (np.isfinite(probabilities).all() and (probabilities >= 0.0).all()):
            raise ValueError(f"landmark {i}: class_probabilities: must be finite and at least 0")
        color = color_of.get(int(probabilities.argmax()))
        if color is not None:
            kept.append(landmark)
            colors.append(color)
            # Of unknown, blue, yellow, small and big orange; unknown where all are 0.
            shares = probabilities / probabilities.sum() if probabilities.any() else np.eye(_PACSIM_COUNT)[0]
            soft.append([shares[[0, 1, 6]].sum(), *shares[2:6]])
            spread.append(_spread(landmark, "pose.covariance", 36, f"landmark {i}: "))
    is_sure = all(max(one) >= 1.0 - _PACSIM_SURE for one in soft)
    has_ids = bool(kept) and all(_has(landmark, "id") for landmark in kept)
    return Cones(
        _positions(kept, "pose.pose.position"),
        _codes(colors) if is_sure else np.array(soft, dtype=np.float64),
        np.array([float(_field(landmark, "detection_probability")) for landmark in kept]),
        np.array([int(_field(landmark, "id")) for landmark in kept], dtype=np.int64) if has_ids else None,
        _covariances(spread),
    )


def to_pacsim(cones: ArrayLike, colors: Optional[ArrayLike] = None, confidences: Optional[ArrayLike] = None,
              ids: Optional[ArrayLike] = None) -> Dict[str, Any]:
    """A pacsim/PerceptionDetections as dict, without headers and covariances; see `to_eufs` for the first parameters.

    confidences: (N,), by default 1.
    ids: (N,), with them the entries are landmarks, as pacsim/Track has them.

    >>> to_pacsim([[3, 1]], colors=["blue"])["detections"][0]["class_probabilities"]
    [0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0]
    """
    given = _given(cones, colors)
    sure = np.ones(len(given)) if confidences is None else np.asarray(confidences, dtype=np.float64)
    names = None if ids is None else np.asarray(ids)
    if sure.shape != (len(given),) or (names is not None and names.shape != (len(given),)):
        raise ValueError(f"confidences and ids: not {len(given)} of them as cones")
    detections = [{
        "pose": {"pose": {"position": _point(position), "orientation": {"x": 0.0, "y": 0.0, "z": 0.0, "w": 1.0}}},
        "class_probabilities": np.eye(_PACSIM_COUNT)[_PACSIM_CLASSES[color]].tolist(),
        "detection_probability": float(sure[i]), **({} if names is None else {"id": int(names[i])}),
    } for i, (position, color) in enumerate(given)]
    return {"detections": detections}


_AMZ = Fields({"cone_detections": None}, "position.x", "position.y", "color.data",
              {"b": "blue", "y": "yellow", "o": "orange", "blue": "blue", "yellow": "yellow", "orange": "orange", "": "unknown", "u": "unknown"})
# How the cones of a message are read, by its type. A type that is not here takes a `Fields`.
READERS = {
    "eufs_msgs/ConeArrayWithCovariance": from_eufs,
    "fs_msgs/Track": from_fs_track,
    "pacsim/PerceptionDetections": from_pacsim,
    "pacsim/Track": from_pacsim,
    "fsd_common_msgs/ConeDetections": _AMZ.read,
    "fsd_common_msgs/Map": _AMZ._replace(lists={f"cone_{name}": name for name in ("yellow", "blue", "orange")}).read,
    "visualization_msgs/MarkerArray": Fields({"markers": None}, "pose.position.x", "pose.position.y", "color").read,
    "sensor_msgs/PointCloud2": Fields().read,
}
