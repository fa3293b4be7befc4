"""Latency boxes, as several experiments draw them."""

import numpy as np

from .theme import INK, SURFACE, logarithmic, method_color


def box_plot(axes, results, samples):
    """On a logarithmic axis: quartiles, median, whiskers to the 1st and 99th percentile, maximum."""
    boxes = [{"med": np.median(s.latency), "q1": np.percentile(s.latency, 25), "q3": np.percentile(s.latency, 75),
              "whislo": np.percentile(s.latency, 1), "whishi": np.percentile(s.latency, 99),
              "fliers": [s.latency.max()], "label": s.label} for s in samples]
    places = np.arange(len(boxes), 0, -1)
    shapes = axes.bxp(boxes, positions=places, vert=False, widths=0.5, patch_artist=True,
                      flierprops={"marker": "|", "markersize": 7})
    for i, sample in enumerate(samples):
        color = method_color(results.methods, sample.method)
        shapes["boxes"][i].set(facecolor=color, edgecolor=color)
        shapes["medians"][i].set(color=SURFACE, linewidth=1.8)
        shapes["fliers"][i].set(markeredgecolor=color)
        for line in shapes["whiskers"][2 * i:2 * i + 2] + shapes["caps"][2 * i:2 * i + 2]:
            line.set(color=color)
    axes.set_xscale("log")
    logarithmic(axes.xaxis)
    axes.grid(False, axis="y")
    axes.set_xlabel("latency [ms]")
    axes.tick_params(axis="y", labelcolor=INK)
