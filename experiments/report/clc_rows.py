"""What the CLC paper's tables and figures share."""

import numpy as np

from .tables import Cell, method_cell, percent, text

MOST_RATE = 0.3 + 1e-9


def of_paper(samples):
    """Those whose method is the paper's, or this project's extension of it."""
    return [sample for sample in samples if sample.method.startswith("clc")]


def moderate(sample):
    """As in the paper, histograms take rates of false positives up to 30 %."""
    return sample.where(sample.rate <= MOST_RATE)


def printed(row, key):
    return percent(row[key] / 100)


def rows_by_rate(results, published, samples, of_paper, of_ours):
    """For each rate of ours or the paper's: the paper's row first, then one of each method. Also the numbers of the
    paper's rows."""
    rows, marks = [], []
    printed_at = {round(row["rate"], 6): row for row in published["clc"]}
    ours = {round(rate, 6) for sample in samples for rate in sample.rate}
    for rate in sorted(ours | set(printed_at)):
        if rate in printed_at:
            rows.append([text("CLC paper"), percent(rate)] + of_paper(printed_at[rate]))
            marks.append(len(rows) - 1)
        for sample in samples:
            part = sample.where(np.abs(sample.rate - rate) < 1e-6)
            if len(part):
                rows.append([method_cell(results.methods, sample.method, sample.label), percent(rate)] + of_ours(part))
    return rows, marks


UNKNOWN = Cell("–")
