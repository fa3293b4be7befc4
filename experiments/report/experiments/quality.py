"""Quality of the lanes

Claim: Which method finds a usable lane most often, and how does this depend on false positives?
Protocol: every method on the same scenes, each on the cone set it was made for (its own n, or all that is visible). \
Usable: a lane that does not leave the track within 20 m; if it never leaves it, it must be at least 20 m or 75 % of the \
ground truth long. Success: it does not leave the track within 20 m, as in the CLC paper. IoU: overlap with the ground truth of all that is visible, \
so a small cone set limits it. Accurate: the four checks of the RLD paper, against the ground truth of the method's \
own cone set. A method whose name ends in warm keeps its last lane; this helps it if false positives are new at \
every pose, as in condition paper. Intervals are 95 % bootstrap, tracks resampled, because scenes of one track are similar. Failures and \
time-outs count in every mean.
Source: usable is this project's; success and IoU as in the CLC paper, VIII; accurate as in the RLD paper, IV-B.
Command: conelane compare --out RESULTS
"""

import numpy as np

from .. import measures
from ..figures import counts_of_points, drawn, group, in_condition, method_key, percent_label, variants
from ..rows import attributes, key_cells, keys, note_on_training, part
from ..tables import Column, percent, table
from ..theme import leaders_axis, method_legend, method_style, new_figure


def quality_table(results):
    rows = []
    for row in results.rows:
        scores = part(results, row)
        accurate, usable, overlap = (scores.known(name) for name in ("accurate", "usable", "iou"))
        rows.append(key_cells(results, row) + [
            percent(row.get("usable_share"), interval=measures.mean_interval(usable.usable, usable.track),
                    measure="usable_share"),
            percent(row["success_share"], interval=measures.mean_interval(scores.success, scores.track),
                    measure="success_share"),
            percent(row.get("mean_iou"), interval=measures.mean_interval(overlap.iou, overlap.track),
                    measure="mean_iou"),
            percent(row.get("accurate_share"), interval=measures.mean_interval(accurate.accurate, accurate.track),
                    measure="accurate_share"),
            percent(row.get("solved_share"), measure="solved_share"),
            percent(row.get("complete_share"), measure="complete_share")])
    columns = keys(results) + [Column("usable %"), Column("success %"), Column("mean IoU %"), Column("accurate %"), Column("solved %"),
                               Column("complete %")]
    return table("quality", "", columns, rows, row_attributes=attributes(results),
                 note="Small: 95 % interval. Solved: within 0.4 s proven optimal, or proven to have no lane. Complete: the enumeration came to "
                 f"its end.{note_on_training(results)}")


def _by_rate(results, what, values_of):
    """None where no score has the measure."""
    figure, axes = new_figure()
    for sample, variant in variants(results.samples):
        points = []
        for rate in results.rates:
            values, tracks = values_of(sample.at(rate))
            if len(values):
                mean = values.mean()
                interval = measures.mean_interval(values, tracks) or (mean, mean)
                points.append((100 * rate, 100 * mean, 100 * max(0, mean - interval[0]),
                               100 * max(0, interval[1] - mean)))
        if points:
            x, y, below, above = np.array(points).T
            axes.errorbar(x, y, yerr=(below, above), elinewidth=0.8, capsize=2, label=sample.label,
                          **method_style(results.methods, sample.method, variant))
    axes.set_xlabel("false positives [% of all points]")
    axes.set_ylabel(what)
    leaders_axis(axes)
    axes.set_xticks([100 * rate for rate in results.rates], [percent_label(rate) for rate in results.rates])
    method_legend(axes)
    return figure


def _known(name):
    def values_of(scores):
        scores = scores.known(name)
        return scores.values[name], scores.track
    return values_of


def usable_figure(results):
    return _by_rate(results, "usable [%]", _known("usable"))


def success_figure(results):
    return _by_rate(results, "success [%]", lambda scores: (scores.success, scores.track))


def iou_figure(results):
    return _by_rate(results, "mean IoU [%]", _known("iou"))


def accurate_figure(results):
    return _by_rate(results, "accurate [%]", _known("accurate"))


def html(results, published):
    bars = ("Error bars: 95 % intervals, tracks resampled. The axis is stretched towards 100 %. "
            + counts_of_points(results.under(results.main_condition), results.under(results.main_condition).samples))
    figures = []
    for condition in results.conditions:
        under = results.under(condition)
        if any(sample.has("usable") for sample in under.samples):
            name, title = (f"-{condition}", f", condition {condition}") if condition else ("", "")
            figures.append(drawn(f"usable-by-rate{name}", f"High and level curves are good. Share of scenes with a usable lane, by the share of "
                                 f"false positives. {bars}",
                                 usable_figure(under), f"Usable lanes{title}",
                                 condition if len(results.conditions) > 1 else ""))
    under, alone = results.under(results.main_condition), in_condition(results)
    figures.append(drawn("success-by-rate", "High and level curves are good. Share of scenes whose lane does not diverge within 20 m, "
                         f"also if it is short. {bars}"
                         f"{alone}", success_figure(under), "Success"))
    if any(sample.has("iou") for sample in under.samples):
        figures.append(drawn("iou-by-rate", "High is good, compared with everything visible, so a method with a small cone set stays low. "
                             f"{bars}{alone}", iou_figure(under), "Overlap"))
    if any(sample.has("accurate") for sample in under.samples):
        figures.append(drawn("accurate-by-rate", "High is good: all four checks of the RLD paper pass, compared with the ground "
                             f"truth of the method's own cone set. {bars}{alone}", accurate_figure(under), "Accurate lanes"))
    return group(figures, method_key(results, results.samples)) + quality_table(results)
