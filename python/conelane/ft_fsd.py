"""The planner of ft-fsd-path-planning (FaSTTUBe), answered by conelane.

A program that says

    from fsd_path_planning import ConeTypes, MissionTypes, PathPlanner

says `from conelane.ft_fsd import ...` instead and stays as it is otherwise. What differs is written at `PathPlanner`.
"""
from __future__ import annotations

from enum import IntEnum
from typing import List, Optional, Sequence, Tuple, Union

import numpy as np
from numpy.typing import NDArray

from . import Color, Detector, Lane

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


_COLOR_OF = {
    ConeTypes.UNKNOWN: Color.unknown,
    ConeTypes.YELLOW: Color.yellow,
    ConeTypes.BLUE: Color.blue,
    ConeTypes.ORANGE_SMALL: Color.orange,
    ConeTypes.ORANGE_BIG: Color.orange,
}
_SAME_CONE_M = 0.8  # a cone of two calls, as slow maps move
_FARTHEST_START_M = 3.0  # a lane is wider than twice this nowhere, so the car is not in it
_STEP_M = 0.1  # of the line that a path is read off
_WIDEST_MATCH_M = 6.5  # cones of both sides farther apart are no pair
_SHORTEST_REST_M = 1.0  # less of an old path is no path
_SLACK_M = 2.0  # how much farther than the car has moved its place on an old path may be

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]
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


