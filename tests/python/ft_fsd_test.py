"""The planner of ft-fsd-path-planning, answered by conelane: small scenes, and the recorded runs frame by frame."""
import json
import os
import unittest
from functools import partial
from pathlib import Path

import numpy as np

import conelane
from conelane import ft_fsd
from conelane.ft_fsd import ConeTypes, MissionTypes

PathPlanner = partial(ft_fsd.PathPlanner, time_limit_ms=None)  # a pause of the machine changes no answer
HERE = np.array([0.0, 0.0])
AHEAD = np.array([1.0, 0.0])


def by_type(**arrays):
    cones = [np.zeros((0, 2)) for _ in ConeTypes]
    for name, array in arrays.items():
        cones[ConeTypes[name]] = np.array(array, dtype=float)
    return cones


STRAIGHT = by_type(LEFT=[[x, 1.5] for x in (0, 4, 8, 12)], RIGHT=[[x, -1.5] for x in (0, 4, 8, 12)])


class Interface(unittest.TestCase):
    def test_the_path_of_a_straight_lane(self):
        path = PathPlanner(MissionTypes.trackdrive).calculate_path_in_global_frame(STRAIGHT, HERE, AHEAD)
        self.assertEqual(path.shape, (40, 4))
        np.testing.assert_allclose(path[:, 0], np.linspace(0, 12, 40), atol=1e-6)  # the lane ends at 12 m
        np.testing.assert_allclose(path[:, 1], path[:, 0], atol=1e-6)
        np.testing.assert_allclose(path[:, 2:], 0.0, atol=1e-6)

    def test_a_lane_that_begins_ahead_is_joined_to_the_car(self):
        path = PathPlanner(MissionTypes.trackdrive, points=400).calculate_path_in_global_frame(
            STRAIGHT, np.array([-5.0, 0.5]), np.array([np.cos(0.1), np.sin(0.1)]))
        np.testing.assert_allclose(path[0, 1:3], [-5.0, 0.5], atol=1e-6)
        steps = np.diff(path[:, 1:3], axis=0)
        heading = np.unwrap(np.arctan2(steps[:, 1], steps[:, 0]))
        self.assertAlmostEqual(heading[0], 0.1, delta=0.05)
        np.testing.assert_allclose(np.linalg.norm(steps, axis=1), np.diff(path[:, 0]), rtol=2e-2)
        # The curvature is that of the way: it turns the heading from step to step.
        turned = np.cumsum(path[:-1, 3] * np.diff(path[:, 0]))
        np.testing.assert_allclose(heading[0] + turned, heading, atol=0.05)
        np.testing.assert_allclose(path[path[:, 1] > 0.6, 2], 0.0, atol=1e-3)

    def test_a_path_of_the_length_that_is_asked_for(self):
        planner = PathPlanner(MissionTypes.autocross, path_length_m=6.0, points=7, detector="clc")
        path = planner.calculate_path_in_global_frame(STRAIGHT, HERE, AHEAD)
        np.testing.assert_allclose(path[:, 0], np.arange(7.0), atol=1e-6)

    def test_the_curvature_of_a_left_circle_is_positive(self):
        angle = np.arange(0.0, 2.2, 0.3)
        circle = np.column_stack([np.sin(angle), 1.0 - np.cos(angle)])
        cones = by_type(UNKNOWN=np.vstack([10 * circle + [0, 2], 14 * circle + [0, -2]]))  # about (0, 12)
        path = PathPlanner(MissionTypes.trackdrive).calculate_path_in_global_frame(cones, HERE, AHEAD)
        np.testing.assert_allclose(path[5:35, 3], 1 / 12, atol=0.02)

    def test_directions(self):
        for direction in (AHEAD, 5 * AHEAD, 0.0, np.array([0.0]), [1, 0]):
            path = PathPlanner(MissionTypes.trackdrive).calculate_path_in_global_frame(STRAIGHT, HERE, direction)
            np.testing.assert_allclose(path[-1, 1:3], [12, 0], atol=1e-6)

    def test_intermediate_results(self):
        planner = PathPlanner(MissionTypes.trackdrive)
        results = planner.calculate_path_in_global_frame(STRAIGHT, HERE, AHEAD, return_intermediate_results=True)
        path, left, right, left_virtual, right_virtual, to_right, to_left = results
        self.assertEqual(path.shape, (40, 4))
        np.testing.assert_array_equal(left, STRAIGHT[ConeTypes.LEFT])
        np.testing.assert_array_equal(right, STRAIGHT[ConeTypes.RIGHT])
        np.testing.assert_array_equal(left_virtual, left)
        np.testing.assert_array_equal(right_virtual, right)
        self.assertEqual((to_right.tolist(), to_left.tolist()), ([0, 1, 2, 3], [0, 1, 2, 3]))

    def test_a_cone_without_partner_is_matched_to_none(self):
        cones = by_type(LEFT=[[x, 1.5] for x in (0, 4, 8, 12)])  # one boundary alone
        planner = PathPlanner(MissionTypes.trackdrive)
        path, left, right, *_, to_right, to_left = planner.calculate_path_in_global_frame(cones, HERE, AHEAD, True)
        self.assertEqual((len(left), len(right), to_right.tolist(), to_left.tolist()), (4, 0, [-1] * 4, []))
        np.testing.assert_allclose(path[:, 2], 1.5 - 3.5 / 2)  # half the usual width beside it

    def test_a_path_ends_where_colours_contradict_the_lane(self):
        def length(left_colors):
            cones = by_type(RIGHT=[[x, -1.5] for x in (0, 4, 8, 12)])
            for x, color in zip((0, 4, 8, 12), left_colors):
                cones[ConeTypes[color]] = np.vstack([cones[ConeTypes[color]], [[x, 1.5]]])
            planner = PathPlanner(MissionTypes.trackdrive)
            found = planner.calculate_path_in_global_frame(cones, HERE, AHEAD)
            # What comes after goes no farther.
            later = planner.calculate_path_in_global_frame(by_type(), HERE, AHEAD)
            self.assertEqual(len(later), len(found))
            self.assertLess(abs(later[-1, 0] - found[-1, 0]), 0.5)
            return round(found[-1, 0], 6)

        self.assertEqual(length(["BLUE", "BLUE", "BLUE", "BLUE"]), 12)
        self.assertEqual(length(["BLUE", "ORANGE_BIG", "UNKNOWN", "BLUE"]), 12)
        self.assertEqual(length(["BLUE", "BLUE", "YELLOW", "BLUE"]), 12)  # one miscoloured cone
        self.assertEqual(length(["BLUE", "YELLOW", "BLUE", "BLUE"]), 12)
        self.assertEqual(length(["BLUE", "BLUE", "BLUE", "YELLOW"]), 12)
        self.assertEqual(length(["BLUE", "BLUE", "YELLOW", "YELLOW"]), 4)
        self.assertEqual(length(["YELLOW", "YELLOW", "YELLOW", "YELLOW"]), 3)  # the plan has a path, so there are rows

    def test_a_lane_beside_the_car_is_not_driven(self):
        planner = PathPlanner(MissionTypes.trackdrive)
        path = planner.calculate_path_in_global_frame(STRAIGHT, np.array([0.0, 8.0]), AHEAD)
        self.assertEqual((planner.path_age, path.shape), (None, (0, 4)))

    def test_the_detector_is_the_one_asked_for(self):
        # A lone boundary: clc finds no lane, front one of one boundary.
        cones = by_type(UNKNOWN=[[x, 1.5] for x in (0, 4, 8, 12)])
        for detector, boundaries, state in (("clc", (0, 0), "searching"), ("front", (4, 0), "following")):
            planner = PathPlanner(MissionTypes.trackdrive, detector=detector)
            _, left, right, *_ = planner.calculate_path_in_global_frame(cones, HERE, AHEAD, True)
            self.assertEqual((len(left), len(right)), boundaries, detector)
            self.assertEqual(planner.plan.state, state)

    def test_there_is_no_path_before_the_first_lane(self):
        planner = PathPlanner(MissionTypes.trackdrive)
        self.assertIsNone(planner.path_age)
        results = planner.calculate_path_in_global_frame(by_type(), np.array([100.0, 50.0]), AHEAD, True)
        self.assertEqual(results[0].shape, (0, 4))
        self.assertTrue(all(len(result) == 0 for result in results))
        self.assertIsNone(planner.path_age)

    def test_an_old_path_is_cut_at_the_car_and_flagged_and_ends(self):
        planner = PathPlanner(MissionTypes.trackdrive)
        found = planner.calculate_path_in_global_frame(STRAIGHT, HERE, AHEAD)
        self.assertEqual(planner.path_age, 0)
        for age in range(1, 6):
            car = np.array([1.5 * age, 0.3])
            results = planner.calculate_path_in_global_frame(by_type(), car, AHEAD, True)
            path = results[0]
            self.assertEqual((planner.path_age, path.shape), (age, (40, 4)))
            self.assertEqual(planner.plan.state, "bridging")
            self.assertAlmostEqual(path[0, 1], car[0], delta=0.1)  # beside the car
            self.assertGreaterEqual(path[:, 1].min(), car[0] - 1e-6)  # nothing behind it
            self.assertLessEqual(path[-1, 1], found[-1, 1] + 1e-6)  # no farther than it was
            self.assertGreater(path[-1, 1], found[-1, 1] - 0.5 - 1e-6)
            np.testing.assert_allclose(path[:, 0], np.linspace(0, path[-1, 1] - path[0, 1], 40), atol=1e-6)
            self.assertTrue(all(len(result) == 0 for result in results[1:]))
            path[:] = 0.0  # what a caller does to its path stays with it
        path = planner.calculate_path_in_global_frame(by_type(), np.array([9.0, 0.0]), AHEAD)
        self.assertEqual((planner.path_age, path.shape, planner.plan.state), (None, (0, 4), "lost"))  # too old
        path = planner.calculate_path_in_global_frame(by_type(), HERE, AHEAD)
        self.assertEqual((planner.path_age, path.shape), (None, (0, 4)))  # and it stays gone
        again = planner.calculate_path_in_global_frame(STRAIGHT, HERE, AHEAD)
        np.testing.assert_allclose(again, found, atol=1e-6)
        self.assertEqual(planner.path_age, 0)

    def test_the_age_follows_the_times_that_are_told(self):
        planner = PathPlanner(MissionTypes.trackdrive)
        ages = []
        for time_s, cones in ((5.0, STRAIGHT), (5.2, by_type()), (5.5, by_type()), (5.6, by_type()), (6.0, STRAIGHT)):
            planner.calculate_path_in_global_frame(cones, HERE, AHEAD, time_s=time_s)
            ages.append(planner.path_age)
        self.assertEqual(ages, [0, 1, 2, None, 0])

    def test_no_old_path_is_returned_where_none_of_it_lies_ahead(self):
        for car, direction in (((100.0, 50.0), AHEAD), ((11.5, 0.0), AHEAD), ((14.0, 0.0), AHEAD),
                               ((2.0, 4.0), AHEAD), ((2.0, 0.0), -AHEAD)):
            planner = PathPlanner(MissionTypes.trackdrive)
            planner.calculate_path_in_global_frame(STRAIGHT, HERE, AHEAD)
            path = planner.calculate_path_in_global_frame(by_type(), np.array(car), direction)
            self.assertEqual((planner.path_age, path.shape), (None, (0, 4)), (car, direction))
        planner = PathPlanner(MissionTypes.trackdrive, max_path_age=0)
        planner.calculate_path_in_global_frame(STRAIGHT, HERE, AHEAD)
        self.assertEqual(planner.calculate_path_in_global_frame(by_type(), HERE, AHEAD).shape, (0, 4))

    def test_cones_keep_their_ids_while_they_move_a_little(self):
        planner = PathPlanner(MissionTypes.trackdrive)
        ids = planner._memory.ids_of
        self.assertEqual(ids(np.array([[0.0, 0], [4, 0], [8, 0]])).tolist(), [0, 1, 2])
        # One is gone, two have moved, two are new; the new one beside an old cone is farther from it than that is.
        self.assertEqual(ids(np.array([[8.3, 0], [0.2, 0], [0.6, 0], [12, 0]])).tolist(), [2, 0, 3, 4])
        self.assertEqual(ids(np.zeros((0, 2))).tolist(), [])
        self.assertEqual(ids(np.array([[0.0, 0.0]])).tolist(), [5])

    def test_what_the_original_has_and_conelane_has_not_is_refused_aloud(self):
        planner = PathPlanner(MissionTypes.trackdrive)
        for name in ("cone_sorting", "cone_matching", "pathing", "config", "global_path", "set_global_path",
                     "relocalizer"):
            with self.assertRaisesRegex(AttributeError, name):
                getattr(planner, name)
            with self.assertRaisesRegex(AttributeError, name):
                setattr(planner, name, None)
        with self.assertRaises(AttributeError):
            planner.mission = MissionTypes.skidpad
        self.assertIsNone(planner.relocalization_info)
        self.assertFalse(hasattr(PathPlanner(MissionTypes.skidpad), "relocalization_info"))

    def test_refusals(self):
        for mission in (MissionTypes.skidpad, MissionTypes.acceleration):
            with self.assertRaisesRegex(ValueError, "laps"):
                PathPlanner(mission, laps=2)
        with self.assertRaisesRegex(ValueError, "only front"):
            PathPlanner(MissionTypes.trackdrive, detector="fsd")
        for wrong in ({"points": 1}, {"path_length_m": 0.0}, {"interval_s": 0.0}, {"interval_s": float("nan")}):
            with self.assertRaisesRegex(ValueError, "points at least 2"):
                PathPlanner(MissionTypes.trackdrive, **wrong)
        with self.assertRaisesRegex(ValueError, "max_path_age"):
            PathPlanner(MissionTypes.trackdrive, max_path_age=-1)
        plan = PathPlanner(MissionTypes.trackdrive).calculate_path_in_global_frame
        broken = by_type(BLUE=[[0, np.nan]])
        for message, arguments in (("4 arrays, not 5", (STRAIGHT[:4], HERE, AHEAD)),
                                   (r"cones\[2\]: must be a finite number", (broken, HERE, AHEAD)),
                                   (r"cones\[0\]: has shape \(1, 3\)", ([np.ones((1, 3))] + STRAIGHT[1:], HERE, AHEAD)),
                                   (r"vehicle_position: has shape \(3,\)", (STRAIGHT, np.zeros(3), AHEAD)),
                                   ("vehicle_direction: ", (STRAIGHT, HERE, np.zeros(2))),
                                   ("must be finite numbers", (STRAIGHT, np.array([np.inf, 0]), AHEAD)),
                                   ("time_s: must be a finite number", (STRAIGHT, HERE, AHEAD, np.nan))):
            with self.subTest(message), self.assertRaisesRegex(ValueError, message):
                plan(*arguments[:3], **({"time_s": arguments[3]} if len(arguments) > 3 else {}))


