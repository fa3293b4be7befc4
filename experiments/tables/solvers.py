"""Solvers and exactness: the figures of the runs of experiments/tables/solvers, and their tables."""

import os
import random
import re
import statistics
from collections import defaultdict

from cells import lines_of, percent, provenance, rounded, table

RATES = [0.0, 0.1, 0.3, 0.5]
LANES = ["beam", "candidate", "choice", "beside"]
SUCCESSES = {"ground_truth", "near_ground_truth", "too_short", "diverging_from_20"}
GAPS = [("none", 1e-6), ("to 1 %", 0.01), ("to 10 %", 0.1), ("above", float("inf"))]
DENSITIES = [4, 5, 6, 7, 10]
EDGES = [100, 200, 300, 500, 1000]
BEAM_KEYS = ["beam", "drop", "scenes", "best_score", "first_usable", "usable", "any_usable", "iou", "median_ms", "p95_ms", "worst_ms"]
BEAM = 15  # what front takes
DENSE = "eufs_comp_2021"  # a course whose cones are 1.7 m apart
CLAIMS = {"proven_default": "all visible", "proven_shape": "with the costs of the lane's shape", "proven_learned": "with learned costs",
          "proven_paper": "pairing `paper`", "proven_60": "60 nearest"}


def quantile(values, share):
    """Linear between the two nearest values."""
    values = sorted(values)
    place = share * (len(values) - 1)
    low = int(place)
    return values[low] + (place - low) * (values[min(low + 1, len(values) - 1)] - values[low])


def backend_rows(lines):
    """One row for each solver and size; the lines of a scene have a status, those of other rows of the study have none."""
    cells = defaultdict(list)
    for line in lines:
        if "scene" in line and line.get("permutation", 0) == 0:
            cells[line["backend"], line["nearest"]].append(line)
    rows = []
    for (backend, nearest), cell in cells.items():
        times = [line["latency_ms"] for line in cell]
        rows.append({"table": "backends", "backend": backend, "nearest": nearest, "scenes": len(cell),
                     "proven": sum(line["status"] in ("optimal", "infeasible") for line in cell),
                     "median_ms": rounded(quantile(times, 0.5)), "p95_ms": rounded(quantile(times, 0.95)), "max_ms": rounded(max(times))})
    return rows


def size_rows(lines):
    """The measures that the study itself prints, see docs/measures.md."""
    versions = {line["backend"]: line.get("version", "") for line in lines if line.get("row") == "block"}
    return [{"table": "sizes", "backend": line["backend"], "nearest": line["nearest"], "version": versions.get(line["backend"], ""),
             "scenes": line["scenes"], "runs": line["runs"], "solved": line["solved"], "errors": line["errors"],
             "geometric_ms": rounded(line["geometric_ms"]), "par10_ms": rounded(line["par10_ms"])}
            for line in lines if line.get("row") == "summary" and "condition" not in line]


def proven_rows(name, lines):
    """Shares proven within 50 ms and within the limit of 1 s, by range and rate, with and without the dense course."""
    cells = defaultdict(list)
    for line in lines:
        track, _, rate, distance = line["scene"].split("/")[:4]
        cells[float(distance.removeprefix("range_")), float(rate.removeprefix("fp_"))].append((track == DENSE, line))
    rows = []
    for (distance, rate), cell in sorted(cells.items()):
        for limit_ms in (50.0, 1000.0):
            def share(lines):
                proven = [line["status"] in ("optimal", "infeasible") and line["build_ms"] + line["solve_ms"] <= limit_ms for line in lines]
                return rounded(sum(proven) / len(proven))
            rows.append({"table": "proven", "claims": name, "range": distance, "rate": rate, "limit_ms": limit_ms, "scenes": len(cell),
                         "proven": share([line for _, line in cell]), "proven_without_dense": share([line for dense, line in cell if not dense])})
    return rows


def growth_row(lines):
    # A scene that is not proven has taken longer than any that is.
    times = [line["cpu_ms"] if line["proven"] else float("inf") for line in lines]

    def known(share):
        value = quantile(times, share) if max(times) < float("inf") else sorted(times)[min(len(times) - 1, round(share * (len(times) - 1)))]
        return rounded(value) if value < float("inf") else None
    return {"scenes": len(lines), "edges": statistics.median(line["edges"] for line in lines), "median_ms": known(0.5), "p95_ms": known(0.95),
            "nodes": rounded(statistics.fmean(line["nodes"] for line in lines)),
            "proven": rounded(statistics.fmean(float(line["proven"]) for line in lines))}


