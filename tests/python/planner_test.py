"""conelane.Planner: a drawn lane and a lap, frame by frame. How planners behave is tested in C++ (planner_contract_test)."""
import threading
import unittest

import numpy as np

import conelane

COLUMNS = 7


def straight(x0=0.0, x1=60.0):
    """Cones every 4 m on both sides of the x axis, and their ids."""
    x = np.arange(x0, x1, 4.0)
    cones = np.vstack([np.column_stack([x, np.full(len(x), 1.75)]), np.column_stack([x, np.full(len(x), -1.75)])])
    return cones, np.arange(len(cones))


def in_view(cones, pose, range_m=20.0):
    ahead = (cones - pose[:2]) @ [np.cos(pose[2]), np.sin(pose[2])]
    return (ahead >= 0.0) & (np.linalg.norm(cones - pose[:2], axis=1) <= range_m)


def oval():
    """Cones of a course of two straights of 20 m and half circles of 8 m, and the car's pose by way driven."""
    lap = 40.0 + 16.0 * np.pi

    def pose(s):
        s = s % lap
        for length, start, yaw, curvature in ((10, (0, 0), 0, 0), (8 * np.pi, (10, 0), 0, 1 / 8), (20, (10, 16), np.pi, 0),
                                              (8 * np.pi, (-10, 16), np.pi, 1 / 8), (10, (-10, 0), 2 * np.pi, 0)):
            if s <= length:
                break
            s -= length
        x, y = start
        if curvature:
            turn = yaw + s * curvature
            return np.array([x + (np.sin(turn) - np.sin(yaw)) / curvature,
                             y + (np.cos(yaw) - np.cos(turn)) / curvature, turn])
        return np.array([x + s * np.cos(yaw), y + s * np.sin(yaw), yaw])

    cones = []
    for s in np.linspace(0.0, lap, 30, endpoint=False):
        x, y, yaw = pose(s)
        for side in (1.75, -1.75):
            cones.append([x - side * np.sin(yaw), y + side * np.cos(yaw)])
    return np.array(cones), pose, lap


