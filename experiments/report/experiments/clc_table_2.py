"""CLC Table II: enumerations that came to their end

Claim: The search sees the whole space in nearly half of the scenes without false positives, and finds a good lane in \
the others too.
Protocol: methods that enumerate, all ranges together. The best candidate's IoU is known where candidates were kept.
Source: CLC paper, VIII-E, Table II.
Published: 46.4 / 34.4 / 13.4 / 2.3 % complete at 0 / 10 / 30 / 50 % false positives.
Command: conelane compare --methods clc --candidates --out RESULTS
"""

import numpy as np

from ..clc_rows import UNKNOWN, printed, rows_by_rate
from ..experiment import Missing
from ..tables import Column, percent, table


def html(results, published):
    samples = [sample for sample in results.samples if sample.has("complete")]
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