def growth_rows(lines):
    """By number of cones; all visible cones by density and by edges, in classes from one bound up to the next."""
    cells = defaultdict(list)
    for line in lines:
        if not line["all_visible"]:
            cells[line["cones"]].append(line)
    rows = [{"table": "growth", "nearest": cones} | growth_row(cell) for cones, cell in sorted(cells.items())]
    whole = [line for line in lines if line["all_visible"]]
    for name, key, bounds in (("growth by density", "density", DENSITIES), ("growth by edges", "edges", EDGES)):
        for low, high in zip([None, *bounds], [*bounds, None]):
            cell = [line for line in whole if (low is None or line[key] >= low) and (high is None or line[key] < high)]
            if cell:
                rows.append({"table": name, "from": low, "below": high} | growth_row(cell))
    return rows


def anytime_rows(lines):
    """The study's own table: what is known when a limit ends the search."""
    cells = defaultdict(list)
    for line in lines:
        cells[line["limit_ms"]].append(line)
    rows = []
    for limit, cell in sorted(cells.items()):
        def close(line):
            return "objective" in line and line["objective"] - line["best_known"] <= 0.01 * max(1.0, abs(line["best_known"]))
        unproven = [line for line in cell if not line["proven"]]
        gaps = [line["gap"] for line in unproven if "gap" in line]
        rows.append({"table": "anytime", "limit_ms": limit, "scenes": len(cell), "open": len(unproven), "open_close": sum(map(close, unproven)), "gap": rounded(statistics.median(gaps)) if gaps else None})
    return rows


def certificate_row(text):
    """From the last line of `conelane certify --verify`."""
    numbers = re.search(r"^verified: (\d+) optima, (\d+) infeasible, (\d+) lower bounds; (\d+) refused; (\d+) not verified within (\d+) steps$", text, flags=re.M)
    return {"table": "certificates"} | dict(zip(("optima", "infeasible", "bounds", "refused", "beyond", "steps"), map(int, numbers.groups())))


# Exactness. A lane that was not found is not usable, and its IoU is 0.


def is_usable(line, name):
    return float(name in line and bool(line[name].get("usable")))


def is_success(line, name):
    return float(name in line and line[name]["category"] in SUCCESSES)


def iou(line, name):
    return line[name]["iou"] if name in line else 0.0


def quality(lines, name):
    return [rounded(statistics.fmean(is_usable(line, name) for line in lines)), rounded(statistics.fmean(iou(line, name) for line in lines))]


def interval(lines, value):
    """95 % of the means when courses are drawn again, with replacement."""
    by_track = defaultdict(list)
    for line in lines:
        by_track[line["track"]].append(value(line))
    tracks = sorted(by_track)
    draw = random.Random(1)
    means = []
    for _ in range(2000):
        drawn = [by_track[draw.choice(tracks)] for _ in tracks]
        means.append(sum(map(sum, drawn)) / sum(map(len, drawn)))
    return [rounded(quantile(means, 0.025)), rounded(quantile(means, 0.975))]


def exactness_rows(lines):
    rows = []
    for rate in RATES:
        both = [line for line in lines if line["false_positive_rate"] == rate and "gap" in line]
        rows.append({"table": "exactness", "rate": rate, "scenes": len(both), "of": sum(line["false_positive_rate"] == rate for line in lines),
                     "equal": rounded(statistics.fmean(float(line["equal"]) for line in both))} |
                    {name: rounded(statistics.fmean(is_success(line, name) for line in both)) for name in ("optimum", "candidate", "choice")})
    return rows


def cost_names(lines):
    """default, shape and learned: the last objective is a file of learned costs."""
    return {name: name if name in ("default", "shape") else "learned" for name in {line["costs"] for line in lines}}


