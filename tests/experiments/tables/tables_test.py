"""tables_test.py ROOT: how the figures of runs become tables, on figures made by hand, and that a page which says something else is found."""

import json
import os
import re
import shutil
import subprocess
import sys
import tempfile
import unittest

ROOT = sys.argv.pop(1)
sys.dont_write_bytecode = True
sys.path.insert(0, os.path.join(ROOT, "experiments", "tables"))

import engines  # noqa: E402
import held_out  # noqa: E402
import races  # noqa: E402
import reproduce  # noqa: E402
import shipped  # noqa: E402
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

    def test_a_method_has_a_row_without_and_one_with_colours(self):
        def row(run, method, usable):
            return {"run": run, "method": method, "condition": "car", "rate": 0.0, "range": 30.0, "usable": usable, "iou": 0.5}
        rows = [row("front", "front", 0.9), row("front_colors", "front", 0.95), row("others_colors", "rld-shape", 0.6)]
        lines = held_out.colour_table(held_out.Figures({"rows": rows})).splitlines()[2:]
        dashes = " – |" * 7
        self.assertEqual(lines[:2], [f"| `front` | 90.0/50 |{dashes}", f"| `front`, with colours | 95.0/50 |{dashes}"])
        self.assertIn(f"| `rld-shape` | – |{dashes}", lines)
        self.assertIn(f"| `rld-shape`, with colours | 60.0/50 |{dashes}", lines)
        self.assertEqual(lines[-1], f"| ft-fsd-path-planning, with colours | – |{dashes}")
        self.assertEqual(len(lines), 2 * len(held_out.COLOURED))

    def test_ordinary_courses_have_a_row_with_colours(self):
        part = {"part": "ordinary", "run": "front_colors", "method": "front", "condition": "car", "rate": 0.0, "scenes": 1, "measured": 1, "iou": 1.0}
        parts = [part | {"range": 30.0, "usable": 1.0, "judged": 3}, part | {"range": 50.0, "usable": 0.0, "judged": 1}]
        text = held_out.ordinary_table(held_out.Figures({"parts": parts}))
        self.assertIn("| `car`, with colours | 75.0/100 | – | – | – |", text)
        self.assertIn("| `car` | – | – | – | – |", text)

    def test_the_script_makes_each_run_and_no_figure_with_colours_stands_for_one_without(self):
        with open(os.path.join(ROOT, "experiments", "tables", "held_out"), encoding="utf-8") as stream:
            made = re.findall(r"^ *(?:cross_validate|race|peer) (\w+) ", stream.read(), flags=re.M)
        self.assertEqual(sorted(made), sorted(held_out.COMPARISONS + held_out.RACES))
        self.assertLessEqual(set(held_out.COLOURED.values()), set(held_out.COMPARISONS) - held_out.OWN_SCENES)


def heat(method="a", finished=True, **values):
    return {"track": "x", "seed": 1, "method": method, "false_positive_rate": 0.3, "finished": finished, "finished_laps": int(finished), "cones_hit": 0,
            "lateral_error_p95_m": 0.2, "stop_said_m": None, "frames": 100, "wrong_unflagged": 0, "unsteady_share": 0.0} | values