class PathPlanner:
    """Path from cones, call by call, with the interface of ft-fsd-path-planning.

    Parameters
    ----------
    mission : MissionTypes
        Skidpad is not supported; all others are planned alike.
    experimental_performance_improvements : bool
        Without effect.
    methods : sequence of str
        Detectors, out of `conelane.methods()`. The first one whose lane has both boundaries and the colours that
        belong there is taken; else the first that has one boundary alone.
    path_length_m : float
        The path ends there [m], or where the lane does.
    points : int
        M, rows of the path.
    time_limit_ms : float
        Of each call, all detectors together [ms].
    max_path_age : int
        Calls in a row without a lane of their own in which the last path is still returned; 0 for none.

    Attributes
    ----------
    path_age : int or None
        Of the path returned last: 0 where it is of that call's cones, n where its lane was found n calls before; None
        where there was no path.

    Raises
    ------
    ValueError
        For the mission skidpad, for an unknown method and for none.

    Notes
    -----
    What differs from ft-fsd-path-planning:

    - **No path is an array of no rows**, shape (0, 4): where no lane was found yet, or none for more than
      `max_path_age` calls, or where nothing of the last path lies ahead of the car. A controller brakes then.
    - A path of an earlier call is flagged by `path_age`. It is what is left of it: it begins beside the car, and goes no
      farther than it did.
    - The path begins at the car's foot point on the centre line, and at the car itself only where the lane begins
      ahead of it.
    - Where the lane that is seen is shorter than `path_length_m`, the rows are closer together instead of going on
      where no cone is. The path ends too where a cone of a side has the colour of the other one.
    - No virtual cones are made up: the arrays with virtual cones are those of the sorted ones.

    Examples
    --------
    >>> import numpy as np
    >>> from conelane.ft_fsd import ConeTypes, MissionTypes, PathPlanner
    >>> cones = [np.zeros((0, 2)) for _ in ConeTypes]
    >>> cones[ConeTypes.LEFT] = np.array([[0, 1.5], [4, 1.5], [8, 1.5]])
    >>> cones[ConeTypes.RIGHT] = np.array([[0, -1.5], [4, -1.5], [8, -1.5]])
    >>> planner = PathPlanner(MissionTypes.trackdrive)
    >>> path = planner.calculate_path_in_global_frame(cones, np.array([0.0, 0.0]), np.array([1.0, 0.0]))
    >>> path.shape
    (40, 4)
    """

    def __init__(
        self,
        mission: MissionTypes,
        experimental_performance_improvements: bool = False,
        *,
        methods: Sequence[str] = ("front-warm", "front", "clc"),
        path_length_m: float = 20.0,
        points: int = 40,
        time_limit_ms: float = 50.0,
        max_path_age: int = 5,
    ) -> None:
        if mission == MissionTypes.skidpad:
            raise ValueError("mission: skidpad is not supported: its circles cross, which is no lane")
        if not path_length_m > 0.0 or points < 2 or not methods:
            raise ValueError("path_length_m must be above 0, points at least 2, methods at least 1")
        if max_path_age < 0:
            raise ValueError("max_path_age: must not be below 0")
        self.mission = MissionTypes(mission)
        self._detectors = [Detector(method) for method in methods]
        self._length_m = path_length_m
        self._points = points
        self._time_limit_ms = time_limit_ms
        self._memory = _ConeMemory()
        self._max_path_age = max_path_age
        self.path_age: Optional[int] = None
        self._last_path = np.zeros((0, 4))  # what is left of it
        self._last_place = np.zeros(2)  # of the car, where it was cut

    def calculate_path_in_global_frame(
        self,
        cones: Sequence[FloatArray],
        vehicle_position: FloatArray,
        vehicle_direction: Union[FloatArray, float],
        return_intermediate_results: bool = False,
    ) -> Union[FloatArray, Intermediate]:
        """Path ahead of the car.

        Parameters
        ----------
        cones : sequence of five (N, 2) ndarray of float
            Positions [m] by `ConeTypes`.
        vehicle_position : (2,) ndarray of float
            x, y of the car [m].
        vehicle_direction : (2,) ndarray of float, or float
            Along the car, of any length above 0; or its yaw [rad].
        return_intermediate_results : bool
            Return all seven results instead of the path alone.

        Returns
        -------
        path : (M, 4) ndarray of float
            s [m], x, y [m], curvature [1/m]. Where no lane is found, or none within 3 m of the car: what is left of the
            last path, see `path_age`; of shape (0, 4) where there is no path.
        sorted_left, sorted_right : (L, 2), (R, 2) ndarray of float
            Boundaries from the car outward [m]; empty where no lane is found.
        left_with_virtual, right_with_virtual : (L, 2), (R, 2) ndarray of float
            The same, since no virtual cones are made up.
        left_to_right, right_to_left : (L,), (R,) ndarray of int
            For each cone the nearest one of the other side, -1 where none is within 6.5 m.

        Raises
        ------
        ValueError
            For wrong shapes and for numbers that are not finite.
        """
        places, colors = _merge(cones)
        pose = _pose(vehicle_position, vehicle_direction)
        planned = self._plan(places, colors, pose)
        if planned is None:
            path = self._rest_of_last_path(pose)
            left = right = np.zeros((0, 2))
        else:
            path, lane = planned
            left, right = lane.left_points, lane.right_points
            self.path_age = 0
        self._last_path, self._last_place = path, np.array(pose[:2])
        path = path.copy()
        if not return_intermediate_results:
            return path
        return path, left, right, left.copy(), right.copy(), _nearest(left, right), _nearest(right, left)

    def _plan(self, places: FloatArray, colors: IntArray,
              pose: Tuple[float, float, float]) -> Optional[Tuple[FloatArray, Lane]]:
        """The path to be driven and its lane."""
        ids = self._memory.ids_of(places)
        left_ms = self._time_limit_ms
        of_one_boundary = None
        for detector in self._detectors:
            lane = detector.detect(places, pose, ids=ids, colors=colors, time_limit_ms=left_ms)
            left_ms -= lane.latency_ms
            path = self._path_of(lane)
            if path is None:
                continue
            if len(lane.left) and len(lane.right):
                return path, lane
            of_one_boundary = of_one_boundary or (path, lane)
        return of_one_boundary

    def _path_of(self, lane: Lane) -> Optional[FloatArray]:
        line = _as_coloured(lane.centre_line(step_m=_STEP_M), lane)
        if len(line) < 2:
            return None
        rows = np.vstack([_way_to(line[0], lane.pose), line[:, [0, 1, 2, 4]]])  # s, x, y, curvature
        rows[:, 0] = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(rows[:, 1:3], axis=0), axis=1))])
        if np.linalg.norm(rows[0, 1:3] - lane.pose[:2]) > _FARTHEST_START_M:
            return None
        s = np.linspace(0.0, min(self._length_m, rows[-1, 0]), self._points)
        return np.column_stack([s] + [np.interp(s, rows[:, 0], rows[:, column]) for column in (1, 2, 3)])

    def _rest_of_last_path(self, pose: Tuple[float, float, float]) -> FloatArray:
        """The last path from the car on, a call older; no rows where it is too old or nothing of it lies ahead."""
        age = None if self.path_age is None else self.path_age + 1
        self.path_age = None
        if age is None or age > self._max_path_age:
            return np.zeros((0, 4))
        path, place = self._last_path, np.array(pose[:2])
        along = np.array([np.cos(pose[2]), np.sin(pose[2])])
        s = np.unique(np.append(np.arange(0.0, path[-1, 0], _STEP_M), path[-1, 0]))
        line = np.column_stack([np.interp(s, path[:, 0], path[:, column]) for column in (1, 2, 3)])
        # The car is not far along from where it was: the other leg of a hairpin may be nearer to it.
        near = s <= np.linalg.norm(place - self._last_place) + _SLACK_M
        distance = np.linalg.norm(line[:, :2] - place, axis=1)
        foot = int(distance[near].argmin())
        while foot + 1 < len(s) and (line[foot, :2] - place) @ along < 0.0:
            foot += 1
        if distance[foot] > _FARTHEST_START_M or s[-1] - s[foot] < _SHORTEST_REST_M:
            return np.zeros((0, 4))
        if (line[foot + 1, :2] - line[foot, :2]) @ along < 0.0:  # the car drives against it
            return np.zeros((0, 4))
        self.path_age = age
        rest = np.linspace(s[foot], s[-1], self._points)
        return np.column_stack([rest - rest[0]] + [np.interp(rest, s, line[:, column]) for column in range(3)])


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


