"""Measures of solvers

Claim: Which solver is fastest overall, how steady is it, and what is gained by choosing a solver for each scene?
Protocol: a run is a scene in one order of its cones, and of the rows and columns of its program. Solved: proven \
within the limit, accepted by the checker, and refuted by no other backend. Geometric mean shifted by 1 ms, failures at the \
limit. PAR 1, PAR 2 and PAR 10: mean time, failures at 1, 2 and 10 times the limit. By all: over the runs that every backend \
solved. Variation: standard deviation over mean of a scene's times over its orders, median over scenes. Integrals: of the \
gap to the best lane graph known, over time. Memory: growth of the process; for a program from outside, all its \
memory. Pairs: Wilcoxon's signed-rank test on a scene's geometric mean times, corrected by Holm. Definitions and sources: \
docs/measures.md.
Source: this project.
Command: conelane study backends --sizes 12,20,30,60,all --permutations 5 --gap-limits 1,3,10,30,100 --scenes RESULTS/scenes.scenes.jsonl --out \
RESULTS/backends.jsonl
"""

import os

from .. import solves
from ..experiment import Missing
from ..figures import drawn, group
from ..load import require
from ..tables import Cell, Column, milliseconds, percent, table, text
from ..theme import legend, logarithmic, new_figure, series_style

_NUMBER = (int, float)
_DECADES, _STEPS = 3, 75  # the ratios of profiles: 1 to 1000


def _read(results, kind, keys):
    path = results.path(solves.FILE)
    rows = solves.measures(results, kind)
    for number, row in rows:
        for key, kinds in keys:
            require(path, number, row, key, kinds)
    return [row for _, row in rows]


def _group_name(row):
    return f"{solves.size_name(row['nearest'])} {row.get('condition', '')}".strip()


def _group(row):
    return Cell(_group_name(row), solves.size_order(row["nearest"]))


def _share(value):
    return percent(value) if value is not None else text("")


def _milliseconds(value):
    return milliseconds(value) if value is not None else text("")


def _summaries(summaries, blocks):
    peak = {(block["nearest"], block["backend"]): block.get("peak_bytes") for block in blocks}
    rows = []
    for row in summaries:
        memory = peak.get((row["nearest"], row["backend"]))
        spread = row.get("spread")
        rows.append([_group(row), text(row["backend"]), Cell(str(row["runs"]), row["runs"]),
                     percent(row["solved"] / row["runs"]), Cell(str(row["errors"]), row["errors"]),
                     milliseconds(row["geometric_ms"]), _milliseconds(row.get("par1_ms")), milliseconds(row["par2_ms"]), milliseconds(row["par10_ms"]),
                     Cell(str(row["common"]), row["common"]), _milliseconds(row.get("common_geometric_ms")),
                     _milliseconds(row.get("median_engine_ms")), _share(row.get("variability")),
                     Cell(f"{spread:.2f}", spread) if spread is not None else text(""),
                     _milliseconds(row.get("primal_integral_ms")), _milliseconds(row.get("dual_integral_ms")),
                     Cell(str(row["won"]), row["won"]),
                     Cell(f"{memory / 2**20:.1f}", memory) if memory is not None else text("")])
    columns = [Column("n"), Column("backend", "text"), Column("runs"), Column("solved %"), Column("errors"),
               Column("geometric mean ms"), Column("PAR 1 ms"), Column("PAR 2 ms"), Column("PAR 10 ms"), Column("solved by all"),
               Column("geometric mean ms, by all"), Column("own time, median ms"), Column("variation %"),
               Column("max / min"), Column("primal integral ms"), Column("dual integral ms"), Column("first"),
               Column("peak MiB")]
    reference = [block["reference_ms"] for block in blocks]
    mean = sum(reference) / len(reference) if reference else 0.0
    note = ""
    if len(reference) > 1 and mean > 0.0:
        deviation = (sum((one - mean) ** 2 for one in reference) / (len(reference) - 1)) ** 0.5
        note = (f"A reference problem between blocks took {mean:.3f} ms in the mean, coefficient of variation "
                f"{100.0 * deviation / mean:.1f} %: times that differ by less say nothing. ")
    versions = dict.fromkeys(f"{block['backend']}: {block['version'] or 'version unknown'}" for block in blocks)
    return table("solver-measures", "", columns, rows, note=note + "; ".join(versions) + ".")


