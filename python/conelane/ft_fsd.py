"""A replacement for the planner of ft-fsd-path-planning (FaSTTUBe), based on conelane.

A program that says

    from fsd_path_planning import ConeTypes, MissionTypes, PathPlanner

needs only `from conelane.ft_fsd import ...` instead. The differences are listed at `PathPlanner`.
"""
from __future__ import annotations

from enum import IntEnum
from typing import Any, Dict, List, NoReturn, Optional, Sequence, Tuple, Union

import numpy as np
from numpy.typing import NDArray

from . import Color, Plan, Planner

__all__ = ["ConeTypes", "MissionTypes", "PathPlanner"]


class ConeTypes(IntEnum):
    """Places of the five arrays of cones."""

    UNKNOWN = 0
    RIGHT = YELLOW = 1
    LEFT = BLUE = 2
    START_FINISH_AREA = ORANGE_SMALL = 3
    START_FINISH_LINE = ORANGE_BIG = 4


class MissionTypes(IntEnum):
    """What the car does."""

    none = 0
    acceleration = 1
    skidpad = 2
    autocross = 3
    trackdrive = 4
    ebs_test = 5
    inspection = 6
    manual_driving = 7


_COLOR_OF = {ConeTypes.UNKNOWN: Color.unknown, ConeTypes.YELLOW: Color.yellow, ConeTypes.BLUE: Color.blue,
             ConeTypes.ORANGE_SMALL: Color.orange, ConeTypes.ORANGE_BIG: Color.big_orange}
_EVENTS = (MissionTypes.acceleration, MissionTypes.skidpad, MissionTypes.autocross)  # all others drive laps
_MISSIONS_OF_A_MAP = (MissionTypes.acceleration, MissionTypes.skidpad)
_WITHOUT_END = 1_000_000_000  # laps of a mission that is not a dynamic event
_SAME_CONE_M = 0.8  # a cone of two calls, as slow maps move
_GUESSED_M = 5.0  # of a lane that is a guess
_SHORT_OF_A_WALL = 2  # points of the centre line, 0.5 m each
_SHORTEST_M = 3.0  # of a path: colours end it no earlier
_CONTRADICTION = 3  # more cones of the other side's colour than of the own
_SAME_PLACE_M = 0.1  # of a car that has not moved
_LONGEST_WAY_M = 2.0  # of a car between calls that are compared
_MOVED_M = 0.3  # cones that have moved, beyond noise
_COMPARED_CONES = 12  # the nearest ones
_FIT = 0.5  # share of the distances that is left if a drive explains them
_SURE_CALLS = 5  # whose cones have moved
_MOST_CONES = 5000  # whose places are kept
_WIDEST_MATCH_M = 6.5  # cones of both sides farther apart are no pair

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]
_Pose = Tuple[float, float, float]
_ORIGIN: _Pose = (0.0, 0.0, 0.0)
# Drives that may explain how cones moved from call to call.
_WAY_M, _TURN_RAD = (drives.reshape(-1, 1)
                     for drives in np.meshgrid(np.arange(0.3, 3.0, 0.15), np.arange(-0.4, 0.41, 0.02)))
_Seen = Dict[int, Tuple[FloatArray, IntArray]]  # by id: the last place of a cone, and its sightings by colour
Intermediate = Tuple[FloatArray, FloatArray, FloatArray, FloatArray, FloatArray, IntArray, IntArray]


class _ConeMemory:
    """Gives a cone the id that it had in the last call: that of the nearest one within 0.8 m."""

    def __init__(self) -> None:
        self._places = np.zeros((0, 2))
        self._ids = np.zeros(0, dtype=np.int64)
        self._next = 0

    def ids_of(self, cones: FloatArray) -> IntArray:
        ids = np.full(len(cones), -1, dtype=np.int64)
        distance = np.linalg.norm(cones[:, None, :] - self._places[None, :, :], axis=2)
        new, old = np.nonzero(distance <= _SAME_CONE_M)
        taken = np.zeros(len(self._places), dtype=bool)
        for pair in np.argsort(distance[new, old], kind="stable"):  # the nearest pairs first
            if ids[new[pair]] < 0 and not taken[old[pair]]:
                ids[new[pair]] = self._ids[old[pair]]
                taken[old[pair]] = True
        fresh = ids < 0
        ids[fresh] = np.arange(self._next, self._next + fresh.sum())
        self._next += int(fresh.sum())
        self._places, self._ids = cones, ids
        return ids


