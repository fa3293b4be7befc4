"""CLC Table II: complete enumerations

Claim: Without false positives the search is complete in nearly half of the scenes.
Protocol: methods that enumerate, all ranges together. The best candidate's IoU is known where candidates were kept.
Source: CLC paper, VIII-E, Table II.
Published: 46.4 / 34.4 / 13.4 / 2.3 % complete at 0 / 10 / 30 / 50 % false positives.
Command: conelane compare --methods clc --candidates --out RESULTS/candidates
"""

import numpy as np

from ..clc_rows import UNKNOWN, of_paper, printed, rows_by_rate
from ..experiment import Missing
from ..tables import Column, percent, table


def _stored(results):
    return [sample for sample in results.beside["candidates"] or results.samples if sample.has("complete")]


def html(results, published):
    samples = _stored(results)
    if not samples:
        raise Missing("no method enumerates.")

    def of_ours(part):
        best = part.best_candidate_iou
        known = ~np.isnan(best)
        return [percent(np.mean(part.complete == 1.0)),
                percent(np.where(known, best, 0.0).mean()) if known.any() else UNKNOWN]

    rows, marks = rows_by_rate(results, published, samples, lambda row: [printed(row, "complete"), UNKNOWN], of_ours)
    columns = [Column("method", "text"), Column("false positives %"), Column("complete %"),
               Column("best candidate, mean IoU %")]
    return table("clc-table-2", "", columns, rows, published_rows=marks)


def verdict(results, published):
    """Complete at least as often as in the paper, without false positives."""
    needed = next(row["complete"] for row in published["clc"] if row["rate"] == 0.0)
    judged = []
    for sample in of_paper(_stored(results)):
        clean = sample.at(0.0)
        if len(clean):
            share = 100 * float(np.mean(clean.complete == 1.0))
            judged.append((sample.label, share >= needed, f"{share:.1f} %, the paper {needed:g} %"))
    return judged
