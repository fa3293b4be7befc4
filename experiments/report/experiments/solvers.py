"""What `conelane study backends` measured of solvers."""

from collections import Counter

import numpy as np

from .. import measures
from ..charts import THIN, Curve, chart, drawn, group, series
from ..experiment import Experiment
from ..load import Missing, Sample
from ..records import NUMBER, TEXT, WHOLE
from ..summaries import quantile
from ..tables import Cell, Column, column, count, fixed, milliseconds, percent, short, table, text
from ..theme import MARKERS, SURFACE, series_style
from .speed import ratio

FILE = "backends.jsonl"
_WARM, _ALL_ROWS = " warm", " whole"
_SOLVE = {"scene": TEXT, "track": TEXT, "nearest": WHOLE, "backend": TEXT, "status": TEXT, "nodes": WHOLE, "latency_ms": NUMBER}


def _solves(nearest, backend, rows):
    """The solves of one backend at one cone-set size."""
    columns = {key: np.array([row[key] for row in rows], dtype=object) for key in ("scene", "track", "status")}
    columns |= {key: np.array([row.get(of, np.nan) for row in rows], dtype=float)
                for key, of in (("objective", "objective"), ("nodes", "nodes"), ("latency", "latency_ms"))}
    # Decided: optimum or infeasibility proven.
    return Sample(backend, nearest, columns | {"is_decided": np.isin(columns["status"], ("optimal", "infeasible"))})


def _read(results):
    """By size and backend in the order of the file, and where they come from, as a sentence."""
    # Other rows are measures, or the same scene in another order.
    stored = results.stored(FILE, lambda row: _SOLVE | ({"objective": NUMBER} if row.get("status") == "optimal" else {}),
                            lambda row: "row" not in row and not row.get("permutation", 0))
    rows = {}
    for row in stored:
        rows.setdefault((row["nearest"], row["backend"]), []).append(row)
    return [_solves(*key, of_backend) for key, of_backend in rows.items()], results.origin(stored[0])


def _size_name(nearest):
    """`nearest` of a row: 0 stands for all visible cones."""
    return str(nearest) if nearest else "all"


def _size(row, *more):
    """The first cell of a row; all visible cones are the last size."""
    return Cell(" ".join((_size_name(row["nearest"]), *more)).strip(), row["nearest"] or 10**6)


def _refuted(summaries):
    """How many claims of each backend another one refutes, in all orders."""
    counts = Counter()
    for row in summaries:
        counts[row["backend"]] += row.get("refuted", 0) if "condition" not in row else 0
    return counts


def times_figure(results):
    """Median and p95 of the time to a proven optimum by number of cones, for each engine, with rows on demand or all, whichever proves more and is
    faster at that size; and the time of CLC on the same cone sets. A curve ends where fewer scenes are proven."""
    solves = [one for one in _read(results)[0] if not one.method.endswith(_WARM)]
    sizes = sorted({one.nearest for one in solves}, key=lambda nearest: nearest or np.inf)
    of_engine = {}
    for one in solves:
        of_size = of_engine.setdefault(one.method.removesuffix(_ALL_ROWS), {})
        times = np.where(one.is_decided, one.latency, np.inf)
        of_size[one.nearest] = min(of_size.get(one.nearest, times), times, key=lambda times: (np.mean(np.isinf(times)), quantile(times, 0.5)))
    scenes = {nearest: np.concatenate([one.scene for one in solves if one.nearest == nearest]) for nearest in sizes}
    for sample in results.beside["sweep"]:
        common = np.isin(sample.scene, scenes.get(sample.nearest or 0, []))
        if sample.method == "clc" and np.any(common):
            of_engine.setdefault("clc, a graph search without proof", {})[sample.nearest or 0] = sample.latency[common]
    curves, refuted = [], _refuted(_of_kind(results, "summary"))
    for index, (engine, times) in enumerate(of_engine.items()):
        marker = {"marker": MARKERS[index % len(MARKERS)]} | ({"markerfacecolor": SURFACE} if index >= len(MARKERS) else {})  # then hollow
        refuted_claims = refuted[engine] + refuted[engine + _ALL_ROWS]
        name = f"{engine}, claims refuted: {refuted_claims}" if refuted_claims else engine
        for share, label, style in ((0.5, name, {}), (0.95, "", THIN)):
            points = [(place, quantile(times[nearest], share)) for place, nearest in enumerate(sizes) if nearest in times]
            if any(np.isfinite(time) for _, time in points):  # a gap where it is not known
                curves.append(Curve(label, np.where(np.isfinite(points), points, np.nan), series_style(index) | marker | style))
    figure, axes = chart(curves, "nearest cones in the set", "time [ms], thin: p95", height=2.9 + 0.19 * len(of_engine), log="y")
    axes.set_xticks(range(len(sizes)), [_size_name(nearest) for nearest in sizes])
    return figure, axes


