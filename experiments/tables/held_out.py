"""Courses that no method has learned from: the figures of the runs of experiments/tables/held_out, and their tables."""

import os
from collections import defaultdict

from cells import UNKNOWN, both, columns_table, fixed, grouped, lines_of, mean, over, percent, provenance, read_json, rounded, share, table, version_of
from races import MEASURES, lap_rows, measure_cells, race_rows

COMPARISONS = ["front", "front_no_persist", "front_lap", "front_colors", "clc", "others", "others_colors", "peers", "peers_colors"]
OPTIONAL = {"peers", "peers_colors"}  # of answers that DATA may have
RACES = ["race", "race_harsh", "race_ten", "race_safe"]
OWN_SCENES = {"front", "clc", "others", "peers"}  # runs on the scenes of the first table

CONDITIONS = ["paper", "car"]
RATES = [0.0, 0.1, 0.3, 0.5]
DESIGNED = {"epfl", "fsai_sim"}
# Runs without annotated boundaries, and a course of cones at random.
PECULIAR = {"ftlog_skidpad", "ftlog_one_turn", "ftlog_fsg_19_2_laps", "eufs_rand"}

METHODS = {
    "front": "`front`",
    "clc": "`clc`",
    "rld-learned": "`rld-learned`",
    "rld-strip": "`rld-strip`",
    "rld-shape": "`rld-shape`",
    "clc-paper": "`clc-paper`",
    "rld-pair": "`rld-pair`",
    "rld-cbc": "`rld-cbc`, 12 cones",
    "ft-fsd-path-planning": "ft-fsd-path-planning, without colours",
}
# The run in which a method sees colours, for each method that can use them.
COLOURED = {"front": "front_colors", "rld-learned": "others_colors", "rld-shape": "others_colors",
            "ft-fsd-path-planning": "peers_colors"}
# Among 12 cones no lane is long enough to be usable: experiments/tables/engines compares cone sets.
README_METHODS = {name: title for name, title in METHODS.items() if name != "rld-cbc"} | {
    "clc-paper": "`clc-paper`: CLC as printed",
    "rld-pair": "`rld-pair`: RLD's own objective",
    "ft-fsd-path-planning": "ft-fsd-path-planning",
}


def row_of(line):
    """The figures of one method, condition, rate and range, from a line of results.jsonl."""
    row = {"method": line["method"], "condition": line["condition"], "rate": line["false_positive_rate"], "range": line["range"],
           "scenes": line["scenes"], "errors": line["errors"], "usable": line.get("usable_share"), "iou": line.get("mean_iou"),
           "exact": line["share"]["ground_truth"], "centre_p95_m": line.get("lateral_p95_m"),
           "heading_p95_rad": line.get("heading_p95_rad"), "unsteady": line.get("unsteady_share"),
           "latency_ms": {key: rounded(line["latency_ms"][key]) for key in ("median", "p95", "max")}}
    said = line.get("calibration", {})
    if "error" in said:
        row["certainty"] = {"off": said["error"], "sure": said.get("sure_share"), "usable_if_sure": said.get("usable_where_sure_share"),
                            "trusted": said.get("trusted_share"), "right_if_trusted": said.get("right_where_trusted_share")}
        row["certainty"] = {key: rounded(value) for key, value in row["certainty"].items()}
    return {key: rounded(value) for key, value in row.items()}


def part_of(scores, family_of, name, selected):
    """Usable and IoU over the selected courses, by method, condition, rate and range."""
    cells = grouped((score for score in scores if selected(family_of[score["track"]], score["track"])), ("method", "condition", "false_positive_rate", "range"))
    rows = []
    for (method, condition, rate, distance), cell in sorted(cells.items()):
        usable, iou = ([float(score[key]) for score in cell if key in score] for key in ("usable", "iou"))
        rows.append({"part": name, "method": method, "condition": condition, "rate": rate, "range": distance, "scenes": len(cell),
                     "usable": mean(usable), "judged": len(usable), "iou": mean(iou), "measured": len(iou)})
    return rows


