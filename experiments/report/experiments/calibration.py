"""Confidence and trusted length

Claim: Does a method know when its lane is wrong, and how far it is right?
Protocol: of lanes said to be usable with about the same probability, the share that is; the dotted line is where both \
are equal, bins of 0.1, all rates and ranges together. Error: mean over the lanes of the distance from that line. Sure: \
confidence of 0.99 or more. Right where trusted: the lane does not leave the true boundaries within its trusted length; \
trusted: these lengths together, as a share of the lanes' lengths.
Source: this project.
Command: conelane compare --out RESULTS
"""

from ..experiment import Missing
from ..figures import drawn, group
from ..rows import attributes, key_cells, keys
from ..tables import Column, percent, table
from ..theme import MUTED, legend, method_style, new_figure

_MEASURES = (("error", "confidence error %"), ("sure_share", "sure %"), ("usable_where_sure_share", "usable where sure %"),
             ("trusted_share", "trusted %"), ("right_where_trusted_share", "right where trusted %"))


class _Shown:
    """The results without the rows that say nothing of their lanes."""

    def __init__(self, results):
        self.rows = [row for row in results.rows if row.get("calibration")]
        self.methods, self.conditions, self.samples = results.methods, results.conditions, results.samples


def _points(rows):
    """(confidence, share usable, lanes) of the bins of several rows together."""
    bins = {}
    for row in rows:
        for lanes, confidence, usable in row["calibration"].get("bins", ()):
            sums = bins.setdefault(min(int(10 * confidence), 9), [0, 0.0, 0.0])
            for i, value in enumerate((lanes, lanes * confidence, lanes * usable)):
                sums[i] += value
    return [(confidence / lanes, usable / lanes, lanes) for _, (lanes, confidence, usable) in sorted(bins.items())]


def _figure(shown, condition):
    figure, axes = new_figure()
    axes.plot([0, 1], [0, 1], color=MUTED, linewidth=0.8, linestyle=":")
    for method in shown.methods:
        rows = [row for row in shown.rows if row["method"] == method and row.get("condition", "") == condition]
        points = _points(rows)
        if points:
            axes.plot([point[0] for point in points], [point[1] for point in points], label=method,
                      **method_style(shown.methods, method))
    axes.set_xlabel("confidence")
    axes.set_ylabel("share usable")
    legend(axes)
    name = f"calibration-{condition}" if condition else "calibration"
    return drawn(name, "The nearer to the dotted line, the more its confidence says; above it a method is better than it says.", figure, title=condition,
                 condition=condition)


def html(results, published):
    shown = _Shown(results)
    if not shown.rows:
        raise Missing("no method says how sure it is.")
    figures = [_figure(shown, condition) for condition in shown.conditions
               if any(row.get("condition", "") == condition and row["calibration"].get("bins") for row in shown.rows)]
    rows = [key_cells(shown, row) + [percent(row["calibration"].get(key), digits=2, measure=key)
                                     for key, _ in _MEASURES] for row in shown.rows]
    columns = keys(shown) + [Column(title) for _, title in _MEASURES]
    return group(figures) + table("calibration-table", "", columns, rows, row_attributes=attributes(shown))
