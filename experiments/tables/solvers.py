"""Solvers and exactness: the figures of the runs of experiments/tables/solvers, and their tables."""

import math
import os
import random
import re
from statistics import fmean

from cells import UNKNOWN, columns_table, grouped, lines_of, mean, median, pair, percent, provenance, quantile, rounded, share, table

RATES = [0.0, 0.1, 0.3, 0.5]
LANES = ["beam", "candidate", "choice", "beside"]
SUCCESSES = {"ground_truth", "near_ground_truth", "too_short", "diverging_from_20"}
PROVEN = ("optimal", "infeasible")
GAPS = [("none", 1e-6), ("to 1 %", 0.01), ("to 10 %", 0.1), ("above", math.inf)]
DENSITIES = [4, 5, 6, 7, 10]
EDGES = [100, 200, 300, 500, 1000]
LIMITS_MS = [5.0, 20.0, 50.0, 100.0, 200.0, 500.0, 2000.0]
BEAM_KEYS = ["beam", "drop", "scenes", "best_score", "first_usable", "usable", "any_usable", "iou", "median_ms", "p95_ms", "worst_ms"]
BEAM = 15  # what front takes
DENSE = "eufs_comp_2021"  # a course whose cones are 1.7 m apart
CLAIMS = {"proven_default": "all visible", "proven_shape": "with the costs of the lane's shape", "proven_learned": "with learned costs",
          "proven_paper": "pairing `paper`", "proven_60": "60 nearest"}


def backend_rows(lines):
    """One row for each solver and size; the lines of a scene have a status, those of other rows of the study have none."""
    cells = grouped((line for line in lines if "scene" in line and line.get("permutation", 0) == 0), ("backend", "nearest"))
    rows = []
    for (backend, nearest), cell in cells.items():
        times = [line["latency_ms"] for line in cell]
        rows.append({"table": "backends", "backend": backend, "nearest": nearest, "scenes": len(cell),
                     "proven": sum(line["status"] in PROVEN for line in cell), "median_ms": rounded(median(times)),
                     "p95_ms": rounded(quantile(times, 0.95)), "max_ms": rounded(max(times))})
    return rows


def proven_rows(name, lines):
    """Shares proven within 50 ms and within the limit of 1 s, by range and rate, with and without the dense course."""
    def place(line):
        _, _, rate, distance = line["scene"].split("/")[:4]
        return float(distance.removeprefix("range_")), float(rate.removeprefix("fp_"))

    def proven(cell, limit_ms):
        return mean([float(line["status"] in PROVEN and line["build_ms"] + line["solve_ms"] <= limit_ms) for line in cell])
    return [{"table": "proven", "claims": name, "range": distance, "rate": rate, "limit_ms": limit_ms, "scenes": len(cell),
             "proven": proven(cell, limit_ms),
             "proven_without_dense": proven([line for line in cell if not line["scene"].startswith(f"{DENSE}/")], limit_ms)}
            for (distance, rate), cell in sorted(grouped(lines, place).items()) for limit_ms in (50.0, 1000.0)]


def growth_row(lines):
    # A scene that is not proven has taken longer than any that is.
    times = [line["cpu_ms"] if line["proven"] else math.inf for line in lines]
    known = {key: of for key, of in (("median_ms", median(times)), ("p95_ms", quantile(times, 0.95)))}
    return {"scenes": len(lines), "edges": median(line["edges"] for line in lines)} | {
        key: rounded(of) if of < math.inf else None for key, of in known.items()} | {
        "nodes": mean(line["nodes"] for line in lines), "proven": mean(float(line["proven"]) for line in lines)}


def growth_rows(lines):
    """By number of cones; all visible cones by density and by edges, in classes from one bound up to the next."""
    rows = [{"table": "growth", "nearest": cones} | growth_row(cell)
            for (cones,), cell in sorted(grouped((line for line in lines if not line["all_visible"]), ("cones",)).items())]
    for key, bounds in (("density", DENSITIES), ("edges", EDGES)):
        for low, high in zip([None, *bounds], [*bounds, None]):
            cell = [line for line in lines if line["all_visible"] and (low or -math.inf) <= line[key] < (high or math.inf)]
            if cell:
                rows.append({"table": f"growth by {key}", "from": low, "below": high} | growth_row(cell))
    return rows