def families_of(folds, tracks):
    """The family of each track: the fold whose training has not seen it. None for a run without annotated boundaries: nothing learns
    from it."""
    learned = {family: set(read_json(os.path.join(folds, family, "front.json"))["training"]["tracks"]) for family in sorted(os.listdir(folds))}
    family_of = {}
    for track in sorted(tracks):
        unseen = [family for family, seen in learned.items() if track not in seen]
        if len(unseen) not in (1, len(learned)):
            raise SystemExit(f"tables.py: {track} is held out by {len(unseen)} folds of {folds}")
        family_of[track] = unseen[0] if len(unseen) == 1 else None
    return family_of


def twelve_rows(folder):
    """How often a lane of 12 cones is accurate, by costs of RLD and rate, over all families. Scenes without annotated boundaries have no
    accuracy."""
    right, scenes = defaultdict(float), defaultdict(int)
    for name in sorted(os.listdir(folder)):
        if not name.endswith((".default.json", ".shape.json", ".learned.json")):
            continue
        for line in lines_of(os.path.join(folder, name)):
            if line.get("accurate_share") is not None:
                cell = name.split(".")[1], line["false_positive_rate"]
                right[cell] += line["accurate_share"] * line["accuracy_scenes"]
                scenes[cell] += line["accuracy_scenes"]
    return [{"costs": costs, "rate": rate, "scenes": scenes[costs, rate], "accurate": rounded(right[costs, rate] / scenes[costs, rate])}
            for costs, rate in sorted(right)]


def collect(folder):
    stored = {"runs": {}, "rows": [], "parts": [], "races": [], "laps": []}
    family_of = {}
    for name in COMPARISONS:
        path = os.path.join(folder, name)
        if name in OPTIONAL and not os.path.exists(path):
            continue
        lines = lines_of(os.path.join(path, "results.jsonl"))
        stored["runs"][name] = provenance(lines[0])
        stored["rows"] += [{"run": name} | row_of(line) for line in lines]
        scores = lines_of(os.path.join(path, "scores.jsonl"))
        if not family_of:
            family_of = families_of(os.path.join(path, "folds"), {score["track"] for score in scores})
        stored["parts"] += [{"run": name} | row for row in part_of(scores, family_of, "designed", lambda family, _: family in DESIGNED)]
        if name in ("front", "front_no_persist", "front_colors"):
            stored["parts"] += [{"run": name} | row
                                for row in part_of(scores, family_of, "ordinary", lambda _, track: track not in PECULIAR)]
    stored["courses"] = family_of
    for name in RACES:
        record = read_json(os.path.join(folder, name, "race.json"))
        stored["runs"][name] = provenance(record)
        stored["races"] += [{"run": name} | row for row in race_rows(record)]
        stored["laps"] += [{"run": name} | row for row in lap_rows(record)]
    stored["twelve"] = twelve_rows(os.path.join(folder, "twelve"))
    stored["runs"]["twelve"] = version_of(os.path.join(folder, "twelve", "version.txt"))
    return stored


def is_of(row, run, method, condition, rate):
    """Whether a row is of this run; without a run, of one of those on the scenes of the first table."""
    return ((row["run"] in OWN_SCENES if run is None else row["run"] == run) and row["method"] == method
            and row["condition"].split("+")[0] == condition and row["rate"] == rate)


