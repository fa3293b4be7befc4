"""Frames of a run: what `Planner.update` takes, from messages or a file, and how a file of frames is written.

A message becomes a frame in two steps: its cones are read (`conelane.messages`), and the pose of the car at its stamp is
interpolated between the poses before and after it. `conelane.bags` does this for a log, `conelane.ros2_node` in a car.
"""
from __future__ import annotations

import json
import math
import os
import sys
from bisect import bisect_left, insort
from pathlib import Path
from typing import Any, Callable, Dict, Iterable, Iterator, List, NamedTuple, Optional, Tuple, Union

import numpy as np
from numpy.typing import NDArray

from . import NO_ID, Color
from .messages import READERS, Cones, Fields, _field, _has
from .page.replay import frame_lines

__all__ = ["Frame", "Mapping", "MessageFrames", "NoPose", "read_frames", "write_frames"]

FloatArray = NDArray[np.float64]
_HELD_NS = 50_000_000  # the first and the last pose hold this long before and after their stamps
_GAP_NS = 500_000_000  # poses farther apart are not interpolated
_TF = ("tf2_msgs/TFMessage", "tf/tfMessage")
POSE_TYPES = ("nav_msgs/Odometry", "geometry_msgs/PoseStamped", "geometry_msgs/PoseWithCovarianceStamped", *_TF)


class Frame(NamedTuple):
    """One frame: `planner.update(**frame._asdict())`. Arrays as for `Planner.update`; frame of reference: the map's."""

    cones: FloatArray
    pose: Tuple[float, float, float]
    time_s: float
    ids: Optional[NDArray[np.int64]] = None
    colors: Optional[NDArray[Any]] = None
    confidences: Optional[FloatArray] = None
    covariances: Optional[FloatArray] = None


class NoPose(ValueError):
    """The pose of the car, or of the sensor, is not known at the stamp of a frame."""


class Mapping(NamedTuple):
    """What conelane has to be told of a log or a system where the messages do not show it.

    cones, pose: Topics. Needed if there are several, and for cones of MarkerArray and PointCloud2.
    map_frame: Frame of reference of the run. By default the root of the TF tree with the car's frame.
    car_frame: The car's frame of reference. By default the child of Odometry, else "base_link" or "base_footprint".
    cones_frame: Frame of reference of the cones. By default that of their header; without a header the map's.
    types: A dict from names of message types, such as "my_msgs/Cones", to `Fields`.
    definitions: A dict from the same names to the text of the .msg file, for ROS 2 bags without definitions.
    """

    cones: Optional[str] = None
    pose: Optional[str] = None
    map_frame: Optional[str] = None
    car_frame: Optional[str] = None
    cones_frame: Optional[str] = None
    types: Dict[str, Fields] = {}
    definitions: Dict[str, str] = {}

    @classmethod
    def read(cls, file: Union[str, "os.PathLike[str]"]) -> Mapping:
        """The mapping in a YAML file. Raises ValueError, naming file and key."""
        from ruamel.yaml import YAML, YAMLError

        try:
            content = YAML(typ="safe", pure=True).load(Path(file)) or {}
        except (OSError, UnicodeDecodeError, YAMLError) as error:
            raise ValueError(f"{file}: cannot be read: {' '.join(str(error).split())}") from None
        content = _given(content, set(cls._fields) - {"definitions"}, ("types",), f"{file}: ")
        types, definitions = {}, {}
        for name, of_type in content.pop("types", {}).items():
            place, name = f"{file}: types: {name}: ", _plain(str(name))
            given = _given(of_type, {*Fields._fields, "definition"}, ("lists", "colors"), place)
            if "definition" in given:
                definitions[name] = given.pop("definition")
            types[name] = Fields(**given)
            for color in [*types[name].lists.values(), *types[name].colors.values()]:
                if color is not None and str(color) not in Color.__members__:
                    raise ValueError(f"{place}'{color}' is not one of {', '.join(Color.__members__)}")
        return cls(**content, types=types, definitions=definitions)


def _given(given: Any, known: Iterable[str], mappings: Iterable[str], place: str) -> Dict[str, Any]:
    """What a mapping of YAML says: text, but for some keys mappings."""
    if not isinstance(given, dict):
        raise ValueError(f"{place}must be a mapping of {', '.join(sorted(known))}")
    for key, value in given.items():
        if key not in known:
            raise ValueError(f"{place}{key}: is not one of {', '.join(sorted(known))}")
        if value is not None and not isinstance(value, dict if key in mappings else str):
            raise ValueError(f"{place}{key}: must be {'a mapping' if key in mappings else 'text'}")
    return {key: value for key, value in given.items() if value is not None}


