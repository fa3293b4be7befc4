"""What a detector of the package takes, answers and refuses."""
import json
import sys
import threading
import time
import unittest
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np

import conelane

# A straight lane, 3 m wide, along +x: right cones have even indices.
STRAIGHT = np.array([[x, y] for x in (2.0, 6.0, 10.0, 14.0) for y in (-1.5, 1.5)])
ORIGIN = (0.0, 0.0, 0.0)
# A file as `conelane train front` writes it.
WEIGHTS = Path(__file__).parents[2] / "graph_search" / "weights" / "front.json"


class Answers(unittest.TestCase):
    def test_every_method_finds_the_straight_lane(self):
        for name, meaning in conelane.methods().items():
            with self.subTest(name):
                detector = conelane.Detector(name)
                self.assertEqual((detector.name, detector.meaning), (name, meaning))
                lane = detector.detect(STRAIGHT, ORIGIN, time_limit_ms=None)
                self.assertTrue(lane.found)
                self.assertEqual(lane.left.tolist(), [1, 3, 5, 7])
                self.assertEqual(lane.right.tolist(), [0, 2, 4, 6])
                self.assertEqual(lane.method, name)

    def test_sides_are_indices_whatever_the_ids(self):
        lane = conelane.Detector("front").detect(STRAIGHT, ORIGIN, time_limit_ms=None, ids=np.arange(8)[::-1] * 10 - 20)
        self.assertEqual(lane.left.tolist(), [1, 3, 5, 7])
        self.assertEqual(lane.ids.tolist(), [50, 40, 30, 20, 10, 0, -10, -20])
        np.testing.assert_array_equal(lane.left_points, STRAIGHT[1::2])
        np.testing.assert_array_equal(lane.right_points, STRAIGHT[::2])

    def test_the_pose_decides_what_is_left(self):
        lane = conelane.Detector("rld-pair").detect(STRAIGHT, (16.0, 0.0, np.pi), time_limit_ms=None)
        self.assertEqual(lane.left.tolist(), [6, 4, 2, 0])
        np.testing.assert_allclose(lane.pose, [16.0, 0.0, np.pi])

    def test_the_centre_line_runs_in_the_middle(self):
        line = conelane.Detector("front").detect(STRAIGHT, (2.0, 0.0, 0.0), time_limit_ms=None).centre_line(step_m=1.0)
        self.assertEqual(line.shape, (13, 7))  # from the car to the last cones, 12 m ahead
        s, x, y, heading, curvature, left, right = line.T
        np.testing.assert_allclose(s, np.arange(13.0))
        np.testing.assert_allclose(x, s + 2.0, atol=1e-9)
        for zero in (y, heading, curvature):
            np.testing.assert_allclose(zero, 0.0, atol=1e-9)
        np.testing.assert_allclose(left, 1.5, atol=1e-9)
        np.testing.assert_allclose(right, 1.5, atol=1e-9)

    def test_what_a_method_knows_of_its_answer(self):
        front = conelane.Detector("front").detect(STRAIGHT, ORIGIN, time_limit_ms=None)
        self.assertTrue(0.0 <= front.confidence <= 1.0)
        self.assertGreater(front.trusted_m, 0.0)
        self.assertIsNone(front.objective)
        rld = conelane.Detector("rld-pair").detect(STRAIGHT, ORIGIN, time_limit_ms=None)
        self.assertIsNone(rld.confidence)
        self.assertAlmostEqual(rld.objective, rld.bound)

    def test_no_cones_no_lane(self):
        for nothing in ([], np.zeros((0, 2))):
            lane = conelane.Detector("front").detect(nothing, ORIGIN, time_limit_ms=None)
            self.assertEqual((lane.status, lane.found, len(lane.left), len(lane.right)), ("none", False, 0, 0))
            self.assertEqual(lane.centre_line().shape, (0, 7))

    def test_no_time_no_lane(self):
        lane = conelane.Detector("rld-pair").detect(STRAIGHT, ORIGIN, time_limit_ms=0.0)
        self.assertEqual((lane.status, lane.stopped_by), ("stopped", "time"))
        self.assertTrue(conelane.Detector("rld-pair").detect(STRAIGHT, ORIGIN, time_limit_ms=None).found)

    def test_options(self):
        near = conelane.Detector("front", nearest=4).detect(STRAIGHT, ORIGIN, time_limit_ms=None)
        self.assertEqual((near.left.tolist(), near.right.tolist()), ([1, 3], [0, 2]))
        # Edges of 4 m cost too much where a boundary's cones are expected 1 m apart.
        dense = conelane.Detector("rld-pair", parameters={"d_e": 1.0, "d_t": 0.2, "s_crit": 0.1})
        self.assertEqual(dense.detect(STRAIGHT, ORIGIN, time_limit_ms=None).status, "none")
        self.assertTrue(conelane.Detector("rld-context", parameters="context", pairing="paper")
                        .detect(STRAIGHT, ORIGIN, time_limit_ms=None).found)

    def test_numbers_of_any_type_and_layout(self):
        expected = conelane.Detector("clc").detect(STRAIGHT, ORIGIN, time_limit_ms=None).left.tolist()
        whole = STRAIGHT.astype(int) * 1
        for cones in (STRAIGHT.tolist(), STRAIGHT.astype(np.float32), np.asfortranarray(STRAIGHT),
                      np.repeat(STRAIGHT, 2, axis=0)[::2], np.hstack([STRAIGHT, STRAIGHT])[:, :2]):
            self.assertEqual(conelane.Detector("clc").detect(cones, ORIGIN, time_limit_ms=None).left.tolist(), expected)
        np.testing.assert_array_equal(conelane.Detector("clc").detect(whole, ORIGIN, time_limit_ms=None).cones, whole)

    def test_colours_by_name_and_by_code(self):
        names = ["yellow", "blue"] * 4
        codes = [conelane.Color.yellow, conelane.Color.blue] * 4
        for colors in (names, np.array(names), codes, np.array(codes, dtype=np.uint8)):
            lane = conelane.Detector("front").detect(STRAIGHT, ORIGIN, time_limit_ms=None, colors=colors)
            self.assertEqual(lane.colors.tolist(), [2, 1] * 4)
        rows = [[0.1, 0.2, 0.7, 0, 0], [0, 0.5, 0.25, 0.25, 0]] * 4
        lane = conelane.Detector("front").detect(STRAIGHT, ORIGIN, time_limit_ms=None, colors=rows)
        self.assertEqual(lane.colors.tolist(), [2, 1] * 4)
        scene = conelane.Scene(STRAIGHT, ORIGIN, colors=rows)
        self.assertEqual(scene.color_probabilities.tolist(), rows)
        self.assertEqual(conelane.Scene(STRAIGHT, ORIGIN, colors=names).color_probabilities[0].tolist(),
                         [0, 0, 1, 0, 0])

    def test_covariances_are_zero_by_default_and_shorten_what_is_trusted(self):
        front = conelane.Detector("front")
        without = front.detect(STRAIGHT, ORIGIN, time_limit_ms=None)
        matrices = np.tile([[0.04, 0.01], [0.01, 0.09]], (8, 1, 1))
        for zero in (np.zeros((8, 2, 2)), np.zeros((8, 2, 2), dtype=int).tolist()):
            lane = front.detect(STRAIGHT, ORIGIN, time_limit_ms=None, covariances=zero)
            self.assertEqual((lane.left.tolist(), lane.confidence, lane.trusted_m),
                             (without.left.tolist(), without.confidence, without.trusted_m))
        self.assertLess(front.detect(STRAIGHT, ORIGIN, time_limit_ms=None, covariances=1e4 * matrices).trusted_m, without.trusted_m)
        scene = conelane.Scene(STRAIGHT, ORIGIN, covariances=matrices)
        np.testing.assert_array_equal(scene.covariances, matrices)
        self.assertIsNone(conelane.Scene(STRAIGHT, ORIGIN).covariances)
        self.assertEqual(front.detect_scene(scene, time_limit_ms=None).trusted_m,
                         front.detect(STRAIGHT, ORIGIN, time_limit_ms=None, covariances=matrices).trusted_m)
        np.testing.assert_array_equal(
            conelane.Planner().update(STRAIGHT, ORIGIN, 0.0, time_limit_ms=None, covariances=matrices).centre_line,
            conelane.Planner().update(STRAIGHT, ORIGIN, 0.0, time_limit_ms=None).centre_line)

    def test_scenes_with_noise_by_range_have_covariances(self):
        track = conelane.load_tracks("generated:circle")[0]
        scene = conelane.generate_scenes(track, every_m=50.0, noise_by_range=0.02)[0]
        far_m = np.hypot(*(scene.cones - scene.pose[:2]).T)
        np.testing.assert_allclose(scene.covariances[:, 0, 0], (0.02 * far_m) ** 2, atol=1e-6)
        self.assertIsNone(conelane.generate_scenes(track, every_m=50.0)[0].covariances)

    def test_an_answer_keeps_its_own_cones(self):
        cones = STRAIGHT.copy()
        lane = conelane.Detector("front").detect(cones, ORIGIN, time_limit_ms=None)
        cones[:] = 0.0
        lane.cones[:] = 0.0
        np.testing.assert_array_equal(lane.cones, STRAIGHT)


