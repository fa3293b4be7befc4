"""Confidence and colour

Claim: How much more accurate is RLD with detection confidences, or with cone colours of which some are wrong?
Protocol: scenes and folds of a tuning whose parameters were fitted to geometry alone; the same scenes with simulated \
confidences or colours. Each fold is measured on its held-out tracks; the weight of the additional data (w_b with \
confidences, w_color with colours) is chosen on the other tracks. Accurate: the RLD paper's four checks \
on the cone set; success: no lane that leaves the track within 20 m.
Source: this project; the question is the RLD paper's own, V.
Command: conelane study confidence-and-colour --record detectors/parameters/context.record.json --tracks TRACK... \
--out RESULTS/confidence-and-colour.jsonl
"""

import os

from ..experiment import Missing
from ..load import read_lines, require
from ..tables import Cell, Column, percent, table, text

FILE = "confidence-and-colour.jsonl"


def html(results, published):
    path = results.path(FILE)
    if not os.path.exists(path):
        raise Missing(f"there is no {FILE}.")
    rows, origin = [], ""
    for number, row in read_lines(path):
        for key, kinds in (("known", (str,)), ("false_positive_rate", (int, float)), ("scenes", (int,)),
                           ("accurate", (int, float)), ("success", (int, float))):
            require(path, number, row, key, kinds)
        weights = require(path, number, row, "weights", (list,)) if "weights" in row else []
        origin = results.origin(row)
        rows.append([text(row["known"]), percent(row["false_positive_rate"]), Cell(str(row["scenes"]), row["scenes"]),
                     percent(row["accurate"]), percent(row["success"]),
                     text(", ".join(f"{weight:g}" for weight in weights) or "–")])
    columns = [Column("known", "text"), Column("false positives %"), Column("scenes"), Column("accurate %"),
               Column("success %"), Column("weight by fold", "text")]
    return table("confidence-and-colour", "", columns, rows, note=origin.strip())
