"""Tables of courses that no method has learned from, from the runs of experiments/held_out/measure.

    tables.py collect DIR FILE   the figures of the runs in DIR, as one JSON file
    tables.py write FILE         the tables of README.md and docs/ between their markers, and a copy of FILE in docs/benchmarks/
    tables.py check              whether the pages say what docs/benchmarks/held_out.json says; exit code 1 if not

A table stands between `<!-- table NAME -->` and `<!-- end of table -->`.
"""

import json
import os
import re
import statistics
import sys
from collections import defaultdict

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
STORED = os.path.join("docs", "benchmarks", "held_out.json")
PAGES = ["README.md", "docs/results.md", "docs/race.md", "docs/benchmarks/0.5.md"]

COMPARISONS = ["front", "front_no_persist", "front_lap", "clc", "others", "peers"]
RACES = ["race", "race_harsh"]
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
    "rld-shape": "`rld-shape`",
    "clc-paper": "`clc-paper`",
    "rld-pair": "`rld-pair`",
    "rld-cbc": "`rld-cbc`, 12 cones",
    "delaunay-beam": "`delaunay-beam`",
    "astar-lane": "`astar-lane`",
    "ft-fsd-path-planning": "ft-fsd-path-planning, without colours",
}
README_METHODS = METHODS | {
    "clc-paper": "`clc-paper`: CLC as printed",
    "rld-pair": "`rld-pair`: RLD's own objective",
    "rld-cbc": "`rld-cbc`: RLD among 12 cones",
    "ft-fsd-path-planning": "ft-fsd-path-planning",
}


# Collecting


def lines_of(path):
    with open(path, encoding="utf-8") as stream:
        return [json.loads(line) for line in stream]


def provenance(record):
    return {key: record[key] for key in ("commit", "compiler", "machine")}


def rounded(value):
    return round(value, 6) if isinstance(value, float) else value


def mean(values):
    return rounded(statistics.fmean(values)) if values else None


