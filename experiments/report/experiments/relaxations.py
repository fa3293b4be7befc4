"""Relaxations

Claim: Does relaxing the binary constraints decrease latency, and how much accuracy does it cost?
Protocol: every solver that proves nothing, and `path-pair`, which gives the optimum, on the n nearest cones; one \
thread, the problem's making included. Gap: (objective - least cost) divided by the larger of 1 and the least cost's \
size, over the answered scenes. Accurate: the RLD paper's four checks, a solve without an answer counts as inaccurate.
Source: this project; the question is the RLD paper's own, V.
Command: conelane study relaxations --scenes RESULTS/scenes.scenes.jsonl --limit 40 --out RESULTS/relaxations.jsonl
"""

import os

from ..experiment import Missing
from ..load import read_lines, require
from ..tables import Cell, Column, milliseconds, percent, table, text

FILE = "relaxations.jsonl"


def html(results, published):
    path = results.path(FILE)
    if not os.path.exists(path):
        raise Missing(f"there is no {FILE}.")
    rows, origin = [], ""
    for number, row in read_lines(path):
        for key, kinds in (("cones", (int,)), ("solver", (str,)), ("scenes", (int,)), ("feasible", (int,)),
                           ("answered", (int,)), ("optimal", (int,)), ("accurate", (int, float)),
                           ("median_ms", (int, float)), ("p95_ms", (int, float)), ("worst_ms", (int, float))):
            require(path, number, row, key, kinds)
        origin = results.origin(row)
        rows.append([Cell(str(row["cones"]), row["cones"]), text(row["solver"])] +
                    [Cell(str(row[key]), row[key]) for key in ("scenes", "feasible", "answered", "optimal")] +
                    [percent(row.get("mean_gap"), 2), percent(row.get("worst_gap")), percent(row["accurate"])] +
                    [milliseconds(row[key]) for key in ("median_ms", "p95_ms", "worst_ms")])
    columns = [Column("n"), Column("solver", "text"), Column("scenes"), Column("feasible"), Column("answered"),
               Column("optimal"), Column("mean gap %"), Column("worst gap %"), Column("accurate %"),
               Column("median ms"), Column("p95 ms"), Column("max ms")]
    return table("relaxations", "", columns, rows, note=origin.strip())
