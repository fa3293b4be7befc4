"""The optimum against CLC's best candidate

Claim: How far from optimal is the graph search under the objective that RLD minimises, and does the optimum drive \
better?
Protocol: every candidate that CLC enumerates within its iteration limit gets its cost under RLD's objective (29); \
candidates that RLD's constraints forbid are counted separately. The cheapest is compared with the optimum that \
`path-pair` proves on the same cones. Gap: difference divided by the larger of 1 and the optimum's size. Equal: within 1e-6. Optimum and \
cheapest candidate pass the independent checker; a candidate below a proven optimum would have stopped the run.
Source: this project; neither paper compares them.
Command: conelane study optimality --scenes RESULTS/scenes.scenes.jsonl --out RESULTS/optimality.jsonl
"""

import os

import numpy as np

from .. import measures
from ..experiment import Missing
from ..figures import drawn, group, percent_label
from ..load import SUCCESSES, InputError, read_lines, require
from ..tables import Cell, Column, percent, table
from ..theme import MARKERS, legend, new_figure, percent_axis, series_style

FILE = "optimality.jsonl"
_LANES = ("optimum", "candidate", "choice")


def _lane(path, number, row, name):
    lane = require(path, number, row, name, (dict,))
    for key, kinds in (("category", (str,)), ("iou", (int, float))):
        require(path, number, lane, key, kinds)
    return lane


def read(results):
    """The stored scenes under RLD's objective (29); empty where there are none. Other objectives are left out."""
    path = results.path(FILE)
    if not os.path.exists(path):
        return []
    rows = []
    for number, row in read_lines(path):
        for key, kinds in (("scene", (str,)), ("track", (str,)), ("false_positive_rate", (int, float)),
                           ("method", (str,)), ("status", (str,)), ("candidates", (int,)),
                           ("feasible_candidates", (int,))):
            require(path, number, row, key, kinds)
        for name in _LANES:
            if name in row:
                _lane(path, number, row, name)
        if "gap" in row:
            require(path, number, row, "gap", (int, float))
            if "optimum" not in row or "candidate" not in row:
                raise InputError(f"{path}:{number}: gap: there are no two lanes that differ by it")
        if row.get("costs", "default") == "default":
            rows.append(row)
    return rows


def compared(rows):
    """Those with a proven optimum and a feasible candidate."""
    return [row for row in rows if "gap" in row]


def success(rows, name):
    return np.array([float(name in row and row[name]["category"] in SUCCESSES) for row in rows])


def overlap(rows, name):
    return np.array([row[name]["iou"] if name in row else 0.0 for row in rows])


def tracks_of(rows):
    return np.array([row["track"] for row in rows], dtype=object)


def _rates(rows):
    return sorted({row["false_positive_rate"] for row in rows})


def _table(rows, origin):
    lines = []
    for rate in _rates(rows):
        scenes = [row for row in rows if row["false_positive_rate"] == rate]
        both = compared(scenes)
        proven = [row for row in scenes if row["status"] == "optimal"]
        candidates = sum(row["candidates"] for row in scenes)
        line = [percent(rate), Cell(str(len(scenes)), len(scenes)), percent(len(proven) / len(scenes)),
                percent(sum(row["feasible_candidates"] for row in scenes) / candidates if candidates else None),
                percent(np.mean([row["feasible_candidates"] == 0 for row in proven]) if proven else None)]
        if not both:
            lines.append(line + [Cell("–")] * 8)
            continue
        gaps = np.array([row["gap"] for row in both])
        equal = np.array([float(row["equal"]) for row in both])
        line += [Cell(str(len(both)), len(both)),
                 percent(equal.mean(), interval=measures.mean_interval(equal, tracks_of(both))),
                 percent(float(np.median(gaps)), 2), percent(measures.quantile(gaps, 0.95), 2)]
        for value in (success, overlap):
            for name in ("optimum", "candidate"):
                line.append(percent(value(both, name).mean()))
        lines.append(line)
    columns = [Column("false positives %"), Column("scenes"), Column("proven %"), Column("candidates feasible %"),
               Column("proven, none feasible %"), Column("compared"), Column("equal %"), Column("median gap %"),
               Column("p95 gap %"), Column("success optimum %"), Column("success candidate %"),
               Column("IoU optimum %"), Column("IoU candidate %")]
    return table("optimality", "", columns, lines,
                 note="Compared: scenes with a proven optimum and a feasible candidate. Small: 95 % interval, tracks "
                 f"resampled.{origin}")


def _gaps(rows):
    figure, axes = new_figure()
    rates = _rates(rows)
    most = max(1.0, 100 * max(row["gap"] for row in compared(rows)))
    for index, rate in enumerate(rates):
        gaps = [100 * row["gap"] for row in compared(rows) if row["false_positive_rate"] == rate]
        if gaps:
            places, counts = np.unique(gaps, return_counts=True)
            axes.step([*places, most], [*(100 * np.cumsum(counts) / len(gaps)), 100], where="post",
                      label=f"{percent_label(rate)} % false positives", **series_style(index))
    axes.set_xscale("symlog", linthresh=0.1)
    axes.set_xlim(left=0)
    axes.set_xticks([tick for tick in (0, 0.1, 1, 10, 100, 1000) if tick <= max(most, 1)],
                    [f"{tick:g}" for tick in (0, 0.1, 1, 10, 100, 1000) if tick <= max(most, 1)])
    axes.minorticks_off()
    axes.set_xlabel("gap to the proven optimum [%]")
    axes.set_ylabel("scenes within it [%]")
    percent_axis(axes)
    legend(axes)
    return figure


def _driving(rows):
    figure, axes = new_figure()
    rates = _rates(rows)
    titles = {"optimum": "RLD's optimum", "candidate": "cheapest candidate", "choice": "CLC's own choice"}
    for index, name in enumerate(_LANES):
        shares = [success([row for row in rows if row["false_positive_rate"] == rate], name).mean() for rate in rates]
        axes.plot([100 * rate for rate in rates], [100 * share for share in shares], label=titles[name],
                  marker=MARKERS[index], **series_style(index))
    axes.set_xticks([100 * rate for rate in rates], [percent_label(rate) for rate in rates])
    axes.set_xlabel("false positives [% of all points]")
    axes.set_ylabel("success [%]")
    percent_axis(axes)
    legend(axes)
    return figure


def html(results, published):
    rows = read(results)
    if not compared(rows):
        raise Missing(f"there is no {FILE}." if not rows else "no scene has a proven optimum and a feasible candidate.")
    cones = {row.get("nearest") for row in rows}
    where = " and ".join("all visible cones" if n is None else f"the {n} nearest cones" for n in sorted(
        cones, key=lambda n: n or 0))
    figures = [drawn("optimality-gaps", f"A curve that starts high: the cheapest candidate is often the optimum. Candidates of {rows[0]['method']} on {where}.", _gaps(rows), "Gap"),
               drawn("optimality-success", "Equal curves: the optimum drives no better. The scenes with "
                     "a proven optimum and a feasible candidate, as in the table.", _driving(compared(rows)),
                     "Does the optimum drive better?")]
    return group(figures) + _table(rows, results.origin(rows[0]))
