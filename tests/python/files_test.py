"""Scenes, lanes, tracks and scores: what is written is read again, and what is wrong in a file is said."""
import contextlib
import io
import json
import re
import tempfile
import unittest
import warnings
from pathlib import Path

import numpy as np

import conelane
from conelane import frames, replay

CONES = [[0, 1.5], [0, -1.5], [4, 1.5], [4, -1.5], [8, 1.5], [8, -1.5], [8, 5.0]]
TRUTH = ([0, 2, 4], [1, 3, 5])


class InFolder(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)

    def write(self, name, text):
        (self.folder / name).write_text(text, encoding="utf-8")
        return self.folder / name


class Scenes(InFolder):
    def test_a_scene_is_read_as_it_was_written(self):
        scene = conelane.Scene(CONES, (0.5, -0.25, 0.1), ids=np.arange(7) + 3, colors=["blue", "yellow"] * 3 + ["orange"],
                               confidences=np.linspace(0, 1, 7), id="a", ground_truth=TRUTH, track="t")
        conelane.write_scenes(self.folder / "s.scenes.jsonl", [scene])
        again, = conelane.read_scenes(self.folder / "s.scenes.jsonl")
        for one in (scene, again):
            self.assertEqual((one.id, one.track, one.closed), ("a", "t", False))
            np.testing.assert_array_equal(one.cones, CONES)
            np.testing.assert_array_equal(one.pose, [0.5, -0.25, 0.1])
            self.assertEqual(one.ids.tolist(), [3, 4, 5, 6, 7, 8, 9])
            self.assertEqual(one.colors.tolist(), [1, 2, 1, 2, 1, 2, 3])
            np.testing.assert_array_equal(one.confidences, np.linspace(0, 1, 7))
            self.assertEqual([side.tolist() for side in one.ground_truth], list(map(list, TRUTH)))

    def test_what_generated_scenes_say_survives(self):
        track, = conelane.load_tracks("generated:curvy")
        scenes = conelane.generate_scenes(track, false_positive_rate=0.3, condition="car", every_m=20.0, seed=3)
        conelane.write_scenes(self.folder / "1.scenes.jsonl", scenes)
        again = conelane.read_scenes(self.folder / "1.scenes.jsonl")
        conelane.write_scenes(self.folder / "2.scenes.jsonl", again)
        self.assertEqual((self.folder / "1.scenes.jsonl").read_bytes(), (self.folder / "2.scenes.jsonl").read_bytes())
        self.assertEqual((again[0].condition, again[0].false_positive_rate, again[0].range_m), ("car", 0.3, 30.0))

    def test_a_fault_is_named_with_file_line_and_key(self):
        file = self.write("bad.scenes.jsonl", '{"pose": {"x": 0, "y": 0, "yaw": 0}, "cones": [{"id": 1, "x": "far", "y": 1}]}\n')
        with self.assertRaisesRegex(ValueError, r"bad\.scenes\.jsonl:1: cones\[0\]\.x: "):
            conelane.read_scenes(file)
        with self.assertRaisesRegex(ValueError, "nowhere"):
            conelane.read_scenes(self.folder / "nowhere")
        file = self.folder / "bad.csv"  # no text
        file.write_bytes(b"tag,x,y,direction\nblue,\xff,0,0\n")
        with self.assertRaisesRegex(ValueError, r"bad\.csv:2: x: '\\xff' is not a number"):
            conelane.load_tracks(f"eufs:{file}")

    def test_a_scene_is_checked_at_once(self):
        with self.assertRaisesRegex(ValueError, r"ground_truth.left\[1\]: 7 is not an index of the 7 cones"):
            conelane.Scene(CONES, (0, 0, 0), ground_truth=([0, 7], [1]))
        with self.assertRaisesRegex(ValueError, r"cones\[0\]\.x: must be a finite number"):
            conelane.Scene([[np.nan, 0]], (0, 0, 0))

    def test_what_could_not_be_read_is_not_written(self):
        for message, make in (("cone id 0 is there twice", lambda: [conelane.Scene(CONES, (0, 0, 0), ground_truth=([0], [0, 1]))]),
                              (r"ground_truth.left: has shape \(1, 2\)", lambda: [conelane.Scene(CONES, (0, 0, 0), ground_truth=([[0, 2]], [1]))]),
                              ("has no cone", lambda: [conelane.Scene([], (0, 0, 0))]),
                              ("two scenes have the id 'a'", lambda: [conelane.Scene(CONES, (0, 0, 0), id="a")] * 2)):
            with self.subTest(message), self.assertRaisesRegex(ValueError, message):
                conelane.write_scenes(self.folder / "s.scenes.jsonl", make())