def _pairs(pairs):
    rows = [[_group(row), text(row["first"]), text(row["second"]),
             Cell(f"{row['ratio']:.3g}", row["ratio"]), Cell(str(row["scenes"]), row["scenes"]),
             Cell(f"{row['p_value']:.2g}", row["p_value"]),
             Cell(f"{row['corrected_p_value']:.2g}", row["corrected_p_value"])] for row in pairs]
    return table("solver-pairs", "Pairs", [Column("n"), Column("first", "text"), Column("second", "text"),
                                           Column("time ratio"), Column("scenes that differ"), Column("p"),
                                           Column("p, Holm")], rows)


def _selections(selections):
    rows = []
    for row in selections:
        factor = row["single_par10_ms"] / max(row["virtual_par10_ms"], 1e-9)
        rows.append([_group(row), text(row["single_best"]),
                     milliseconds(row["single_par10_ms"]), milliseconds(row["virtual_par10_ms"]),
                     Cell(f"{factor:.2f}", factor)])
    return table("solver-selection", "Single best and virtual best solver",
                 [Column("n"), Column("single best", "text"), Column("PAR 10 ms"), Column("virtual best PAR 10 ms"),
                  Column("ratio")], rows)


def _profiles(summaries):
    figures = []
    for size in dict.fromkeys(row["nearest"] for row in summaries):
        of_size = [row for row in summaries if row["nearest"] == size and "condition" not in row]
        figure, axes = new_figure()
        for index, row in enumerate(of_size):
            ratios = [10.0 ** (_DECADES * k / _STEPS) for k in range(len(row["profile"]))]
            axes.step(ratios, [100.0 * share for share in row["profile"]], where="post", label=row["backend"],
                      **series_style(index) | {"marker": ""})
        axes.set(xscale="log", xlabel="time / fastest time on the same run", ylabel="runs solved [%]", ylim=(-2, 103))
        logarithmic(axes.xaxis)
        legend(axes)
        name = solves.size_name(size)
        figures.append(drawn(f"solver-profile-{name}", "Performance profile over all runs, permutations included.", figure,
                             f"n = {name}"))
    return figures


_GAPS = {"primal": "The faster a curve falls, the sooner a good lane graph is found. Solved again with each limit.",
         "dual": "The faster a curve falls, the sooner the bound is close to the optimum. Solved again with each limit."}


def _gaps(gaps):
    figures = []
    for size in dict.fromkeys(row["nearest"] for row in gaps):
        of_size = [row for row in gaps if row["nearest"] == size]
        name = solves.size_name(size)
        for side, says in _GAPS.items():
            figure, axes = new_figure()
            for index, backend in enumerate(dict.fromkeys(row["backend"] for row in of_size)):
                of_one = [row for row in of_size if row["backend"] == backend]
                axes.step([row["time_ms"] for row in of_one], [100.0 * row[f"mean_{side}_gap"] for row in of_one],
                          where="post", label=backend, **series_style(index) | {"marker": ""})
            axes.set(xscale="log", xlabel="time [ms]", ylabel=f"mean {side} gap [%]", ylim=(-2, 103))
            logarithmic(axes.xaxis)
            legend(axes)
            figures.append(drawn(f"solver-{side}-gap-{name}", says, figure, f"{side.capitalize()} gap over time, n = {name}"))
    return figures


def html(results, published):
    summaries = _read(results, "summary", [(key, _NUMBER) for key in (
        "nearest", "runs", "solved", "errors", "geometric_ms", "par2_ms", "par10_ms", "common", "won")] + [
            ("backend", (str,)), ("profile", (list,))])
    if not summaries:
        raise Missing(f"there is no {os.path.basename(solves.FILE)} with measures.")
    blocks = _read(results, "block", [("nearest", (int,)), ("backend", (str,)), ("version", (str,)),
                                      ("reference_ms", _NUMBER)])
    pairs = _read(results, "pair", [("nearest", (int,)), ("first", (str,)), ("second", (str,))] + [
        (key, _NUMBER) for key in ("ratio", "scenes", "p_value", "corrected_p_value")])
    selections = _read(results, "selection", [("nearest", (int,)), ("single_best", (str,)),
                                              ("single_par10_ms", _NUMBER), ("virtual_par10_ms", _NUMBER)])
    gaps = _read(results, "gap", [("nearest", (int,)), ("backend", (str,)), ("time_ms", _NUMBER),
                                  ("mean_primal_gap", _NUMBER), ("mean_dual_gap", _NUMBER)])
    parts = group(_profiles(summaries) + _gaps(gaps)) + _summaries(summaries, blocks)
    if pairs:
        parts += _pairs(pairs)
    return parts + _selections(selections)
