"""RLD Fig. 6: distribution of latency at n = 12

Claim: Nearly every scene of 12 cones is solved within 0.4 s, most of them far sooner.
Protocol: every method that saw the 12 nearest cones, all rates and ranges together. Solved: within 0.4 s the \
optimum with an absolute gap of at most 1e-5, or the proof that there is no lane.
Source: RLD paper, IV-A, Fig. 6: Mosek, its own machine and a car's own laps.
Published: 97.19 % solved within 0.4 s, mean of these 71.79 ms, 95 % of all within 155.88 ms, standard deviation \
51.96 ms.
Command: conelane compare --methods rld-cbc,rld-paper --nearest 12 --out RESULTS
"""

import numpy as np

from .. import measures
from ..experiment import Missing
from ..figures import drawn, group, variants
from ..tables import Cell, Column, method_cell, milliseconds, percent, table, text
from ..theme import ACCENT, legend, logarithmic, method_color, method_style, new_figure

_LIMIT_MS = 400.0


def _distribution(results, samples, published):
    figure, axes = new_figure(height=3.2)
    smallest = max(1e-3, min(s.latency.min() for s in samples))
    most = max([s.latency.max() for s in samples] + [1.5 * published["rld_p95_ms"]])
    bins = np.geomspace(smallest, most, 61)
    for sample, variant in variants(samples):
        counts, _ = np.histogram(np.clip(sample.latency, smallest, most), bins)
        axes.stairs(100 * counts / len(sample), bins, label=sample.label, linewidth=1.4, gid=f"curve:{sample.method}",
                    color=method_color(results.methods, sample.method),
                    linestyle=method_style(results.methods, sample.method, variant)["linestyle"])
    for value, label in ((published["rld_mean_ms"], "paper's mean"), (published["rld_p95_ms"], "its p95")):
        axes.axvline(value, color=ACCENT, linewidth=1)
        axes.annotate(label, (value, 0.98), xycoords=("data", "axes fraction"), rotation=90, ha="right", va="top",
                      color=ACCENT, fontsize=8)
    axes.set_xscale("log")
    logarithmic(axes.xaxis)
    axes.set_xlabel("latency [ms], bins of equal ratio")
    axes.set_ylabel("scenes [%]")
    legend(axes)
    return figure


def _solved(results, samples, published):
    columns = [Column("method", "text"), Column("solved within 0.4 s %"), Column("mean of solved ms"),
               Column("p95 of all ms"), Column("standard deviation ms"), Column("scenes")]
    rows = [[text("RLD paper"), percent(published["rld_solved"] / 100, 2), milliseconds(published["rld_mean_ms"]),
             milliseconds(published["rld_p95_ms"]), milliseconds(published["rld_standard_deviation_ms"]), Cell("–")]]
    for sample in samples:
        solved = sample.solved == 1.0
        rows.append([method_cell(results.methods, sample.method, sample.label), percent(solved.mean(), 2),
                     milliseconds(sample.latency[solved].mean()) if solved.any() else Cell("–"),
                     milliseconds(measures.quantile(sample.latency, 0.95)), milliseconds(sample.latency.std()),
                     Cell(str(len(sample)), len(sample))])
    return table("rld-solved", "", columns, rows, published_rows=1)


def html(results, published):
    size = published["rld_cone_set"]
    samples = [sample for sample in results.samples if sample.nearest == size]
    if not samples:
        raise Missing(f"no method ran on the {size} nearest cones.")
    figure = drawn("rld-fig-6", "Left of the lines, a method is faster than the paper's mean and 95 % quantile. All rates and ranges together.", _distribution(results, samples, published))
    exact = [sample for sample in samples if sample.has("solved")]
    return group([figure]) + (_solved(results, exact, published) if exact else "")


def verdict(results, published):
    """At least as many solved as in the paper, and half of them within half of the limit."""
    judged = []
    for sample in results.samples:
        if sample.nearest == published["rld_cone_set"] and sample.has("solved"):
            solved, median = sample.solved == 1.0, float(np.median(sample.latency))
            judged.append((sample.label, bool(100 * solved.mean() >= published["rld_solved"] and median < _LIMIT_MS / 2),
                           f"{100 * solved.mean():.2f} % solved, median {median:.2f} ms"))
    return judged