class _FrameCheck:
    """Tells the cones' frame of reference from what moves between calls."""

    def __init__(self) -> None:
        self._first: Optional[Tuple[FloatArray, _Pose]] = None  # since the car has its place
        self._last: Optional[Tuple[FloatArray, _Pose]] = None
        self._drives = 0  # successive calls in which the cones moved
        self.is_cars = False  # the cones move as seen from a car that drives, and its place stays
        self.has_moved = False  # the place, in any call

    @property
    def is_sure(self) -> bool:
        return self._drives >= _SURE_CALLS

    def observe(self, cones: FloatArray, pose: _Pose) -> None:
        now = cones, pose
        last, self._last = self._last, now
        if self._first is None or last is None:
            self._first = now
        elif _way_m(self._first[1], pose) > _SAME_PLACE_M:
            # Cones that move with the car look as from a place that stays.
            moved = _way_m(last[1], pose) < _LONGEST_WAY_M and _has_driven(last[0], _ORIGIN, cones, _ORIGIN)
            self._drives = self._drives + 1 if moved else 0
            self._first, self.is_cars, self.has_moved = now, False, True
        elif not (self.is_sure and self.is_cars):
            self._drives = self._drives + 1 if _has_driven(*last, *now) else 0
            self.is_cars = self.is_cars or self._drives > 0 or _has_driven(*self._first, *now)


def _way_m(a: _Pose, b: _Pose) -> float:
    return float(np.hypot(b[0] - a[0], b[1] - a[1]))