class Frames(unittest.TestCase):
    """In which frame cones and pose are given."""

    X = np.arange(-20.0, 120.0, 4.0)
    CONES = np.vstack([np.column_stack([X, np.full(len(X), 1.7)]), np.column_stack([X + 1.3, np.full(len(X), -1.7)])])

    def view(self, x, noise_m=0.1, missed=0.1, seed=0):
        rng = np.random.default_rng([seed, int(round(1000 * x))])
        seen = (self.CONES[:, 0] > x) & (np.hypot(self.CONES[:, 0] - x, self.CONES[:, 1]) < 20.0)
        seen &= rng.random(len(seen)) >= missed
        return self.CONES[seen] - [x, 0.0] + rng.normal(0.0, noise_m, (int(seen.sum()), 2))

    def test_cones_that_move_while_the_place_stays_are_in_the_cars_frame(self):
        for direction in (AHEAD, np.array([0.0, 1.0])):
            turn = np.array([direction, [-direction[1], direction[0]]])
            planner = PathPlanner(MissionTypes.trackdrive)
            for i, x in enumerate(np.arange(0.0, 12.0, 0.6)):
                path = planner.calculate_path_in_global_frame(by_type(UNKNOWN=self.view(x) @ turn), HERE, direction)
                self.assertEqual(planner.frame, "car" if i > 1 else planner.frame)
                self.assertEqual((planner.path_age, planner.plan.state), (0, "following"))
                np.testing.assert_allclose(path[:, 1:3] @ [-direction[1], direction[0]], 0.0, atol=0.4)
                self.assertGreater(path[-1, 0], 10.0)

    def test_a_car_at_rest_with_noisy_cones_is_not_in_its_own_frame(self):
        planner = PathPlanner(MissionTypes.trackdrive)
        for seed in range(60):
            planner.calculate_path_in_global_frame(by_type(UNKNOWN=self.view(0.0, 0.15, 0.3, seed)), HERE, AHEAD)
            self.assertEqual(planner.frame, "map", f"call {seed}")

    def test_a_pose_that_freezes_costs_no_memory(self):
        planner = PathPlanner(MissionTypes.trackdrive)
        frozen = 0
        for i, x in enumerate(np.arange(0.0, 40.0, 0.6)):
            place = x if i % 12 < 8 else 0.6 * (i - i % 12 + 7)
            cones = self.view(x) + [place, 0.0]
            path = planner.calculate_path_in_global_frame(by_type(UNKNOWN=cones), np.array([place, 0.0]), AHEAD)
            frozen += planner.frame == "car"
            self.assertEqual(planner.frame, planner.frame if i % 12 >= 8 else "map", f"call {i}")
            self.assertLess(np.abs(path[:, 2]).max(), 0.4)
        self.assertGreater(frozen, 10)
        for _ in range(5):  # nothing is seen: the memory of the map bridges it
            planner.calculate_path_in_global_frame(by_type(), np.array([40.0, 0.0]), AHEAD)
        self.assertEqual(planner.plan.state, "bridging")

    def test_the_frame_may_be_told(self):
        for frame in ("map", "car"):
            planner = PathPlanner(MissionTypes.trackdrive, frame=frame)
            for x in (0.0, 0.6, 1.2):
                planner.calculate_path_in_global_frame(by_type(UNKNOWN=self.view(x)), HERE, AHEAD)
                self.assertEqual(planner.frame, frame)
        with self.assertRaisesRegex(ValueError, "frame: is 'cars'"):
            PathPlanner(MissionTypes.trackdrive, frame="cars")

    def test_what_makes_no_sense_is_refused(self):
        for mission, is_moving, message in ((MissionTypes.acceleration, False, "mission acceleration"),
                                            (MissionTypes.skidpad, False, "mission skidpad"),
                                            (MissionTypes.trackdrive, True, "vehicle_position: moves")):
            planner = PathPlanner(mission)
            with self.assertRaisesRegex(ValueError, message):
                for x in np.arange(0.0, 12.0, 0.6):
                    place = np.array([x if is_moving else 0.0, 0.0])
                    planner.calculate_path_in_global_frame(by_type(UNKNOWN=self.view(x)), place, AHEAD)
            with self.assertRaisesRegex(ValueError, message):  # from the first call that shows it
                told = PathPlanner(mission, frame="car")
                for x in (0.0, 0.6):
                    place = np.array([x if is_moving else 0.0, 0.0])
                    told.calculate_path_in_global_frame(by_type(UNKNOWN=self.view(x)), place, AHEAD)


