"""Laps of a car that follows the paths of conelane.ft_fsd, by cones in a map and in the car's frame, with wrong colours
and without. `--data` drives courses of CONELANE_DATA or of ../shared/data."""
import os
import sys
import unittest
from pathlib import Path

import numpy as np

import conelane
from conelane.ft_fsd import ConeTypes, MissionTypes, PathPlanner

SPEED_MS = 6.0
STEP_S = 0.1
WHEELBASE_M = 1.55
RANGE_M = 20.0
CASES = (("car", True, 0.0), ("car", True, 0.1), ("car", False, 0.0), ("map", True, 0.1), ("map", False, 0.0))


class Course:
    """Cones of a circuit, and its middle every 0.1 m."""

    def __init__(self, track):
        left, right = (self.every_decimetre(side) for side in (track.boundaries.left, track.boundaries.right))
        beside = right[[np.linalg.norm(right - place, axis=1).argmin() for place in left]]
        self.middle, self.half_width_m = (left + beside) / 2.0, np.linalg.norm(left - beside, axis=1) / 2.0
        self.cones = track.cones
        self.types = np.zeros(len(track.cones), dtype=int)
        self.types[track.left], self.types[track.right] = ConeTypes.LEFT, ConeTypes.RIGHT

    @staticmethod
    def every_decimetre(line):
        line = np.vstack([line, line[:1]])
        s = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(line, axis=0), axis=1))])
        return np.column_stack([np.interp(np.arange(0.0, s[-1], 0.1), s, line[:, k]) for k in (0, 1)])


class Car:
    """A kinematic bicycle that steers along a path, and brakes where it ends or where there is none."""

    def __init__(self, x, y, yaw):
        self.place, self.yaw, self.steering, self.speed_ms = np.array([x, y]), yaw, 0.0, 0.0

    def seen_from_it(self, places):
        cos, sin = np.cos(self.yaw), np.sin(self.yaw)
        return (places - self.place) @ np.array([[cos, -sin], [sin, cos]])

    def in_map(self, seen):
        cos, sin = np.cos(self.yaw), np.sin(self.yaw)
        return seen @ np.array([[cos, sin], [-sin, cos]]) + self.place

    def follow(self, s, path):
        goal_ms = 0.0
        if len(path):
            goal_ms = min(SPEED_MS, np.sqrt(6.0 * max(s[-1] - 0.5, 0.2)))
            x, y = path[min(np.searchsorted(s, 4.0), len(path) - 1)]
            wanted = np.clip(np.arctan(2.0 * WHEELBASE_M * y / max(x * x + y * y, 0.5)), -0.6, 0.6)
            self.steering += np.clip(wanted - self.steering, -0.25, 0.25)
        self.speed_ms += np.clip(goal_ms - self.speed_ms, -0.4, 0.3)
        for _ in range(5):
            way_m = self.speed_ms * STEP_S / 5.0
            self.place = self.place + way_m * np.array([np.cos(self.yaw), np.sin(self.yaw)])
            self.yaw += way_m / WHEELBASE_M * np.tan(self.steering)


def drive(course, frame, has_colors, wrong, seed):
    """Why a lap was not finished; "" if it was."""
    rng = np.random.default_rng(seed)
    types = course.types if has_colors else np.zeros_like(course.types)
    types = np.where((types > 0) & (rng.random(len(types)) < wrong), 3 - types, types)  # for the whole lap
    at, gone, count = 0, 0, len(course.middle)
    x, y = course.middle[10] - course.middle[0]
    car = Car(*course.middle[0], np.arctan2(y, x))
    planner = PathPlanner(MissionTypes.trackdrive, time_limit_ms=None)
    for call in range(count):  # a metre a second
        cones = car.seen_from_it(course.cones)
        seen = (cones[:, 0] > 0.0) & (np.hypot(*cones.T) < RANGE_M) & (rng.random(len(cones)) > 0.05)
        cones = cones[seen] + rng.normal(0.0, 0.1, (int(seen.sum()), 2))
        place, direction = np.zeros(2), np.array([1.0, 0.0])
        if frame == "map":
            cones, place, direction = car.in_map(cones), car.place, np.array([np.cos(car.yaw), np.sin(car.yaw)])
        by_type = [cones[types[seen] == kind] for kind in ConeTypes]
        path = planner.calculate_path_in_global_frame(by_type, place, direction)
        if not len(path) and len(planner.plan.centre_line) > 1:
            return f"no path in call {call}, though there is a plan"
        car.follow(path[:, 0], car.seen_from_it(path[:, 1:3]) if frame == "map" else path[:, 1:3])
        near = (at + np.arange(-20, 60)) % count
        off_m = np.linalg.norm(course.middle[near] - car.place, axis=1)
        gone += int(off_m.argmin()) - 20
        at = near[off_m.argmin()]
        if off_m.min() > course.half_width_m[at]:
            return f"left the lane after {gone / 10:.0f} m, call {call}"
        if gone >= count - 10:
            return "" if planner.frame == frame else f"took the cones for those of the frame {planner.frame}"
    return f"came {gone / 10:.0f} m far in {call} calls"


class Laps(unittest.TestCase):
    def finish(self, specs, seeds, cases):
        for spec in specs:
            track, = conelane.load_tracks(spec)
            course = Course(track)
            for case in cases:
                for seed in seeds:
                    with self.subTest(course=track.name, frame=case[0], has_colors=case[1], wrong=case[2], seed=seed):
                        self.assertEqual(drive(course, *case, seed), "")


class GeneratedCourses(Laps):
    def test_every_lap_is_finished(self):
        self.finish(("generated:kidney@4", "generated:infield@7"), (1,), CASES)


class RecordedCourses(Laps):
    def test_every_lap_is_finished(self):
        data = Path(os.environ.get("CONELANE_DATA", Path(__file__).parents[2].parent / "shared" / "data"))
        if not data.is_dir():
            self.skipTest("no courses in CONELANE_DATA or in ../shared/data")
        specs = [f"fsd:{data}/fsd_racetrack_dataset:{number}" for number in (1, 4)]
        specs += [f"pacsim:{data}/pacsim/{name}.yaml" for name in ("FSG19", "FSE22")]
        specs += [f"eufs:{data}/{name}.csv" for name in ("eufs/small_track", "eufs/peanut", "epfl/fsds_competition_1",
                                                         "epfl/track_2")]
        self.finish(specs, (1, 2, 3), (CASES[0], CASES[3]))


if __name__ == "__main__":
    chosen = "RecordedCourses" if "--data" in sys.argv else "GeneratedCourses"
    unittest.main(verbosity=2, argv=[sys.argv[0], chosen])  # says what is skipped, and why