class Races(unittest.TestCase):
    def test_races_are_counted_by_method_and_rate(self):
        rows = races.race_rows({"condition": "car", "races": [heat(), heat(finished=False, lateral_error_p95_m=None), heat("b")]})
        self.assertEqual([(row["method"], row["races"], row["finished"], row["not_finished"]) for row in rows],
                         [("a", 2, 0.5, ["x 1"]), ("b", 1, 1.0, [])])

    def test_first_and_later_laps_are_apart_and_a_lap_that_was_not_finished_has_no_time(self):
        lap = {"laps": 1, "time_s": 33.0, "known_course_lap_s": 30.0, "frames": 100, "short_frames": 1, "right_untrusted": 0, "wrong_trusted": 2,
               "sideways_p95_m": 0.02, "max_curvature_1pm": 0.2}
        heats = [heat(first_lap=lap, later_laps=lap | {"laps": 2, "time_s": 60.0}), heat(finished=False, first_lap=lap | {"laps": 0, "frames": 300})]
        laps = [{"run": "race_safe"} | row for row in races.lap_rows({"races": heats})]
        stored = {"races": [{"run": "race_safe"} | row | {"method": "front-warm+planner"} for row in races.race_rows({"condition": "slam", "races": heats})],
                  "laps": laps}
        self.assertEqual(held_out.lap_table(held_out.Figures(stored)).splitlines()[2:],
                         ["| first, 30 % | 1.100 | 0.50 | 1.00 | 0.020 | 0.20 | 50.0 |", "| later, 30 % | 1.000 | 1.00 | 2.00 | 0.020 | 0.20 | 50.0 |"])

    def test_measures_are_those_of_the_program(self):
        row = races.race_rows({"condition": "car", "races": [
            heat(finished_laps=10, cones_hit=5, wrong_unflagged=1, unsteady_share=0.2, stop_said_m=1.0),
            heat(finished=False, finished_laps=2, cones_hit=3, frames=300, unsteady_share=None, lateral_error_p95_m=0.4, stop_said_m=3.0)]})[0]
        self.assertEqual((row["hit_a_lap"], row["wrong"], row["unsteady"], row["stop_said_m"]), (0.75, 0.0025, 0.2, [1.0, 2.0, 3.0]))
        self.assertAlmostEqual(row["lateral_error_p95_m"], 0.3)
        self.assertEqual(races.measure_cells(row), ["50.0", "0.75", "0.30", "20.0", "0.25"])

    def test_no_races_without_a_figure_are_a_dash(self):
        self.assertEqual(races.measure_cells({"finished": 1.0, "lateral_error_p95_m": None}), ["100.0", "–", "–", "–", "–"])

    def test_ten_laps_name_the_courses_that_were_not_finished(self):
        rows = races.race_rows({"condition": "car", "races": [heat("front-warm+planner"), heat("front-warm+planner", finished=False, track="y")]})
        text = held_out.ten_laps_table(held_out.Figures({"races": [{"run": "race_ten"} | row for row in rows]}))
        self.assertIn("| 30 % | 2 | 50.0 |", text)
        self.assertIn("| `y` |", text)


class Shipped(unittest.TestCase):
    def row(self, run, drawn, rate, scenes, usable):
        return {"run": run, "set": drawn, "rate": rate, "range": 30.0, "scenes": scenes, "usable": usable, "iou": 0.5, "trusted": 0.8, "right_if_trusted": 1.0}

    def test_shares_are_weighted_by_scenes(self):
        whole = shipped.together([self.row("a", 31, 0.0, 1, 1.0), self.row("a", 41, 0.0, 3, 0.0)])
        self.assertEqual((whole["scenes"], whole["usable"], whole["iou"]), (4, 0.25, 0.5))

    def test_colours_have_a_row_each_and_uncertain_positions_one_for_each_set(self):
        rows = [self.row(f"colours_{name}", drawn, rate, 10, 0.9) for name in shipped.COLOURS for drawn in shipped.SETS for rate in shipped.RATES]
        rows += [self.row(f"{known}_{noise}", drawn, 0.0, 10 + drawn, 0.7) for known in ("known", "unknown") for noise in shipped.NOISES for drawn in shipped.SETS]
        colours = shipped.colour_table({"rows": rows}).splitlines()
        self.assertEqual(colours[2], "| none | 90.0/50.0 | 90.0/50.0 | 90.0/50.0 | 90.0/50.0 | 100.0, 80 |")
        self.assertEqual(len(colours), 2 + len(shipped.COLOURS))
        uncertain = shipped.uncertainty_table({"rows": rows}).splitlines()
        self.assertEqual(uncertain[4], "| @41, @42, 51 | 0.01 | unknown | 70.0 | 50.0 | 100.0 | 80 |")
        self.assertEqual(len(uncertain), 2 + 2 * len(shipped.NOISES) * len(shipped.SETS))

    def test_missions_count_the_finished(self):
        def rows(mission, run):
            return [{"mission": mission, "run": run, "rate": rate, "races": 50, "finished": 0.98, "stop_said_m": [1.0, 2.0, 3.0 + rate]} for rate in (0.0, 0.5)]
        text = shipped.mission_table({"races": [row for mission in shipped.MISSIONS for run in shipped.CONDITIONS for row in rows(mission, run)]})
        self.assertIn("| `harsh` | 49 / 49 | 49 / 49 | 1.0 to 3.5 | 1.0 to 3.5 |", text)