def _plain(type_name: str) -> str:
    """A type as ROS 1 spells it: pkg/Type instead of pkg/msg/Type."""
    return type_name.replace("/msg/", "/")


class _Edge(NamedTuple):
    """How a frame of reference lies in its parent: translation and quaternion by stamp."""

    parent: str
    samples: List[Tuple[int, Tuple[float, ...]]]
    is_fixed: bool

    def at(self, stamp_ns: int, child: str) -> FloatArray:
        samples = self.samples
        if self.is_fixed:
            return _matrix(samples[-1][1])
        after = bisect_left(samples, (stamp_ns,))
        if after in (0, len(samples)):
            held_ns, values = samples[0 if after == 0 else -1]
            if abs(stamp_ns - held_ns) > _HELD_NS:
                raise NoPose(f"no pose of '{child}' in '{self.parent}' within {_HELD_NS / 1e9} s")
            return _matrix(values)
        (before_ns, first), (after_ns, second) = samples[after - 1], samples[after]
        if stamp_ns == after_ns:
            return _matrix(second)
        if after_ns - before_ns > _GAP_NS:
            raise NoPose(f"the poses of '{child}' in '{self.parent}' have a gap of {(after_ns - before_ns) / 1e9:.1f} s")
        share, (a, b) = (stamp_ns - before_ns) / (after_ns - before_ns), np.array([first, second])
        if a[3:] @ b[3:] < 0.0:
            b[3:] *= -1.0  # the same rotation, the short way round
        return _matrix((1.0 - share) * a + share * b)


def _matrix(values: Any) -> FloatArray:
    """4 x 4, of a translation and a quaternion x, y, z, w of any length above 0."""
    x, y, z, w = np.asarray(values[3:]) / np.linalg.norm(values[3:])
    return np.array([[1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w), values[0]],
                     [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w), values[1]],
                     [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y), values[2]], [0, 0, 0, 1]])


class _Sighting(NamedTuple):
    stamp_ns: int
    frame: Optional[str]  # of reference; empty: the car's, None: the map's
    cones: Cones