class Lanes(InFolder):
    def setUp(self):
        super().setUp()
        self.scene = conelane.Scene(CONES, (0, 0, 0), ids=np.arange(7) + 10, id="a", ground_truth=TRUTH)

    def test_a_lane_is_read_as_it_was_written(self):
        for name in ("front", "rld-pair"):
            lane = conelane.Detector(name).detect_scene(self.scene, time_limit_ms=None)
            conelane.write_lanes(self.folder / "l.lanes.jsonl", [lane])
            again, = conelane.read_lanes(self.folder / "l.lanes.jsonl", [self.scene])
            for key in ("scene_id", "method", "status", "confidence", "trusted_m", "objective", "bound", "closed"):
                self.assertEqual(getattr(again, key), getattr(lane, key), key)
            np.testing.assert_array_equal(again.left, lane.left)
            np.testing.assert_array_equal(again.right, lane.right)
            np.testing.assert_array_equal(again.centre_line(), lane.centre_line())

    def test_positions_stand_for_the_cones_they_are_at(self):
        line = '{"scene": "a", "method": "m", "status": "found", "latency_ms": 1, "left_points": [[0.1, %s], [4, %s]], "right_points": [[0, -1.5], [4, -1.5]]}'
        for y, indices in ((1.5, ([0, 2], [1, 3])), (2.5, ([], []))):  # cones, and none on the left
            lane, = conelane.read_lanes(self.write("p.lanes.jsonl", line % (y, y)), [self.scene])
            self.assertEqual((lane.left.tolist(), lane.right.tolist()), indices)
        self.assertEqual(lane.left_points.tolist(), [[0.1, 2.5], [4, 2.5]])
        np.testing.assert_allclose(lane.centre_line()[:, 2], 0.5, atol=1e-9)

    def test_faults(self):
        line = '{"scene": "%s", "method": "m", "status": "found", "left": [%d, 12], "right": [11, 13], "latency_ms": 1}\n'
        for text, message in ((line % ("b", 10), r"l\.lanes\.jsonl:1: scene: 'b' is not one of the scenes given"),
                              (line % ("a", 99), r"l\.lanes\.jsonl:1: .*99"), ("{}\n", r"l\.lanes\.jsonl:1: ")):
            with self.subTest(text), self.assertRaisesRegex(ValueError, message):
                conelane.read_lanes(self.write("l.lanes.jsonl", text), [self.scene])


class Frames(InFolder):
    def test_what_some_cones_have_is_read(self):
        file = self.write("r.frames.jsonl", '{"pose": {"x": 0, "y": 0, "yaw": 0}, "reset": false, "cones": [{"x": 1, "y": 1, "id": 7, "confidence": '
                          '0.5, "position_covariance": [[0.1, 0], [0, 0.2]], "color_probabilities": [0, 0.6, 0.4, 0, 0]}, '
                          '{"x": 2, "y": 1, "color": "yellow"}]}')
        frame, = filter(None, frames.read_frames(file))
        frames.write_frames(self.folder / "w.frames.jsonl", [frame])
        for one in (frame, next(frames.read_frames(self.folder / "w.frames.jsonl"))):
            self.assertEqual([column.tolist() for column in one[3:]], [
                [7, conelane.NO_ID], [[0, 0.6, 0.4, 0, 0], [0, 0, 1, 0, 0]], [0.5, 1], [[[0.1, 0], [0, 0.2]], [[0, 0], [0, 0]]]])
            conelane.Planner().update(**one._asdict())

    def test_faults(self):
        line = '{"pose": {"x": 0, "y": 0, "yaw": 0}, "cones": [{"x": 1, "y": 2, %s}]}'
        for text, message in (('{"reset": "no"}', "reset"), ("{", ""), ("[1]", ""), ('[{"car_position": [0, 0]}]', "slam_cones"),
                              ('{"time_s": "now"}', "time_s"), ('{"cones": [1]}', r"pose\.x: is missing"), (line % '"id": "7"', r"cones\[0\]\.id: "),
                              (line % '"color": "Blue"', r"cones\[0\]\.color: 'Blue' is not a colour; colours are unknown, blue, yellow, "),
                              (line % '"x": "4.2"', r"cones\[0\]\.x: must be"), (line % '"x": NaN', r"cones\[0\]\.x: must be")):
            with self.subTest(text), self.assertRaisesRegex(ValueError, r"r\.frames\.jsonl(:1)?: .*" + message):
                list(frames.read_frames(self.write("r.frames.jsonl", text)))
        for given, message in ([None], "run: holds no frame"), ([frames.Frame(CONES[:2], (0, 0, 0), 0.0, [5, 5])], r"run: frame 1: cones\[1\]\.id"):
            with self.assertRaisesRegex(ValueError, message):
                replay.replay(given, conelane.Planner())
        with contextlib.redirect_stderr(io.StringIO()) as said:
            self.assertEqual(replay.main([str(self.folder / "run.txt"), "--out", "p.html"]), 2)
        self.assertIn("run.txt: must end in .bag, .db3 or .mcap (a bag), in .jsonl or .json (frames)", said.getvalue())

    def test_a_page_says_why_there_was_no_lane(self):
        run = [frames.Frame(CONES, (0, y, 0), time_s) for time_s, y in ((5.0, 0), (5.1, 0), (2.0, 0), (2.1, 0), (5.2, 40))]
        page = replay.replay([*run, None, *run[2:4]], conelane.Planner(), time_limit_ms=None)
        says = [one["says"] for one in json.loads(page.split('id="race-data">')[1].split("</script>")[0])["frames"]]
        late, off = "the frame is not later than the one before", "the car is off the last lane; fewer than 3 cones within 20 m ahead"
        self.assertEqual([re.sub(r".*[m%](, |$)", "", of) for of in says], ["", "", late, late, off, "", ""])