class Figures:
    """The stored figures; a figure that is not there is a dash."""

    def __init__(self, stored):
        self.stored = stored

    def row(self, run, method, condition, rate, distance):
        return next((row for row in self.stored["rows"] if is_of(row, run, method, condition, rate) and row["range"] == distance), None)

    def part(self, part, run, method, condition, rate, distances):
        """Mean over the ranges, weighted by scenes."""
        found = [row for row in self.stored["parts"]
                 if row["part"] == part and is_of(row, run, method, condition, rate) and row["range"] in distances]
        return {"usable": over(found, "usable", "judged"), "iou": over(found, "iou", "measured")} if found else None

    def there(self, names):
        """The methods of the first table that have figures, with their labels."""
        return [(method, label) for method, label in names.items() if self.row(None, method, "paper", 0.0, 30.0)]


def at_rates(before="", after=""):
    """Titles of the columns of the rates."""
    return [f"{before}{100 * rate:.0f} %{after}" if rate == RATES[0] else f"{100 * rate:.0f} %" for rate in RATES]


def lane_table(first, rows):
    """`rows`: a label and the text of a condition and rate each."""
    return table([first] + [title for condition in CONDITIONS for title in at_rates(f"`{condition}` ")],
                 [[label] + [text(condition, rate) for condition in CONDITIONS for rate in RATES] for label, text in rows])


def methods_table(figures, title, names, cell):
    """A row for each method that has figures; `cell` is of method, condition and rate."""
    return lane_table(title, [(label, lambda condition, rate, method=method: cell(method, condition, rate)) for method, label in figures.there(names)])


def usable_table(figures):
    return methods_table(figures, "usable, %", README_METHODS, lambda *of: percent(figures.row(None, *of, 30.0)["usable"]))


def quality_table(figures, distance):
    return methods_table(figures, "usable / IoU, %", METHODS, lambda *of: both(figures.row(None, *of, distance)))


def designed_table(figures):
    return methods_table(figures, "usable / IoU, %", METHODS, lambda *of: both(figures.part("designed", None, *of, {30.0})))


def ordinary_table(figures):
    rows = [("`paper`", "front", "paper"), ("`car`", "front", "car"),
            ("`car`, with colours", "front_colors", "car"), ("`car`, false positives drawn at each pose", "front_no_persist", "car"),
            ("`harsh`", "front", "harsh")]
    return table(["usable / IoU, %"] + at_rates(),
                 [[label] + [both(figures.part("ordinary", run, "front", condition, rate, {30.0, 50.0})) for rate in RATES]
                  for label, run, condition in rows])


def colour_table(figures):
    """Each method that can use colours, without and with them. A run that is not stored is a row of dashes, so that it is missed."""
    distances = (30.0, 50.0)
    head = ["`car`, usable / IoU, %"] + [title for distance in distances for title in at_rates(f"{distance:.0f} m, ")]
    return table(head, [[METHODS[method].removesuffix(", without colours") + label] +
                        [both(figures.row(run, method, "car", rate, distance)) for distance in distances for rate in RATES]
                        for method, coloured in COLOURED.items() for label, run in (("", None), (", with colours", coloured))])


def conditions_table(figures):
    rows = [(f"`front` in {label}, {distance:.0f} m", run, "front", condition, distance)
            for label, run, condition in (("`harsh`", "front", "harsh"), ("`car`, false positives drawn at each pose", "front_no_persist", "car"))
            for distance in (30.0, 50.0)]
    rows += [(f"`{method}` along a lap", "front_lap", method, "car", 30.0) for method in ("front", "front-warm")]
    lines = []
    for label, run, method, condition, distance in rows:
        cells = [figures.row(run, method, condition, rate, distance) for rate in RATES]
        steady = f"{percent(cells[0]['unsteady'], 0)} / {percent(cells[-1]['unsteady'], 0)}" if run == "front_lap" else UNKNOWN
        lines.append([label] + [both(cell) for cell in cells] + [steady])
    return table(["usable / IoU, %"] + at_rates() + ["unsteady at 0 / 50 %"], lines)