def objective_rows(lines):
    names = cost_names(lines)
    cells = defaultdict(list)
    for line in lines:
        if line["status"] == "optimal" and "optimum" in line and line["optimum"].get("usable") is not None:
            cells[names[line["costs"]], line["condition"]].append(line)
    rows = []
    for (costs, condition), cell in cells.items():
        def less(line):
            return is_usable(line, "optimum") - is_usable(line, "beam")
        asked = [line for line in lines if names[line["costs"]] == costs and line["condition"] == condition and line["status"] != "infeasible"]
        rows.append({"table": "objectives", "costs": costs, "condition": condition, "scenes": len(cell), "asked": len(asked)} |
                    {name: quality(cell, name) for name in ["optimum"] + LANES} |
                    {"less": rounded(statistics.fmean(map(less, cell))), "interval": interval(cell, less)})
    return rows


def gap_rows(lines):
    names = cost_names(lines)
    learned = [line for line in lines if names[line["costs"]] == "learned" and line["status"] == "optimal" and "optimum" in line
               and line["optimum"].get("usable") is not None]
    rows = []
    for lane in ("beam", "candidate", "beside"):
        low = -1.0
        for name, high in GAPS:
            cell = [line for line in learned if lane in line and line[lane].get("gap") is not None and low < line[lane]["gap"] <= high]
            low = high
            rows.append({"table": "gaps", "lane": lane, "gap": name, "scenes": len(cell)} |
                        ({"optimum": quality(cell, "optimum"), "quality": quality(cell, lane)} if cell else {}))
        cell = [line for line in learned if lane in line and line[lane].get("gap") is None]
        rows.append({"table": "gaps", "lane": lane, "gap": "forbidden", "scenes": len(cell)} |
                    ({"optimum": quality(cell, "optimum"), "quality": quality(cell, lane)} if cell else {}))
    return rows


def collect(folder):
    runs = os.path.join(folder, "solvers")
    stored = {"runs": {}, "rows": []}

    def lines(name):
        read = lines_of(os.path.join(runs, name + ".jsonl"))
        if "commit" in read[0]:
            stored["runs"][name] = provenance(read[0])
        return read

    for name in ("backends", "backends_main"):
        stored["rows"] += backend_rows(lines(name))
    stored["rows"] += size_rows(lines("backends_sizes"))
    for name, keys in (("formulations", ["cones", "formulation", "solver", "scenes", "optimal", "columns", "rows", "entries", "mean_gap",
                                         "median_gap", "mean_nodes", "median_ms"]),
                       ("relaxations", ["cones", "solver", "scenes", "optimal", "feasible", "median_ms"]),
                       ("confidence", ["known", "false_positive_rate", "scenes", "accurate", "success"])):
        stored["rows"] += [{"table": name} | {key: rounded(line[key]) for key in keys} for line in lines(name)]
    stored["rows"] += growth_rows(lines("growth"))
    stored["rows"] += anytime_rows(lines("anytime"))
    with open(os.path.join(runs, "verified.txt"), encoding="utf-8") as stream:
        stored["rows"].append(certificate_row(stream.read()))
    stored["rows"] += [{"table": "beam"} | {key: rounded(value) for key, value in line.items() if key in BEAM_KEYS} for line in lines("front_beam")]
    for name in CLAIMS:
        stored["rows"] += proven_rows(name, lines(name + ".solutions"))
    stored["rows"] += exactness_rows(lines("optimality"))
    costs = lines("optimality_costs")
    stored["rows"] += objective_rows(costs) + gap_rows(costs)
    return stored


# Tables


def milliseconds(value):
    return "" if value is None else f"{value:.3f}" if value < 0.1 else f"{value:.2f}" if value < 1 else f"{value:.1f}" if value < 10 else f"{value:.0f}"


def pair(values):
    return "–" if values is None else f"{percent(values[0])} / {percent(values[1])}"


def solver_table(rows):
    names = {"path-pair": "`path-pair`, exact search", "clp-bb/tight": "`clp-bb`, tight", "cbc/tight": "`cbc`, tight",
             "cbc-main/tight": "`cbc-main`, tight", "cbc-main/paper": "`cbc-main`, as printed"}
    lines = []
    for backend, label in names.items():
        cells = [next((row for row in rows if row["backend"] == backend and row["nearest"] == size), None) for size in (12, 30)]
        lines.append([label] + ["" if cell is None else " / ".join(milliseconds(cell[key]) for key in ("median_ms", "p95_ms", "max_ms")) +
                                f" ({cell['proven']} of {cell['scenes']})" for cell in cells])
    return table(["solver", "n = 12", "n = 30"], lines + [["RLD paper (Mosek, its own machine)", "mean 71.8, p95 156", ""]])