class Tracks(InFolder):
    def test_boundaries_are_read_as_they_were_written(self):
        track, = conelane.load_tracks("generated:circle")
        np.testing.assert_array_equal(track.boundaries.left, track.cones[track.left])
        own = conelane.Boundaries([[0, 1], [5, 1], [9, 1]], [[0, -1], [5, -1], [9, -1]], closed=False)
        conelane.write_boundaries(self.folder / "t.tracks.json", {"own": own, track.name: track.boundaries})
        again = conelane.read_boundaries(self.folder / "t.tracks.json")
        self.assertEqual(set(again), {"own", track.name})
        self.assertEqual((again["own"].closed, again[track.name].closed), (False, True))
        np.testing.assert_array_equal(again["own"].right, own.right)
        np.testing.assert_array_equal(again[track.name].right, track.boundaries.right)

    def test_tracks_of_a_file(self):
        file = self.write("oval.csv", "tag,x,y,direction,x_variance,y_variance,xy_covariance\n" + "".join(
            f"{tag},{r * np.cos(a)},{r * np.sin(a)},0,0,0,0\n" for tag, r in (("blue", 10), ("yellow", 13)) for a in np.arange(0, 6.2, 0.3)))
        track, = conelane.load_tracks(f"eufs:{file}")
        self.assertEqual((len(track.left), len(track.right), track.closed), (21, 21, True))
        self.assertEqual(set(track.colors[track.left].tolist()), {conelane.Color.blue})

    def test_what_was_guessed_and_left_out_is_a_warning(self):
        rows = [f"{tag},{r * np.cos(a)},{r * np.sin(a)},0\n" for tag, r in (("blue", 10), ("yellow", 13)) for a in np.arange(0, 6.2, 0.3)]
        file = self.write("oval.csv", "".join(rows) + "yellow,180,0,0\n")
        with warnings.catch_warnings(record=True) as given:
            warnings.simplefilter("always")
            track, = conelane.load_tracks(f"eufs:{file}")
        self.assertEqual([warning.category for warning in given], [UserWarning, UserWarning])
        said = " ".join(str(warning.message) for warning in given)
        self.assertIn("eufs_oval: no header, column 1 is taken for tag", said)
        self.assertIn("left out of the boundaries: the yellow cone of line 43", said)
        self.assertEqual((len(track.cones), len(track.right), len(track.warnings)), (43, 21, 2))

    def test_faults(self):
        for spec in ("generated:nothing", "eufs:nowhere.csv", "what"):
            with self.subTest(spec), self.assertRaises(ValueError):
                conelane.load_tracks(spec)
        track, = conelane.load_tracks("generated:circle")
        for message, options in (("rain", {"condition": "rain"}), ("", {"false_positive_rate": 1.5})):
            with self.assertRaisesRegex(ValueError, message):
                conelane.generate_scenes(track, **options)


