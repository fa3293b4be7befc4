"""What the exact search knows at its time limit

Claim: If the time is too short for a proof, there are a lane graph and a proven gap; both improve with time.
Protocol: `path-pair` on all cones of each scene, solved again under each limit, one thread. Gap: from the bound to the \
best lane graph known under any limit, divided by the larger of 1 and its cost's size; 0 if the optimum is proven. \
Close: a lane graph whose cost is within 1 % of that one's.
Source: this project.
Command: conelane study anytime --scenes RESULTS/scenes.scenes.jsonl --limit 300 --out RESULTS/anytime.jsonl
"""

import os

import numpy

from ..experiment import Missing
from ..figures import drawn, group
from ..load import read_lines, require
from ..theme import legend, logarithmic, new_figure, percent_axis, series_style

FILE = "anytime.jsonl"
CLOSE = 0.01


def read(results):
    """The rows by their limit."""
    path = results.path(FILE)
    if not os.path.exists(path):
        raise Missing(f"there is no {FILE}.")
    by_limit, origin = {}, ""
    for number, row in read_lines(path):
        for key, kinds in (("scene", (str,)), ("limit_ms", (int, float)), ("proven", (bool,))):
            require(path, number, row, key, kinds)
        origin = results.origin(row)
        by_limit.setdefault(row["limit_ms"], []).append(row)
    if not by_limit:
        raise Missing(f"{FILE} holds no row.")
    return dict(sorted(by_limit.items())), origin.strip()


def is_close(row):
    if row["proven"]:
        return True
    if "objective" not in row or "best_known" not in row:
        return False
    return row["objective"] - row["best_known"] <= CLOSE * max(1.0, abs(row["best_known"]))


def html(results, published):
    by_limit, origin = read(results)
    limits = list(by_limit)
    figure, axes = new_figure()
    for index, (label, holds) in enumerate((("proven", lambda row: row["proven"]), ("lane graph within 1 %", is_close))):
        axes.plot(limits, [100.0 * numpy.mean([holds(row) for row in by_limit[limit]]) for limit in limits],
                  marker="os"[index], label=label, **series_style(index))
    axes.set(xscale="log", xlabel="limit [ms]", ylabel="scenes [%]")
    logarithmic(axes.xaxis)
    percent_axis(axes)
    legend(axes)
    shares = drawn("anytime-shares", "Where a curve is level, more time proves nothing more. Share of "
                   f"{len(by_limit[limits[0]])} scenes, by the limit. {origin}".strip(), figure,
                   "Proven, and nearly best")
    # Scenes that are not solved within the first limit: the same scenes at every limit.
    hard = {row["scene"] for row in by_limit[limits[0]] if not row["proven"]}
    figure, axes = new_figure()
    for index, share in enumerate((50, 75, 90)):
        gaps = [[100.0 * row.get("gap", numpy.inf) for row in by_limit[limit] if row["scene"] in hard] for limit in limits]
        axes.plot(limits, [numpy.percentile(gap, share, method="inverted_cdf") if gap else 0.0 for gap in gaps],
                  marker="osD"[index], label=f"{share} % of them at most", **series_style(index))
    axes.set(xscale="log", xlabel="limit [ms]", ylabel="proven gap [%]")
    axes.set_ylim(bottom=0.0)
    logarithmic(axes.xaxis)
    legend(axes)
    gap = drawn("anytime-gap", "The faster a curve falls, the better the first answers are. For the "
                f"{len(hard)} scenes that are not solved within {limits[0]:g} ms. {origin}".strip(),
                figure, "Gap against time")
    return group([shares, gap])