def ends(figures, method, condition, distance, *keys):
    """Texts of figures without and with the most false positives; `keys`: (show, key, digits), of rows or their certainty."""
    cells = [figures.row(None, method, condition, rate, distance) for rate in (0.0, 0.5)]
    cells = [cell | cell.get("certainty", {}) for cell in cells]
    return [" / ".join(show(cell[key], digits) for cell in cells) for show, key, digits in keys]


def error_table(figures):
    return table(["", "centre p95, m", "heading p95, rad", "unsteady, %", "exact, %"], [
        [f"`{method}` in `{condition}`", *ends(figures, method, condition, 30.0, (fixed, "centre_p95_m", 2), (fixed, "heading_p95_rad", 3),
                                               (percent, "unsteady", 0), (percent, "exact", 0))]
        for method, _ in figures.there(METHODS) if method not in ("rld-cbc", "ft-fsd-path-planning") for condition in CONDITIONS])


def certainty_table(figures):
    keys = [(percent, key, digits) for key, digits in (("off", 1), ("sure", 0), ("usable_if_sure", 1), ("trusted", 0), ("right_if_trusted", 1))]
    return table(["at 0 % / 50 % false positives", "off", "sure", "usable if sure", "trusted", "right if trusted"], [
        [f"`{condition}`, {distance:.0f} m", *ends(figures, "front", condition, distance, *keys)] for condition in CONDITIONS for distance in (30.0, 50.0)])


def certainty_in_words(figures):
    """Over all rates and both ranges, weighted by scenes, what is said of sure lanes by their number."""
    def each(key, of=None):
        texts = []
        for condition in CONDITIONS:
            cells = [row["certainty"] | {"weight": row["scenes"] * (1.0 if of is None else row["certainty"][of] or 0.0)} for row in figures.stored["rows"]
                     if (row["run"], row["method"], row["condition"]) == ("front", "front", condition)]
            texts.append(percent(over(cells, key, "weight")))
        return texts
    off, sure, right, trusted = each("off"), each("usable_if_sure", "sure"), each("right_if_trusted"), each("trusted")
    return table(["number", "meaning", "held out, 30 and 50 m, 0 to 50 % false cones"], [
        ["`confidence`", "probability that the lane is usable: right for 20 m and long enough",
         f"off by {off[0]} % (`paper`) and {off[1]} % (`car`) on average; of the lanes with 99 % and more, {sure[0]} and {sure[1]} % are usable"],
        ["`trusted_m`", "distance up to which the lane can be trusted",
         f"right in {right[0]} % (`paper`) and {right[1]} % (`car`) of the scenes; covers {trusted[0]} and {trusted[1]} % of the lane"]])


def latency_table(figures):
    def text(latency):
        return f"{latency['median']:.2f} / {latency['p95']:.1f} / {latency['max']:.0f}"
    return table(["median / p95 / longest, ms", "0 %, 30 m", "50 m", "30 %, 30 m", "50 m", "50 %, 30 m", "50 m"], [
        [f"`{method}` in `{condition}`"] + [text(figures.row(None, method, condition, rate, distance)["latency_ms"])
                                            for rate in (0.0, 0.3, 0.5) for distance in (30.0, 50.0)]
        for method in ("front", "clc") for condition in CONDITIONS])


DRIVERS = [("`front-warm`, frame by frame", "`car`", "race", "front-warm"), ("through a planner", "`car`", "race", "front-warm+planner"),
           ("through a planner", "`harsh`", "race_harsh", "front-warm+planner")]


def races_of(figures, run, method):
    cells = [row for row in figures.stored["races"] if row["run"] == run and row["method"] == method]
    return sorted(cells, key=lambda row: row["rate"])


def race_table(figures):
    return table(["finished, %", "0 %", "30 %", "50 %"],
                 [[f"{label}, {condition}"] + [percent(row["finished"]) for row in races_of(figures, run, method)] for label, condition, run, method in DRIVERS])


