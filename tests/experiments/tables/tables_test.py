"""tables_test.py ROOT: how the figures of runs become tables, on figures made by hand, and that a page which says something else is found."""

import json
import os
import sys
import tempfile
import unittest

ROOT = sys.argv.pop(1)
sys.dont_write_bytecode = True
sys.path.insert(0, os.path.join(ROOT, "experiments", "tables"))

import held_out  # noqa: E402
import solvers  # noqa: E402
import tables  # noqa: E402


def score(track, usable, iou=None, rate=0.0):
    line = {"track": track, "method": "front", "condition": "car", "false_positive_rate": rate, "range": 30.0, "usable": usable}
    return line if iou is None else line | {"iou": iou}


class HeldOut(unittest.TestCase):
    def test_a_family_is_the_fold_that_has_not_seen_the_track(self):
        with tempfile.TemporaryDirectory() as folds:
            for family, seen in (("a", ["x", "y"]), ("b", ["x", "z"]), ("c", ["y", "z"])):
                os.mkdir(os.path.join(folds, family))
                with open(os.path.join(folds, family, "front.json"), "w", encoding="utf-8") as stream:
                    json.dump({"training": {"tracks": seen}}, stream)
            self.assertEqual(held_out.families_of(folds, ["x", "y", "z", "run"]), {"x": "c", "y": "b", "z": "a", "run": None})

    def test_parts_count_each_scene_once(self):
        scores = [score("x", True, 1.0), score("x", False, 0.5), score("y", True, 0.0), score("run", True)]
        rows = held_out.part_of(scores, {"x": "a", "y": "b", "run": None}, "part", lambda family, _: family != "b")
        self.assertEqual(len(rows), 1)
        self.assertEqual((rows[0]["scenes"], rows[0]["judged"], rows[0]["measured"]), (3, 3, 2))
        self.assertAlmostEqual(rows[0]["usable"], 2 / 3, places=6)
        self.assertAlmostEqual(rows[0]["iou"], 0.75)

    def test_races_are_counted_by_method_and_rate(self):
        def race(method, finished, error):
            return {"track": "x", "seed": 1, "method": method, "false_positive_rate": 0.3, "finished": finished, "lateral_error_p95_m": error}
        rows = held_out.race_rows({"condition": "car", "races": [race("a", True, 0.2), race("a", False, None), race("b", True, 0.4)]})
        self.assertEqual([(row["method"], row["races"], row["finished"], row["not_finished"]) for row in rows],
                         [("a", 2, 0.5, ["x 1"]), ("b", 1, 1.0, [])])


    def test_families_of_the_ceiling_add_up_by_their_scenes(self):
        def row(family, scenes, expected, attained, inside):
            return {"family": family, "rate": 0.5, "scenes": scenes, "power": 1.0, "expected": expected, "attained": attained, "start": 0,
                    "inside": inside, "ends": 1}
        with tempfile.TemporaryDirectory() as folder:
            self.assertEqual(held_out.ceiling_rows(folder), [])
            with open(os.path.join(folder, "ceiling.json"), "w", encoding="utf-8") as stream:
                json.dump([row("a", 30, 0.9, 1.0, 0), row("b", 10, 0.5, 0.6, 3)], stream)
            rows = held_out.ceiling_rows(folder)
        self.assertEqual(rows[-1], {"family": "all", "rate": 0.5, "scenes": 40, "expected": 0.8, "attained": 0.9, "start": 0, "inside": 3, "ends": 2})


