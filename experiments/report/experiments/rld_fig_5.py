"""RLD Fig. 5: latency by cone-set size

Claim: An exact answer takes more time with more cones; the paper stays under 80 ms below 14.
Protocol: mean and one standard deviation of all solves at each size, from the sweep; a lower bar that would reach \
zero ends at a tenth of the mean.
Source: RLD paper, IV-A, Fig. 5: Mosek, its own machine and its own scenes.
Published: mean 71.79 ms at n = 12; under 80 ms on average below 14 cones.
Command: conelane sweep --out RESULTS/sweep
"""

import numpy as np

from ..experiment import Missing
from ..figures import drawn
from ..theme import ACCENT, legend, logarithmic, method_style, new_figure


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
    return drawn("rld-fig-5", "The star: the size and mean that the paper's text states.", figure)