class Missions(unittest.TestCase):
    def test_every_mission_is_served(self):
        for mission in MissionTypes:
            planner = PathPlanner(mission)
            path = planner.calculate_path_in_global_frame(STRAIGHT, HERE, AHEAD)
            self.assertEqual(planner.plan.phase, "approach" if mission == MissionTypes.skidpad else "", mission)
            if mission not in (MissionTypes.skidpad, MissionTypes.acceleration):
                self.assertEqual((planner.plan.state, path.shape), ("following", (40, 4)), mission)

    def test_acceleration_ends_behind_its_finish(self):
        x = np.concatenate([[-0.3, 0.3], np.arange(5.0, 75.0, 5.0), [74.7, 75.3], np.arange(80.0, 130.0, 5.0)])
        cones = np.vstack([np.column_stack([x, np.full(len(x), side)]) for side in (1.9, -1.9)])
        planner = PathPlanner(MissionTypes.acceleration)
        stop_at = None
        for car in np.arange(-2.0, 90.0, 0.8):
            seen = cones[(cones[:, 0] >= car) & (np.hypot(cones[:, 0] - car, cones[:, 1]) < 20.0)]
            path = planner.calculate_path_in_global_frame(by_type(UNKNOWN=seen), np.array([car, 0.0]), AHEAD)
            if len(path):
                np.testing.assert_allclose(path[:, 2], 0.0, atol=0.3)
                self.assertAlmostEqual(path[0, 1], car, delta=0.3)
            if planner.plan.stop and stop_at is None:
                stop_at = car
        self.assertTrue(75.0 <= stop_at < 80.0, stop_at)
        self.assertEqual(planner.plan.state, "finished")

    def test_a_skidpad_anywhere_in_the_map_is_found_and_driven(self):
        """As nodes call it: the whole map in each call, and the pose of the car on it, wherever the map has its origin."""
        centres, turn = np.array([[0.0, -9.125], [0.0, 9.125]]), np.array([[np.cos(0.5), np.sin(0.5)], [-np.sin(0.5), np.cos(0.5)]])
        lane = [[x, y] for x in (-14.0, -11.0, 11.0, 14.0) for y in (1.5, -1.5)]
        rings = np.vstack([centre + radius * np.column_stack([np.cos(a), np.sin(a)]) for centre in centres for radius in (7.625, 10.625)
                           for a in [2.0 * np.pi * np.arange(16) / 16 + 0.1]])
        free = (np.abs(np.linalg.norm(rings[:, None] - centres, axis=2) - 9.125) > 1.4).all(axis=1) & (np.abs(rings[:, 1]) > 1.4)
        cones = by_type(UNKNOWN=np.vstack([rings[free], lane]) @ turn + [30.0, -12.0])
        planner, phases = PathPlanner(MissionTypes.skidpad), []
        place, ahead = np.array([-15.0, 0.0]), AHEAD
        for _ in range(600):
            path = planner.calculate_path_in_global_frame(cones, place @ turn + [30.0, -12.0], ahead @ turn)
            phases += [] if planner.plan.phase in phases[-1:] else [planner.plan.phase]
            if not len(path) or path[-1, 0] < 0.6:
                break
            points = (path[:, 1:3] - [30.0, -12.0]) @ turn.T
            place, then = (np.array([np.interp(s, path[:, 0], column) for column in points.T]) for s in (0.6, 0.9))
            ahead = (then - place) / np.linalg.norm(then - place)
            on_circle = np.abs(np.linalg.norm(place - centres, axis=1) - 9.125).min() < 0.4
            self.assertTrue(on_circle or abs(place[1]) < 0.6, place)
        self.assertEqual(phases, ["approach", "right 1", "right 2", "left 1", "left 2", "exit"])
        self.assertEqual((planner.plan.state, planner.plan.stop), ("finished", True))