def first_figure(results):
    """What the page begins with, where there are solves."""
    try:
        return drawn("engine-times", "Only a curve that goes on to the right proves nearly all scenes. Strong curves: the median, failures above all "
                     "times. Thin curves: p95.", times_figure(results), "Time to a proven optimum by number of cones")
    except Missing:
        return ""


@Experiment
def warm_start(results, published):
    """Warm start along a lap
    Claim: What does the last scene's lane graph save an exact solver?
    Protocol: each backend twice on the same scenes in travel order, without and with the start. Ratio: geometric mean of
    the time with it divided by the time without, scene by scene; below 1, the start saves time. False positives are drawn at
    every pose.
    Source: this project; the RLD paper builds its model once and updates it.
    Command: conelane study backends --warm-start --scenes RESULTS/scenes.scenes.jsonl --out RESULTS/backends.jsonl"""
    try:
        solves, origin = _read(results)
    except Missing:
        solves, origin = [], ""
    rows = []
    for warm in (one for one in solves if one.method.endswith(_WARM)):
        start = next((one for one in solves if (one.nearest, one.method + _WARM) == (warm.nearest, warm.method)), None)
        found = measures.latency_ratio(warm, start) if start else None
        if found:
            rows.append({"warm": warm, "cold": start, "ratio": found})
    if not rows:
        raise Missing("no backend was run with and without a start.")
    return table("warm-start", [
        column("n", count, lambda row: row["warm"].nearest), column("backend", text, lambda row: row["cold"].method),
        ratio("time ratio", lambda row: row["ratio"]), column("nodes without", fixed, lambda row: row["cold"].nodes.mean()),
        column("nodes with", fixed, lambda row: row["warm"].nodes.mean()), column("scenes", count, lambda row: row["ratio"][2])],
        rows, note=f"Small: 95 % interval, tracks resampled.{origin}")


_KINDS = {"summary": {"backend": TEXT, "profile": (list,)} | dict.fromkeys(
              ("nearest", "runs", "solved", "errors", "geometric_ms", "par10_ms", "won"), NUMBER),
          "block": {"nearest": WHOLE, "backend": TEXT, "version": TEXT, "reference_ms": NUMBER},
          "pair": {"nearest": WHOLE, "first": TEXT, "second": TEXT} | dict.fromkeys(("ratio", "p_value", "corrected_p_value"), NUMBER),
          "selection": {"nearest": WHOLE, "single_best": TEXT, "single_par10_ms": NUMBER, "virtual_par10_ms": NUMBER},
          "gap": {"nearest": WHOLE, "backend": TEXT, "time_ms": NUMBER, "mean_primal_gap": NUMBER, "mean_dual_gap": NUMBER}}


def _of_kind(results, kind):
    """The rows of one kind that the study worked out."""
    try:
        return results.stored(FILE, _KINDS[kind], lambda row: row.get("row") == kind)
    except Missing:
        return []


_GROUP = Column("n", lambda row: _size(row, row.get("condition", "")))


def _steps(curves, xlabel, ylabel):
    return chart(series(curves, "steps"), xlabel, ylabel, log="x", ylim=(-2, 103))


def _profiles(summaries):
    for size in dict.fromkeys(row["nearest"] for row in summaries):
        curves = [(row["backend"], [(10.0 ** (k / 25), 100.0 * share) for k, share in enumerate(row["profile"])])  # ratios from 1 to 1000
                  for row in summaries if row["nearest"] == size and "condition" not in row]
        yield drawn(f"solver-profile-{_size_name(size)}", "Performance profile over all runs, permutations included.",
                    _steps(curves, "time / fastest time on the same run", "runs solved [%]"), f"n = {_size_name(size)}")


_GAPS = {"primal": "The faster a curve falls, the sooner a good lane graph is found. Solved again with each limit.",
         "dual": "The faster a curve falls, the sooner the bound is close to the optimum. Solved again with each limit."}


def _gaps(gaps):
    for size in dict.fromkeys(row["nearest"] for row in gaps):
        of_size = [row for row in gaps if row["nearest"] == size]
        for side, says in _GAPS.items():
            curves = [(backend, [(row["time_ms"], 100.0 * row[f"mean_{side}_gap"]) for row in of_size if row["backend"] == backend])
                      for backend in dict.fromkeys(row["backend"] for row in of_size)]
            yield drawn(f"solver-{side}-gap-{_size_name(size)}", says, _steps(curves, "time [ms]", f"mean {side} gap [%]"),
                        f"{side.capitalize()} gap over time, n = {_size_name(size)}")