class Reproduce(unittest.TestCase):
    def events(self, *events):
        return [{"part": part, "event": event, "time": f"2026-01-01T00:{minute:02}:00Z"} for part, event, minute in events]

    def test_a_part_that_was_killed_counts_from_its_last_begin(self):
        events = self.events(("held_out", "begin", 0), ("held_out", "begin", 5), ("held_out", "end", 15), ("shipped", "begin", 15), ("shipped", "end", 16),
                             ("solvers", "begin", 16), ("solvers", "end", 18), ("engines", "begin", 18), ("engines", "end", 18), ("pictures", "begin", 18),
                             ("pictures", "end", 18))
        rows = reproduce.part_rows(events)
        self.assertEqual([(row["part"], row["minutes"], row["calls"]) for row in rows],
                         [("held_out", 10.0, 2), ("shipped", 1.0, 1), ("solvers", 2.0, 1), ("engines", 0.0, 1), ("pictures", 0.0, 1)])
        with self.assertRaises(SystemExit):
            reproduce.part_rows(events[:-1])
        self.assertEqual([row["part"] for row in reproduce.part_rows(events[:3])], ["held_out"])

    def test_the_record_has_commit_and_dates(self):
        with tempfile.TemporaryDirectory() as folder:
            with open(os.path.join(folder, "held_out.json"), "w", encoding="utf-8") as stream:
                json.dump({"runs": {"front": {"commit": "c", "compiler": "g", "machine": "m"}}}, stream)
            with open(os.path.join(folder, "parts.jsonl"), "w", encoding="utf-8") as stream:
                for event in self.events(*((part, event, minute) for minute, part in enumerate(reproduce.WHAT) for event in ("begin", "end"))):
                    stream.write(json.dumps(event) + "\n")
            stored = reproduce.collect(folder)
        self.assertEqual((stored["commit"], stored["begun"], stored["ended"]), ("c", "2026-01-01 00:00", "2026-01-01 00:04"))
        self.assertIn("| commit | c |", reproduce.run_table(stored))

    def test_a_run_of_another_commit_is_found(self):
        stored = {kind: {} for kind in tables.KINDS} | {"engines": {"runs": {"e": {"commit": "f"}}}} | {"solvers": {"runs": {"a": {"commit": "c"}, "b": {"commit": "d"}}}}
        self.assertEqual(tables.strangers(stored), [])
        found = tables.strangers(stored | {"reproduce": {"commit": "c"}})
        self.assertEqual(len(found), 1)
        self.assertIn("the run 'b' is of commit d", found[0])


class Solvers(unittest.TestCase):
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

    def test_classes_take_all_visible_cones_from_one_bound_up_to_the_next(self):
        def line(edges, proven=True, whole=True):
            return {"all_visible": whole, "cones": 12, "density": 4, "edges": edges, "proven": proven, "nodes": 1, "cpu_ms": edges / 100}
        rows = solvers.growth_rows([line(99), line(100), line(199, False), line(5000, False), line(30, whole=False)])
        classes = [(row["from"], row["below"], row["scenes"], row["proven"]) for row in rows if row["table"] == "growth by edges"]
        self.assertEqual(classes, [(None, 100, 1, 1.0), (100, 200, 2, 0.5), (1000, None, 1, 0.0)])
        self.assertEqual([(row["from"], row["below"]) for row in rows if row["table"] == "growth by density"], [(4, 5)])
        self.assertEqual([row["nearest"] for row in rows if row["table"] == "growth"], [12])
        self.assertIn("| 1000 and more | 1 | 5000 |  |  | 1.00 | 0.0 |", solvers.class_table([row for row in rows if row["table"] == "growth by edges"], "edges"))

    def test_what_is_known_when_a_limit_ends_the_search(self):
        def line(status, latency_ms, objective=None, *steps):
            return {"scene": "a", "status": status, "latency_ms": latency_ms, "steps": [
                {"time_ms": time, "objective": of, "bound": bound} for time, of, bound in steps]} | ({} if objective is None else {"objective": objective})
        rows = solvers.anytime_rows([line("optimal", 4.0, -10.0), line("infeasible", 1.0), line("optimal", 30.0, -10.0, (5.1, -9.95, -14.0), (30.0, -10.0, -10.0)),
                                     line("feasible", 2000.0, -10.0, (5.2, -8.0, -12.0), (2000.0, -10.0, -11.0)), line("stopped", 2000.0)])
        self.assertEqual((rows[0]["scenes"], rows[0]["open"], rows[0]["open_close"], rows[0]["gap"]), (5, 3, 1, 0.3))
        self.assertEqual((rows[-1]["open"], rows[-1]["open_close"], rows[-1]["gap"]), (2, 1, 0.1))
        self.assertIn("| 5 ms | 2 of 5 | 60.0 | 1 of 3 | 30 % |", solvers.anytime_table(rows))

    def test_certificates_are_read_off_the_last_line(self):
        row = solvers.certificate_row("a: a reason\nverified: 5 optima, 1 infeasible, 2 lower bounds; 0 refused; 3 not verified within 200000 steps\n")
        self.assertEqual((row["optima"], row["infeasible"], row["bounds"], row["refused"], row["beyond"]), (5, 1, 2, 0, 3))
        self.assertIn("| not within 200000 steps | 3 |", solvers.certificate_table([row]))

    def test_the_width_of_front_stands_out(self):
        row = {"beam": 15, "drop": 4.0, "best_score": 0.9, "first_usable": 0.8, "usable": 0.8, "any_usable": 0.95, "iou": 0.85, "median_ms": 1.0, "p95_ms": 2.0,
               "worst_ms": 30.0}
        self.assertEqual(solvers.beam_table([row, row | {"beam": 30}]).splitlines()[2:],
                         ["| **15, 4** | 90.0 | 80.0 | 80.0 | 95.0 | 85.0 | 1.0 / 2.0 / 30 |", "| 30, 4 | 90.0 | 80.0 | 80.0 | 95.0 | 85.0 | 1.0 / 2.0 / 30 |"])