def _has_driven(before: FloatArray, pose_before: _Pose, now: FloatArray, pose_now: _Pose) -> bool:
    """Whether cones lie as seen before and after a drive of 0.3 to 3 m, and few stayed in place."""
    before = _nearest_cones(before, pose_before, 3 * _COMPARED_CONES)
    now = _nearest_cones(now, pose_now, _COMPARED_CONES)
    count = min(len(before), len(now))
    if count < 4:
        return False
    stood_m = float(_nearest_m(now, before[None], count // 5)[0])
    if stood_m < _MOVED_M:
        return False
    before, now = _from_car(before, pose_before), _from_car(now, pose_now)
    x, y = before[:, 0] - _WAY_M * np.cos(_TURN_RAD / 2.0), before[:, 1] - _WAY_M * np.sin(_TURN_RAD / 2.0)
    cos, sin = np.cos(_TURN_RAD), np.sin(_TURN_RAD)
    driven_m = _nearest_m(now, np.stack([x * cos + y * sin, y * cos - x * sin], axis=-1), 2 * count // 5)
    return bool(driven_m.min() < _FIT * stood_m)


def _nearest_cones(cones: FloatArray, pose: _Pose, count: int) -> FloatArray:
    return cones[np.linalg.norm(cones - pose[:2], axis=1).argsort()[:count]]


def _from_car(places: FloatArray, pose: _Pose) -> FloatArray:
    cos, sin = np.cos(pose[2]), np.sin(pose[2])
    return (places - pose[:2]) @ np.array([[cos, -sin], [sin, cos]])


def _nearest_m(places: FloatArray, sets: FloatArray, rank: int) -> FloatArray:
    """Distance of places to the nearest ones of each set: the one with this rank."""
    distance = np.linalg.norm(places[:, None] - sets[:, None], axis=-1).min(axis=-1)
    return np.partition(distance, rank, axis=1)[:, rank]


def _absent(names: str, instead: str) -> property:
    """Attributes of the original that have no meaning here: to read or to set one is an error."""

    def refuse(*_: Any) -> NoReturn:
        raise AttributeError(f"PathPlanner has no {names}: {instead}")

    return property(refuse, refuse)


class PathPlanner:
    """Path from cones, call by call, with the interface of ft-fsd-path-planning: a thin wrapper around `conelane.Planner`.

    mission: acceleration, skidpad, autocross and trackdrive are driven to their stop; all others as laps without end.
    experimental_performance_improvements: Without effect.
    detector: One of `conelane.methods()`.
    laps: Of trackdrive, by default 10, and of autocross, by default 1.
    path_length_m: Length of the path [m]; shorter if the lane ends before.
    points: M, rows of the path.
    time_limit_ms: Of each call [ms]; None for no limit.
    max_path_age: For at most this many calls without a lane, `interval_s` apart, the last path is returned; 0 for none.
    interval_s: Time between calls that give no `time_s` [s].
    frame: Frame of reference of cones and pose, "map" or "car". By default recognised: in the car's, the cones move as
        the car drives while `vehicle_position` stays. There each call is answered by itself.

    Its attributes:
    path_age: Of the path returned last: 0 where its lane is of that call's cones, n where it was found n calls
        before; None where there was no path.
    plan: Of the last call: its state, `stop`, `lap`, `phase` and how far it is safe.
    frame: "map" or "car": how the last call was answered.
    relocalization_info: None in missions of laps, like the original. In acceleration and skidpad an `AttributeError`.

    Raises ValueError for an unknown detector or frame, for `laps` of a mission that has none, and for values out of range.

    What differs from ft-fsd-path-planning:

    - **Without a path the array has no rows**, shape (0, 4): where no lane was found yet, or none for more than
      `max_path_age` calls, or where nothing of the last path lies ahead of the car. A controller brakes then. As long
      as the plan has a path, there are rows.
    - `path_age` flags a path of an earlier call. Then its rest is returned: from beside the car to where the earlier
      path ended.
    - `plan.stop` says that the last line is crossed. The path ends where the car has to be at rest.
    - The path begins at the car's foot point on the centre line, and at the car itself only where the lane begins
      ahead of it.
    - Where the lane that is seen is shorter than `path_length_m`, the rows are closer together instead of going on
      where no cone is. The path also ends, but not in its first 3 m, where colours contradict the lane: where in a
      stretch of a side three more cones have the other side's colour than this side's (two more at the side's end), and
      before it crosses a line between successive cones of a side that have this side's colour. A single contradicting
      cone counts as miscoloured.
    - No virtual cones are made up: the arrays with virtual cones are those of the sorted ones. In acceleration and
      skidpad, once their place is found, the path is that of the rules, laid onto the cones, and the sorted arrays are
      empty. `ebs_test` is driven as laps.
    - In a map calls have a memory: one planner serves one run, call by call. In the car's frame there is none: no laps
      are counted, nothing says stop, and a call without a lane has no path. There acceleration, skidpad and a
      `vehicle_position` that moves are a `ValueError`.
    - `cone_sorting`, `cone_matching`, `pathing`, `config`, `relocalizer`, `global_path` and `set_global_path` are
      refused by an `AttributeError`. `mission` cannot be assigned. There is no `RelocalizationInformation`.
    - Invalid input is a `ValueError`, and the planner stays unchanged.

    >>> import numpy as np
    >>> from conelane.ft_fsd import ConeTypes, MissionTypes, PathPlanner
    >>> cones = [np.zeros((0, 2)) for _ in ConeTypes]
    >>> cones[ConeTypes.LEFT] = np.array([[0, 1.5], [4, 1.5], [8, 1.5]])
    >>> cones[ConeTypes.RIGHT] = np.array([[0, -1.5], [4, -1.5], [8, -1.5]])
    >>> planner = PathPlanner(MissionTypes.trackdrive)
    >>> path = planner.calculate_path_in_global_frame(cones, np.array([0.0, 0.0]), np.array([1.0, 0.0]))
    >>> path.shape
    (40, 4)
    >>> planner.plan.state
    'following'
    """

    def __init__(self, mission: MissionTypes, experimental_performance_improvements: bool = False, *,
                 detector: str = "front-warm", laps: Optional[int] = None, path_length_m: float = 20.0, points: int = 40,
                 time_limit_ms: Optional[float] = 50.0, max_path_age: int = 5, interval_s: float = 0.1,
                 frame: Optional[str] = None) -> None:
        if frame not in (None, "map", "car"):
            raise ValueError(f"frame: is '{frame}', not 'map', 'car' or None")
        if not path_length_m > 0.0 or points < 2 or not interval_s > 0.0:
            raise ValueError("path_length_m and interval_s must be above 0, points at least 2")
        if max_path_age < 0:
            raise ValueError("max_path_age: must not be below 0")
        self._mission = MissionTypes(mission)
        self._given_frame = frame
        if self.mission not in (*_EVENTS, MissionTypes.trackdrive):
            laps = _WITHOUT_END if laps is None else laps
        # Half a call more: sums of intervals are not exact.
        self._planner = Planner(self.mission.name if self.mission in _EVENTS else "trackdrive", detector, laps,
                                max_age_s=(max_path_age + 0.5) * interval_s if max_path_age else 0.0)
        self._without_memory = Planner("trackdrive", detector)
        self._frame_check = _FrameCheck()
        self._length_m = path_length_m
        self._points = points
        self._time_limit_ms = time_limit_ms
        self._interval_s = interval_s
        self._time_s: Optional[float] = None
        self._memory = _ConeMemory()
        self._seen: _Seen = {}  # those seen last at the end
        self._calls = 0  # since the lane was found
        self._end: Optional[FloatArray] = None  # where colours say that the lane ends
        self.frame = frame or "map"
        self.path_age: Optional[int] = None
        self.plan: Optional[Plan] = None

    cone_sorting = cone_matching = pathing = config = _absent(
        "cone_sorting, cone_matching, pathing, config", "choose its detector, path_length_m and points")
    global_path = set_global_path = _absent(
        "global_path, set_global_path", "its path is that of the cones, and after a lap it knows the course")
    relocalizer = _absent("relocalizer", "it lays the known course onto the cones of the map by itself")

    @property
    def mission(self) -> MissionTypes:
        return self._mission

    @property
    def relocalization_info(self) -> None:
        if self.mission in _MISSIONS_OF_A_MAP:
            raise AttributeError(f"PathPlanner has no relocalization_info in {self.mission.name}: its paths are in the "
                                 "frame of the cones")

    def calculate_path_in_global_frame(self, cones: Sequence[FloatArray], vehicle_position: FloatArray,
                                       vehicle_direction: Union[FloatArray, float],
                                       return_intermediate_results: bool = False, *,
                                       time_s: Optional[float] = None) -> Union[FloatArray, Intermediate]:
        """Path ahead of the car.

        cones: Positions [m] by `ConeTypes`.
        vehicle_position: (2,), x, y of the car [m].
        vehicle_direction: (2,), along the car, of any length above 0; or its yaw [rad].
        return_intermediate_results: Return all seven results instead of the path alone.
        time_s: When the cones were seen, by any clock that never goes back [s]. By default `interval_s` after the
            last call.

        Returns the path, or all seven:
        path: (M, 4), s [m], x, y [m], curvature [1/m]. Where no lane is found: the rest of the last path, see
            `path_age`; of shape (0, 4) where there is no path.
        sorted_left, sorted_right: Boundaries of this call's lane from the car outward [m]; empty where no lane is
            found.
        left_with_virtual, right_with_virtual: The same, since no virtual cones are made up.
        left_to_right, right_to_left: For each cone the index of the other side's nearest cone; -1 if that is over 6.5 m away.

        Raises ValueError for wrong shapes and for numbers that are not finite; the planner then stays unchanged. Also for
            cones in the car's frame in acceleration and skidpad, or while `vehicle_position` moves.
        """
        places, colors = _merge(cones)
        pose = _pose(vehicle_position, vehicle_direction)
        if not np.isfinite(pose).all():
            raise ValueError("vehicle_position, vehicle_direction: must be finite numbers")
        if time_s is None:
            time_s = 0.0 if self._time_s is None else self._time_s + self._interval_s
        if not np.isfinite(time_s):
            raise ValueError("time_s: must be a finite number")
        self.frame = self._frame_of(places, pose)
        planner, memory, seen = self._planner, self._memory, self._seen
        if self.frame == "car":  # each call by itself
            planner, memory, seen = self._without_memory, _ConeMemory(), {}
            planner.reset()
        ids = memory.ids_of(places)
        _remember(seen, ids, places, colors)
        self.plan = planner.update(places, pose, time_s, ids=ids, colors=colors, time_limit_ms=self._time_limit_ms)
        self._time_s = time_s if self._time_s is None else max(time_s, self._time_s)
        is_fresh = self.plan.state in ("following", "finished") and self.plan.age_s == 0.0
        left = right = np.zeros((0, 2))
        if is_fresh:
            self._end = None
            left = self._boundary(self.plan.answer.left_ids, seen, Color.blue, Color.yellow)
            right = self._boundary(self.plan.answer.right_ids, seen, Color.yellow, Color.blue)
            self._cut_guess()
        path = self._path()
        self._calls = 0 if is_fresh else self._calls + 1
        self.path_age = self._calls if len(path) else None
        if not return_intermediate_results:
            return path
        return path, left, right, left.copy(), right.copy(), _nearest(left, right), _nearest(right, left)

    def _frame_of(self, places: FloatArray, pose: _Pose) -> str:
        """Of this call's cones: "map", or "car", where memory is of no use. Refuses what makes no sense."""
        if self._given_frame == "map":
            return "map"
        check = self._frame_check
        check.observe(places, pose)
        if check.has_moved and (self._given_frame == "car" or (check.is_sure and not check.is_cars)):
            raise ValueError("vehicle_position: moves, though the cones are in the car's frame: give a place that stays "
                             "with them, or give both in a map")
        if self.mission in _MISSIONS_OF_A_MAP:
            if self._given_frame == "car" or (check.is_cars and check.is_sure and not check.has_moved):
                raise ValueError(f"mission {self.mission.name}: the cones are in the car's frame, and only a map says "
                                 "where the car has to stop: give cones and pose in a map")
            return "map"
        return "car" if check.is_cars or self._given_frame == "car" else "map"

    def _boundary(self, ids: IntArray, seen: _Seen, own: Color, other: Color) -> FloatArray:
        """Places of a boundary. Notes where its colours contradict the lane: the lane ends beside the last cone before.
        Also notes where the driven lane, which may be another one, crosses the line between two cones of the own
        colour."""
        known = [seen[cone] for cone in ids.tolist() if cone in seen]
        places = np.array([place for place, _ in known]).reshape(-1, 2)
        colors = _most_seen(np.array([sightings for _, sightings in known]).reshape(-1, len(Color)))
        line = self.plan.centre_line[:, 1:3]
        if not len(line):
            return places
        wrong = _first_contradiction((colors == other).astype(int) - (colors == own))
        if wrong is not None:
            self._end_at(line[_along(line, places[wrong - 1]) if wrong else 0])
        is_own = colors == own
        crossing = _first_crossing(line, places, np.flatnonzero(is_own[:-1] & is_own[1:]))
        if crossing is not None:
            self._end_at(line[max(0, crossing - _SHORT_OF_A_WALL)])
        return places

    def _end_at(self, end: FloatArray) -> None:
        """The path ends here, or where it had to end before."""
        line = self.plan.centre_line[:, 1:3]
        if self._end is None or _along(line, end) < _along(line, self._end):
            self._end = end

    def _cut_guess(self) -> None:
        """A lane of one boundary of which nothing is trusted is a guess: its beginning alone is a path."""
        line = self.plan.centre_line
        if self.plan.answer.confidence is not None or self.plan.safe_m > 0.0 or len(line) == 0:
            return
        self._end_at(line[np.abs(line[:, 0] - _GUESSED_M).argmin(), 1:3])

    def _path(self) -> FloatArray:
        line = self.plan.centre_line
        if len(line) < 2:
            return np.zeros((0, 4))
        length = min(self._length_m, line[-1, 0])
        if self._end is not None:
            length = min(length, max(_SHORTEST_M, line[_along(line[:, 1:3], self._end), 0]))
        s = np.linspace(0.0, length, self._points)
        return np.column_stack([s] + [np.interp(s, line[:, 0], line[:, column]) for column in (1, 2, 4)])


def _merge(cones: Sequence[FloatArray]) -> Tuple[FloatArray, IntArray]:
    """All cones as one array, with their colours."""
    if len(cones) != len(ConeTypes):
        raise ValueError(f"cones: {len(cones)} arrays, not {len(ConeTypes)} in the order of ConeTypes")
    arrays: List[FloatArray] = []
    for kind, given in zip(ConeTypes, cones):
        array = np.asarray(given, dtype=float)
        if array.size and (array.ndim != 2 or array.shape[1] != 2):
            raise ValueError(f"cones[{kind:d}]: has shape {array.shape}, not (N, 2)")
        if not np.isfinite(array).all():
            raise ValueError(f"cones[{kind:d}]: must be a finite number")
        arrays.append(array.reshape(-1, 2))
    colors = np.repeat([_COLOR_OF[kind] for kind in ConeTypes], [len(array) for array in arrays])
    return np.concatenate(arrays), colors


def _pose(position: FloatArray, direction: Union[FloatArray, float]) -> Tuple[float, float, float]:
    place = np.asarray(position, dtype=float)
    if place.shape != (2,):
        raise ValueError(f"vehicle_position: has shape {place.shape}, not (2,)")
    along = np.squeeze(np.asarray(direction, dtype=float))
    if along.shape == ():
        return float(place[0]), float(place[1]), float(along)
    if along.shape != (2,) or not along.any():
        raise ValueError("vehicle_direction: is neither an angle nor two numbers of which one is not 0")
    return float(place[0]), float(place[1]), float(np.arctan2(along[1], along[0]))


def _remember(seen: _Seen, ids: IntArray, places: FloatArray, colors: IntArray) -> None:
    for cone, place, color in zip(ids.tolist(), places, colors):
        _, sightings = seen.pop(cone, (place, np.zeros(len(Color), dtype=np.int64)))
        sightings[color] += 1
        seen[cone] = (place, sightings)
    while len(seen) > _MOST_CONES:
        del seen[next(iter(seen))]


def _most_seen(sightings: IntArray) -> IntArray:
    """The colour that each cone had most often; unknown where two had it equally often."""
    known = sightings[:, 1:]
    is_most = known == known.max(axis=1, keepdims=True)
    return np.where(is_most.sum(axis=1) == 1, 1 + is_most.argmax(axis=1), Color.unknown)


def _first_contradiction(votes: IntArray) -> Optional[int]:
    """Index of the first cone of a stretch whose colours contradict a lane. Votes: 1 of a cone of the other side's
    colour, -1 of one of the own. One cone alone is a miscoloured one: three more votes against are needed in a
    stretch, two at the end of the boundary, where no later cone can speak for it."""
    total = best = first = begin = 0
    for i, vote in enumerate([*votes.tolist(), 1]):
        if total <= 0:
            total, begin = 0, i
        total += vote
        if total > best:
            best, first = total, begin
    return first if best >= _CONTRADICTION else None


def _along(line: FloatArray, place: FloatArray) -> int:
    """Index of the point of a line that is nearest to a place."""
    return int(np.linalg.norm(line - place, axis=1).argmin()) if len(line) else 0


def _first_crossing(line: FloatArray, wall: FloatArray, segments: Sequence[int]) -> Optional[int]:
    """Index of the first point of a line after which it crosses one of these segments of a wall."""
    chosen = np.array(segments, dtype=int)
    a, b, c, d = line[:-1, None], line[1:, None], wall[None, chosen], wall[None, chosen + 1]
    crosses = (_side(a, b, c) * _side(a, b, d) < 0.0) & (_side(c, d, a) * _side(c, d, b) <= 0.0)
    points = np.flatnonzero(crosses.any(axis=1))
    return int(points[0]) if len(points) else None


def _side(a: FloatArray, b: FloatArray, c: FloatArray) -> FloatArray:
    """1 where c lies left of the line from a to b, -1 where it lies right of it."""
    return np.sign((b[..., 0] - a[..., 0]) * (c[..., 1] - a[..., 1]) - (b[..., 1] - a[..., 1]) * (c[..., 0] - a[..., 0]))


def _nearest(of: FloatArray, among: FloatArray) -> IntArray:
    if not len(of) or not len(among):
        return np.full(len(of), -1)
    distance = np.linalg.norm(of[:, None, :] - among[None, :, :], axis=2)
    best = distance.argmin(axis=1)
    return np.where(distance.min(axis=1) <= _WIDEST_MATCH_M, best, -1)