def _as_coloured(line: FloatArray, lane: Lane) -> FloatArray:
    """A centre line as far as colours bear it out, since detectors do not look at them.

    It ends beside the last cone of a side before the first one of the other side's colour; there is none where that is
    the first or the second cone.
    """
    colors, places = lane.colors, lane.cones
    for side, other in ((lane.left, Color.yellow), (lane.right, Color.blue)):
        wrong = np.flatnonzero(colors[side] == other)
        if len(wrong) and wrong[0] < 2:
            return line[:0]
        if len(wrong) and len(line):
            last = places[side[wrong[0] - 1]]
            line = line[: np.linalg.norm(line[:, 1:3] - last, axis=1).argmin() + 1]
    return line


def _way_to(start: FloatArray, pose: FloatArray) -> FloatArray:
    """Rows from the car up to the first row of a centre line that begins ahead of it; none where it does not.

    A cubic that leaves along the car and arrives along the lane.
    """
    along = np.array([np.cos(pose[2]), np.sin(pose[2])])
    gap = start[1:3] - pose[:2]
    if gap @ along < _STEP_M:
        return np.zeros((0, 4))
    distance = np.linalg.norm(gap)
    leaving, arriving = distance * along, distance * np.array([np.cos(start[3]), np.sin(start[3])])
    bend = 3.0 * gap - 2.0 * leaving - arriving  # p(t) = pose + leaving t + bend t^2 + twist t^3
    twist = leaving + arriving - 2.0 * gap
    t = np.linspace(0.0, 1.0, int(np.ceil(distance / _STEP_M)), endpoint=False)[:, None]
    places = pose[:2] + leaving * t + bend * t**2 + twist * t**3
    (dx, dy), (ddx, ddy) = (leaving + 2.0 * bend * t + 3.0 * twist * t**2).T, (2.0 * bend + 6.0 * twist * t).T
    curvature = (dx * ddy - dy * ddx) / np.hypot(dx, dy) ** 3
    return np.column_stack([np.zeros(len(t)), places, curvature])


def _nearest(of: FloatArray, among: FloatArray) -> IntArray:
    if not len(of) or not len(among):
        return np.full(len(of), -1)
    distance = np.linalg.norm(of[:, None, :] - among[None, :, :], axis=2)
    best = distance.argmin(axis=1)
    return np.where(distance.min(axis=1) <= _WIDEST_MATCH_M, best, -1)
