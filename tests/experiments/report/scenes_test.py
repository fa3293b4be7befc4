"""scenes_test.py EXPERIMENTS: which scenes the report shows as the worst ones and which laps its viewer has, on samples
small enough to follow by hand."""

import sys
import unittest

import numpy as np

sys.path.insert(0, sys.argv.pop(1))
from report import scenes  # noqa: E402
from report.load import InputError, Results, Sample  # noqa: E402


def results_of(rows, methods=("clc",), directory="results"):
    """Rows: (scene, track, rate, usable, IoU), for each method the same."""
    columns = {name: np.array([row[i] for row in rows], dtype=object) for i, name in enumerate(("scene", "track"))}
    columns |= {name: np.array([row[i] for row in rows], dtype=float)
                for i, name in ((2, "rate"), (3, "usable"), (4, "iou"))}
    columns |= {"condition": np.array(["paper"] * len(rows), dtype=object), "range": np.full(len(rows), 30.0),
                "cones": np.full(len(rows), 40.0), "category": np.array(["near_ground_truth"] * len(rows), dtype=object)}
    stored = [{"method": name, "false_positive_rate": rate, "range": 30.0, "condition": "paper"}
              for name in methods for rate in sorted({row[2] for row in rows})]
    return Results(directory, {}, stored, [Sample(name, None, columns) for name in methods], {}, {}, list(methods))


class Worst(unittest.TestCase):
    def of(self, rows, places):
        return scenes._worst(scenes._wrong(results_of(rows))["clc", "paper"], places)

    def test_only_what_is_not_usable_the_lowest_overlap_first(self):
        rows = [("a", "one", 0.3, 1, 0.1), ("b", "two", 0.3, 0, 0.9), ("c", "three", 0.3, 0, 0.2),
                ("d", "four", 0.3, 0, np.nan)]
        places = {scene: (100.0 * i, 0.0) for i, scene in enumerate("abcd")}
        self.assertEqual(self.of(rows, places), ["c", "b", "d"])
        self.assertEqual(self.of(rows[:1], places), [])
        self.assertEqual(len(scenes._wrong(results_of(rows))["clc", "paper"]), 3)

    def test_ties_go_by_name(self):
        rows = [("b", "one", 0.3, 0, 0.0), ("a", "two", 0.3, 0, 0.0)]
        self.assertEqual(self.of(rows, {"a": (0.0, 0.0), "b": (0.0, 0.0)}), ["a", "b"])

    def test_two_of_a_track_and_these_apart(self):
        rows = [(f"pose_{i}", "one", 0.3, 0, 0.01 * i) for i in range(6)]
        places = {f"pose_{i}": (5.0 * i, 0.0) for i in range(6)}  # 15 m from the first is the fourth
        self.assertEqual(self.of(rows, places), ["pose_0", "pose_3"])

    def test_ten_are_enough(self):
        rows = [(f"s{i:02}", f"track {i}", 0.3, 0, 0.0) for i in range(20)]
        self.assertEqual(self.of(rows, {f"s{i:02}": (0.0, 0.0) for i in range(20)}), [f"s{i:02}" for i in range(10)])


def frame(turns, usable):
    """A frame whose left boundary turns by each of `turns` [rad], and whether each method's lane is usable."""
    heading, points = 0.0, [(0.0, 0.0)]
    for turn in [0.0, *turns]:
        heading += turn
        points.append((points[-1][0] + 400 * np.cos(heading), points[-1][1] + 400 * np.sin(heading)))
    return {"c": [value for point in points for value in point], "g": [list(range(len(points))), [], 0],
            "a": [[[], [], 0, 1.0, 0.9, 0, 1, one, None, None, None] for one in usable]}


