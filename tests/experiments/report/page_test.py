"""page_test.py PROGRAM RESULTS: the page that PROGRAM made of RESULTS is well-formed, stands alone and shows the
numbers of results.jsonl; made again it is the same; wrong input is told in one line. Further pages are made of stored
results that a small comparison does not have."""

import json
import math
import os
import re
import shutil
import subprocess
import sys
import tempfile
import unittest
from html.parser import HTMLParser

from stored_results import Setup, write_results

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "..", "experiments"))
from report.methods import described  # noqa: E402  (the package of the page lies there)

PROGRAM, RESULTS = sys.argv[1:3]
VOID = {"meta", "link", "input", "br"}


class Page(HTMLParser):
    """Keeps what the tests ask for, and what is wrong."""

    def __init__(self, text):
        super().__init__()
        self.open, self.wrong, self.ids, self.outside = [], [], [], []
        self.rows, self.cells, self.words = {}, {}, {}  # cells: the values of a row's columns, in order
        self.table, self.row = None, None
        self.feed(text)
        self.close()

    def handle_starttag(self, tag, pairs):
        attributes = dict(pairs)
        if "id" in attributes:
            self.ids.append(attributes["id"])
        for key in ("src", "href"):
            if key in attributes and not attributes[key].startswith(("#", "data:")):
                self.outside.append(attributes[key])
        if tag == "div" and attributes.get("class") == "table":
            self.table = attributes["id"]
        if tag == "tr" and "data-range" in attributes:
            self.row = (self.table, attributes["data-method"], attributes["data-condition"],
                        float(attributes["data-rate"]), float(attributes["data-range"]))
        elif tag == "tr" and attributes.get("data-method"):
            self.row = (self.table, attributes["data-method"], attributes.get("data-condition", ""),
                        float(attributes.get("data-rate", "nan")))
        if tag == "td" and self.row:
            self.cells.setdefault(self.row, []).append(attributes.get("data-value"))
        if tag == "td" and self.row and "data-measure" in attributes:
            self.rows.setdefault(self.row, {})[attributes["data-measure"]] = [attributes.get("data-value"), ""]
            self.measure = attributes["data-measure"]
        elif tag == "small":
            self.measure = None
        if tag not in VOID:
            self.open.append(tag)

    def handle_startendtag(self, tag, pairs):
        self.handle_starttag(tag, pairs)
        if tag not in VOID:
            self.open.pop()

    def handle_endtag(self, tag):
        if not self.open or self.open.pop() != tag:
            self.wrong.append((tag, self.getpos()))
        if tag == "td":
            self.measure = None
        if tag == "tr":
            self.row = None

    def handle_data(self, text):
        if self.row and getattr(self, "measure", None):
            self.rows[self.row][self.measure][1] += text.strip()
        if self.open and self.open[-1] not in ("script", "style"):
            self.words[self.open[-1]] = self.words.get(self.open[-1], "") + text


def report(results, page, *options):
    return subprocess.run([PROGRAM, "report", "--results", results, "--out", page, *options], capture_output=True,
                          text=True, check=False)


def read(*path):
    with open(os.path.join(*path), encoding="utf-8") as stream:
        return stream.read()


def write(text, *path):
    with open(os.path.join(*path), "w", encoding="utf-8") as stream:
        stream.write(text)


def lines(name, folder=RESULTS):
    return [json.loads(line) for line in read(folder, name).splitlines()]


def label(line):
    return line["method"] + (f" n={line['nearest']}" if "nearest" in line else "")


def part(text, kind, name):
    """A table or a figure of the page."""
    end = {"table": "</table>", "figure": "</figure>"}[kind]
    begin = f'<div class="table" id="{name}">' if kind == "table" else f'<figure id="{name}"[^>]*>'
    return re.search(rf"{begin}.*?{end}", text, flags=re.S)[0]


def viewer_data(text):
    return json.loads(re.search(r'<script type="application/json" id="scene-data">(.*?)</script>', text, flags=re.S)[1])


