"""What exact search gives, and what it costs."""

import numpy as np

from .. import measures
from ..charts import by_rate, chart, drawn, group, series
from ..experiment import Experiment
from ..load import SUCCESSES, Missing
from ..records import NUMBER, TEXT, WHOLE, YES_OR_NO
from ..summaries import median, percent_label, quantile
from ..tables import column, count, fixed, milliseconds, percent, table, text
from ..theme import percent_axis


class Compared:
    """Scenes of optimality.jsonl with a proven optimum and a feasible candidate."""

    def __init__(self, rows):
        self.rows = [row for row in rows if "gap" in row]
        self.track = np.array([row["track"] for row in self.rows], dtype=object)
        self.equal = np.array([float(row["equal"]) for row in self.rows])
        self.gaps = np.array([row["gap"] for row in self.rows])

    def __len__(self):
        return len(self.rows)

    def success(self, name):
        return np.array([float(name in row and row[name]["category"] in SUCCESSES) for row in self.rows])

    def overlap(self, name):
        return np.array([row[name]["iou"] if name in row else 0.0 for row in self.rows])


_LANES = {"optimum": "RLD's optimum", "candidate": "cheapest candidate", "choice": "CLC's own choice"}


def read_optimality(results):
    """The stored scenes under RLD's objective (29); other objectives are left out."""
    lane = {"category": TEXT, "iou": NUMBER}
    kinds = {"scene": TEXT, "track": TEXT, "false_positive_rate": NUMBER, "method": TEXT, "status": TEXT, "candidates": WHOLE,
             "feasible_candidates": WHOLE}

    def of_row(row):
        return kinds | ({"gap": NUMBER, "equal": YES_OR_NO, "optimum": (dict,), "candidate": (dict,)} if "gap" in row else {}) | {
            f"{name}?": lane for name in _LANES}
    return results.stored("optimality.jsonl", of_row, lambda row: row.get("costs", "default") == "default")


def _of_rates(rows):
    """(rate, rows, those compared) by rate."""
    for rate in sorted({row["false_positive_rate"] for row in rows}):
        of_rate = [row for row in rows if row["false_positive_rate"] == rate]
        yield rate, of_rate, Compared(of_rate)


def _optimality_gaps(rows):
    most = max(1.0, 100 * max(Compared(rows).gaps))
    curves = []
    for rate, _, both in _of_rates(rows):
        places, counts = np.unique(100 * both.gaps, return_counts=True)
        curves.append((f"{percent_label(rate)} % false positives",
                       [*zip(places, 100 * np.cumsum(counts) / len(both)), (most, 100)] if len(both) else []))
    figure, axes = chart(series(curves, "steps"), "gap to the proven optimum [%]", "scenes within it [%]", scale=percent_axis)
    axes.set_xscale("symlog", linthresh=0.1)
    axes.set_xlim(left=0)
    ticks = [tick for tick in (0, 0.1, 1, 10, 100, 1000) if tick <= most]
    axes.set_xticks(ticks, [f"{tick:g}" for tick in ticks])
    axes.minorticks_off()
    return figure, axes