def size_table(rows):
    sizes = sorted({row["nearest"] for row in rows}, key=lambda size: size or float("inf"))  # 0: all visible cones
    lines = []
    for backend in dict.fromkeys(row["backend"] for row in rows):
        cells = [next((row for row in rows if row["backend"] == backend and row["nearest"] == size), None) for size in sizes]
        lines.append([f"`{backend}`", next(cell["version"] for cell in cells if cell)] +
                     ["–" if cell is None else f"{milliseconds(cell['geometric_ms'])} / {milliseconds(cell['par10_ms'])} ({percent(cell['solved'] / cell['runs'])} %)"
                      for cell in cells])
    return table(["solver, formulation", "version", *(f"n = {size}" if size else "all visible" for size in sizes)], lines)


def formulation_table(rows):
    names = {"paper": "printed rows", "tight": "tight rows"}
    return table(["", "columns", "rows", "entries", "LP gap, mean (median)", "nodes", "median ms"],
                 [[f"{names[row['formulation']]}, by `{row['solver']}`", f"{row['columns']:.0f}", f"{row['rows']:.0f}", f"{row['entries']:.0f}",
                   f"{percent(row['mean_gap'], 2)} % ({percent(row['median_gap'], 2)} %)", f"{row['mean_nodes']:.1f}", milliseconds(row["median_ms"])]
                  for row in rows])


def relaxation_table(rows):
    solvers = list(dict.fromkeys(row["solver"] for row in rows))
    lines = []
    for solver in solvers:
        cells = [next(row for row in rows if row["solver"] == solver and row["cones"] == size) for size in (12, 30)]
        lines.append([f"`{solver}`"] + [text for cell in cells for text in (f"{percent(cell['optimal'] / cell['feasible'])} %", milliseconds(cell["median_ms"]))])
    return table(["", "finds the optimum, n = 12", "median ms", "finds the optimum, n = 30", "median ms"], lines)


def growth_table(rows):
    return table(["nearest cones", "scenes", "edges", "median ms", "p95 ms", "nodes", "proven, %"],
                 [[str(row["nearest"]), str(row["scenes"]), f"{row['edges']:.0f}", milliseconds(row["median_ms"]), milliseconds(row["p95_ms"]),
                   f"{row['nodes']:.2f}", percent(row["proven"])] for row in rows])


def class_table(rows, name):
    def label(row):
        low, high = row["from"], row["below"]
        return f"below {high}" if low is None else f"{low} and more" if high is None else f"{low} to {high}"
    return table([name, "scenes", "edges", "median ms", "p95 ms", "nodes", "proven, %"],
                 [[label(row), str(row["scenes"]), f"{row['edges']:.0f}", milliseconds(row["median_ms"]), milliseconds(row["p95_ms"]),
                   f"{row['nodes']:.2f}", percent(row["proven"])] for row in rows])


def anytime_table(rows):
    return table(["limit", "proven", "proven or within 1 % of the best known, %", "of the open ones", "gap of the open ones, median"],
                 [[f"{row['limit_ms']:.0f} ms", f"{row['scenes'] - row['open']} of {row['scenes']}", percent((row["scenes"] - row["open"] + row["open_close"]) / row["scenes"]),
                   f"{row['open_close']} of {row['open']}", "–" if row["gap"] is None else f"{percent(row['gap'], 0)} %"] for row in rows])


def certificate_table(rows):
    return table(["claimed and verified", "scenes"],
                 [[label, str(row[key])] for row in rows for key, label in
                  (("optima", "the optimum"), ("infeasible", "no lane graph"), ("bounds", "a lower bound"), ("beyond", f"not within {row['steps']} steps"),
                   ("refused", "refused"))])


def beam_table(rows):
    def label(row):
        text = f"{row['beam']}, {row['drop']:.0f}"
        return f"**{text}**" if row["beam"] == BEAM else text
    return table(["beam, drop", "best score, %", "usable by score, %", "usable, judged, %", "any of 20 usable, %", "IoU, %", "median / p95 / longest ms"],
                 [[label(row)] + [percent(row[key]) for key in ("best_score", "first_usable", "usable", "any_usable", "iou")] +
                  [" / ".join(milliseconds(row[key]) for key in ("median_ms", "p95_ms", "worst_ms"))] for row in rows])