class MessageFrames:
    """Makes frames of messages. A message may be an object or a dict, as in `conelane.messages`; `type_name` names its type.

    mapping: See `Mapping`.
    most: How many poses of each frame of reference are kept, at times up to twice as many; None for all.
    """

    def __init__(self, mapping: Mapping = Mapping(), most: Optional[int] = None) -> None:
        self.map_frame, self.car_frame, self._cones_frame = (
            name and name.lstrip("/") for name in (mapping.map_frame, mapping.car_frame, mapping.cones_frame))
        self._fields = mapping.types
        self._most = most
        self._edges: Dict[str, _Edge] = {}
        self._of_pose: Optional[str] = None  # the frame that a topic of poses gives; TF does not change it

    def reader(self, type_name: str) -> Optional[Callable[[Any], Cones]]:
        """What reads the cones of this type; None if the type is unknown."""
        fields = self._fields.get(_plain(type_name))
        return fields.read if fields else READERS.get(_plain(type_name))

    def add_poses(self, type_name: str, message: Any, is_fixed: bool = False) -> None:
        """Adds the poses of a message of one of `POSE_TYPES`. Raises ValueError for an invalid pose."""
        if _plain(type_name) in _TF:
            for one in _field(message, "transforms"):
                child = _field(one, "child_frame_id").lstrip("/")
                if child != self._of_pose:
                    self._add(one, child, _field(one, "transform.translation"), _field(one, "transform.rotation"), is_fixed)
            return
        pose = _field(message, "pose.pose" if "Stamped" not in type_name or "Covariance" in type_name else "pose")
        if self.car_frame is None and _plain(type_name) == POSE_TYPES[0]:
            self.car_frame = _field(message, "child_frame_id").lstrip("/") or None
        self._of_pose = self.car_frame = self.car_frame or "base_link"
        self._add(message, self._of_pose, _field(pose, "position"), _field(pose, "orientation"), False)

    def _add(self, message: Any, child: str, position: Any, rotation: Any, is_fixed: bool) -> None:
        values = (*_numbers(position, "xyz"), *_numbers(rotation, "xyzw"))
        if not all(map(math.isfinite, values)) or not any(values[3:]):
            raise ValueError(f"pose of '{child}': must be finite, and its quaternion not 0")
        parent = _field(message, "header.frame_id").lstrip("/")
        edge = self._edges.get(child)
        if edge is None or edge.parent != parent:  # what lay in another frame is no longer of use
            edge = self._edges[child] = _Edge(parent, [], is_fixed)
        insort(edge.samples, (_stamp_ns(message), values))
        if self._most is not None and len(edge.samples) > 2 * self._most:
            del edge.samples[:-self._most]

    def sighting(self, type_name: str, message: Any, received_ns: int) -> _Sighting:
        """The cones of a message. A message without stamp gets the time at which it was received."""
        reader = self.reader(type_name)
        if reader is None:
            raise ValueError(f"type {_plain(type_name)} is unknown: a mapping has to say where its cones are")
        marked = _field(message, "markers") if _plain(type_name) == "visualization_msgs/MarkerArray" else [message]
        frame, stamp_ns = "", received_ns
        if len(marked) and not _has(marked[0], "header"):
            frame = None
        elif len(marked):
            frame, stamp_ns = _field(marked[0], "header.frame_id").lstrip("/"), _stamp_ns(marked[0]) or received_ns
        return _Sighting(stamp_ns, self._cones_frame or frame, reader(message))

    def frame(self, sighting: _Sighting, start_ns: int = 0) -> Frame:
        """The frame of a sighting; its `time_s` counts from `start_ns`. Cones that are not finite are left out. If an id occurs
        twice, the frame has no ids. Raises NoPose."""
        car_frame, map_frame = self._frame_of_car, self.frame_of_map
        car = self._between(car_frame, map_frame, sighting.stamp_ns)
        if sighting.frame in (None, map_frame):
            cones_frame = np.eye(4)
        elif sighting.frame in ("", car_frame) or self._edges.keys() == {car_frame}:
            cones_frame = car  # where no other transform is known, what is not in the map is the car's
        else:
            cones_frame = self._between(sighting.frame, map_frame, sighting.stamp_ns)
        positions, colors, confidences, ids, covariances = sighting.cones
        rotation = cones_frame[:2, :2]
        places = positions @ rotation.T + cones_frame[:2, 3]
        kept = np.isfinite(places).all(axis=1)
        for column in (confidences, covariances):  # one cone that the planner refuses would cost the frame
            if column is not None:
                kept &= np.isfinite(column).all(axis=tuple(range(1, column.ndim)))
        if ids is not None and len(np.unique(ids[kept])) != kept.sum():
            ids = None
        spread = None if covariances is None else (rotation @ covariances @ rotation.T)[kept]
        if spread is not None:
            spread = 0.5 * (spread + spread.transpose(0, 2, 1))
        return Frame(places[kept], (float(car[0, 3]), float(car[1, 3]), float(np.arctan2(car[1, 0], car[0, 0]))),
                     (sighting.stamp_ns - start_ns) / 1e9, None if ids is None else ids[kept], colors[kept],
                     None if confidences is None else np.clip(confidences[kept], 0.0, 1.0), spread)

    @property
    def _frame_of_car(self) -> str:
        return self.car_frame or next((name for name in ("base_link", "base_footprint") if name in self._edges), "base_link")

    @property
    def frame_of_map(self) -> str:
        """The frame of reference of the run: that of the mapping, or the root of the tree that the car's is in."""
        frame, seen = self._frame_of_car, set()
        while self.map_frame is None and frame in self._edges and frame not in seen:
            seen.add(frame)
            frame = self._edges[frame].parent
        return self.map_frame or frame

    def _to_root(self, frame: str, end: str, stamp_ns: int) -> Tuple[FloatArray, str]:
        """Of a frame of reference in `end`, or in the last one on the way up."""
        matrix = np.eye(4)
        for _ in range(len(self._edges)):
            if frame == end or frame not in self._edges:
                break
            edge = self._edges[frame]
            matrix, frame = edge.at(stamp_ns, frame) @ matrix, edge.parent
        return matrix, frame

    def _between(self, frame: str, to: str, stamp_ns: int) -> FloatArray:
        matrix, top = self._to_root(frame, to, stamp_ns)
        if top == to:
            return matrix
        other, other_top = self._to_root(to, top, stamp_ns)
        if other_top != top:
            raise NoPose(f"no transform from '{frame}' to '{to}'")
        return np.linalg.inv(other) @ matrix


def _numbers(of: Any, names: str) -> List[float]:
    return [float(of[name] if isinstance(of, dict) else getattr(of, name)) for name in names]