@Experiment
def optimality(results, published):
    """The optimum against CLC's best candidate
    Claim: How far from optimal is the graph search under the objective that RLD minimises, and does the optimum drive
    better?
    Protocol: every candidate that CLC enumerates within its iteration limit gets its cost under RLD's objective (29);
    candidates that RLD's constraints forbid are counted separately. The cheapest is compared with the optimum that
    `path-pair` proves on the same cones. Gap: difference divided by the larger of 1 and the optimum's size. Equal: within 1e-6.
    Optimum and cheapest candidate pass the independent checker; a candidate below a proven optimum would have stopped the run.
    Source: this project; neither paper compares them.
    Command: conelane study optimality --scenes RESULTS/scenes.scenes.jsonl --out RESULTS/optimality.jsonl"""
    rows = read_optimality(results)
    if not len(Compared(rows)):
        raise Missing("no scene has a proven optimum and a feasible candidate.")
    where = " and ".join("all visible cones" if n is None else f"the {n} nearest cones" for n in sorted(
        {row.get("nearest") for row in rows}, key=lambda n: n or 0))
    compared = [both for _, _, both in _of_rates(Compared(rows).rows)]
    rates = [rate for rate, _, _ in _of_rates(Compared(rows).rows)]
    driving = by_rate(series([(words, [(100 * rate, 100 * both.success(name).mean()) for rate, both in zip(rates, compared)])
                              for name, words in _LANES.items()]), "success [%]", rates, scale=percent_axis)
    figures = [drawn("optimality-gaps", "A curve that starts high: the cheapest candidate is often the optimum. Candidates of "
                     f"{rows[0]['method']} on {where}.", _optimality_gaps(rows), "Gap"),
               drawn("optimality-success", "Equal curves: the optimum drives no better. The scenes with "
                     "a proven optimum and a feasible candidate, as in the table.", driving, "Does the optimum drive better?")]
    lines = [{"rate": rate, "rows": of_rate, "both": both if len(both) else None,
              "proven": [row for row in of_rate if row["status"] == "optimal"]} for rate, of_rate, both in _of_rates(rows)]

    def of_both(title, show, value, **options):
        return column(title, show, lambda line: value(line["both"]) if line["both"] else None, **options)

    def feasible(line):
        candidates = sum(row["candidates"] for row in line["rows"])
        return sum(row["feasible_candidates"] for row in line["rows"]) / candidates if candidates else None
    return group(figures) + table("optimality", [
        column("false positives %", percent, lambda line: line["rate"]), column("scenes", count, lambda line: len(line["rows"])),
        column("proven %", percent, lambda line: len(line["proven"]) / len(line["rows"])), column("candidates feasible %", percent, feasible),
        column("proven, none feasible %", percent,
               lambda line: np.mean([row["feasible_candidates"] == 0 for row in line["proven"]]) if line["proven"] else None),
        of_both("compared", count, len),
        of_both("equal %", percent, lambda both: both.equal.mean(),
                interval=lambda line: line["both"] and measures.mean_interval(line["both"].equal, line["both"].track)),
        of_both("median gap %", percent, lambda both: median(both.gaps), digits=2),
        of_both("p95 gap %", percent, lambda both: quantile(both.gaps, 0.95), digits=2),
        *(of_both(f"success {name} %", percent, lambda both, name=name: both.success(name).mean()) for name in ("optimum", "candidate")),
        *(of_both(f"IoU {name} %", percent, lambda both, name=name: both.overlap(name).mean()) for name in ("optimum", "candidate"))], lines,
        note="Compared: scenes with a proven optimum and a feasible candidate. Small: 95 % interval, tracks "
             f"resampled.{results.origin(rows[0])}")


def _grouped(rows, key):
    """{key: rows}, in order of the keys."""
    found = {}
    for row in rows:
        found.setdefault(key(row), []).append(row)
    return dict(sorted(found.items()))


def _curves(groups, *curves, **options):
    """Curves of (label, value of the rows of a group) over the keys of the groups."""
    return chart(series([(label, [(place, value(rows)) for place, rows in groups.items()]) for label, value in curves]), **options)


def _of_values(key, statistic):
    return lambda rows: statistic([row[key] for row in rows])


@Experiment
def growth(results, published):
    """How the cost of the exact search grows
    Claim: Time grows mildly with the cones and steeply with their density.
    Protocol: `path-pair` on the nearest cones of each scene at each size that it exceeds, and on all of them; processor
    time of its thread, from the scene in memory to the answer in memory. A search that reached its limit counts with the
    time that it took. Density: mean number of other cones within 5.5 m of a cone.
    Source: this project.
    Command: conelane study growth --scenes RESULTS/scenes.scenes.jsonl --limit 300 --out RESULTS/growth.jsonl"""
    rows = results.stored("growth.jsonl", {"cones": WHOLE, "all_visible": YES_OR_NO, "density": NUMBER, "edges": WHOLE, "nodes": WHOLE,
                                           "cpu_ms": NUMBER})
    figures = []
    for name, title, xlabel, whole, key, caption in (
            ("growth-size", "By the number of cones", "nearest cones", False, lambda row: row["cones"],
             "A straight line on this scale: each cone more multiplies the time. Scenes that have more cones."),
            ("growth-density", "By density", "others within 5.5 m of a cone", True, lambda row: int(row["density"]) + 0.5,
             "Scenes at the right end, with dense cones, take most time. All visible cones.")):
        groups = _grouped((row for row in rows if row["all_visible"] == whole), key)
        if groups:
            figure = _curves(groups, ("median, ms", _of_values("cpu_ms", median)),
                             ("p95, ms", _of_values("cpu_ms", lambda values: quantile(values, 0.95))), ("nodes, mean", _of_values("nodes", np.mean)),
                             xlabel=xlabel, ylabel="", log="y")
            figures.append(drawn(name, f"{caption} {results.origin(rows[0]).strip()}".strip(), figure, title))
    return group(figures)