class Straight(unittest.TestCase):
    def setUp(self):
        self.cones, self.ids = straight()

    def update(self, planner, x, time_s, **more):
        pose = np.array([x, 0.0, 0.0])
        seen = in_view(self.cones, pose)
        if more.pop("with_ids", True):
            more["ids"] = self.ids[seen]
        return planner.update(self.cones[seen], pose, time_s, time_limit_ms=None, **more)

    def test_a_plan_says_what_to_drive(self):
        planner = conelane.Planner(mission="trackdrive", detector="front-warm", laps=3)
        self.assertEqual((planner.mission, planner.detector), ("trackdrive", "front-warm"))
        for with_ids in (True, False):
            planner.reset()
            for i in range(4):
                plan = self.update(planner, 0.5 * i, 0.1 * i, with_ids=with_ids)
            self.assertEqual((plan.state, plan.lap, plan.stop, plan.phase, plan.age_s), ("following", 0, False, "", 0.0))
            line = plan.centre_line
            self.assertEqual(line.shape[1], COLUMNS)
            self.assertEqual(line[0, 0], 0.0)
            self.assertAlmostEqual(line[0, 1], 1.5, delta=0.3)
            self.assertGreater(line[-1, 0], 14.0)
            np.testing.assert_allclose(line[:, 2], 0.0, atol=0.05)
            np.testing.assert_allclose(line[:, 5:], 1.75, atol=0.1)
            self.assertTrue(0.0 < plan.safe_m <= line[-1, 0] + 0.5)
            self.assertGreater(plan.latency_ms, 0.0)
            answer = plan.answer
            self.assertTrue(answer.found)
            self.assertEqual((answer.status, answer.message, answer.stopped_by), ("found", "", None))
            self.assertGreater(answer.confidence, 0.5)
            self.assertGreater(answer.trusted_m, 5.0)
            if with_ids:
                self.assertLessEqual(set(answer.left_ids), set(range(15)))
                self.assertLessEqual(set(answer.right_ids), set(range(15, 30)))
            else:
                self.assertTrue((answer.left_ids < 0).all())
            self.assertIsNone(planner.course())

    def test_a_plan_has_the_options_and_the_lane_of_cpp(self):
        missing = np.isin(np.arange(len(self.cones)), [2])  # a cone of the left boundary
        cones = self.cones[~missing & (self.cones[:, 0] < 20.0)]
        smooth, rough = (conelane.Planner(step_m=1.0, smoothing_m=m, max_gap_m=g) for m, g in ((3.0, 5.5), (0.25, 9.0)))
        bend = np.column_stack([cones[:, 0], cones[:, 1] + 0.02 * cones[:, 0] ** 2])
        lanes = [planner.update(bend, (0, 0, 0), 0.0, time_limit_ms=None).lane for planner in (smooth, rough)]
        np.testing.assert_allclose(np.diff(lanes[0].centre_line[:, 0]), 1.0)
        self.assertFalse(np.allclose(lanes[0].centre_line[:10, 4], lanes[1].centre_line[:10, 4], atol=1e-3))
        self.assertFalse(lanes[0].closed or lanes[0].left_inferred or lanes[0].right_inferred)
        self.assertEqual(([side for side, _, _ in lanes[0].bridged], lanes[1].bridged), (["left"], []))
        _, start, end = lanes[0].bridged[0]
        self.assertTrue(5.5 < end - start < 9.0)
        self.assertGreaterEqual(lanes[0].length_m, lanes[0].trusted_m)
        for key in ("step_m", "smoothing_m", "max_gap_m", "default_width_m"):
            with self.assertRaisesRegex(ValueError, f"{key}: must be"):
                conelane.Planner(**{key: -1.0})

    def test_one_boundary_alone_infers_the_other(self):
        right = [[x, -1.5] for x in (2, 5, 8, 11, 14)]
        plan = conelane.Planner(default_width_m=5.0).update(right, (0, 0, 0), 0.0, time_limit_ms=None)
        self.assertTrue(plan.lane.left_inferred)
        np.testing.assert_allclose(plan.lane.centre_line[:, 5:].sum(axis=1), 5.0, atol=1e-6)
        lane = conelane.Detector("front").detect(right, (0, 0, 0), time_limit_ms=None)
        self.assertEqual((lane.drivable().left_inferred, lane.drivable().right_inferred), (True, False))
        np.testing.assert_array_equal(lane.drivable(default_width_m=4.0).centre_line, lane.centre_line(usual_width_m=4.0))

    def test_what_is_wrong_is_named_and_changes_nothing(self):
        planner, same = conelane.Planner(), conelane.Planner()
        for i in range(3):
            for message, arguments, more in (
                    (r"cones\[0\]\.y: must be a finite number", ([[0.0, np.nan]], (0, 0, 0), 0.1 * i), {}),
                    ("pose: has shape", ([[0.0, 1.0]], (0, 0), 0.1 * i), {}),
                    (r"pose\.yaw", ([[0.0, 1.0]], (0, 0, np.inf), 0.1 * i), {}),
                    ("time_s: is not finite", ([[0.0, 1.0]], (0, 0, 0), np.nan), {}),
                    ("time_s: is not a number", ([[0.0, 1.0]], (0, 0, 0), "now"), {}),
                    ("time_limit_ms", ([[0.0, 1.0]], (0, 0, 0), 0.1 * i), {"time_limit_ms": np.nan}),
                    ("ids: has shape", ([[0.0, 1.0]], (0, 0, 0), 0.1 * i), {"ids": [1, 2]}),
                    (r"cones\[1\]\.id", ([[0.0, 1.0], [1.0, 1.0]], (0, 0, 0), 0.1 * i), {"ids": [7, 7]}),
                    ("colors", ([[0.0, 1.0]], (0, 0, 0), 0.1 * i), {"colors": ["green"]}),
                    (r"cones\[0\]\.confidence", ([[0.0, 1.0]], (0, 0, 0), 0.1 * i), {"confidences": [2.0]})):
                with self.subTest(message), self.assertRaisesRegex(ValueError, message):
                    planner.update(*arguments, **more)
            plan, expected = self.update(planner, 0.5 * i, 0.1 * i), self.update(same, 0.5 * i, 0.1 * i)
            np.testing.assert_array_equal(plan.centre_line, expected.centre_line)

    def test_options(self):
        for message, options in (("mission: there is no 'rally', only trackdrive", {"mission": "rally"}),
                                 ("only front", {"detector": "magic"}),
                                 ("laps", {"laps": 0}),
                                 ("laps", {"mission": "skidpad", "laps": 4}),
                                 ("laps", {"mission": "acceleration", "laps": 1}),
                                 ("max_age_s", {"max_age_s": -1.0}),
                                 ("weights", {"detector": "clc", "weights": b"{}"}),
                                 ("there is no option 'max_age', only mission, detector, laps, max_age_s, ", {"max_age": 2})):
            with self.subTest(message), self.assertRaisesRegex(ValueError, message):
                conelane.Planner(**options)
        self.assertEqual(repr(conelane.Planner("skidpad")), "<conelane.Planner 'skidpad' by 'front-warm'>")

    def test_planners_of_threads_are_independent(self):
        alone = [self.update(conelane.Planner(), 0.0, 0.0).centre_line]
        results = []

        def run():
            planner = conelane.Planner()
            for i in range(5):
                results.append((i, self.update(planner, 0.5 * i, 0.1 * i).centre_line))

        threads = [threading.Thread(target=run) for _ in range(4)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        self.assertEqual(len(results), 20)
        for i, line in results:
            if i == 0:
                np.testing.assert_array_equal(line, alone[0])


class Laps(unittest.TestCase):
    def test_a_lap_gives_the_course_and_the_last_one_ends_the_run(self):
        cones, pose_at, lap = oval()
        planner = conelane.Planner("autocross")
        stop_at = None
        for i, s in enumerate(np.arange(0.0, lap + 6.0, 0.6)):
            pose = pose_at(s)
            seen = in_view(cones, pose)
            plan = planner.update(cones[seen], pose, 0.1 * i, ids=np.flatnonzero(seen), time_limit_ms=None)
            if plan.stop and stop_at is None:
                stop_at = s
        self.assertEqual((plan.state, plan.lap), ("finished", 1))
        self.assertTrue(lap - 1e-6 <= stop_at < lap + 5.0, stop_at)
        course = planner.course()
        self.assertEqual(course.shape[1], COLUMNS)
        middle = np.array([pose_at(s)[:2] for s in np.arange(0.0, lap, 0.1)])
        off = np.linalg.norm(course[:, None, 1:3] - middle[None], axis=2).min(axis=1)
        self.assertLess(off.max(), 0.3)
        planner.reset()
        self.assertIsNone(planner.course())


if __name__ == "__main__":
    unittest.main()