class ReportPage(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.text = read(RESULTS, "page.html")
        cls.page = Page(cls.text)

    def made_of_copy(self, change):
        """The page that is made of a changed copy of the results; `change` is of its folder."""
        with tempfile.TemporaryDirectory() as folder:
            copy, page = os.path.join(folder, "copy"), os.path.join(folder, "page.html")
            shutil.copytree(RESULTS, copy)
            change(copy)
            done = report(copy, page)
            self.assertEqual((done.returncode, done.stderr), (0, ""))
            return read(page)

    def test_is_well_formed_and_stands_alone(self):
        self.assertEqual((self.page.wrong, self.page.open, self.page.outside), ([], [], []))
        self.assertEqual(sorted(self.page.ids), sorted(set(self.page.ids)))
        styles = "".join(re.findall(r"<style>(.*?)</style>", self.text, flags=re.S))
        self.assertNotRegex(styles, r"url\(|@import")

    def test_figures_refer_to_what_is_there(self):
        self.assertLessEqual(set(re.findall(r'(?:href="#|url\(#)([^")]+)', self.text)), set(self.page.ids))

    def test_has_every_figure_or_says_why_not(self):
        for name in ("headline", "by-rate", "methods", "failure-causes", "steering", "usable-by-rate-paper", "usable-by-rate-car", "by-track",
                     "by-size", "growth", "usable-by-size", "accurate-by-size", "success-by-rate", "latency",
                     "latency-by-rate", "optimality", "optimality-gaps", "engine-times", "solver-measures", "solver-profile-6", "warm-start",
                     "growth-size", "growth-density", "race-finished", "race-table", "race-replay",
                     "formulations", "relaxations", "rld-fig-5", "rld-fig-6", "rld-solved", "rld-fig-7-straight",
                     "rld-fig-7-circle", "clc-table-1", "clc-table-2", "clc-fig-9", "clc-fig-11", "clc-fig-12",
                     "clc-fig-15", "clc-fig-16a", "clc-fig-16b", "ratios"):
            self.assertTrue(name in self.page.ids, name)
        absent = "".join(re.findall(r'<div class="absent">(.*?)</div>', self.text, flags=re.S))
        self.assertEqual(re.findall(r"<b>(.*?)</b>", absent),
                         ["Confidence and trusted length", "Methods from outside"])

    def test_every_experiment_says_what_it_shows(self):
        articles = re.findall(r'<article class="experiment.*?</article>', self.text, flags=re.S)
        self.assertEqual(len(articles), 25)
        for article in articles:
            self.assertRegex(article, r'<h3>[^<]+</h3><p class="claim">[^<]')
            self.assertEqual(re.findall(r"<dt>(Protocol|Source|Command)</dt>", article),
                             ["Protocol", "Source", "Command"])
        of_papers = [article for article in articles if re.match(r".*?<h3>(RLD|CLC) (Fig|Table)", article, flags=re.S)]
        self.assertEqual(len(of_papers), 10)
        for article in of_papers:
            self.assertIn("<dt>Published</dt>", article)
            self.assertIn('<p class="claim">The paper claims: ', article)
            self.assertRegex(article, r'<p class="judged"><b[^>]*>(Holds here|Does not hold here)</b> for |Not judged here')
        self.assertEqual(self.text.count('<p class="claim">The paper claims: '), 10)  # and no other heading is a claim

    def test_every_figure_says_what_to_see(self):
        figures = re.findall(r'<figure id="([^"]*)"[^>]*>.*?<figcaption>(.*?)</figcaption></figure>', self.text, flags=re.S)
        self.assertGreater(len(figures), 20)
        for name, caption in figures:
            self.assertRegex(caption, r"^[A-Z][^.]{25,}\.", name)  # one whole sentence first

    def test_the_papers_claims_are_judged_by_the_scores(self):
        judged = dict(re.findall(r"<h3>(CLC Table I|RLD Fig. 6):[^<]*</h3>.*?(<p class=\"judged\">.*?</p>)", self.text, flags=re.S))
        scores = [line for line in lines("scores.jsonl") if line["condition"] == "paper"]
        bad = ("none", "diverging_below_20")
        shares = [[line["category"] not in bad for line in scores if line["method"] == "clc" and
                   line["false_positive_rate"] == rate] for rate in (0.0, 0.3)]
        least = min(sum(share) / len(share) for share in shares)
        self.assertIn(f"{'Holds' if least >= 0.99 else 'Does not hold'} here</b> for clc ({100 * least:.1f} % at ",
                      judged["CLC Table I"])
        solved = [line["solved"] for line in scores if line.get("nearest") == 12 and "solved" in line]
        self.assertIn(f"{100 * sum(solved) / len(solved):.2f} % solved", judged["RLD Fig. 6"])

    def test_the_first_screen_says_what_to_run(self):
        first = re.search(r'<section id="verdict">(.*?)</section>', self.text, flags=re.S)[1]
        self.assertLess(self.text.index('<section id="verdict">'), self.text.index('<section id="comparison">'))
        intro = self.text[self.text.index("<main>"):self.text.index('<section id="verdict">')]
        self.assertEqual(intro.count('class="headline"'), 1)  # what a cone lane is, what is compared, the answer
        self.assertIn("A <b>cone lane</b> is", intro)
        self.assertRegex(intro, r"Compared: 3 methods on the same \d+ scenes of 2 tracks")
        self.assertIn('<canvas data-scene="', re.search(r'<figure id="cone-lane".*?</figure>', intro, flags=re.S)[0])
        for hint in ("nothing disturbed, n\u00a0=\u00a0", "cones off by 0.1 m, pose by 0.3 m and 5°, 5 % missed, n\u00a0=\u00a0"):
            self.assertIn(f'<small class="hint">{hint}', first)  # the conditions beside their columns
        self.assertEqual(first.count("<table"), 1)  # one table
        rows = re.findall(r'<tr data-method="([^"]*)">', first)
        self.assertEqual(sorted(rows), ["clc", "rld-cbc n=12", "rld-pair"])
        scores = lines("scores.jsonl")
        usable = {}
        for line in scores:
            usable.setdefault(label(line), []).append(line["usable"])
        shares = [sum(usable[name]) / len(usable[name]) for name in rows]
        self.assertEqual(shares, sorted(shares, reverse=True))  # the best comes first
        shown = [float(values[0]) for key, values in self.page.cells.items() if key[0] == "headline"]
        for share, value in zip(shares, shown):
            self.assertAlmostEqual(share, value)
        cards = re.findall(r'<figure class="scene" data-method="([^"]*)">(.*?)</figure>', first, flags=re.S)
        self.assertEqual(sorted(name for name, _ in cards), sorted(rows))
        for name, card in cards:
            self.assertRegex(card, rf"<b>{name}</b> [A-Z]")
            self.assertRegex(card, r"<br>Here: [a-z]")
        drawn = re.findall(r'<canvas data-scene="([^"]*)" data-slot="(\d)" data-zoom=all>', first)
        self.assertEqual([int(slot) for _, slot in drawn], list(range(len(cards))))
        self.assertEqual(len({scene for scene, _ in drawn}), 1)  # one scene at one zoom
        self.assertIn("Robust Lane Detection with Binary Integer Optimization", first)
        self.assertIn("Lane Detection using Graph Search and Geometric Constraints for Formula Student Driverless", first)

    def test_tables_have_the_best_method_first(self):
        best = re.findall(r'<tr data-method="([^"]*)">', part(self.text, "table", "headline"))
        for table in ("quality", "steering", "latencies", "categories", "failure-causes"):
            of_table = [key[1] for key in self.page.cells if key[0] == table]
            self.assertEqual(list(dict.fromkeys(of_table)), best, table)

    def test_one_legend_serves_the_figures_of_a_group(self):
        for name in ("usable-by-rate-paper", "success-by-rate", "iou-by-rate", "latency-by-rate"):
            figure = part(self.text, "figure", name)
            self.assertNotIn(f'id="{name}-legend_1"', figure)
        keys = re.findall(r'<p class="method-key">(.*?)</p>', self.text, flags=re.S)
        self.assertEqual(len(keys), 2)  # of quality and latency; no method here says how sure it is
        for key in keys:
            self.assertEqual(sorted(re.findall(r"</svg>([^<]*)</span>", key)), ["clc", "rld-cbc n=12", "rld-pair"])

    def test_every_share_says_of_how_many(self):
        for table in ("headline", "by-rate", "by-track", "failure-causes", "quality", "categories"):
            self.assertIn(">scenes</button>", part(self.text, "table", table), table)
        for name in ("usable-by-rate-car", "success-by-rate", "latency-by-rate"):
            figure = part(self.text, "figure", name)
            self.assertRegex(figure, r"n = \d+ scenes a point\.")

    def test_a_time_that_the_limit_ended_is_named_a_limit(self):
        longest = max(line["latency_ms"] for line in lines("scores.jsonl"))
        for limit_ms in (longest, 2 * longest):
            run = json.loads(read(RESULTS, "run.json")) | {"time_limit_ms": limit_ms}
            text = self.made_of_copy(lambda copy, run=run: write(json.dumps(run), copy, "run.json"))
            self.assertEqual("<small>limit</small>" in text, limit_ms == longest)
            self.assertEqual(" ended the search, which would have taken longer." in text, limit_ms == longest)

    def test_every_method_of_the_program_is_explained(self):
        listed = subprocess.run([PROGRAM, "methods"], capture_output=True, text=True, check=True).stdout
        names = [line.split()[0] for line in listed.splitlines()]
        self.assertGreater(len(names), 10)
        for name in names:
            self.assertTrue(described(None, name)[0], f"{name}: no line in experiments/report/methods.py")

    def test_methods_of_different_objectives_are_never_said_to_agree(self):
        exactness = re.search(r'<section id="exactness">(.*?)</section>', self.text, flags=re.S)[1]
        for names in re.findall(r"<li>([^<]*) minimise one objective", exactness):
            self.assertFalse("rld-pair" in names and "rld-shape" in names, names)

    def test_no_paired_ratio_is_below_one(self):
        ratios = [float(value) for value in re.findall(r'<td class="number" data-value="([\d.]+)">\d+\.\d\d <small>',
                                                       part(self.text, "table", "ratios"))]
        self.assertGreater(len(ratios), 2)
        self.assertGreaterEqual(min(ratios), 1.0)

    def test_choosing_a_method_reaches_the_curves(self):
        self.assertEqual(set(re.findall(r'<g data-curve="([^"]*)"', part(self.text, "figure", "success-by-rate"))), {"rld-cbc", "rld-pair", "clc"})

    def test_stored_exactness_is_what_is_shown(self):
        stored = [line for line in lines("optimality.jsonl") if "gap" in line and line["costs"] == "default"]
        equal = sum(line["equal"] for line in stored) / len(stored)
        self.assertIn(f"proven optimum in {100 * equal:.1f}\u00a0% of {len(stored)} scenes", self.text)
        self.assertIn("Claims refuted by another backend: 0.", self.text)

    def test_solves_of_all_visible_cones_are_a_size(self):
        stored = [line | {"refuted": 2 * (line.get("backend") == "path-pair")} if line.get("row") == "summary" else line for line in lines("backends.jsonl")]
        text = self.made_of_copy(lambda copy: write("".join(json.dumps(line) + "\n" for line in stored + [
            line | {"nearest": 0} for line in stored]), copy, "backends.jsonl"))
        ids = Page(text).ids
        for name in ("solver-profile", "solver-primal-gap", "solver-dual-gap"):
            self.assertTrue({f"{name}-6", f"{name}-all"} <= set(ids), name)
        measures = next(one for one in re.findall(r'<article class="experiment.*?</article>', text, flags=re.S) if "<h3>Measures of solvers</h3>" in one)
        summaries = [line for line in stored if line.get("row") == "summary"]
        for group in {f"all {line.get('condition', '')}".strip() for line in summaries}:
            self.assertGreaterEqual(len(re.findall(rf">{group}</t[dh]>", measures)), 2, group)
        for title in ("geometric mean ms", "PAR 10 ms", "adds to the virtual best, ms", "variation %", "primal integral ms", "dual integral ms",
                      "peak MiB", "p, Holm", "coefficient of variation", ' data-measure="refuted" data-value="2">', "refuted by another backend: 4."):
            self.assertIn(title, measures)
        self.assertIn("path-pair, claims refuted: 4", part(text, "figure", "engine-times"))
        for block in (line for line in stored if line.get("row") == "block"):
            self.assertIn(f"{block['backend']}: {block['version'] or 'version unknown'}", measures)

    def test_numbers_are_those_of_the_results(self):
        checked = 0
        for row in lines("results.jsonl"):
            key = (label(row), row["condition"], row["false_positive_rate"], row["range"])
            stored = {"quality": {k: row.get(k) for k in ("usable_share", "success_share", "mean_iou",
                                                          "accurate_share", "solved_share", "complete_share")},
                      "steering": {k: row.get(k) for k in ("lateral_median_m", "lateral_p95_m", "heading_median_rad",
                                                           "heading_p95_rad", "unsteady_share")},
                      "latencies": {**row["latency_ms"], "within_budget_share": row["within_budget_share"]},
                      "categories": row["share"]}
            for table, values in stored.items():
                for measure, (value, shown) in self.page.rows[(table, *key)].items():
                    if values[measure] is None:
                        self.assertEqual((value, shown), (None, "–"))
                        continue
                    self.assertEqual(float(value), values[measure], (table, key, measure))
                    is_in_unit = measure.endswith("_m") or (table == "latencies" and not measure.endswith("_share"))
                    scale = math.degrees(1) if measure.endswith("_rad") else 1.0 if is_in_unit else 100.0
                    digits = len(shown.partition(".")[2])
                    self.assertAlmostEqual(float(shown), scale * values[measure], delta=0.5001 * 10.0 ** -digits)
                    checked += 1
        self.assertGreater(checked, 12 * 14)

    def test_scenes_are_those_of_the_lanes(self):
        data = viewer_data(self.text)
        scored = {line["scene"] for line in lines("scores.jsonl")}
        self.assertEqual(set(data["frames"]), scored)
        self.assertEqual({scene for lap in data["laps"] for scene in lap["scenes"]}, scored)
        scene = next(line for line in lines("scenes.scenes.jsonl") if line["id"] == data["start"])
        frame = data["frames"][scene["id"]]
        cones = {cone["id"]: (cone["x"], cone["y"]) for cone in scene["cones"]}
        self.assertEqual(len(frame["c"]), 2 * len(cones))
        first = frame["g"][0][0]
        pose, (x, y) = scene["pose"], cones[scene["ground_truth"]["left"][0]]
        away = ((x - pose["x"]) ** 2 + (y - pose["y"]) ** 2) ** 0.5
        self.assertAlmostEqual((frame["c"][2 * first] ** 2 + frame["c"][2 * first + 1] ** 2) ** 0.5, 100 * away,
                               delta=1.0)
        self.assertGreater(frame["c"][2 * first + 1], 0)  # on the car's left
        self.assertEqual(round(frame["f"] / len(cones), 1), 0.3)  # the rate of the gallery

    def test_names_no_place_of_this_machine(self):
        self.assertNotIn(os.path.dirname(RESULTS), self.text)

    def test_made_again_it_is_the_same_with_whole_pictures(self):
        with tempfile.TemporaryDirectory() as folder:
            seen = []
            for name in ("one", "two"):
                pictures, again = os.path.join(folder, name), os.path.join(folder, "again.html")
                done = report(RESULTS, again, "--png", pictures)
                self.assertEqual((done.returncode, done.stderr), (0, ""))
                self.assertEqual(read(again), self.text)
                self.assertEqual(sorted(os.listdir(pictures)), ["engines.png", "growth.png", "iou.png", "latency.png", "success.png", "usable.png"])
                seen.append({})
                for picture in os.listdir(pictures):
                    with open(os.path.join(pictures, picture), "rb") as stream:
                        seen[-1][picture] = stream.read()
                    self.assertEqual(seen[-1][picture][:8], b"\x89PNG\r\n\x1a\n")
                    self.assertGreater(int.from_bytes(seen[-1][picture][16:20], "big"), 800)  # pixels across
            self.assertEqual(seen[0], seen[1])
            self.assertEqual(sorted(os.listdir(folder)), ["again.html", "one", "two"])

    def test_says_how_many_scenes_are_left_out(self):
        self.assertNotIn("left out everywhere", self.text)
        stored = json.loads(read(RESULTS, "scenes.tracks.json"))
        stored["circle"]["left_out"] = ["circle/pose_0001/fp_0.00/range_30", "circle/pose_0002/fp_0.00/range_30"]
        self.assertIn("<li>2 scenes are left out everywhere: the ground truth is degenerate",
                      self.made_of_copy(lambda copy: write(json.dumps(stored), copy, "scenes.tracks.json")))

    def refused(self, results, page, *options):
        done = report(results, page, *options)
        self.assertEqual(done.returncode, 2, done.stderr)
        self.assertEqual(len(done.stderr.splitlines()), 1, done.stderr)
        self.assertFalse(os.path.exists(page))
        return done.stderr

    def test_wrong_input_is_one_line(self):
        with tempfile.TemporaryDirectory() as folder:
            page = os.path.join(folder, "page.html")
            self.assertIn("is not a directory", self.refused(os.path.join(folder, "nothing"), page))
            self.assertIn("nowhere", self.refused(RESULTS, os.path.join(folder, "nowhere", "page.html")))
            self.assertIn("matplotlib", self.refused(RESULTS, page, "--python", os.path.join(folder, "no-python")))
            copy = os.path.join(folder, "copy")
            shutil.copytree(RESULTS, copy)
            whole = read(RESULTS, "scores.jsonl").splitlines(keepends=True)
            for change, complaint in ((lambda rows: rows[:-1], "scores of"),
                                      (lambda rows: [rows[0].replace('"cones"', '"bones"')] + rows[1:],
                                       ":1: cones: is missing"),
                                      (lambda rows: [rows[0].replace('"iou":', '"ion":')] + rows[1:], "mean_iou of"),
                                      (lambda rows: [re.sub('"usable":[a-z]+', '"usable":2', rows[0])] + rows[1:],
                                       "usable_share of"),
                                      (lambda rows: [rows[0].replace('"range"', '"cause":"bad luck","range"')] +
                                       rows[1:], ":1: cause: there is no 'bad luck'"),
                                      (lambda rows: rows[:2] + ["{\n"] + rows[3:], "scores.jsonl:3: ")):
                write("".join(change(whole)), copy, "scores.jsonl")
                self.assertIn(complaint, self.refused(copy, page))
            write("".join(whole), copy, "scores.jsonl")
            for name, text, complaint in (("optimality.jsonl", '{"scene": "a"}\n', "optimality.jsonl:1: track: "),
                                          ("backends.jsonl", "[]\n", "backends.jsonl:1: "),
                                          ("growth.jsonl", '{"cones": 6}\n', "growth.jsonl:1: all_visible"),
                                          ("formulations.jsonl", '{"cones": 6}\n', "formulations.jsonl:1: formulation"),
                                          ("race/race.json", "{", "race.json: "), ("race/race.json", "{}", "race.json: races"),
                                          ("race/race.json", '{"races": [{}]}', "races[0].track"),
                                          ("race/replay.jsonl", '{"frames": 1}\n', "replay.jsonl:1: frames")):
                before = read(copy, name) if os.path.exists(os.path.join(copy, name)) else ""
                write(text, copy, name)
                self.assertIn(complaint, self.refused(copy, page))
                write(before, copy, name)
                if not before:
                    os.unlink(os.path.join(copy, name))
            os.unlink(os.path.join(copy, "run.json"))
            self.assertIn("run.json", self.refused(copy, page))

    def test_rows_by_rate_are_the_mean_over_the_scores(self):
        rows = {key: values for key, values in self.page.cells.items() if key[0] == "by-rate"}
        scores = lines("scores.jsonl")
        blocks = {(line["method"], line["condition"], line["false_positive_rate"]) for line in scores}
        self.assertEqual({key[2:] for key in rows}, {block[1:] for block in blocks})
        self.assertEqual(len(rows), len(blocks))
        for (_, *key), cells in rows.items():
            of_row = [line for line in scores if [label(line), line["condition"], line["false_positive_rate"]] == key]
            usable = sum(line["usable"] for line in of_row) / len(of_row)
            exact = sum(line["category"] == "ground_truth" for line in of_row) / len(of_row)
            self.assertAlmostEqual(float(cells[0]), usable)
            self.assertAlmostEqual(float(cells[3]), exact)
            self.assertEqual(float(cells[5]), max(line["latency_ms"] for line in of_row))
            self.assertEqual(int(cells[6]), len(of_row))

    def test_causes_are_those_of_the_scores(self):
        causes = {}
        for line in lines("scores.jsonl"):
            self.assertEqual("cause" in line, not line["usable"], line)
            if "cause" in line:
                of_method = causes.setdefault((label(line), line["condition"]), {})
                of_method[line["cause"]] = of_method.get(line["cause"], 0) + 1
        self.assertGreater(len(causes), 2)
        for method, of_method in causes.items():
            shown = next(values for key, values in self.page.rows.items() if key[:3] == ("failure-causes", *method))
            for cause, count in of_method.items():
                self.assertAlmostEqual(float(shown[cause][0]), count / sum(of_method.values()))

    def test_gallery_shows_the_worst_first(self):
        scores = {(line["method"], line["scene"]): line for line in lines("scores.jsonl")}
        found = re.findall(r'<details class="worst" open data-method="([^"]*)" data-condition="([^"]*)">(.*?)</details>',
                           self.text, flags=re.S)
        self.assertEqual({(name.partition(" n=")[0], condition) for name, condition, _ in found},
                         {(line["method"], line["condition"]) for line in scores.values() if not line["usable"]})
        for name, condition, content in found:
            method = name.partition(" n=")[0]
            shown = re.findall(r'data-open="([^"]*)"', content)
            tracks = [scores[method, scene]["track"] for scene in shown]
            self.assertTrue(0 < len(shown) <= 10 and all(tracks.count(track) <= 2 for track in tracks))
            self.assertFalse(any(scores[method, scene]["usable"] for scene in shown))  # it holds what is wrong
            ranks = [scores[method, scene]["iou"] for scene in shown]
            self.assertEqual(ranks, sorted(ranks))
            wrong = [line for line in scores.values() if (line["method"], line["condition"]) == (method, condition)
                     and not line["usable"]]
            self.assertEqual(ranks[0], min(line["iou"] for line in wrong))
            self.assertRegex(content, rf"<small>(\d+ of )?{len(wrong)} lane")
            self.assertEqual(re.findall(r'<canvas data-scene="([^"]*)"', content), shown)

    def test_experiments_take_other_comparisons_from_beside(self):
        def move_candidates(copy):
            scores = read(copy, "scores.jsonl")
            os.mkdir(os.path.join(copy, "candidates"))
            write(scores, copy, "candidates", "scores.jsonl")
            write(re.sub(r'"(best_candidate_iou|first_near_iteration)":[^,]*,', "", scores), copy, "scores.jsonl")
        self.assertEqual(part(self.made_of_copy(move_candidates), "figure", "clc-fig-11"), part(self.text, "figure", "clc-fig-11"))

    def made_of(self, folder, setup, *options):
        """The page that is made of such results, and what its viewer has."""
        results, page = os.path.join(folder, "results"), os.path.join(folder, "page.html")
        write_results(results, setup)
        done = report(results, page, *options)
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        text = read(page)
        self.assertEqual((Page(text).wrong, Page(text).open), ([], []))
        return text, viewer_data(text)

    def test_runs_points_and_centre_lines_have_no_overlap(self):
        with tempfile.TemporaryDirectory() as folder:
            card = {"outside": "exec", "self_timed_ms": {"median": 3.25, "p95": 8.5},
                    "card": {"name": "Points", "licence": "MIT", "colour_used": False, "training_courses": ["one"]}}
            text, data = self.made_of(folder, Setup(methods=("ids", "points", "line"), points=("points",),
                                                    centre_lines=("line",), runs=("run",), outside={"points": card},
                                                    trained_on={"points": ("one",)}))
            run = next(lap for lap in data["laps"] if lap["track"] == "run")
            frame = data["frames"][run["scenes"][1]]
            slots = [method["label"] for method in data["methods"]]  # best first
            points, line = (frame["a"][slots.index(name)] for name in ("points", "line"))
            self.assertEqual(frame["g"], [[], [], 0])
            self.assertEqual(data["tracks"]["run"]["driven"][:4], [-500, 20, -400, 20])
            self.assertEqual(points[:2], [{"p": [0, 140, 800, 140, 1600, 140]},
                                                 {"p": [0, -140, 800, -140, 1600, -140]}])
            self.assertEqual(line[:2], [{"p": [0, 10, 800, 10, 1600, 10]}, []])
            self.assertEqual([answer[4] for answer in frame["a"]], [None] * 3)
            seen = next(lap for lap in data["laps"] if (lap["track"], lap["condition"]) == ("one", "car"))
            self.assertEqual(data["frames"][seen["scenes"][0]]["m"], [600, 150])
            self.assertIn("IoU unknown", text)
            for condition in ("paper", "car"):
                self.assertIn(f'id="calibration-{condition}"', text)
            lanes = sum(int(value) for value in re.findall(r'data-value="(\d+)">\d+</td></tr>', part(text, "table", "calibration-bins")))
            stored = lines("results.jsonl", os.path.join(folder, "results"))
            self.assertEqual(lanes, sum(one[0] for row in stored for one in row["calibration"].get("bins", ())))
            self.assertGreater(lanes, 0)
            self.assertEqual(part(text, "table", "calibration-table").count(">99.50<"), 12)  # right where trusted: three methods, conditions and rates
            self.assertEqual(part(text, "table", "by-track").count("<small>trained</small>"), 2)  # one course in two conditions
            self.assertEqual(part(text, "table", "headline").count("*</td>"), 1)  # one method
            self.assertRegex(text, r'<div class="table" id="outside">.*?<td[^>]*>MIT</td>.*?>3\.25<.*?>8\.50<')

    def test_results_of_earlier_versions_still_make_a_page(self):
        with tempfile.TemporaryDirectory() as folder:
            text, data = self.made_of(folder, Setup(conditions=("",), old=True))
            self.assertIn("success in ", text)
            self.assertNotIn('id="failure-causes"', text)
            self.assertNotIn('id="calibration-table"', text)
            self.assertNotIn(">condition<", text)
            self.assertEqual({lap["condition"] for lap in data["laps"]}, {""})

    def test_a_large_comparison_shows_some_laps_and_says_how_to_get_others(self):
        with tempfile.TemporaryDirectory() as folder:
            setup = Setup(tracks=tuple("abcdefgh"), rates=(0.3, 0.5), poses=700, every_m=1.1,
                          methods=("first", "second"))
            text, data = self.made_of(folder, setup)
            self.assertLess(len(text), 15e6)
            self.assertTrue("conelane report --viewer TRACK" in text)
            whole = [lap for lap in data["laps"] if len(lap["scenes"]) == 700]
            self.assertTrue(16 < len(whole) < 32, len(whole))
            self.assertEqual(sum(lap["rate"] == 0.3 for lap in whole), 16)  # all of the gallery's rate come first
            named, data = self.made_of(folder, setup, "--viewer", "h,b")
            self.assertLess(len(named), 15e6)
            long = {lap["track"] for lap in data["laps"] if len(lap["scenes"]) > 100}
            self.assertEqual(long, {"h", "b"})
            self.assertEqual({(lap["rate"], lap["condition"]) for lap in data["laps"] if lap["track"] == "h"},
                             {(rate, condition) for rate in (0.3, 0.5) for condition in ("paper", "car")})
            results = os.path.join(folder, "results")
            page = os.path.join(folder, "other.html")
            self.assertIn("there is no track 'z'", self.refused(results, page, "--viewer", "h,z"))

    def test_no_warning_of_a_library_reaches_the_user(self):
        with tempfile.TemporaryDirectory() as folder:  # one scene, one track: figures have next to nothing to show
            setup = Setup(tracks=("one",), rates=(0.3,), poses=1, conditions=("paper",), methods=("a" * 60, "b"))
            self.made_of(folder, setup)  # nothing on stderr
            sweep = subprocess.run([PROGRAM, "sweep", "--tracks", "generated:straight", "--methods", "rld-pair", "--sizes", "6",
                                    "--every", "60", "--out", os.path.join(folder, "sweep")], capture_output=True, text=True,
                                   check=False)
            self.assertEqual((sweep.returncode, sweep.stderr), (0, ""))
            self.assertNotIn("arning", sweep.stdout)

    def test_studies_alone_make_a_page(self):
        with tempfile.TemporaryDirectory() as folder:
            page = os.path.join(folder, "page.html")
            for name in ("backends.jsonl", "growth.jsonl"):
                shutil.copy(os.path.join(RESULTS, name), folder)
                done = report(folder, page, "--png", os.path.join(folder, "pictures"))
                self.assertEqual((done.returncode, done.stderr), (0, ""))
                text = read(page)
                made = Page(text)
                self.assertEqual((made.wrong, made.open, made.outside), ([], [], []))
                self.assertLessEqual({"exactness", "protocol", "engine-times", "solver-measures"}, set(made.ids))
                self.assertLess(text.index('id="engine-times"'), text.index('id="exactness"'))
                self.assertEqual(os.listdir(os.path.join(folder, "pictures")), ["engines.png"])
                self.assertNotIn("comparison", made.ids)
            self.assertIn("By the number of cones", text)

    def test_without_scenes_it_says_so(self):
        def strip(copy):
            for name in ("scenes.scenes.jsonl", "optimality.jsonl", "backends.jsonl", "formulations.jsonl", "relaxations.jsonl",
                         "growth.jsonl"):
                os.unlink(os.path.join(copy, name))
            for name in ("sweep", "race"):
                shutil.rmtree(os.path.join(copy, name))
        text = self.made_of_copy(strip)
        self.assertIn("the results hold no scenes.scenes.jsonl", text)
        for complaint in ("there is no sweep over cone-set sizes.", "there is no optimality.jsonl.",
                          "there is no backends.jsonl.", "there is no formulations.jsonl.",
                          "there is no growth.jsonl.", "there is no relaxations.jsonl.", "there is no race/race.json."):
            self.assertIn(complaint, text)
        self.assertIn("<code>conelane compare --by-size --out RESULTS/sweep</code>", text)
        self.assertEqual(Page(text).wrong, [])


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