def row_of(line):
    """The figures of one method, condition, rate and range, from a line of results.jsonl."""
    row = {"method": line["method"], "condition": line["condition"], "rate": line["false_positive_rate"], "range": line["range"],
           "scenes": line["scenes"], "errors": line["errors"], "usable": line.get("usable_share"), "iou": line.get("mean_iou"),
           "exact": line["share"]["ground truth"], "centre_p95_m": line.get("lateral_p95_m"),
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
    cells = defaultdict(list)
    for score in scores:
        if selected(family_of[score["track"]], score["track"]):
            cells[score["method"], score["condition"], score["false_positive_rate"], score["range"]].append(score)
    return [{"part": name, "method": method, "condition": condition, "rate": rate, "range": distance, "scenes": len(cell),
             "usable": mean([float(score["usable"]) for score in cell if "usable" in score]),
             "judged": sum("usable" in score for score in cell),
             "iou": mean([score["iou"] for score in cell if "iou" in score]), "measured": sum("iou" in score for score in cell)}
            for (method, condition, rate, distance), cell in sorted(cells.items())]


def families_of(folds, tracks):
    """The family of each track: the fold whose training has not seen it. None for a run without annotated boundaries: nothing learns
    from it."""
    learned = {}
    for family in sorted(os.listdir(folds)):
        with open(os.path.join(folds, family, "front.json"), encoding="utf-8") as stream:
            learned[family] = set(json.load(stream)["training"]["tracks"])
    family_of = {}
    for track in sorted(tracks):
        unseen = [family for family, seen in learned.items() if track not in seen]
        if len(unseen) not in (1, len(learned)):
            raise SystemExit(f"tables.py: {track} is held out by {len(unseen)} folds of {folds}")
        family_of[track] = unseen[0] if len(unseen) == 1 else None
    return family_of


def race_rows(record):
    cells = defaultdict(list)
    for heat in record["races"]:
        cells[heat["method"], heat["false_positive_rate"]].append(heat)
    rows = []
    for (method, rate), heats in sorted(cells.items()):
        def median(key):
            known = [heat[key] for heat in heats if heat[key] is not None]
            return rounded(statistics.median(known)) if known else None
        rows.append({"method": method, "condition": record["condition"], "rate": rate, "races": len(heats),
                     "finished": mean([float(heat["finished"]) for heat in heats]),
                     "lateral_error_p95_m": median("lateral_error_p95_m"),
                     "not_finished": sorted(f"{heat['track']} {heat['seed']}" for heat in heats if not heat["finished"])})
    return rows


def collect(folder):
    stored = {"runs": {}, "rows": [], "parts": [], "races": []}
    family_of = {}
    for name in COMPARISONS:
        path = os.path.join(folder, name)
        if name == "peers" and not os.path.exists(path):
            continue
        lines = lines_of(os.path.join(path, "results.jsonl"))
        stored["runs"][name] = provenance(lines[0])
        stored["rows"] += [{"run": name} | row_of(line) for line in lines]
        scores = lines_of(os.path.join(path, "scores.jsonl"))
        if not family_of:
            family_of = families_of(os.path.join(path, "folds"), {score["track"] for score in scores})
        stored["parts"] += [{"run": name} | row for row in part_of(scores, family_of, "designed", lambda family, _: family in DESIGNED)]
        if name in ("front", "front_no_persist"):
            stored["parts"] += [{"run": name} | row
                                for row in part_of(scores, family_of, "ordinary", lambda _, track: track not in PECULIAR)]
    stored["courses"] = family_of
    for name in RACES:
        with open(os.path.join(folder, name, "race.json"), encoding="utf-8") as stream:
            record = json.load(stream)
        stored["runs"][name] = provenance(record)
        stored["races"] += [{"run": name} | row for row in race_rows(record)]
    return stored


# Writing


class Figures:
    """The stored figures; a figure that is not there is a dash."""

    def __init__(self, stored):
        self.stored = stored

    def row(self, run, method, condition, rate, distance):
        found = [row for row in self.stored["rows"]
                 if (row["run"] in OWN_SCENES if run is None else row["run"] == run) and row["method"] == method
                 and row["condition"].split("+")[0] == condition and row["rate"] == rate and row["range"] == distance]
        return found[0] if found else None

    def part(self, part, run, method, condition, rate, distances):
        """Mean over the ranges, weighted by scenes."""
        found = [row for row in self.stored["parts"]
                 if row["part"] == part and (row["run"] in OWN_SCENES if run is None else row["run"] == run) and row["method"] == method
                 and row["condition"].split("+")[0] == condition and row["rate"] == rate and row["range"] in distances]
        if not found:
            return None
        usable = sum(row["usable"] * row["judged"] for row in found) / sum(row["judged"] for row in found)
        measured = [row for row in found if row["iou"] is not None]
        iou = sum(row["iou"] * row["measured"] for row in measured) / sum(row["measured"] for row in measured) if measured else None
        return {"usable": usable, "iou": iou}


def percent(value, digits=1):
    return "–" if value is None else f"{100 * value:.{digits}f}"


def both(row):
    return "–" if row is None else f"{percent(row['usable'])} / {percent(row['iou'], 0)}"


def table(header, rows):
    lines = [header, ["---"] * len(header), *rows]
    return "\n".join("| " + " | ".join(line) + " |" for line in lines)


def columns(first, conditions=CONDITIONS):
    return [first] + [f"`{condition}` {100 * rate:.0f} %" if rate == RATES[0] else f"{100 * rate:.0f} %"
                      for condition in conditions for rate in RATES]


def methods_there(figures, names):
    return [(method, label) for method, label in names.items() if figures.row(None, method, "paper", 0.0, 30.0)]


def usable_table(figures):
    return table(columns("usable, %"),
                 [[label] + [percent(figures.row(None, method, condition, rate, 30.0)["usable"])
                             for condition in CONDITIONS for rate in RATES]
                  for method, label in methods_there(figures, README_METHODS)])


def quality_table(figures, distance):
    return table(columns("usable / IoU, %"),
                 [[label] + [both(figures.row(None, method, condition, rate, distance)) for condition in CONDITIONS for rate in RATES]
                  for method, label in methods_there(figures, METHODS)])


def designed_table(figures):
    return table(columns("usable / IoU, %"),
                 [[label] + [both(figures.part("designed", None, method, condition, rate, {30.0}))
                             for condition in CONDITIONS for rate in RATES]
                  for method, label in methods_there(figures, METHODS)])


def ordinary_table(figures):
    rows = [("`paper`", "front", "paper"), ("`car`", "front", "car"),
            ("`car`, false positives drawn at each pose", "front_no_persist", "car"), ("`harsh`", "front", "harsh")]
    return table(["usable / IoU, %"] + [f"{100 * rate:.0f} %" for rate in RATES],
                 [[label] + [both(figures.part("ordinary", run, "front", condition, rate, {30.0, 50.0})) for rate in RATES]
                  for label, run, condition in rows])


def conditions_table(figures):
    rows = [(f"`front` in `harsh`, {distance:.0f} m", "front", "front", "harsh", distance) for distance in (30.0, 50.0)]
    rows += [(f"`front` in `car`, false positives drawn at each pose, {distance:.0f} m", "front_no_persist", "front", "car", distance)
             for distance in (30.0, 50.0)]
    rows += [(f"`{method}` along a lap", "front_lap", method, "car", 30.0) for method in ("front", "front-warm")]
    lines = []
    for label, run, method, condition, distance in rows:
        cells = [figures.row(run, method, condition, rate, distance) for rate in RATES]
        steady = f"{percent(cells[0]['unsteady'], 0)} / {percent(cells[-1]['unsteady'], 0)}" if run == "front_lap" else "–"
        lines.append([label] + [both(cell) for cell in cells] + [steady])
    return table(["usable / IoU, %"] + [f"{100 * rate:.0f} %" for rate in RATES] + ["unsteady at 0 / 50 %"], lines)


def error_table(figures):
    def pair(cells, key, digits, scale=1.0):
        return " / ".join("–" if cell[key] is None else f"{scale * cell[key]:.{digits}f}" for cell in cells)
    lines = []
    for method, _ in methods_there(figures, METHODS):
        if method in ("rld-cbc", "ft-fsd-path-planning"):
            continue
        for condition in CONDITIONS:
            cells = [figures.row(None, method, condition, rate, 30.0) for rate in (0.0, 0.5)]
            lines.append([f"`{method}` in `{condition}`", pair(cells, "centre_p95_m", 2), pair(cells, "heading_p95_rad", 3),
                          pair(cells, "unsteady", 0, 100.0), pair(cells, "exact", 0, 100.0)])
    return table(["", "centre p95, m", "heading p95, rad", "unsteady, %", "exact, %"], lines)


def certainty_table(figures):
    lines = []
    for condition in CONDITIONS:
        for distance in (30.0, 50.0):
            cells = [figures.row(None, "front", condition, rate, distance)["certainty"] for rate in (0.0, 0.5)]
            def pair(key, digits):
                return " / ".join(percent(cell[key], digits) for cell in cells)
            lines.append([f"`{condition}`, {distance:.0f} m", pair("off", 1), pair("sure", 0), pair("usable_if_sure", 1),
                          pair("trusted", 0), pair("right_if_trusted", 1)])
    return table(["at 0 % / 50 % false positives", "off", "sure", "usable if sure", "trusted", "right if trusted"], lines)


def latency_table(figures):
    lines = []
    for method in ("front", "clc"):
        for condition in CONDITIONS:
            cells = [figures.row(None, method, condition, rate, distance)["latency_ms"]
                     for rate in (0.0, 0.3, 0.5) for distance in (30.0, 50.0)]
            lines.append([f"`{method}` in `{condition}`"] +
                         [f"{cell['median']:.2f} / {cell['p95']:.1f} / {cell['max']:.0f}" for cell in cells])
    return table(["median / p95 / longest, ms", "0 %, 30 m", "50 m", "30 %, 30 m", "50 m", "50 %, 30 m", "50 m"], lines)


def race_table(figures):
    rows = [("`front-warm`, frame by frame, `car`", "race", "front-warm"), ("through a planner, `car`", "race", "front-warm planner"),
            ("through a planner, `harsh`", "race_harsh", "front-warm planner")]
    lines = []
    for label, run, method in rows:
        cells = [row for row in figures.stored["races"] if row["run"] == run and row["method"] == method]
        lines.append([label] + [percent(row["finished"]) for row in sorted(cells, key=lambda row: row["rate"])])
    return table(["finished, %", "0 %", "30 %", "50 %"], lines)


def runs_table(figures):
    return table(["run", "commit", "compiler", "machine"],
                 [[f"`{name}`", run["commit"], run["compiler"], run["machine"]] for name, run in figures.stored["runs"].items()])


TABLES = {
    "usable": usable_table,
    "quality at 30 m": lambda figures: quality_table(figures, 30.0),
    "quality at 50 m": lambda figures: quality_table(figures, 50.0),
    "designed courses": designed_table,
    "ordinary courses": ordinary_table,
    "conditions of front": conditions_table,
    "errors": error_table,
    "certainty of front": certainty_table,
    "latency": latency_table,
    "races": race_table,
    "runs": runs_table,
}

BLOCK = re.compile(r"(<!-- table (?P<name>[^>]*?) -->\n).*?(<!-- end of table -->)", flags=re.S)


def filled(text, figures, page):
    def block(match):
        name = match["name"]
        if name not in TABLES:
            raise SystemExit(f"{page}: no table is called '{name}'; there are {', '.join(TABLES)}")
        return f"{match[1]}{TABLES[name](figures)}\n{match[3]}"
    return BLOCK.sub(block, text)


def read(path):
    with open(path, encoding="utf-8") as stream:
        return stream.read()


def write(path, text):
    with open(path + ".part", "w", encoding="utf-8") as stream:
        stream.write(text)
    os.replace(path + ".part", path)


def text_of(stored):
    """One row a line, so that a change shows."""
    def lines(rows):
        return "[\n" + ",\n".join("    " + json.dumps(row) for row in rows) + "\n  ]"
    return ("{\n" + ",\n".join(f'  "{key}": ' + (lines(value) if isinstance(value, list) else json.dumps(value))
                               for key, value in stored.items()) + "\n}\n")


def main(arguments):
    match arguments:
        case ["collect", folder, file]:
            write(file, text_of(collect(folder)))
        case ["write", file]:
            text = read(file)
            figures = Figures(json.loads(text))
            for page in PAGES:
                path = os.path.join(ROOT, page)
                write(path, filled(read(path), figures, page))
            write(os.path.join(ROOT, STORED), text)
        case ["check"]:
            figures = Figures(json.loads(read(os.path.join(ROOT, STORED))))
            pages = {page: read(os.path.join(ROOT, page)) for page in PAGES}
            named = {match["name"] for text in pages.values() for match in BLOCK.finditer(text)}
            wrong = [f"{page}: a table is not what {STORED} says" for page, text in pages.items() if filled(text, figures, page) != text]
            wrong += [f"no page has the table '{name}'" for name in TABLES if name not in named]
            print("\n".join(wrong) or f"{len(named)} tables are what {STORED} says")
            return 1 if wrong else 0
        case _:
            print(__doc__, file=sys.stderr)
            return 2
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