def race_measure_table(figures):
    return table(["who drives", "condition", "false positives", "races", *MEASURES],
                 [[label, condition, f"{100 * row['rate']:.0f} %", str(row["races"]), *measure_cells(row)]
                  for label, condition, run, method in DRIVERS for row in races_of(figures, run, method)])


def ten_laps_table(figures):
    return table(["false positives", "races", *MEASURES, "not finished"],
                 [[f"{100 * row['rate']:.0f} %", str(row["races"]), *measure_cells(row),
                   ", ".join(f"`{race.split()[0]}`" for race in row["not_finished"]) or "none"] for row in races_of(figures, "race_ten", "front-warm+planner")])


def lap_table(figures):
    """Of the races by the trust, a row for the laps of each rate; with the share of the races that were finished."""
    finished = {row["rate"]: row["finished"] for row in races_of(figures, "race_safe", "front-warm+planner")}
    return columns_table("laps, false positives", "{laps}, {percent:.0f} %", {
        "time ratio": lambda row: fixed(row["time_ratio"], 3), "safe < 3 m, %": share("short", 2), "trusted, wrong, %": share("wrong_trusted", 2),
        "sideways p95, m": lambda row: fixed(row["sideways_p95_m"], 3), "curvature, 1/m": lambda row: fixed(row["curvature_1pm"], 2),
        "races finished, %": lambda row: percent(finished[row["rate"]])},
        [row | {"percent": 100.0 * row["rate"]} for row in figures.stored.get("laps", []) if row["run"] == "race_safe"])


def twelve_table(figures):
    names = {"default": "(29)", "shape": "costs of the shape", "learned": "learned costs"}
    lines = []
    for costs, label in names.items():
        cells = sorted((row for row in figures.stored["twelve"] if row["costs"] == costs), key=lambda row: row["rate"])
        lines.append([label] + [percent(row["accurate"]) for row in cells])
    return table(["accurate, %", "0 %", "16.7 % (1 : 5)", "50 % (1 : 1)"], lines + [["RLD paper (its generated scenes)", "", "96.4", "above 90"]])


def judge_table(stored):
    """The record of a judge: expected and attained, and where it errs, by family; and what all checks of `accurate` leave."""
    rates = sorted({row["rate"] for row in stored.get("judge", [])})
    lines = []
    for family in ("fsd", "epfl", "eufs", "events", "fsai_sim", "all"):
        cells = [row for row in stored.get("judge", []) if row["family"] == family]
        lines.append([f"`{family}`" if family != "all" else "all"] +
                     [f"{percent(row['expected'])} / {percent(row['attained'])}" for row in cells] +
                     [", ".join(str(sum(row[where] for row in cells)) for where in ("start", "inside", "ends"))])
    for costs, label in (("judge", "all checks: the judge"), ("truth", "all checks: the truth")):
        cells = {row["rate"]: row["accurate"] for row in stored.get("judge_checks", []) if row["costs"] == costs}
        lines.append([label] + [percent(cells.get(rate)) for rate in rates] + ["–"])
    return table(["at most one wrong cone, %: expected / attained", "0 %", "16.7 % (1 : 5)", "50 % (1 : 1)", "errors at start, inside, at ends"],
                 lines)


TABLES = {
    "usable": usable_table,
    "quality at 30 m": lambda figures: quality_table(figures, 30.0),
    "quality at 50 m": lambda figures: quality_table(figures, 50.0),
    "designed courses": designed_table,
    "ordinary courses": ordinary_table,
    "with colours": colour_table,
    "conditions of front": conditions_table,
    "errors": error_table,
    "certainty of front": certainty_table,
    "certainty of front in words": certainty_in_words,
    "latency": latency_table,
    "races": race_table,
    "races by measure": race_measure_table,
    "ten laps": ten_laps_table,
    "lap times": lap_table,
    "twelve cones": twelve_table,
}


def tables(stored):
    """The text of each table by its name."""
    figures = Figures(stored)
    return {name: make(figures) for name, make in TABLES.items()}