def proven_table(rows):
    places = [(distance, rate) for distance in (30.0, 50.0) for rate in (0.0, 0.3, 0.5)]
    lines = []
    for claims, label in CLAIMS.items():
        for limit_ms, limit in ((50.0, "50 ms"), (1000.0, "1 s")):
            cells = [next(row for row in rows if (row["claims"], row["limit_ms"], row["range"], row["rate"]) == (claims, limit_ms, *place))
                     for place in places]
            lines.append([f"{label}, {limit}"] + [f"{percent(cell['proven'])} ({percent(cell['proven_without_dense'])})" for cell in cells])
    return table(["cones and costs, limit", "30 m, no false cones", "30 %", "50 %", "50 m, none", "30 %", "50 %"], lines)


def confidence_table(rows):
    rates = sorted({row["false_positive_rate"] for row in rows})
    lines = []
    for known in dict.fromkeys(row["known"] for row in rows):
        cells = [next(row for row in rows if row["known"] == known and row["false_positive_rate"] == rate) for rate in rates]
        lines.append([known] + [percent(cell["accurate"]) for cell in cells] + [percent(cells[-1]["success"])])
    header = [f"accurate at {percent(rate, 0 if rate in (0.0, 0.5) else 1)} %" for rate in rates]
    return table(["", *header, f"success at {percent(rates[-1], 0)} %"], lines)


def exactness_table(rows):
    labels = [("scenes with both", lambda row: f"{row['scenes']} of {row['of']}"), ("the candidate is the optimum, % of these", lambda row: percent(row["equal"])),
              ("success of the optimum, %", lambda row: percent(row["optimum"])), ("success of that candidate, %", lambda row: percent(row["candidate"])),
              ("success of what CLC's network chooses, %", lambda row: percent(row["choice"]))]
    return table(["false positives"] + [f"{100 * row['rate']:.0f} %" for row in rows], [[label] + [text(row) for row in rows] for label, text in labels])


def objective_table(rows):
    names = {"default": "(29)", "shape": "shape", "learned": "learned"}
    return table(["objective", "condition", "scenes", "optimum", "beam", "CLC's best by it", "CLC", "`front`", "optimum less beam, usable"],
                 [[names[row["costs"]], f"`{row['condition']}`", f"{row['scenes']} of {row['asked']}"] + [pair(row[name]) for name in ["optimum"] + LANES] +
                  [f"{percent(row['less'])} ({percent(row['interval'][0])} to {percent(row['interval'][1])})"]
                  for condition in ("paper", "car") for costs in names for row in rows if (row["costs"], row["condition"]) == (costs, condition)])


def gap_table(rows):
    lines = []
    for gap in [name for name, _ in GAPS] + ["forbidden"]:
        line = [gap if gap != "forbidden" else "forbidden by the rows"]
        for lane in ("beam", "candidate", "beside"):
            cell = next(row for row in rows if row["lane"] == lane and row["gap"] == gap)
            line += [str(cell["scenes"]), pair(cell.get("optimum")), pair(cell.get("quality"))]
        lines.append(line)
    return table(["gap", "beam: scenes", "its optimum", "its lane", "CLC's best: scenes", "its optimum", "its lane", "`front`: scenes", "its optimum", "its lane"],
                 lines)


TABLES = {"solvers": ("backends", solver_table), "solvers by size": ("sizes", size_table), "formulations": ("formulations", formulation_table), "relaxations": ("relaxations", relaxation_table),
          "growth of path-pair": ("growth", growth_table), "growth by density": ("growth by density", lambda rows: class_table(rows, "density")),
          "growth by edges": ("growth by edges", lambda rows: class_table(rows, "edges")), "within a limit": ("anytime", anytime_table),
          "certificates": ("certificates", certificate_table), "width of the beam": ("beam", beam_table),
          "proven by path-pair": ("proven", proven_table),
          "confidence and colour": ("confidence", confidence_table), "exactness": ("exactness", exactness_table), "exactness by objective": ("objectives", objective_table),
          "exactness by gap": ("gaps", gap_table)}


def tables(stored):
    """The text of each table by its name."""
    return {name: make([row for row in stored["rows"] if row["table"] == part]) for name, (part, make) in TABLES.items()}