class Solvers(unittest.TestCase):
    def test_a_quantile_lies_between_its_neighbours(self):
        self.assertEqual(solvers.quantile([3.0, 1.0, 2.0], 0.5), 2.0)
        self.assertEqual(solvers.quantile([1.0, 2.0], 0.75), 1.75)
        self.assertEqual(solvers.quantile([1.0], 0.95), 1.0)

    def test_a_proof_counts_from_its_time_on(self):
        def solution(track, status, milliseconds):
            return {"scene": f"{track}/pose_0001/fp_0.30/range_50", "status": status, "build_ms": 1.0, "solve_ms": milliseconds}
        rows = solvers.proven_rows("proven_default", [solution("x", "optimal", 20.0), solution("x", "infeasible", 200.0),
                                                      solution("x", "feasible", 1000.0), solution(solvers.DENSE, "stopped", 1000.0)])
        self.assertEqual([(row["limit_ms"], row["proven"]) for row in rows], [(50.0, 0.25), (1000.0, 0.5)])
        self.assertAlmostEqual(rows[0]["proven_without_dense"], 1 / 3, places=6)

    def test_the_orders_of_a_scene_are_no_further_scenes(self):
        lines = [{"scene": "s", "backend": "b", "nearest": 12, "status": "optimal", "latency_ms": 2.0},
                 {"scene": "s", "backend": "b", "nearest": 12, "status": "optimal", "latency_ms": 9.0, "permutation": 1},
                 {"row": "gap", "backend": "b", "nearest": 12}]
        self.assertEqual([(row["scenes"], row["proven"], row["max_ms"]) for row in solvers.backend_rows(lines)], [(1, 1, 2.0)])

    def test_a_lane_that_is_missing_is_not_usable(self):
        optimum = {"usable": True, "iou": 1.0, "category": "ground_truth"}
        line = {"track": "x", "costs": "default", "condition": "car", "status": "optimal", "optimum": optimum}
        row = solvers.objective_rows([line, line | {"beam": optimum | {"iou": 0.5}}])[0]
        self.assertEqual((row["optimum"], row["beam"], row["less"], row["scenes"]), ([1.0, 1.0], [0.5, 0.25], 0.5, 2))

    def test_gaps_fall_into_one_class_each(self):
        def line(gap):
            lane = {"usable": True, "iou": 1.0, "category": "ground_truth"} | ({} if gap is None else {"gap": gap})
            return {"track": "x", "costs": "own.json", "status": "optimal", "optimum": {"usable": True, "iou": 1.0}, "beam": lane}
        rows = solvers.gap_rows([line(gap) for gap in (0.0, 0.005, 0.01, 0.05, 2.0, None)])
        counts = {row["gap"]: row["scenes"] for row in rows if row["lane"] == "beam"}
        self.assertEqual(counts, {"none": 1, "to 1 %": 2, "to 10 %": 1, "above": 1, "forbidden": 1})


class Pages(unittest.TestCase):
    def test_a_table_goes_between_its_markers(self):
        page = "before\n<!-- table one -->\nold\n<!-- end of table -->\nafter\n"
        self.assertEqual(tables.filled(page, {"one": "| new |"}, "page"),
                         "before\n<!-- table one -->\n| new |\n<!-- end of table -->\nafter\n")
        with self.assertRaises(SystemExit):
            tables.filled(page, {"two": ""}, "page")

    def test_the_stored_file_is_json_with_a_row_on_each_line(self):
        stored = {"runs": {"a": {"commit": "c"}}, "rows": [{"x": 1}, {"x": 2}]}
        text = tables.text_of(stored)
        self.assertEqual(json.loads(text), stored)
        self.assertIn('\n    {"x": 2}\n', text)

    def test_a_changed_figure_is_found(self):
        self.assertEqual(tables.check(), 0)
        all_tables = tables.all_tables()
        name = "usable"
        changed = all_tables | {name: all_tables[name].replace("9", "8", 1)}
        self.assertNotEqual(changed[name], all_tables[name])
        page = tables.read(os.path.join(ROOT, "README.md"))
        self.assertEqual(tables.filled(page, all_tables, "README.md"), page)
        self.assertNotEqual(tables.filled(page, changed, "README.md"), page)


if __name__ == "__main__":
    unittest.main()
