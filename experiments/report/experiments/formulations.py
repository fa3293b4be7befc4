"""Formulations

Claim: Both formulations have the same optimum; the tight one has the stronger relaxation and is solved faster.
Protocol: the n nearest cones of each scene with at least n cones; the tight formulation by `cbc`, the printed one by \
`cbc-main`, each the faster of the two on it; one thread, building included. LP gap: (optimum - relaxation) divided \
by the larger of 1 and the optimum's size. A difference in optima above 1e-6 would have stopped the run.
Source: this project; the printed rows are those of the RLD paper, III.
Command: conelane study formulations --scenes RESULTS/scenes.scenes.jsonl --limit 40 --out RESULTS/formulations.jsonl
"""

import os

from ..experiment import Missing
from ..load import read_lines, require
from ..tables import Cell, Column, milliseconds, percent, table, text

FILE = "formulations.jsonl"


def html(results, published):
    path = results.path(FILE)
    if not os.path.exists(path):
        raise Missing(f"there is no {FILE}.")
    rows, origin = [], ""
    for number, row in read_lines(path):
        for key, kinds in (("cones", (int,)), ("formulation", (str,)), ("solver", (str,)), ("scenes", (int,)),
                           ("optimal", (int,)), ("infeasible", (int,)), ("columns", (int, float)),
                           ("rows", (int, float)), ("mean_nodes", (int, float)), ("median_build_ms", (int, float)),
                           ("median_ms", (int, float)), ("p95_ms", (int, float))):
            require(path, number, row, key, kinds)
        origin = results.origin(row)
        counts = [Cell(f"{row[key]:.0f}", row[key]) for key in ("columns", "rows")]
        rows.append([Cell(str(row["cones"]), row["cones"]), text(row["formulation"]), text(row["solver"]),
                     Cell(str(row["scenes"]), row["scenes"]),
                     percent((row["optimal"] + row["infeasible"]) / row["scenes"])] + counts +
                    [percent(row.get("median_gap")), percent(row.get("mean_gap")),
                     Cell(f"{row['mean_nodes']:.1f}", row["mean_nodes"]), milliseconds(row["median_build_ms"]),
                     milliseconds(row["median_ms"]), milliseconds(row["p95_ms"])])
    columns = [Column("n"), Column("formulation", "text"), Column("solver", "text"), Column("scenes"),
               Column("proven %"), Column("columns"), Column("rows"), Column("LP gap, median %"),
               Column("LP gap, mean %"), Column("nodes"), Column("build ms"), Column("median ms"), Column("p95 ms")]
    return table("formulations", "", columns, rows, note=origin.strip())