def _stamp_ns(message: Any) -> int:
    stamp = _field(message, "header.stamp")
    return int(_field(stamp, "sec")) * 1_000_000_000 + int(_field(stamp, "nanosec"))


def _as_line(frame: Frame) -> str:
    x, y, yaw = frame.pose
    cones: List[Dict[str, Any]] = [{"x": one[0], "y": one[1]} for one in np.round(frame.cones, 6).tolist()]
    columns: List[Tuple[str, Any]] = [("id", frame.ids), ("confidence", frame.confidences), ("position_covariance", frame.covariances)]
    if frame.colors is not None:
        is_sure = frame.colors.ndim == 1
        columns.append(("color", np.array([color.name for color in Color])[frame.colors]) if is_sure
                       else ("color_probabilities", frame.colors))
    for key, values in columns:
        if values is not None:
            for cone, value in zip(cones, values.tolist()):
                if key != "id" or value != NO_ID:
                    cone[key] = value
    return json.dumps({"time_s": frame.time_s, "pose": {"x": x, "y": y, "yaw": yaw}, "cones": cones}, separators=(",", ":"))


def write_frames(file: Union[str, "os.PathLike[str]"], frames: Iterable[Frame]) -> int:
    """Writes a `*.frames.jsonl` file, which `conelane drive --follow` takes, and returns the number of frames. If writing fails,
    an old file stays unchanged."""
    count, half = 0, Path(f"{os.fspath(file)}.part-{os.getpid()}")
    try:
        with open(half, "w", encoding="utf-8") as stream:
            for count, frame in enumerate(frames, 1):
                stream.write(_as_line(frame) + "\n")
        half.replace(file)
    finally:
        half.unlink(missing_ok=True)
    return count


def _number(of: Any, key: str, place: str) -> float:
    value = of.get(key) if isinstance(of, dict) else None
    if type(value) not in (int, float) or not abs(value) <= sys.float_info.max:
        raise ValueError(f"{place}{key}: {'is missing' if value is None else 'must be a finite number'}")
    return float(value)


def _column(cones: List[Dict[str, Any]], key: str, absent: Any, what: str) -> Optional[NDArray[Any]]:
    """What cones have for a key, and what stands for it in those without; None where no cone has it."""
    values = [cone.get(key) for cone in cones]
    if all(value is None for value in values):
        return None
    for i, (value, other) in enumerate(zip(values, absent)):
        parts, like = np.array(value, dtype=object), np.array(other, dtype=object)
        if value is not None and (parts.shape != like.shape or not {type(part) for part in parts.flat} <= {int, *map(type, like.flat)}):
            raise ValueError(f"cones[{i}].{key}: must be {what}")
    return np.array([other if value is None else value for value, other in zip(values, absent)])


def _frame(line: Dict[str, Any]) -> Frame:
    """Raises ValueError, naming the key."""
    x, y, yaw = (_number(line.get("pose"), key, "pose.") for key in ("x", "y", "yaw"))
    cones = line.get("cones")
    if not isinstance(cones, list):
        raise ValueError("cones: must be an array")
    places = [[_number(cone, key, f"cones[{i}].") for key in ("x", "y")] for i, cone in enumerate(cones)]
    names = [str(cone.get("color") or "unknown") for cone in cones]
    for i, name in enumerate(names):
        if name not in Color.__members__:
            raise ValueError(f"cones[{i}].color: '{name}' is not a colour; colours are {', '.join(Color.__members__)}")
    labels = np.array([Color[name] for name in names], dtype=np.uint8)
    ids, confidences, covariances = (_column(cones, key, [absent] * len(cones), what) for key, absent, what in (
        ("id", NO_ID, "an integer"), ("confidence", 1.0, "a number"), ("position_covariance", np.zeros((2, 2)), "[[xx, xy], [xy, yy]]")))
    colors = _column(cones, "color_probabilities", np.eye(len(Color))[labels], "5 numbers")
    return Frame(np.array(places).reshape(-1, 2), (x, y, yaw), line["time_s"], ids, labels if colors is None else colors, confidences,
                 covariances)


def read_frames(file: Union[str, "os.PathLike[str]"], interval_s: float = 0.1) -> Iterator[Optional[Frame]]:
    """The frames of a file, as `conelane drive --follow` reads it; None where another run begins.

    interval_s: Time between frames that have no time [s].
    Raises ValueError, naming file, line and key.
    """
    for number, line in frame_lines(os.fspath(file), interval_s):
        try:
            yield None if "reset" in line else _frame(line)
        except ValueError as error:
            raise ValueError(f"{file}:{number}: {error}") from None
