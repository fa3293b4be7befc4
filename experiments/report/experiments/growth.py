"""How the cost of the exact search grows

Claim: Time grows mildly with the cones and steeply with their density.
Protocol: `path-pair` on the nearest cones of each scene at each size that it exceeds, and on all of them; processor \
time of its thread, from the scene in memory to the answer in memory. A search that reached its limit counts with the \
time that it took. Density: mean number of other cones within 5.5 m of a cone.
Source: this project.
Command: conelane study growth --scenes RESULTS/scenes.scenes.jsonl --limit 300 --out RESULTS/growth.jsonl
"""

import os

import numpy

from ..experiment import Missing
from ..figures import drawn, group
from ..load import read_lines, require
from ..theme import legend, logarithmic, new_figure, series_style

FILE = "growth.jsonl"


def _curves(x_label, groups, caption, name, title):
    figure, axes = new_figure()
    places = list(groups)
    for index, (label, value) in enumerate((
            ("median", lambda rows: numpy.median([row["cpu_ms"] for row in rows])),
            ("p95", lambda rows: numpy.percentile([row["cpu_ms"] for row in rows], 95, method="inverted_cdf")))):
        axes.plot(places, [value(groups[place]) for place in places], marker="os"[index], label=f"{label}, ms",
                  **series_style(index))
    axes.plot(places, [numpy.mean([row["nodes"] for row in groups[place]]) for place in places], marker="D",
              label="nodes, mean", **series_style(2))
    axes.set(yscale="log", xlabel=x_label)
    logarithmic(axes.yaxis)
    legend(axes)
    return drawn(name, caption, figure, title)


def html(results, published):
    path = results.path(FILE)
    if not os.path.exists(path):
        raise Missing(f"there is no {FILE}.")
    by_size, by_density, origin = {}, {}, ""
    for number, row in read_lines(path):
        for key, kinds in (("cones", (int,)), ("all_visible", (bool,)), ("density", (int, float)), ("edges", (int,)),
                           ("nodes", (int,)), ("cpu_ms", (int, float))):
            require(path, number, row, key, kinds)
        origin = results.origin(row).strip()
        if row["all_visible"]:
            by_density.setdefault(int(row["density"]) + 0.5, []).append(row)
        else:
            by_size.setdefault(row["cones"], []).append(row)
    figures = []
    if by_size:
        figures.append(_curves("nearest cones", dict(sorted(by_size.items())), "A straight line on this scale: each cone more "
                               f"multiplies the time. Scenes that have more cones. {origin}".strip(), "growth-size", "By the number of cones"))
    if by_density:
        figures.append(_curves("others within 5.5 m of a cone", dict(sorted(by_density.items())),
                               "Scenes at the right end, with dense cones, take most time. All visible cones. "
                               f"{origin}".strip(), "growth-density", "By density"))
    if not figures:
        raise Missing(f"{FILE} holds no row.")
    return group(figures)