def known_at(line, limit):
    """Objective and bound, None where unknown, when a limit ended the search of a line of the study of backends."""
    steps = [step for step in line["steps"] if step["time_ms"] <= 1.1 * limit + 1.0]
    return (steps[-1].get("objective"), steps[-1].get("bound")) if steps else (None, None)


def anytime_rows(lines):
    """What is known when a limit ends the search; the best lane graph is that of the longest limit."""
    rows = []
    cell = [line for line in lines if "scene" in line]
    for limit in LIMITS_MS:
        unproven = [line for line in cell if not (line["status"] in PROVEN and line["latency_ms"] <= limit)]
        known = [(line.get("objective"), *known_at(line, limit)) for line in unproven]
        close = sum(objective is not None and objective - best <= 0.01 * max(1.0, abs(best)) for best, objective, _ in known)
        gaps = [max(0.0, best - bound) / max(1.0, abs(best)) for best, _, bound in known if best is not None and bound is not None]
        rows.append({"table": "anytime", "limit_ms": limit, "scenes": len(cell), "open": len(unproven), "open_close": close,
                     "gap": rounded(median(gaps)) if gaps else None})
    return rows


def certificate_row(text):
    """From the last line of `conelane certify --verify`."""
    numbers = re.search(r"^verified: (\d+) optima, (\d+) infeasible, (\d+) lower bounds; (\d+) refused; (\d+) not verified within (\d+) steps$", text, flags=re.M)
    return {"table": "certificates"} | dict(zip(("optima", "infeasible", "bounds", "refused", "beyond", "steps"), map(int, numbers.groups())))


# Exactness. A lane that was not found is not usable, and its IoU is 0.


def is_usable(line, name):
    return float(name in line and bool(line[name].get("usable")))


def quality(lines, name):
    return [mean([is_usable(line, name) for line in lines]), mean([line[name]["iou"] if name in line else 0.0 for line in lines])]


def interval(lines, value):
    """95 % of the means when courses are drawn again, with replacement."""
    by_track = {track: [value(line) for line in cell] for (track,), cell in sorted(grouped(lines, ("track",)).items())}
    draw, tracks, means = random.Random(1), list(by_track), []
    for _ in range(2000):
        drawn = [by_track[draw.choice(tracks)] for _ in tracks]
        means.append(sum(map(sum, drawn)) / sum(map(len, drawn)))
    return [rounded(quantile(means, end)) for end in (0.025, 0.975)]


def exactness_rows(lines):
    rows = []
    for rate in RATES:
        of_rate = [line for line in lines if line["false_positive_rate"] == rate]
        both = [line for line in of_rate if "gap" in line]
        rows.append({"table": "exactness", "rate": rate, "scenes": len(both), "of": len(of_rate), "equal": mean([float(line["equal"]) for line in both])} |
                    {name: mean([float(name in line and line[name]["category"] in SUCCESSES) for line in both]) for name in ("optimum", "candidate", "choice")})
    return rows


def costs_of(line):
    """default, shape or learned: the last objective is a file of learned costs."""
    return line["costs"] if line["costs"] in ("default", "shape") else "learned"


def is_judged(line):
    return line["status"] == "optimal" and "optimum" in line and line["optimum"].get("usable") is not None


def objective_rows(lines):
    def less(line):
        return is_usable(line, "optimum") - is_usable(line, "beam")
    rows = []
    for (costs, condition), cell in grouped(lines, lambda line: (costs_of(line), line["condition"])).items():
        judged = [line for line in cell if is_judged(line)]
        if judged:
            rows.append({"table": "objectives", "costs": costs, "condition": condition, "scenes": len(judged),
                         "asked": sum(line["status"] != "infeasible" for line in cell)} |
                        {name: quality(judged, name) for name in ["optimum"] + LANES} |
                        {"less": rounded(fmean(map(less, judged))), "interval": interval(judged, less)})
    return rows


