"""Quality of the lanes

Claim: Which method finds the lane most often, and how does it bear false positives?
Protocol: every method on the same scenes, each on the cone set it was made for (its own n, or all that is visible). \
Success: a lane that does not leave the track within 20 m. IoU: overlap with the ground truth of all that is visible, \
so a small cone set bounds it. Accurate: the four checks of the RLD paper, against the ground truth of the method's \
own cone set. A method whose name ends in warm carries its last lane along; false positives are drawn anew at every \
pose, which helps it. Intervals are 95 % bootstrap, tracks resampled, as scenes of one track are alike. Failures and \
time-outs stay in every mean.
Source: this project; success and IoU as in the CLC paper, VIII; accurate as in the RLD paper, IV-B.
Command: conelane compare --out RESULTS
"""

import numpy as np

from .. import measures
from ..figures import drawn, group, percent_label, variants
from ..rows import KEYS, attributes, key_cells, part
from ..tables import Column, percent, table
from ..theme import legend, method_style, new_figure, percent_axis


def quality_table(results):
    rows = []
    for row in results.rows:
        scores = part(results, row)
        accurate = scores.known("accurate")
        rows.append(key_cells(results, row) + [
            percent(row["success_share"], interval=measures.mean_interval(scores.success, scores.track),
                    measure="success_share"),
            percent(row["mean_iou"], interval=measures.mean_interval(scores.iou, scores.track), measure="mean_iou"),
            percent(row.get("accurate_share"), interval=measures.mean_interval(accurate.accurate, accurate.track),
                    measure="accurate_share"),
            percent(row.get("solved_share"), measure="solved_share"),
            percent(row.get("complete_share"), measure="complete_share")])
    columns = KEYS + [Column("success %"), Column("mean IoU %"), Column("accurate %"), Column("solved %"),
                      Column("complete %")]
    return table("quality", "", columns, rows, row_attributes=attributes(results),
                 note="Small: 95 % interval. Solved: proven optimal within 0.4 s. Complete: the enumeration came to "
                 "its end.")


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
    percent_axis(axes)
    axes.set_xticks([100 * rate for rate in results.rates], [percent_label(rate) for rate in results.rates])
    legend(axes)
    return figure


def success_figure(results):
    return _by_rate(results, "success [%]", lambda scores: (scores.success, scores.track))


def iou_figure(results):
    return _by_rate(results, "mean IoU [%]", lambda scores: (scores.iou, scores.track))


def accurate_figure(results):
    def values_of(scores):
        scores = scores.known("accurate")
        return scores.accurate, scores.track
    return _by_rate(results, "accurate [%]", values_of)


def html(results, published):
    bars = "Error bars: 95 % intervals, tracks resampled."
    figures = [
        drawn("success-by-rate", f"Share of scenes with a lane that does not diverge within 20 m. {bars}",
              success_figure(results), "Success"),
        drawn("iou-by-rate", f"Against all that is visible: a small cone set bounds it from above. {bars}",
              iou_figure(results), "Overlap")]
    if any(sample.has("accurate") for sample in results.samples):
        figures.append(drawn("accurate-by-rate", "All four checks of the RLD paper hold, against the ground truth of "
                             f"the method's own cone set. {bars}", accurate_figure(results), "Accurate lanes"))
    return group(figures) + quality_table(results)
