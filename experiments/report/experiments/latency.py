"""Latency

Claim: Which method answers in time, at the median and in the tail?
Protocol: from the scene in memory to the lane in memory, the building of any model included; one thread, pinned to \
one processor; one untimed call before each lap. A run at its time limit counts with the time it took. The real-time \
budget is 50 ms, the period of a 20 Hz LiDAR.
Source: this project.
Command: conelane compare --out RESULTS
"""

import numpy as np

from .. import measures
from ..boxes import box_plot
from ..figures import counts_of_points, drawn, group, in_condition, method_key, percent_label, variants
from ..rows import attributes, key_cells, keys, note_on_limit, part
from ..tables import Cell, Column, milliseconds, percent, table
from ..theme import ACCENT, MUTED, logarithmic, method_legend, method_style, new_figure
from ..leaders import REAL_TIME_BUDGET_MS


def latency_table(results):
    rows = []
    for row in results.rows:
        scores = part(results, row)
        latency = row["latency_ms"]
        interval = measures.median_interval(scores.latency, scores.track)
        rows.append(key_cells(results, row) + [milliseconds(latency["median"], interval=interval, measure="median")] + [
            milliseconds(latency[key], limit_ms=results.time_limit_ms if key in ("p95", "p99", "max") else np.inf,
                         measure=key) if key in latency else Cell("–")
            for key in ("mean", "standard_deviation", "shifted_geometric_mean", "p95", "p99", "max")] +
            [percent(row.get("within_budget_share"), measure="within_budget_share")])
    columns = keys(results) + [Column("median ms"), Column("mean ms"), Column("standard deviation ms"),
                               Column("geometric mean ms"), Column("p95 ms"), Column("p99 ms"), Column("max ms"),
                               Column("within 50 ms %")]
    return table("latencies", "", columns, rows, row_attributes=attributes(results),
                 note=f"Geometric mean: shifted by 1 ms. Small: 95 % interval, tracks resampled.{note_on_limit(results)}")


def _budget(axes, line, label_at, **text):
    line(REAL_TIME_BUDGET_MS, color=ACCENT, linewidth=1)
    axes.annotate("50 ms", label_at, textcoords="offset points", color=ACCENT, fontsize=8, **text)


def _limit(results, samples, axes, line, label_at, **text):
    """The time limit, where it ended an answer."""
    limit = results.time_limit_ms
    if np.isfinite(limit) and any(sample.latency.max() >= limit for sample in samples):
        line(limit, color=MUTED, linewidth=1, linestyle=":")
        axes.annotate(f"limit {limit:g} ms", label_at(limit), textcoords="offset points", color=MUTED, fontsize=8, **text)


def boxes_figure(results):
    figure, axes = new_figure(height=0.95 + 0.33 * len(results.samples))
    box_plot(axes, results, results.samples)
    _budget(axes, axes.axvline, (REAL_TIME_BUDGET_MS, 1), xycoords=("data", "axes fraction"), xytext=(-3, -1),
            ha="right", va="top")
    _limit(results, results.samples, axes, axes.axvline, lambda limit: (limit, 1), xycoords=("data", "axes fraction"),
           xytext=(-3, -1), ha="right", va="top")
    return figure


def by_rate_figure(results):
    """Median and 99th percentile by rate of false positives."""
    figure, axes = new_figure(height=3.1)
    for sample, variant in variants(results.samples):
        parts = [(rate, sample.at(rate).latency) for rate in results.rates if len(sample.at(rate))]
        rates = [100 * rate for rate, _ in parts]
        medians = [np.median(latency) for _, latency in parts]
        tails = [measures.quantile(latency, 0.99) for _, latency in parts]
        style = method_style(results.methods, sample.method, variant)
        axes.plot(rates, medians, label=sample.label, **style)
        axes.plot(rates, tails, **style | {"linewidth": 0.8, "markersize": 2.5, "alpha": 0.75})
    _budget(axes, axes.axhline, (100 * results.rates[0], REAL_TIME_BUDGET_MS), xytext=(0, 3), ha="left")
    _limit(results, results.samples, axes, axes.axhline, lambda limit: (100 * results.rates[0], limit), xytext=(0, 3),
           ha="left")
    axes.set_yscale("log")
    logarithmic(axes.yaxis)
    axes.set_xticks([100 * rate for rate in results.rates], [percent_label(rate) for rate in results.rates])
    axes.set_xlabel("false positives [% of all points]")
    axes.set_ylabel("latency [ms], thin: p99")
    method_legend(axes)
    return figure


def html(results, published):
    under, alone = results.under(results.main_condition), in_condition(results)
    return group([
        drawn("latency-by-rate", "Below the line, a method answers in time. Strong curves: the median. Thin curves: the 99th percentile, the slowest "
              "answers. "
              f"{counts_of_points(under, under.samples)}{alone}", by_rate_figure(under), "Latency by false-positive rate"),
        drawn("latency", "A tick (the maximum) right of the line: at least one answer was too late for real time. Boxes: quartiles and "
              f"median; whiskers to the 1st and 99th percentile.{alone}", boxes_figure(under), "Latency over all rates and ranges")
    ], method_key(results, under.samples)) + latency_table(results)