class OwnWeights(unittest.TestCase):
    def test_the_shipped_file_by_path_and_by_bytes_is_the_shipped_detector(self):
        shipped = conelane.Detector("front").detect(STRAIGHT, ORIGIN, time_limit_ms=None)
        for weights in (WEIGHTS, str(WEIGHTS), WEIGHTS.read_bytes()):
            lane = conelane.Detector("front", weights=weights).detect(STRAIGHT, ORIGIN, time_limit_ms=None)
            self.assertEqual((lane.left.tolist(), lane.confidence, lane.trusted_m),
                             (shipped.left.tolist(), shipped.confidence, shipped.trusted_m))

    def test_other_weights_answer_otherwise(self):
        own = json.loads(WEIGHTS.read_text())
        own["usable_output_bias"] = [own["usable_output_bias"][0] - 3.0]
        lanes = [conelane.Detector("front-warm", weights=weights).detect(STRAIGHT, ORIGIN, time_limit_ms=None)
                 for weights in (WEIGHTS, json.dumps(own).encode())]
        self.assertLess(lanes[1].confidence, lanes[0].confidence - 1e-3)


class Refusals(unittest.TestCase):
    def check(self, message, cones=STRAIGHT, pose=ORIGIN, **more):
        with self.assertRaises(ValueError) as raised:
            conelane.Detector("front").detect(cones, pose, **more)
        self.assertEqual(str(raised.exception), message)

    def test_numbers_that_are_not_finite(self):
        broken = STRAIGHT.copy()
        broken[3, 1] = np.nan
        self.check("cones[3].y: must be a finite number", broken)
        self.check("pose.yaw: must be a finite number", pose=(0, 0, np.inf))
        self.check("time_limit_ms: is not a number", time_limit_ms=float("nan"))
        self.check("cones[1].confidence: must be in [0, 1]", confidences=[1, 1.5] + [1] * 6)

    def test_an_id_twice(self):
        self.check("cones[7].id: cone id 3 is there twice", ids=[0, 1, 2, 3, 4, 5, 6, 3])

    def test_shapes(self):
        self.check("cones: has shape (8, 3), not (N, 2)", np.zeros((8, 3)))
        self.check("cones: has shape (2,), not (N, 2)", [1.0, 2.0])
        self.check("pose: has shape (2,), not (3,): x, y, yaw", pose=(0, 0))
        self.check("ids: has shape (7,), not (8,) as cones", ids=np.arange(7))
        self.check("colors: has shape (1,), not (8,) as cones", colors=["blue"])
        self.check("confidences: has shape (8, 1), not (8,) as cones", confidences=np.ones((8, 1)))

    def test_dtypes(self):
        self.check("cones: has dtype complex128, not real numbers", STRAIGHT * 1j)
        self.check("cones: has dtype <U3, not real numbers", STRAIGHT.astype("U3"))
        self.check("cones: has dtype object, not real numbers", np.array([[None, 1]]))
        self.check("ids: has dtype float64, not whole numbers", ids=np.arange(8.0))
        self.check("ids[1]: is above 2^63 - 1", ids=np.array([0, 2**63] + [1] * 6, dtype=np.uint64))
        self.check("colors: has shape (8, 4), not (8, 5) or (8,)", colors=np.zeros((8, 4)))
        self.check("cones[0].color_probabilities: must add up to 1", colors=np.zeros((8, 5)))
        self.check("cones[0].color_probabilities: must be in [0, 1]", colors=np.full((8, 5), 2.0))
        self.check("covariances: has shape (8, 4), not (8, 2, 2)", covariances=np.zeros((8, 4)))
        self.check("covariances: has shape (7, 2, 2), not (8, 2, 2)", covariances=np.zeros((7, 2, 2)))
        self.check("covariances[0]: must be a finite number", covariances=np.full((8, 2, 2), np.nan))
        self.check("covariances[0]: must be symmetric", covariances=np.tile([[1.0, 0.5], [0.0, 1.0]], (8, 1, 1)))
        self.check("covariances[0]: must be positive semidefinite",
                   covariances=np.tile([[1.0, 2.0], [2.0, 1.0]], (8, 1, 1)))
        self.check("colors: has dtype float64, not names or codes of colours", colors=np.zeros(8))
        self.check("colors[0]: 'red' is not a colour; colours are unknown, blue, yellow, orange, big_orange", colors=["red"] * 8)
        self.check("colors[2]: 7 is not a colour; colours are 0 to 4: unknown, blue, yellow, orange, big_orange",
                   colors=[0, 0, 7, 0, 0, 0, 0, 0])

    def test_names_and_options(self):
        whole = WEIGHTS.read_bytes()
        cut = whole[:whole.index(b",", 5000)]
        newline = b"\n"
        for message, call in (
            ("there is no detector 'fron', only " + ", ".join(conelane.methods()), lambda: conelane.Detector("fron")),
            ("there is no option 'closest', only nearest, parameters, pairing, weights",
             lambda: conelane.Detector("front", closest=3)),
            ("there is no option 'closest'", lambda: conelane.Planner(closest=None)),
            ("weights: \\xff.json: cannot be read", lambda: conelane.Detector("front", weights="\udcff.json")),
            ("d_e: is not a number", lambda: conelane.Detector("rld-pair", parameters={"d_e": True})),
            ("centre_line: must be finite numbers", lambda: conelane.speed_profile([[0.0, 0, 0, 0, np.nan, 0, 0]])),
            ("nearest: must be a whole number, at least 1", lambda: conelane.Detector("front", nearest=0)),
            ("nearest: must be a whole number, at least 1", lambda: conelane.Detector("front", nearest=2.5)),
            ("parameters: there is no 'd_f', only d_e", lambda: conelane.Detector("rld-pair", parameters={"d_f": 1})),
            ("d_e: is not a number", lambda: conelane.Detector("rld-pair", parameters={"d_e": "far"})),
            ("d_e", lambda: conelane.Detector("rld-pair", parameters={"d_e": -1.0})),
            ("pairing: 'far' is not one of near_far, paper", lambda: conelane.Detector("rld-pair", pairing="far")),
            ("parameters: is of the detectors rld-..., 'clc' has none",
             lambda: conelane.Detector("clc", parameters="context")),
            ("weights: is of front, front-warm and rld-strip, 'clc' has none",
             lambda: conelane.Detector("clc", weights=WEIGHTS)),
            ("weights: is neither the path nor the bytes of a file", lambda: conelane.Detector("front", weights=3)),
            ("weights: nowhere.json: cannot be read", lambda: conelane.Detector("front", weights="nowhere.json")),
            ("weights: line 1: must be a JSON object", lambda: conelane.Detector("front", weights=b"[]")),
            (f"weights: line {cut.count(newline) + 1}: the file ends in the middle",
             lambda: conelane.Detector("front", weights=cut)),
            ("step_m", lambda: conelane.Detector("clc").detect(STRAIGHT, ORIGIN, time_limit_ms=None).centre_line(step_m=0.0)),
            ("usual_width_m: must be in [",
             lambda: conelane.Detector("clc").detect(STRAIGHT, ORIGIN, time_limit_ms=None).centre_line(usual_width_m=0.5)),
        ):
            with self.subTest(message), self.assertRaises(ValueError) as raised:
                call()
            self.assertIn(message, str(raised.exception))

    def test_none_is_no_scene_and_no_lane(self):
        for call in (lambda: conelane.Detector("clc").detect_scene(None), lambda: conelane.write_scenes("none", [None]),
                     lambda: conelane.read_lanes("none", [None]), lambda: conelane.write_lanes("none", [None])):
            with self.assertRaisesRegex(TypeError, "must not be None"):
                call()

    def test_a_detector_goes_on_after_an_error(self):
        detector = conelane.Detector("front-warm")
        with self.assertRaises(ValueError):
            detector.detect(STRAIGHT * np.nan, ORIGIN)
        self.assertTrue(detector.detect(STRAIGHT, ORIGIN, time_limit_ms=None).found)


