"""Quantiles, and numbers as texts: one definition for the report and experiments/tables, the first one that of
evaluation/scoring/statistics.cpp, too."""

import math
from statistics import median  # noqa: F401  (the mean of the two in the middle where the number of values is even)

UNKNOWN = "–"


def quantile(values, share):
    """Nearest rank: the smallest value that at least `share` of the sample does not exceed."""
    ordered = sorted(values)
    # A rank that is whole in exact arithmetic, such as 0.95 * 20, must not be rounded up to the next one.
    return ordered[max(1, math.ceil(share * len(ordered) - 1e-9)) - 1]


def fixed(value, digits):
    return UNKNOWN if value is None else f"{value:.{digits}f}"


def percent(share, digits=1):
    return UNKNOWN if share is None else f"{100.0 * share:.{digits}f}"


def percent_label(rate):
    """A rate as axes and tables name it: 16.7, not 16.66; 30, not 30.0."""
    return percent(rate).rstrip("0").rstrip(".")
