"""What the RLD paper's section IV shows, for every method that sees a cone set of the paper's size, and its own
numbers beside."""

import numpy as np

from .figures import drawn, group, left_out, percent_label
from .tables import Cell, Column, method_cell, milliseconds, percent, table, text
from .comparison_figures import variants
from .theme import ACCENT, legend, logarithmic, method_colour, method_style, new_figure

TOPOLOGIES = ("straight", "circle", "curvy")


def _at_size(results, size):
    return [sample for sample in results.samples if sample.nearest == size]


def latency_by_size(results, published):
    """Fig. 5."""
    name, title = "rld-fig-5", "RLD Fig. 5: latency by cone-set size"
    sized = [sample for sample in results.sweep if sample.nearest is not None]
    if not sized:
        return left_out(name, title, "the results hold no sweep over cone-set sizes.")
    figure, axes = new_figure(height=3.2)
    for method in dict.fromkeys(sample.method for sample in sized):
        points = np.array([(s.nearest, s.latency.mean(), s.latency.std()) for s in sized if s.method == method])
        size, mean, deviation = points.T
        axes.errorbar(size, mean, yerr=(np.minimum(deviation, 0.9 * mean), deviation), elinewidth=0.8, capsize=2,
                      label=method, **method_style(results.methods, method))
    axes.plot([published["rld_cone_set"]], [published["rld_mean_ms"]], marker="*", markersize=11, linestyle="",
              color=ACCENT, label="RLD paper (solved)")
    axes.set_yscale("log")
    logarithmic(axes.yaxis)
    axes.set_xlabel("cones in the set, n")
    axes.set_ylabel("latency [ms]")
    legend(axes)
    return drawn(name, title, "Mean and one standard deviation; a lower bar that would reach zero ends at a tenth of "
                 "the mean. The paper's mark stands at the size and mean that its text states.", figure)


def latency_distribution(results, published):
    """Fig. 6."""
    size = published["rld_cone_set"]
    name, title = "rld-fig-6", f"RLD Fig. 6: distribution of latency at n = {size}"
    samples = _at_size(results, size)
    if not samples:
        return left_out(name, title, f"no method ran on the {size} nearest cones.")
    figure, axes = new_figure(height=3.2)
    smallest = max(1e-3, min(s.latency.min() for s in samples))
    most = max([s.latency.max() for s in samples] + [1.5 * published["rld_p95_ms"]])
    bins = np.geomspace(smallest, most, 61)
    for sample in samples:
        counts, _ = np.histogram(np.clip(sample.latency, smallest, most), bins)
        axes.stairs(100 * counts / len(sample), bins, label=sample.label, linewidth=1.4,
                    color=method_colour(results.methods, sample.method),
                    linestyle=method_style(results.methods, sample.method)["linestyle"])
    for value, label in ((published["rld_mean_ms"], "paper's mean"), (published["rld_p95_ms"], "its p95")):
        axes.axvline(value, color=ACCENT, linewidth=1)
        axes.annotate(label, (value, 0.98), xycoords=("data", "axes fraction"), rotation=90, ha="right", va="top",
                      color=ACCENT, fontsize=8)
    axes.set_xscale("log")
    logarithmic(axes.xaxis)
    axes.set_xlabel("latency [ms], bins of equal ratio")
    axes.set_ylabel("scenes [%]")
    legend(axes)
    return drawn(name, title, "All rates and ranges together. The paper's distribution comes from another machine, "
                 "another solver and a car's own laps.", figure)


def solved_table(results, published):
    """The numbers printed with Fig. 6."""
    size = published["rld_cone_set"]
    samples = [sample for sample in _at_size(results, size) if sample.has("solved")]
    if not samples:
        return ""
    columns = [Column("method", "text"), Column("solved within 0.4 s %"), Column("mean of solved ms"),
               Column("p95 of all ms"), Column("standard deviation ms"), Column("scenes")]
    rows = [[text("RLD paper"), percent(published["rld_solved"] / 100, 2), milliseconds(published["rld_mean_ms"]),
             milliseconds(published["rld_p95_ms"]), milliseconds(published["rld_standard_deviation_ms"]),
             Cell("–")]]
    for sample in samples:
        solved = sample.solved == 1.0
        ordered = np.sort(sample.latency)
        rows.append([method_cell(results.methods, sample.method, sample.label), percent(solved.mean(), 2),
                     milliseconds(sample.latency[solved].mean()) if solved.any() else Cell("–"),
                     milliseconds(ordered[max(0, int(np.ceil(0.95 * len(ordered))) - 1)]),
                     milliseconds(sample.latency.std()), Cell(str(len(sample)), len(sample))])
    return table("rld-solved", f"Solved within the paper's limit, cone sets of n = {size}", columns, rows,
                 published_rows=1)


def inaccurate_by_topology(results, published):
    """Fig. 7."""
    size = published["rld_cone_set"]
    name, title = "rld-fig-7", "RLD Fig. 7: inaccurate lanes by topology"
    samples = [s.known("accurate") for s in _at_size(results, size)]
    present = [t for t in TOPOLOGIES if any(t in s.track for s in samples)]
    if not present:
        return [left_out(name, title, f"no method with n = {size} ran on a track called "
                         f"{', '.join(TOPOLOGIES[:-1])} or {TOPOLOGIES[-1]}.")]
    figures = []
    shares = [1 - s.where((s.track == t) & (s.rate == rate)).accurate.mean() for s in samples for t in present
              for rate in results.rates if np.any((s.track == t) & (s.rate == rate))]
    most = max([row["inaccurate"] for row in published["rld"]] + [100 * share for share in shares])
    for topology in present:
        figure, axes = new_figure(height=2.7)
        for sample, variant in variants(samples):
            part = sample.where(sample.track == topology)
            points = [(100 * rate, 100 * (1 - part.at(rate).accurate.mean()))
                      for rate in results.rates if len(part.at(rate))]
            if points:
                axes.plot(*zip(*points), label=sample.label, **method_style(results.methods, sample.method, variant))
        exact = [(100 * row["rate"], row["inaccurate"]) for row in published["rld"]]
        axes.plot(*zip(*exact), marker="*", markersize=11, linestyle="", color=ACCENT,
                  label="RLD paper, all three (1:1 is a bound)")
        ticks = sorted({round(rate, 4) for rate in results.rates} | {round(row["rate"], 4) for row in published["rld"]})
        axes.set_xticks([100 * rate for rate in ticks], [percent_label(rate) for rate in ticks])
        axes.set_ylim(0, 1.06 * most)
        axes.set_xlabel("false positives [% of all points]")
        axes.set_ylabel("inaccurate [%]")
        legend(axes)
        figures.append(drawn(f"{name}-{topology}", f"{title}: {topology}",
                             "Share of scenes where one of the paper's four checks fails. 16.7 % is the paper's "
                             "ratio 1:5, 50 % its 1:1. One scale for all topologies.", figure))
    return figures


def html(results, published):
    figures = [latency_by_size(results, published), latency_distribution(results, published)]
    return (group(figures) + solved_table(results, published) + group(inaccurate_by_topology(results, published)))
