"""Confidence and trusted length

Claim: Does a method know when its lane is wrong, and how far it is right?
Protocol: the share of usable lanes among lanes with about the same confidence, in bins of 0.1, all rates and ranges \
together; on the dotted line, share and confidence are equal. Error: mean over the lanes of the distance from that line. Sure: \
confidence of 0.99 or more. Right where trusted: the lane does not leave the true boundaries within its trusted length; \
trusted: these lengths together, as a share of the lanes' lengths.
Source: this project.
Command: conelane compare --out RESULTS
"""

from ..experiment import Missing
from ..figures import drawn, group, method_key
from ..rows import attributes, key_cells, keys
from ..tables import Cell, Column, method_cell, percent, table, text
from ..theme import MUTED, method_color, method_legend, method_style, new_figure

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
            for confidence, usable, lanes in points:
                axes.annotate(str(lanes), (confidence, usable), xytext=(4, -9 if shown.methods.index(method) % 2 else 4),
                              textcoords="offset points", fontsize=6, color=method_color(shown.methods, method))
    axes.set_xlabel("confidence")
    axes.set_ylabel("share usable")
    method_legend(axes)
    name = f"calibration-{condition}" if condition else "calibration"
    return drawn(name, "Near the dotted line, the confidence is right; above it, the method is better than its confidence. "
                 "Numbers: lanes at a point.", figure, title=f"Confidence, condition {condition}" if condition else "",
                 condition=condition)


def _lanes(row):
    """Of how many lanes a row's shares are."""
    lanes = sum(found for found, _, _ in row["calibration"].get("bins", ()))
    return Cell(str(lanes), lanes) if lanes else Cell("–")


def _bins_table(shown):
    """What the figures are drawn from, with the number of lanes."""
    rows, attributes_of = [], []
    for condition in shown.conditions:
        for method in dict.fromkeys(row["method"] for row in shown.rows):
            points = _points([row for row in shown.rows if row["method"] == method and
                              row.get("condition", "") == condition])
            under = [text(condition)] if shown.conditions != [""] else []
            for confidence, usable, lanes in points:
                rows.append([method_cell(shown.methods, method, method)] + under +
                            [percent(confidence), percent(usable), Cell(str(lanes), lanes)])
                attributes_of.append({"method": method, "condition": condition})
    if not rows:
        return ""
    columns = [Column("method", "text")] + ([Column("condition", "text")] if shown.conditions != [""] else []) + [
        Column("mean confidence %"), Column("usable %"), Column("lanes")]
    return table("calibration-bins", "Lanes of about the same confidence, all rates and ranges together", columns, rows,
                 row_attributes=attributes_of)


def html(results, published):
    shown = _Shown(results)
    if not shown.rows:
        raise Missing("no method says how sure it is.")
    figures = [_figure(shown, condition) for condition in shown.conditions
               if any(row.get("condition", "") == condition and row["calibration"].get("bins") for row in shown.rows)]
    rows = [key_cells(shown, row) + [_lanes(row)] + [percent(row["calibration"].get(key), digits=2, measure=key)
                                     for key, _ in _MEASURES] for row in shown.rows]
    columns = keys(shown) + [Column("lanes")] + [Column(title) for _, title in _MEASURES]
    return group(figures, method_key(results, [sample for sample in results.samples if any(
        row["method"] == sample.method for row in shown.rows)])) + _bins_table(shown) + table("calibration-table", "", columns, rows, row_attributes=attributes(shown))
