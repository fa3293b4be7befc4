"""The sweep over cone-set sizes: who is ahead at which size, as a table and as figures."""

import numpy as np

from . import measures
from .figures import drawn, group, left_out, percent_label
from .tables import Cell, Column, method_cell, milliseconds, table
from .theme import legend, method_style, new_figure
from .verdict import MEASURES, leaders_of


def _sized(results):
    return [sample for sample in results.sweep if sample.nearest is not None]


def html(results):
    """The table by size; empty where there was no sweep."""
    sized = _sized(results)
    if not sized:
        return ""
    columns = [Column("cones n")] + [Column(f"most often {words}", "text") for _, words, _ in MEASURES] + [
        Column("fastest", "text"), Column("its median ms"), Column("scenes")]
    rows = []
    for size in sorted({sample.nearest for sample in sized}):
        samples = [sample for sample in sized if sample.nearest == size]
        row = [Cell(str(size), size)]
        for _, _, values_of in MEASURES:
            leaders = leaders_of(samples, values_of)
            names = ", ".join(sorted(part.method for part in leaders[1])) if leaders else "–"
            row.append(Cell(names, names, f"{100 * leaders[0]:.1f} %" if leaders else ""))
        fastest = min(samples, key=lambda sample: np.median(sample.latency))
        row += [method_cell(results.methods, fastest.method, fastest.method),
                milliseconds(float(np.median(fastest.latency))),
                Cell(str(max(map(len, samples))), max(map(len, samples)))]
        rows.append(row)
    rates = ", ".join(percent_label(rate) for rate in sorted({rate for sample in sized for rate in sample.rate}))
    return table("by-size", "Ahead, by cone-set size", columns, rows,
                 note=f"The sweep: every method on the n nearest cones, {rates} % false positives. Several names: as "
                 "above.")


def figures(results):
    """Quality by cone-set size."""
    sized = _sized(results)
    if not sized:
        return group([left_out("by-size-figures", "Quality by cone-set size",
                               "the results hold no sweep over cone-set sizes.")])
    made = []
    for name, words, values_of in MEASURES:
        figure, axes = new_figure()
        for method in dict.fromkeys(sample.method for sample in sized):
            points = []
            for sample in (sample for sample in sized if sample.method == method):
                values, tracks = values_of(sample)
                if not values:
                    continue
                shares = np.array(list(values.values()))
                mean = shares.mean()
                interval = measures.mean_interval(shares, np.array(list(tracks.values()), dtype=object))
                low, high = interval or (mean, mean)
                points.append((sample.nearest, 100 * mean, 100 * max(0, mean - low), 100 * max(0, high - mean)))
            if points:
                size, mean, below, above = np.array(points).T
                axes.errorbar(size, mean, yerr=(below, above), elinewidth=0.8, capsize=2, label=method,
                              **method_style(results.methods, method))
        axes.set_xlabel("cones in the set, n")
        axes.set_ylabel(f"{words} [%]")
        axes.set_ylim(top=102)
        legend(axes)
        made.append(drawn(f"{name}-by-size", f"{words.capitalize()} by cone-set size",
                          "From the sweep. Error bars: 95 % intervals, tracks resampled.", figure))
    return group(made)