class Start(unittest.TestCase):
    def of(self, frames, rate=0.3):
        results = results_of([(name, "one", rate, 1, 1.0) for name in frames], methods=("clc", "front", "rld"))
        return scenes._start(results, frames, [{"condition": "paper", "rate": rate, "scenes": list(frames)}])

    def test_turns_ahead_that_most_methods_get_right_but_not_all(self):
        straight, bend = [0.0, 0.0], [0.5, -0.9]
        self.assertAlmostEqual(scenes._turning_rad(frame(bend, [])), 1.4)
        self.assertEqual(self.of({"a": frame(straight, [1, 1, 0]), "b": frame(bend, [1, 1, 0])}), "b")
        self.assertEqual(self.of({"a": frame(bend, [1, 0, 0]), "b": frame(straight, [1, 1, 0])}), "b")  # too hard
        self.assertEqual(self.of({"a": frame(bend, [1, 1, 1]), "b": frame(straight, [1, 1, 0])}), "b")  # all the same
        self.assertEqual(self.of({"a": frame(bend, [0, 1, 1]), "b": frame(straight, [1, 1, 1])}), "b")  # not the best
        self.assertEqual(self.of({"a": frame(bend, [1, 1, 0]), "b": frame(bend, [1, 1, 0])}), "a")  # the first
        self.assertEqual(self.of({"a": frame(straight, [0, 0, 0])}), "a")  # whatever there is


class Laps(unittest.TestCase):
    ROWS = [("a0", "easy", 0.0, 1, 1.0), ("a1", "easy", 0.3, 1, 1.0), ("b0", "hard", 0.0, 1, 1.0),
            ("b1", "hard", 0.3, 0, 0.1)]

    def names(self, laps, order):
        return [laps.scenes[lap][0] for lap in order]

    def test_the_hardest_track_at_the_gallerys_rate_comes_first(self):
        results = results_of(self.ROWS)
        laps = scenes._Laps(results)
        self.assertEqual(self.names(laps, laps.by_interest(results)), ["b1", "a1", "b0", "a0"])

    def test_whole_laps_while_there_is_room(self):
        results = results_of(self.ROWS)
        laps = scenes._Laps(results)
        for lap in laps.bytes_of:
            laps.bytes_of[lap] = scenes.MOST_BYTES // 2
        self.assertEqual(self.names(laps, scenes._chosen_laps(results, laps, ())[0]), ["b1", "a1"])

    def test_named_tracks_are_thinned_instead(self):
        results = results_of(self.ROWS)
        laps = scenes._Laps(results)
        for lap in laps.bytes_of:
            laps.bytes_of[lap] = scenes.MOST_BYTES
        chosen, stride = scenes._chosen_laps(results, laps, ("easy",))
        self.assertEqual((self.names(laps, chosen), stride), (["a1", "a0"], 2))
        with self.assertRaisesRegex(InputError, "there is no track 'none'"):
            scenes._chosen_laps(results, laps, ("none",))

    def test_what_turns_out_too_large_is_dropped(self):
        results = results_of(self.ROWS)
        laps = scenes._Laps(results)
        chosen = laps.by_interest(results)
        frames = {row[0]: {"c": "x" * (scenes.MOST_BYTES // 2 - 100)} for row in self.ROWS}
        stride = scenes._make_room(laps, chosen, {"a0"}, frames, 1, False)
        self.assertEqual((sorted(frames), stride), (["a0", "b1"], 1))  # the picked scene stays


class FalsePositives(unittest.TestCase):
    def test_a_seen_cone_may_be_off_by_the_noise(self):
        boundary = np.array([[0.0, 0.0], [4.0, 0.0]])
        seen = np.array([[0.0, 0.005], [4.3, 0.0], [2.0, 0.0]])
        self.assertEqual(scenes._false_positives(seen, boundary, 0.0).tolist(), [False, True, True])
        self.assertEqual(scenes._false_positives(seen, boundary, 0.1).tolist(), [False, False, True])
        self.assertEqual(scenes._false_positives(seen, None, 0.1).tolist(), [False] * 3)


if __name__ == "__main__":
    unittest.main()