class Engines(unittest.TestCase):
    def lines(self):
        def solve(nearest, status, time_ms, **more):
            return {"scene": "s", "track": "x", "backend": "b", "nearest": nearest, "status": status, "latency_ms": time_ms} | more
        summary = {"row": "summary", "backend": "b", "nearest": 0, "geometric_ms": 2.0, "geometric_ms_interval": [1.0, 3.0], "par10_ms": 30.0,
                   "contribution_ms": 5.0}
        return [solve(0, "optimal", 2.0), solve(0, "infeasible", 4.0), solve(0, "feasible", 10.0), solve(12, "optimal", 1.0),
                solve(12, "error", 9.0, permutation=1), {"row": "block", "backend": "b", "nearest": 0, "version": "b 1"}, summary,
                summary | {"condition": "car", "par10_ms": 99.0},
                {"row": "pair", "first": "b", "second": "a", "nearest": 0, "ratio": 2.0, "ratio_interval": [1.5, 2.5], "corrected_p_value": 0.03}]

    def test_what_is_not_proven_is_above_all_times(self):
        rows = engines.size_rows(self.lines())
        self.assertEqual([(row["nearest"], row["scenes"], row["solved"], row["median_ms"], row["p95_ms"]) for row in rows],
                         [(0, 3, 2, 4.0, None), (12, 1, 1, 1.0, 1.0)])

    def test_all_visible_cones_are_the_last_size(self):
        head, _, line = engines.size_table(engines.size_rows(self.lines())).splitlines()
        self.assertEqual([cell.strip() for cell in head.split("|")[2:-1]], ["n = 12", "all visible"])
        self.assertEqual(line, "| `b`, b 1 | 1.0/1.0/100.0 | 4.0/–/66.7 |")

    def test_figures_are_shown_with_their_intervals(self):
        text = engines.compared_table(engines.size_rows(self.lines())).splitlines()[2]
        self.assertEqual(text, "| `b` | 2.0 (1.0 to 3.0) | 30 | – | 2.0 (1.5 to 2.5) | 0.03 | 5.0 |")

    def test_methods_among_the_same_cones_have_a_row_each(self):
        text = engines.tables({"rows": [{"table": "cone sets", "method": "clc", "nearest": nearest, "usable": 0.5} for nearest in (6, 12, 0)]})["usable by cone set"]
        self.assertEqual(text.splitlines()[0], "| usable, % | n = 12 | all visible |")
        self.assertIn("| `clc` | 50.0 | 50.0 |", text)