class Scores(unittest.TestCase):
    def test_the_true_lane_and_one_that_leaves_it(self):
        scene = conelane.Scene(CONES, (0, 0, 0), ground_truth=TRUTH)
        course = conelane.Boundaries([[x, 1.5] for x in range(0, 40, 4)], [[x, -1.5] for x in range(0, 40, 4)], False)
        lane = conelane.Detector("front").detect(CONES, (0, 0, 0), time_limit_ms=None)
        good = conelane.score(scene, lane, course)
        self.assertEqual((good.category, good.usable, good.success, good.iou, good.accurate), ("ground_truth", True, True, 1.0, True))
        self.assertEqual((good.lane_length_m, good.ground_truth_length_m, good.divergence_distance_m), (8.0, 8.0, None))
        np.testing.assert_allclose(good.lateral_error_m, 0.0, atol=1e-6)
        # The same cones without the last left one: now the false one is left of the lane.
        astray = conelane.Detector("rld-pair").detect(np.delete(CONES, 4, axis=0), (0, 0, 0), ids=[0, 1, 2, 3, 5, 6], time_limit_ms=None)
        self.assertEqual(astray.ids[astray.left].tolist(), [0, 2, 6])
        bad = conelane.score(scene, astray, course)
        self.assertEqual((bad.category, bad.usable, bad.success), ("diverging_below_20", False, False))
        self.assertLess(bad.iou, 1.0)
        self.assertIsNone(bad.lateral_error_m)

    def test_without_boundaries_divergence_is_unknown(self):
        scene = conelane.Scene(CONES, (0, 0, 0), ground_truth=TRUTH)
        self.assertIsNone(conelane.score(scene, conelane.Detector("front").detect_scene(scene, time_limit_ms=None)).usable)

    def test_faults(self):
        lane = conelane.Detector("front").detect(CONES, (0, 0, 0), time_limit_ms=None)
        with self.assertRaises(ValueError):
            conelane.score(conelane.Scene(CONES, (0, 0, 0)), lane)  # no ground truth
        other = conelane.Scene(CONES[:4], (0, 0, 0), ground_truth=([0, 2], [1, 3]))
        with self.assertRaisesRegex(ValueError, r"left\[2\]"):
            conelane.score(other, lane)


class Rld(unittest.TestCase):
    def test_both_exact_solvers_prove_the_same_optimum(self):
        cones = CONES + [[3.0, 0.2]]
        by = {name: conelane.solve_rld(cones, (0, 0, 0), solver=name) for name in ("path-pair", "exhaustive")}
        for solution in by.values():
            self.assertEqual(solution.status, "optimal")
            self.assertEqual((solution.left.tolist(), solution.right.tolist()), TRUTH)
            self.assertEqual(sorted(map(tuple, solution.edges)), [(0, 2), (1, 3), (2, 4), (3, 5)])
            self.assertLessEqual(solution.bound, solution.objective)
        self.assertAlmostEqual(by["path-pair"].objective, by["exhaustive"].objective)

    def test_infeasible_and_stopped(self):
        none = conelane.solve_rld(CONES[:3], (0, 0, 0))
        self.assertEqual((none.status, none.edges.shape, none.objective, len(none.left)), ("infeasible", (0, 2), None, 0))
        self.assertIsNone(none.stopped_by)
        stopped = conelane.solve_rld(CONES, (0, 0, 0), time_limit_ms=0)
        self.assertEqual((stopped.status, stopped.stopped_by), ("stopped", "time"))
        self.assertEqual(repr(stopped), "<conelane.RldSolution stopped, stopped by time>")

    def test_parameters(self):
        heavy = conelane.solve_rld(CONES, (0, 0, 0), parameters={"w_b": 2.0})
        default = conelane.solve_rld(CONES, (0, 0, 0))
        self.assertAlmostEqual(heavy.objective, default.objective - 4.0)  # four edges, each worth 1 more
        for name in ("context", "learned"):
            same = [conelane.solve_rld(CONES, (0, 0, 0), parameters=p).objective for p in (name, conelane.rld_parameters(name))]
            self.assertEqual(same[0], same[1])
            self.assertNotEqual(same[0], default.objective)

    def test_faults(self):
        for message, options in (("there is no solver 'cbc', only path-pair, exhaustive", {"solver": "cbc"}),
                                 ("limits: ", {"absolute_gap": -1.0}), ("limits: ", {"time_limit_ms": np.nan}),
                                 ("d_max: ", {"parameters": {"d_max": np.inf}}),
                                 ("neither None, the name of a set nor a dict", {"parameters": 3})):
            with self.subTest(options), self.assertRaisesRegex(ValueError, message):
                conelane.solve_rld(CONES, (0, 0, 0), **options)
        with self.assertRaisesRegex(ValueError, r"cones\[1\].id: cone id 1 is there twice"):
            conelane.solve_rld(CONES[:2], (0, 0, 0), ids=[1, 1])


if __name__ == "__main__":
    unittest.main()