def _spread_of_reference(blocks):
    reference = [block["reference_ms"] for block in blocks]
    if len(reference) < 2 or not np.mean(reference) > 0.0:
        return ""
    mean = np.mean(reference)
    return (f"A reference problem between blocks took {mean:.3f} ms in the mean, coefficient of variation "
            f"{100.0 * np.std(reference, ddof=1) / mean:.1f} %: times that differ by less say nothing. ")


@Experiment
def solver_measures(results, published):
    """Measures of solvers
    Claim: All exact solvers have the same optimum. Which is fastest, how steady is it, and what is gained by choosing a solver for each scene?
    Protocol: a run is a scene in one order of its cones, and of the rows and columns of its program, one thread, pinned; the time is from the
    scene in memory to the lane graph in memory, the program's building included. Solved: proven within the limit, accepted by the checker, and
    refuted by no other backend. Errors: of all orders, with refuted claims. Geometric mean shifted by 1 ms, failures at the limit. PAR 10: mean
    time, failures at 10 times the limit. Small: 95 % intervals, courses resampled. Adds: PAR 10 of the virtual best without this solver, less that
    with it. Variation: standard deviation over mean of a scene's times over its orders, median over scenes. Integrals: of the gap to the best lane
    graph known, over time. Memory: growth of the process; for a program from outside, all its memory. Pairs: each solver and the reference,
    Wilcoxon's signed-rank test on the means of courses, corrected by Holm. Definitions and sources: docs/measures.md.
    Source: this project; the RLD paper runs Mosek on the printed formulation.
    Published: mean 71.79 ms, 95 % within 155.88 ms at n = 12, on another machine.
    Command: conelane study backends --sizes 12,20,30,60,all --permutations 5 --gap-limits 1,3,10,30,100 --scenes RESULTS/scenes.scenes.jsonl --out
    RESULTS/backends.jsonl"""
    origin = _read(results)[1]
    summaries, blocks, pairs, selections, gaps = (_of_kind(results, kind) for kind in _KINDS)
    if not summaries:
        raise Missing(f"there is no {FILE} with measures.")
    peak = {(block["nearest"], block["backend"]): block["peak_bytes"] / 2**20 for block in blocks if "peak_bytes" in block}
    versions = dict.fromkeys(f"{block['backend']}: {block['version'] or 'version unknown'}" for block in blocks)
    parts = group([*_profiles(summaries), *_gaps(gaps)]) + table(
        "solver-measures", [
            _GROUP, column("backend", text, "backend"), column("scenes", count, "scenes"), column("runs", count, "runs"),
            column("solved %", percent, lambda row: row["solved"] / row["runs"]), column("errors", count, "errors"),
            column("refuted", count, "refuted"), column("median ms", milliseconds, "median_ms"),
            column("geometric mean ms", milliseconds, "geometric_ms", interval=lambda row: row.get("geometric_ms_interval")),
            column("PAR 10 ms", milliseconds, "par10_ms", interval=lambda row: row.get("par10_ms_interval")),
            column("own time, median ms", milliseconds, "median_engine_ms"), column("variation %", percent, "variability"),
            column("max / min", fixed, "spread", digits=2), column("primal integral ms", milliseconds, "primal_integral_ms"),
            column("dual integral ms", milliseconds, "dual_integral_ms"), column("first", count, "won"),
            column("adds to the virtual best, ms", milliseconds, "contribution_ms"),
            column("peak MiB", fixed, lambda row: peak.get((row["nearest"], row["backend"])))], summaries,
        note=f"Claims refuted by another backend: {_refuted(summaries).total()}. {_spread_of_reference(blocks)}{'; '.join(versions)}.{origin}")
    if pairs:
        parts += table("solver-pairs", [
            _GROUP, column("first", text, "first"), column("second", text, "second"), column("time ratio", short, "ratio", interval=lambda row: row.get("ratio_interval")),
            column("courses that differ", count, "courses"), column("p", short, "p_value", digits=2),
            column("p, Holm", short, "corrected_p_value", digits=2)], pairs, caption="Pairs")
    return parts + table("solver-selection", [
        _GROUP, column("single best", text, "single_best"), column("PAR 10 ms", milliseconds, "single_par10_ms"),
        column("virtual best PAR 10 ms", milliseconds, "virtual_par10_ms"),
        column("ratio", fixed, lambda row: row["single_par10_ms"] / max(row["virtual_par10_ms"], 1e-9), digits=2)],
        selections, caption="Single best and virtual best solver")