@unittest.skipUnless(shutil.which("git"), "there is no git")
class OneCommit(unittest.TestCase):
    """experiments/reproduce in a project of its own, whose setup ends it with exit code 7: what comes before is whether DIR may be used."""

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.project, self.runs = os.path.join(folder.name, "project"), os.path.join(folder.name, "runs")
        os.makedirs(os.path.join(self.project, "experiments", "tables"))
        os.makedirs(os.path.join(self.project, ".ci"))
        os.makedirs(os.path.join(self.project, "docs"))
        os.mkdir(self.runs)
        for name in ("reproduce", "tables/steps"):
            shutil.copy(os.path.join(ROOT, "experiments", name), os.path.join(self.project, "experiments", name))
        self.executable(os.path.join(self.project, ".ci", "setup"), "exit 7")
        self.write("docs/page.md", "a page")
        self.write("code.py", "code")
        self.git("init", "--quiet")
        self.git("add", "--all")
        self.git("-c", "user.name=name", "-c", "user.email=mail", "commit", "--quiet", "--message", "all")
        self.commit = self.git("rev-parse", "--short=12", "HEAD").strip()

    def git(self, *arguments):
        return subprocess.run(["git", "-C", self.project, *arguments], check=True, capture_output=True, text=True).stdout

    def write(self, name, text):
        with open(os.path.join(self.project, name), "w", encoding="utf-8") as stream:
            stream.write(text)

    def executable(self, path, command):
        with open(path, "w", encoding="utf-8") as stream:
            stream.write(f"#!/bin/sh\n{command}\n")
        os.chmod(path, 0o755)

    def program_of(self, commit):
        self.executable(os.path.join(self.runs, "conelane"), f"echo 'commit {commit}'")

    def expect(self, code, words="", *parts):
        run = subprocess.run(["bash", os.path.join(self.project, "experiments", "reproduce"), self.runs, self.project, *parts], capture_output=True, text=True, check=False)
        self.assertEqual(run.returncode, code, run.stderr)
        self.assertIn(words, run.stderr)

    def test_an_empty_folder_and_one_of_this_commit_are_used(self):
        self.expect(7)
        self.program_of(self.commit)
        self.expect(7)

    def test_runs_of_another_commit_are_refused(self):
        self.program_of("another_commit")
        self.expect(2, f"holds runs of commit another_commit, but this checkout is {self.commit}")

    def test_other_files_are_refused(self):
        self.executable(os.path.join(self.runs, "held_out.json"), "")
        self.expect(2, "holds other files")

    def test_a_part_that_is_not_there_is_refused(self):
        self.expect(2, "figures is none of the parts", "held_out", "figures")

    def test_changes_in_no_commit_are_refused(self):
        self.write("code.py", "other code")
        self.expect(2, "code.py")
        self.program_of(self.commit)
        self.expect(2, "code.py")

    def test_a_later_call_may_find_pages_that_the_first_one_wrote(self):
        self.write("docs/page.md", "a table")
        self.expect(2, "docs/page.md")
        self.program_of(self.commit)
        self.expect(7)


class Pages(unittest.TestCase):
    def test_a_table_goes_between_its_markers(self):
        page = "before\n<!-- table one -->\nold\n<!-- end of table -->\nafter\n"
        self.assertEqual(tables.filled(page, {"one": "| new |"}, "page"),
                         "before\n<!-- table one -->\n| new |\n<!-- end of table -->\nafter\n")
        with self.assertRaises(SystemExit):
            tables.filled(page, {"two": ""}, "page")

    def test_a_number_in_a_sentence_is_that_of_its_cell(self):
        text = {"usable": "| usable | 0 % | 50 % |\n| --- | --- | --- |\n| `front` | 98.3/90 | 92.4/85 |"}
        self.assertEqual(tables.filled("1.0<!--usable:front:2--> 7<!--usable:front:1:2--> 1.0<!--usable:front:min--> 1", text, "page"),
                         "92.4<!--usable:front:2--> 90<!--usable:front:1:2--> 92.4<!--usable:front:min--> 1")
        for cell in ("usable:front:3", "usable:clc:1", "other:front:1", "usable:front:1:3"):
            self.assertRaises(SystemExit, tables.filled, f"1.0<!--{cell}-->", text, "page")

    def test_runs_of_one_origin_share_a_row(self):
        run = {"commit": "c", "compiler": "g", "machine": "m"}
        text = tables.runs_table({"a": run | {"machine": ""}, "b": run, "d": run | {"commit": "e"}, "f": run | {"commit": "h", "machine": ""}})
        self.assertEqual(text.splitlines()[2:], ["| c | g | m | `b`, `a` |", "| e | g | m | `d` |", "| h | g |  | `f` |"])

    def test_the_stored_file_is_json_with_a_row_on_each_line(self):
        stored = {"runs": {"a": {"commit": "c"}}, "rows": [{"x": 1}, {"x": 2}]}
        text = tables.text_of(stored)
        self.assertEqual(json.loads(text), stored)
        self.assertIn('\n    {"x": 2}\n', text)

    def test_a_changed_figure_is_found(self):
        self.assertEqual(tables.check(), 0)
        all_tables = tables.all_tables(tables.stored_figures())
        name = "usable"
        changed = all_tables | {name: all_tables[name].replace("9", "8", 1)}
        self.assertNotEqual(changed[name], all_tables[name])
        page = tables.read(os.path.join(ROOT, "README.md"))
        self.assertEqual(tables.filled(page, all_tables, "README.md"), page)
        self.assertNotEqual(tables.filled(page, changed, "README.md"), page)


if __name__ == "__main__":
    unittest.main()