def data():
    """The folder of recorded runs, or None."""
    here = Path(os.environ.get("CONELANE_DATA", Path(__file__).parents[2].parent / "shared" / "data"))
    return here / "ft_fsd" if (here / "ft_fsd").is_dir() else None


def frames(name):
    for frame in json.loads((data() / f"{name}.json").read_text(encoding="utf-8")):
        cones = [np.array(kind, dtype=float).reshape(-1, 2) for kind in frame["slam_cones"]]
        yield cones, np.array(frame["car_position"]), np.array(frame["car_direction"])


def crosses(path, wall):
    """Whether a polyline crosses another one."""
    a, b, c, d = path[:-1, None], path[1:, None], wall[None, :-1], wall[None, 1:]

    def side(p, q, r):
        return np.sign((q[..., 0] - p[..., 0]) * (r[..., 1] - p[..., 1])
                       - (q[..., 1] - p[..., 1]) * (r[..., 0] - p[..., 0]))

    return bool(((side(a, b, c) * side(a, b, d) < 0) & (side(c, d, a) * side(c, d, b) < 0)).any())


@unittest.skipIf(data() is None, "no recorded runs in CONELANE_DATA or in ../shared/data")
class RecordedRuns(unittest.TestCase):
    def test_every_path_of_two_laps_stays_inside_the_coloured_boundaries(self):
        from matplotlib.path import Path as Polygon

        track, = conelane.load_tracks(f"ftlog:{data() / 'fsg_19_2_laps.json'}")
        walls = [np.vstack([wall, wall[:1]]) for wall in (track.boundaries.left, track.boundaries.right)]
        planner = PathPlanner(MissionTypes.trackdrive)
        count = at_car = both = 0
        for i, (cones, position, direction) in enumerate(frames("fsg_19_2_laps")):
            path, left, right, *_ = planner.calculate_path_in_global_frame(cones, position, direction, True)
            count += 1
            self.assertEqual(path.shape, (0 if planner.path_age is None else 40, 4))
            self.assertTrue(np.isfinite(path).all())
            places = path[:, 1:3]
            if planner.path_age:  # of an earlier frame: it goes on from beside the car
                self.assertLessEqual(planner.path_age, 5)
                self.assertGreaterEqual((places[0] - position) @ direction, -0.6, f"frame {i}")
                self.assertGreater((places[-1] - position) @ direction, 0.0, f"frame {i}")
            if len(path) == 0:
                continue
            inside = Polygon(walls[0]).contains_points(places) != Polygon(walls[1]).contains_points(places)
            self.assertTrue(inside.all(), f"frame {i}")
            self.assertFalse(crosses(places, walls[0]) or crosses(places, walls[1]), f"frame {i}")
            at_car += np.linalg.norm(path[0, 1:3] - position) < 1.0  # no path of an earlier frame
            both += len(left) > 0 and len(right) > 0
        self.assertEqual(count, 440)
        self.assertGreater(at_car, 415)
        self.assertGreater(both, 390)

    def test_every_lane_that_is_found_can_be_driven_and_says_how_far(self):
        detector = conelane.Detector("front")
        found = of_one_boundary = 0
        for i, (cones, position, direction) in enumerate(frames("fsg_19_2_laps")):
            pose = (*position, np.arctan2(direction[1], direction[0]))
            lane = detector.detect(np.vstack(cones), pose, time_limit_ms=None)
            if not lane.found:
                self.assertEqual((len(lane.centre_line()), lane.trusted_m), (0, None), f"frame {i}")
                continue
            found += 1
            of_one_boundary += lane.confidence is None
            self.assertGreater(len(lane.centre_line()), 0, f"frame {i}")
            self.assertIsNotNone(lane.trusted_m, f"frame {i}")
            if lane.confidence is None:
                self.assertLessEqual(lane.trusted_m, 10.0)
        self.assertGreater(found, 435)
        self.assertGreater(of_one_boundary, 10)

    def test_every_frame_of_a_real_turn_has_a_path(self):
        planner = PathPlanner(MissionTypes.trackdrive)
        count = 0
        for i, (cones, position, direction) in enumerate(frames("one_turn")):
            path = planner.calculate_path_in_global_frame(cones, position, direction)
            self.assertEqual(path.shape, (40, 4))
            self.assertTrue(np.isfinite(path).all())
            self.assertLess(np.linalg.norm(path[0, 1:3] - position), 3.0, f"frame {i}")
            count += 1
        self.assertEqual(count, 111)

    def test_a_real_skidpad_has_a_path_in_each_phase(self):
        planner = PathPlanner(MissionTypes.skidpad)
        paths = {}
        for cones, position, direction in frames("skidpad"):
            path = planner.calculate_path_in_global_frame(cones, position, direction)
            if len(path):
                self.assertLess(np.linalg.norm(path[0, 1:3] - position), 2.0)
                paths[planner.plan.phase] = paths.get(planner.plan.phase, 0) + 1
        self.assertEqual(list(paths), ["approach", "right 1", "right 2", "left 1", "left 2", "exit"])
        self.assertGreater(min(paths.values()), 5)


if __name__ == "__main__":
    unittest.main(verbosity=2)  # says what is skipped, and why
