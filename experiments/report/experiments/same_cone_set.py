"""The same cone set for all

Claim: Which method is ahead at which cone-set size, and how does its time grow?
Protocol: every method on the n nearest cones ahead, the same scenes at every size. If several names are listed, zero \
is within the 95 % interval of the paired difference from the best (tracks resampled). Fastest: least geometric mean.
Source: this project; the sizes are those of the RLD paper's Fig. 5 and beyond.
Command: conelane compare --by-size --out RESULTS/sweep
"""

import numpy as np

from .. import measures
from ..experiment import Missing
from ..figures import drawn, group, percent_label
from ..tables import Cell, Column, method_cell, milliseconds, table
from ..theme import ACCENT, legend, logarithmic, method_style, new_figure, percent_axis
from ..leaders import MEASURES, REAL_TIME_BUDGET_MS, fastest_of, leaders_of


def _by_size(results):
    columns = [Column("cones n")] + [Column(f"most often {words}", "text") for _, words, _ in MEASURES] + [
        Column("fastest", "text"), Column("its median ms"), Column("scenes")]
    rows = []
    for size in sorted({sample.nearest for sample in results.sweep}):
        samples = [sample for sample in results.sweep if sample.nearest == size]
        row = [Cell(str(size), size)]
        for _, _, values_of in MEASURES:
            leaders = leaders_of(samples, values_of)
            names = ", ".join(sorted(part.method for part in leaders[1])) if leaders else "–"
            row.append(Cell(names, names, f"{100 * leaders[0]:.1f} %" if leaders else ""))
        fastest = fastest_of(samples)
        rows.append(row + [method_cell(results.methods, fastest.method, fastest.method),
                           milliseconds(float(np.median(fastest.latency))),
                           Cell(str(max(map(len, samples))), max(map(len, samples)))])
    rates = ", ".join(percent_label(rate) for rate in sorted({rate for s in results.sweep for rate in s.rate}))
    return table("by-size", "", columns, rows, note=f"{rates} % false positives.")


def growth_figure(results):
    """Median and 99th percentile of latency by cone-set size; None without a sweep."""
    if not results.sweep:
        return None
    figure, axes = new_figure(height=3.1)
    for method in dict.fromkeys(sample.method for sample in results.sweep):
        samples = [sample for sample in results.sweep if sample.method == method]
        sizes = [sample.nearest for sample in samples]
        medians = [np.median(sample.latency) for sample in samples]
        tails = [measures.quantile(sample.latency, 0.99) for sample in samples]
        style = method_style(results.methods, method)
        axes.plot(sizes, medians, label=method, **style)
        axes.plot(sizes, tails, **style | {"linewidth": 0.8, "markersize": 2.5, "alpha": 0.75})
    axes.axhline(REAL_TIME_BUDGET_MS, color=ACCENT, linewidth=1)
    axes.annotate("50 ms", (min(s.nearest for s in results.sweep), REAL_TIME_BUDGET_MS), xytext=(0, 3),
                  textcoords="offset points", color=ACCENT, fontsize=8)
    axes.set_yscale("log")
    logarithmic(axes.yaxis)
    axes.set_xlabel("cones in the set, n")
    axes.set_ylabel("latency [ms], thin: p99")
    legend(axes)
    return figure


def quality_figure(results, words, values_of):
    figure, axes = new_figure(height=3.1)
    for method in dict.fromkeys(sample.method for sample in results.sweep):
        points = []
        for sample in (sample for sample in results.sweep if sample.method == method):
            values, tracks = values_of(sample)
            if not values:
                continue
            shares = np.array(list(values.values()))
            mean = shares.mean()
            low, high = (measures.mean_interval(shares, np.array(list(tracks.values()), dtype=object)) or (mean, mean))
            points.append((sample.nearest, 100 * mean, 100 * max(0, mean - low), 100 * max(0, high - mean)))
        if points:
            size, mean, below, above = np.array(points).T
            axes.errorbar(size, mean, yerr=(below, above), elinewidth=0.8, capsize=2, label=method,
                          **method_style(results.methods, method))
    axes.set_xlabel("cones in the set, n")
    axes.set_ylabel(f"{words} [%]")
    percent_axis(axes)
    legend(axes)
    return figure


def html(results, published):
    if not results.sweep:
        raise Missing("there is no sweep over cone-set sizes.")
    figures = [drawn("growth", "A level curve: more cones cost no time. Strong curves: the median. Thin curves: the 99th percentile.", growth_figure(results), "Latency")]
    figures += [drawn(f"{name}-by-size", "High is good, and where a curve is level, more cones do not help. Error bars: 95 % intervals, tracks resampled.",
                      quality_figure(results, words, values_of), words.capitalize())
                for name, words, values_of in MEASURES]
    return group(figures) + _by_size(results)