def run_together(calls):
    """Runs the calls in threads that start at once; the results in order. What a thread raises is raised here."""
    gate = threading.Barrier(len(calls))
    with ThreadPoolExecutor(len(calls)) as pool:
        return list(pool.map(lambda call: (gate.wait(), call())[1], calls))


class Threads(unittest.TestCase):
    def setUp(self):
        track = conelane.load_tracks("generated:curvy")[0]
        self.scenes = conelane.generate_scenes(track, false_positive_rate=0.3, every_m=5.0)

    @staticmethod
    def lanes_of(detector, scenes):
        lanes = [detector.detect_scene(scene, time_limit_ms=None) for scene in scenes]
        return [(lane.status, lane.left.tolist(), lane.right.tolist()) for lane in lanes]

    def test_detectors_of_several_threads_answer_as_alone(self):
        names = ["front", "clc", "rld-pair", "front"]
        alone = [self.lanes_of(conelane.Detector(name), self.scenes) for name in names]
        together = run_together([lambda name=name: self.lanes_of(conelane.Detector(name), self.scenes)
                                 for name in names])
        self.assertEqual(together, alone)

    def test_one_detector_may_be_called_from_several_threads(self):
        detector = conelane.Detector("front")
        alone = self.lanes_of(detector, self.scenes)
        for lanes in run_together([lambda: self.lanes_of(detector, self.scenes)] * 4):
            self.assertEqual(lanes, alone)

    def test_python_goes_on_while_a_search_runs(self):
        cones = np.random.default_rng(1).uniform(-15.0, 15.0, (150, 2))  # the proof takes longer than the limit
        searched = threading.Event()
        lane = []

        def search():
            lane.append(conelane.Detector("rld-pair").detect(cones, ORIGIN, time_limit_ms=2000.0))
            searched.set()

        interval = sys.getswitchinterval()
        thread = threading.Thread(target=search)
        thread.start()
        longest, ticks, last = 0.0, 0, time.perf_counter()
        while not searched.is_set():
            time.sleep(0.001)
            now = time.perf_counter()
            longest, ticks, last = max(longest, now - last), ticks + 1, now
        thread.join()
        self.assertGreater(lane[0].latency_ms, 100.0, "the search is too short to say anything")
        self.assertGreater(ticks, 10)
        self.assertLess(longest, lane[0].latency_ms / 2000.0 + interval)


class Plot(unittest.TestCase):
    def test_a_lane_is_drawn_and_where_there_is_none_the_cones_are(self):
        import matplotlib

        matplotlib.use("Agg")
        from matplotlib import pyplot

        figure, ax = pyplot.subplots()
        lane = conelane.Detector("front").detect(STRAIGHT, ORIGIN, time_limit_ms=None)
        self.assertIs(lane.plot(ax), ax)
        drawn = {line.get_label(): line.get_xydata() for line in ax.get_lines()}
        self.assertEqual(set(drawn), {"cones", "left", "right", "centre line"})
        np.testing.assert_array_equal(drawn["left"], STRAIGHT[1::2])
        np.testing.assert_array_equal(drawn["right"], STRAIGHT[::2])
        np.testing.assert_array_equal(drawn["centre line"], lane.centre_line()[:, 1:3])
        pyplot.close(figure)
        ax = conelane.Detector("clc").detect([[1.0, 2.0]], ORIGIN).plot()
        self.assertEqual([line.get_label() for line in ax.get_lines()], ["cones"])
        pyplot.close("all")


if __name__ == "__main__":
    unittest.main()
