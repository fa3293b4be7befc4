"""CLC Table I: outcomes of the scenes

Claim: Up to 30 % false positives, at least 99 % of lanes are right for 20 m.
Protocol: every method on what it sees, all ranges together, as in the paper. The categories are the paper's; \
`none` is separate here.
Source: CLC paper, VIII-D, Table I: 1964 poses over 9 recorded tracks, 30 m and 50 m.
Published: success 99.4 / 99.2 / 99.3 / 95.0 % and mean IoU 96.9 / 96.0 / 93.2 / 79.5 % at 0 / 10 / 30 / 50 % false \
positives. The text of VIII-D says 2.6 % critical failures at 50 %, the table 5.0 %; the table is used here.
Command: conelane compare --full --tracks fsd:DIR --out RESULTS
"""

import numpy as np

from ..clc_rows import MOST_RATE, UNKNOWN, of_paper, printed, rows_by_rate
from ..figures import percent_label
from ..load import CATEGORIES
from ..rows import CATEGORY_NOTE
from ..tables import Column, percent, table


def html(results, published):
    keys = CATEGORIES[:-1]
    titles = ("ground truth %", "near %", "too short %", "diverging ≥ 20 m %", "diverging < 20 m %")
    columns = ([Column("method", "text"), Column("false positives %")] + [Column(title) for title in titles] +
               [Column("none %"), Column("success %"), Column("mean IoU %")])

    def of_row(row):
        return [printed(row, key) for key in keys] + [UNKNOWN, printed(row, "success"), printed(row, "mean_iou")]

    def of_ours(part):
        return ([percent(np.mean(part.category == key)) for key in CATEGORIES] +
                [percent(part.success.mean()), percent(part.mean_iou)])

    rows, marks = rows_by_rate(results, published, results.samples, of_row, of_ours)
    return table("clc-table-1", "", columns, rows, published_rows=marks, note=CATEGORY_NOTE)


def verdict(results, published):
    """Success at every rate up to 30 %."""
    judged = []
    for sample in of_paper(results.samples):
        shares = {rate: float(sample.at(rate).success.mean()) for rate in sorted(set(sample.rate)) if rate <= MOST_RATE}
        if shares:
            rate, least = min(shares.items(), key=lambda pair: pair[1])
            judged.append((sample.label, least >= 0.99, f"{100 * least:.1f} % at {percent_label(rate)} %"))
    return judged
