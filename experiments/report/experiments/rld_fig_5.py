"""RLD Fig. 5: latency by cone-set size

Claim: An exact answer takes more time with more cones; the paper stays under 80 ms below 14.
Protocol: mean and one standard deviation of all solves at each size, from the sweep; a lower bar that would reach \
zero ends at a tenth of the mean.
Source: RLD paper, IV-A, Fig. 5: Mosek, its own machine and its own scenes.
Published: mean 71.79 ms at n = 12; under 80 ms on average below 14 cones.
Command: conelane compare --by-size --out RESULTS/sweep
"""

import numpy as np

from ..experiment import Missing
from ..figures import drawn
from ..theme import ACCENT, legend, logarithmic, method_style, new_figure

_SMALL_SET, _SMALL_SET_MS = 14, 80.0  # as the paper says


def html(results, published):
    if not results.sweep:
        raise Missing("there is no sweep over cone-set sizes.")
    figure, axes = new_figure(height=3.2)
    for method in dict.fromkeys(sample.method for sample in results.sweep):
        points = np.array([(s.nearest, s.latency.mean(), s.latency.std()) for s in results.sweep if s.method == method])
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
    return drawn("rld-fig-5", "Below the star, a method is faster than the paper's mean. A steep curve: more cones cost much time.", figure)


def verdict(results, published):
    """Exact methods: slower on the largest set than on the smallest, and below the paper's mean under 14 cones."""
    judged = []
    for method in dict.fromkeys(sample.method for sample in results.sweep if sample.has("solved")):
        means = {sample.nearest: float(sample.latency.mean()) for sample in results.sweep if sample.method == method}
        small, large, below = min(means), max(means), [mean for size, mean in means.items() if size < _SMALL_SET]
        holds = means[large] > means[small] and max(below, default=0.0) < _SMALL_SET_MS
        judged.append((method, holds, f"mean {means[small]:.2f} ms at n = {small}, {means[large]:.2f} ms at n = {large}"))
    return judged