def gap_rows(lines):
    learned = [line for line in lines if costs_of(line) == "learned" and is_judged(line)]
    rows = []
    for lane in ("beam", "candidate", "beside"):
        cells = grouped((line for line in learned if lane in line), lambda line, lane=lane: "forbidden" if line[lane].get("gap") is None else next(
            name for name, high in GAPS if line[lane]["gap"] <= high))
        for name in [name for name, _ in GAPS] + ["forbidden"]:
            cell = cells.get(name, [])
            rows.append({"table": "gaps", "lane": lane, "gap": name, "scenes": len(cell)} |
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
    keys = ["cones", "formulation", "solver", "scenes", "optimal", "columns", "rows", "entries", "mean_gap", "median_gap", "mean_nodes", "median_ms"]
    for name, of in (("formulations", keys), ("relaxations", ["cones", "solver", "scenes", "optimal", "feasible", "median_ms"])):
        stored["rows"] += [{"table": name} | {key: rounded(line[key]) for key in of} for line in lines(name)]
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
    return "" if value is None else f"{value:.{3 if value < 0.1 else 2 if value < 1 else 1 if value < 10 else 0}f}"


def times(*keys):
    return lambda row: " / ".join(milliseconds(row[key]) for key in keys)


def pivot(rows, labels, columns, cell, unknown=UNKNOWN):
    """A line for each of `labels` (values of keys -> text), with a cell for each of `columns` (values of other keys)."""
    def text(wanted):
        found = next((row for row in rows if wanted.items() <= row.items()), None)
        return unknown if found is None else cell(found)
    return [[label] + [text(dict(values) | dict(column)) for column in columns] for values, label in labels.items()]


def only(**values):
    """Values of keys as a key of its own."""
    return tuple(values.items())


def solver_table(rows):
    names = {"path-pair": "`path-pair`, exact search", "clp-bb/tight": "`clp-bb`, tight", "cbc/tight": "CBC tuned (`cbc`), tight",
             "cbc-main/tight": "CBC, defaults (`cbc-main`), tight", "cbc-main/paper": "CBC, defaults (`cbc-main`), as printed"}
    lines = pivot(rows, {only(backend=backend): label for backend, label in names.items()}, [only(nearest=size) for size in (12, 30)],
                  lambda row: f"{times('median_ms', 'p95_ms', 'max_ms')(row)} ({row['proven']} of {row['scenes']})", "")
    return table(["solver", "n = 12", "n = 30"], lines + [["RLD paper (Mosek, its own machine)", "mean 71.8, p95 156", ""]])


def formulation_table(rows):
    names = {"paper": "printed rows", "tight": "tight rows"}
    return columns_table("", lambda row: f"{names[row['formulation']]}, by `{row['solver']}`", {
        "columns": "{columns:.0f}", "rows": "{rows:.0f}", "entries": "{entries:.0f}",
        "LP gap, mean (median)": lambda row: f"{percent(row['mean_gap'], 2)} % ({percent(row['median_gap'], 2)} %)", "nodes": "{mean_nodes:.1f}",
        "median ms": times("median_ms")}, rows)


def relaxation_table(rows):
    lines = []
    for (solver,), cells in grouped(rows, ("solver",)).items():
        of_size = {row["cones"]: [f"{percent(row['optimal'] / row['feasible'])} %", milliseconds(row["median_ms"])] for row in cells}
        lines.append([f"`{solver}`", *of_size[12], *of_size[30]])
    return table(["", "finds the optimum, n = 12", "median ms", "finds the optimum, n = 30", "median ms"], lines)


def growth_table(rows, title="nearest cones", label="{nearest}"):
    return columns_table(title, label, {"scenes": "{scenes}", "edges": "{edges:.0f}", "median ms": times("median_ms"), "p95 ms": times("p95_ms"),
                          "nodes": "{nodes:.2f}", "proven, %": share("proven")}, rows)


def class_table(rows, name):
    def label(row):
        low, high = row["from"], row["below"]
        return f"below {high}" if low is None else f"{low} and more" if high is None else f"{low} to {high}"
    return growth_table(rows, name, label)


def anytime_table(rows):
    return columns_table("limit", "{limit_ms:.0f} ms", {
        "proven": lambda row: f"{row['scenes'] - row['open']} of {row['scenes']}",
        "proven or within 1 % of the best known, %": lambda row: percent((row["scenes"] - row["open"] + row["open_close"]) / row["scenes"]),
        "of the open ones": "{open_close} of {open}",
        "gap of the open ones, median": lambda row: UNKNOWN if row["gap"] is None else f"{percent(row['gap'], 0)} %"}, rows)


def certificate_table(rows):
    return table(["claimed and verified", "scenes"],
                 [[label, str(row[key])] for row in rows for key, label in
                  (("optima", "the optimum"), ("infeasible", "no lane graph"), ("bounds", "a lower bound"), ("beyond", f"not within {row['steps']} steps"),
                   ("refused", "refused"))])


def beam_table(rows):
    def label(row):
        text = f"{row['beam']}, {row['drop']:.0f}"
        return f"**{text}**" if row["beam"] == BEAM else text
    return columns_table("beam, drop", label, {
        "best score, %": share("best_score"), "usable by score, %": share("first_usable"), "usable, judged, %": share("usable"),
        "any of 20 usable, %": share("any_usable"), "IoU, %": share("iou"), "median / p95 / longest ms": times("median_ms", "p95_ms", "worst_ms")}, rows)


def proven_table(rows):
    labels = {only(claims=claims, limit_ms=limit_ms): f"{label}, {limit}" for claims, label in CLAIMS.items()
              for limit_ms, limit in ((50.0, "50 ms"), (1000.0, "1 s"))}
    return table(["cones and costs, limit", "30 m, no false cones", "30 %", "50 %", "50 m, none", "30 %", "50 %"],
                 pivot(rows, labels, [only(range=distance, rate=rate) for distance in (30.0, 50.0) for rate in (0.0, 0.3, 0.5)],
                       lambda row: f"{percent(row['proven'])} ({percent(row['proven_without_dense'])})"))


def exactness_table(rows):
    labels = {"scenes with both": "{scenes} of {of}".format_map, "the candidate is the optimum, % of these": share("equal"),
              "success of the optimum, %": share("optimum"), "success of that candidate, %": share("candidate"),
              "success of what CLC's network chooses, %": share("choice")}
    return table(["false positives"] + [f"{100 * row['rate']:.0f} %" for row in rows], [[label] + list(map(text, rows)) for label, text in labels.items()])


def objective_table(rows):
    names = {"default": "(29)", "shape": "shape", "learned": "learned"}
    order = sorted(rows, key=lambda row: (("paper", "car").index(row["condition"]), list(names).index(row["costs"])))
    lanes = dict(zip(["optimum", *LANES], ("optimum", "beam", "CLC's best by it", "CLC", "`front`")))
    return columns_table("objective", lambda row: names[row["costs"]], {
        "condition": "`{condition}`", "scenes": "{scenes} of {asked}"} | {
        title: lambda row, name=name: pair(row[name]) for name, title in lanes.items()} | {
        "optimum less beam, usable": lambda row: f"{percent(row['less'])} ({percent(row['interval'][0])} to {percent(row['interval'][1])})"}, order)


def gap_table(rows):
    lines = []
    for (gap,), cells in grouped(rows, ("gap",)).items():
        of_lane = {row["lane"]: [str(row["scenes"]), pair(row.get("optimum")), pair(row.get("quality"))] for row in cells}
        lines.append(["forbidden by the rows" if gap == "forbidden" else gap] + of_lane["beam"] + of_lane["candidate"] + of_lane["beside"])
    return table(["gap", "beam: scenes", "its optimum", "its lane", "CLC's best: scenes", "its optimum", "its lane", "`front`: scenes", "its optimum", "its lane"],
                 lines)


TABLES = {"solvers": ("backends", solver_table), "formulations": ("formulations", formulation_table), "relaxations": ("relaxations", relaxation_table),
          "growth of path-pair": ("growth", growth_table), "growth by density": ("growth by density", lambda rows: class_table(rows, "density")),
          "growth by edges": ("growth by edges", lambda rows: class_table(rows, "edges")), "within a limit": ("anytime", anytime_table),
          "certificates": ("certificates", certificate_table), "width of the beam": ("beam", beam_table),
          "proven by path-pair": ("proven", proven_table),
          "exactness": ("exactness", exactness_table), "exactness by objective": ("objectives", objective_table),
          "exactness by gap": ("gaps", gap_table)}


def tables(stored):
    """The text of each table by its name."""
    return {name: make([row for row in stored["rows"] if row["table"] == part]) for name, (part, make) in TABLES.items()}