@Experiment
def formulations(results, published):
    """Formulations
    Claim: Both formulations have the same optimum; the tight one has the stronger relaxation and is solved faster.
    Protocol: the n nearest cones of each scene with at least n cones; the tight formulation by `cbc`, the printed one by
    `cbc-main`, each the faster of the two on it; one thread, building included. LP gap: (optimum - relaxation) divided
    by the larger of 1 and the optimum's size. A difference in optima above 1e-6 would have stopped the run.
    Source: this project; the printed rows are those of the RLD paper, III.
    Command: conelane study formulations --scenes RESULTS/scenes.scenes.jsonl --limit 40 --out RESULTS/formulations.jsonl"""
    rows = results.stored("formulations.jsonl", dict.fromkeys(("formulation", "solver"), TEXT) | dict.fromkeys(
        ("cones", "scenes", "optimal", "infeasible"), WHOLE) | dict.fromkeys(
        ("columns", "rows", "mean_nodes", "median_build_ms", "median_ms", "p95_ms"), NUMBER))
    return table("formulations", [
        column("n", count, "cones"), column("formulation", text, "formulation"), column("solver", text, "solver"),
        column("scenes", count, "scenes"), column("proven %", percent, lambda row: (row["optimal"] + row["infeasible"]) / row["scenes"]),
        column("columns", fixed, "columns", digits=0), column("rows", fixed, "rows", digits=0), column("LP gap, median %", percent, "median_gap"),
        column("LP gap, mean %", percent, "mean_gap"), column("nodes", fixed, "mean_nodes"), column("build ms", milliseconds, "median_build_ms"),
        column("median ms", milliseconds, "median_ms"), column("p95 ms", milliseconds, "p95_ms")], rows, note=results.origin(rows[0]).strip())


@Experiment
def relaxations(results, published):
    """Relaxations
    Claim: Does relaxing the binary constraints decrease latency, and how much accuracy does it cost?
    Protocol: every solver that proves nothing, and `path-pair`, which gives the optimum, on the n nearest cones; one
    thread, the problem's making included. Gap: (objective - least cost) divided by the larger of 1 and the least cost's
    size, over the answered scenes. Accurate: the RLD paper's four checks, a solve without an answer counts as inaccurate.
    Source: this project; the question is the RLD paper's own, V.
    Command: conelane study relaxations --scenes RESULTS/scenes.scenes.jsonl --limit 40 --out RESULTS/relaxations.jsonl"""
    rows = results.stored("relaxations.jsonl", {"solver": TEXT} | dict.fromkeys(("cones", "scenes", "feasible", "answered", "optimal"), WHOLE) |
                          dict.fromkeys(("accurate", "median_ms", "p95_ms", "worst_ms"), NUMBER))
    return table("relaxations", [
        column("n", count, "cones"), column("solver", text, "solver"),
        *(column(key, count, key) for key in ("scenes", "feasible", "answered", "optimal")),
        column("mean gap %", percent, "mean_gap", digits=2), column("worst gap %", percent, "worst_gap"), column("accurate %", percent, "accurate"),
        column("median ms", milliseconds, "median_ms"), column("p95 ms", milliseconds, "p95_ms"), column("max ms", milliseconds, "worst_ms")],
        rows, note=results.origin(rows[0]).strip())
