"""CLC Fig. 16: latency by effort

Claim: Latency grows in proportion to the iterations, and little with the points of the map.
Protocol: mean and one standard deviation in ten bins of equal width; bins of a single scene are left out.
Source: CLC paper, VIII-G, Fig. 16.
Published: a picture; linear in the iterations, less than proportional to map points, up to 2500 iterations.
Command: conelane compare --methods clc --out RESULTS
"""

import numpy as np

from ..clc_rows import of_paper
from ..experiment import Missing
from ..figures import drawn, group, variants
from ..theme import legend, method_style, new_figure


def _latency_against(results, samples, column, xlabel):
    figure, axes = new_figure()
    for sample, variant in variants(samples):
        x = sample.values[column]
        bins = np.digitize(x, np.linspace(x.min(), x.max() + 1e-9, 11)) - 1
        points = [(x[bins == i].mean(), sample.latency[bins == i].mean(), sample.latency[bins == i].std())
                  for i in range(10) if np.count_nonzero(bins == i) > 1]
        if points:
            centre, mean, deviation = np.array(points).T
            axes.errorbar(centre, mean, yerr=(np.minimum(deviation, mean), deviation), elinewidth=0.8, capsize=2,
                          label=sample.label, **method_style(results.methods, sample.method, variant))
    axes.set_xlabel(xlabel)
    axes.set_ylabel("latency [ms]")
    axes.set_ylim(bottom=0)
    legend(axes)
    return figure


def html(results, published):
    samples = [sample.known("iterations") for sample in results.samples if sample.has("iterations")]
    if not samples:
        raise Missing("no method enumerates.")
    return group([
        drawn("clc-fig-16a", "A straight line: the time is proportional to the iterations. Means and standard deviations.",
              _latency_against(results, samples, "iterations", "iterations"), "By iterations"),
        drawn("clc-fig-16b", "A flat line: more points cost little time. Means and standard deviations.",
              _latency_against(results, samples, "cones", "points in the map"), "By map points")])


def verdict(results, published):
    """Latency goes with the iterations, and more so than with the points of the map."""
    judged = []
    for sample in of_paper(sample.known("iterations") for sample in results.samples if sample.has("iterations")):
        known = [values for values in (sample.iterations, sample.cones) if np.ptp(values) > 0]
        if len(known) == 2 and np.ptp(sample.latency) > 0:
            effort, points = (float(np.corrcoef(sample.latency, values)[0, 1]) for values in known)
            judged.append((sample.label, effort >= 0.8 and effort > points,
                           f"correlation {effort:.2f} with the iterations, {points:.2f} with the points"))
    return judged
