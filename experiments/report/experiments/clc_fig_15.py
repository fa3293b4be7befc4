"""CLC Fig. 15: latency of the graph search

Claim: The graph search is fast enough for a car, even in its slowest scene.
Protocol: methods that enumerate, all rates and ranges. Quartiles and median; whiskers to the 1st and 99th \
percentile; the tick is the maximum.
Source: CLC paper, VIII-G, Fig. 15: Intel i7-12700K.
Published: median below 5 ms, maximum 12 ms.
Command: conelane compare --methods clc --out RESULTS
"""

import numpy as np

from ..boxes import box_plot
from ..clc_rows import of_paper
from ..experiment import Missing
from ..figures import drawn
from ..theme import ACCENT, new_figure


def html(results, published):
    samples = [sample for sample in results.samples if sample.has("iterations")]
    if not samples:
        raise Missing("no method enumerates.")
    figure, axes = new_figure(height=1.15 + 0.33 * len(samples))
    box_plot(axes, results, samples)
    for value, label, side in ((published["clc_median_below_ms"], "paper's median below", "right"),
                               (published["clc_max_ms"], "its maximum", "left")):
        axes.axvline(value, color=ACCENT, linewidth=1)
        axes.annotate(label, (value, 1.01), xycoords=("data", "axes fraction"), ha=side, va="bottom", color=ACCENT,
                      fontsize=8)
    return drawn("clc-fig-15", "Boxes and ticks left of the lines are faster than the paper's median and maximum, which were measured on its own machine.", figure)


def verdict(results, published):
    """Median and maximum are below the paper's, on whatever machine this was."""
    judged = []
    for sample in of_paper(sample for sample in results.samples if sample.has("iterations")):
        median, most = float(np.median(sample.latency)), float(sample.latency.max())
        judged.append((sample.label, median < published["clc_median_below_ms"] and most <= published["clc_max_ms"],
                       f"median {median:.2f} ms, maximum {most:.1f} ms"))
    return judged
