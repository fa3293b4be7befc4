"""What the CLC paper's section VIII shows, for our methods, and its own numbers beside. As in the paper, histograms
take false-positive rates up to 30 %."""

import numpy as np

from .comparison_figures import box_plot, variants
from .figures import drawn, group, left_out
from .load import CATEGORIES
from .tables import Cell, Column, method_cell, percent, table, text
from .theme import ACCENT, INK, legend, method_colour, method_style, new_figure

MOST_RATE = 0.3 + 1e-9


def _moderate(sample):
    return sample.where(sample.rate <= MOST_RATE)


def _printed(row, key):
    return percent(row[key] / 100)


def _rows_by_rate(results, published, samples, of_paper, of_ours):
    """For each rate of ours or the paper's: the paper's row first, then one of each method."""
    rows, marks = [], []
    printed = {round(row["rate"], 6): row for row in published["clc"]}
    for rate in sorted({round(rate, 6) for rate in results.rates} | set(printed)):
        if rate in printed:
            rows.append([text("CLC paper"), percent(rate)] + of_paper(printed[rate]))
            marks.append(len(rows) - 1)
        for sample in samples:
            part = sample.where(np.abs(sample.rate - rate) < 1e-6)
            if len(part):
                rows.append([method_cell(results.methods, sample.method, sample.label), percent(rate)] + of_ours(part))
    return rows, marks


def success_table(results, published):
    """Table I: all ranges together, as in the paper."""
    keys = CATEGORIES[:-1]
    titles = ("ground truth %", "near %", "too short %", "diverging ≥ 20 m %", "diverging < 20 m %")
    columns = ([Column("method", "text"), Column("false positives %")] + [Column(title) for title in titles] +
               [Column("none %"), Column("success %"), Column("mean IoU %")])

    def of_paper(row):
        return ([_printed(row, key) for key in keys] + [Cell("–"), _printed(row, "success"), _printed(row, "mean_iou")])

    def of_ours(part):
        return ([percent(np.mean(part.category == key)) for key in CATEGORIES] +
                [percent(part.success.mean()), percent(part.iou.mean())])

    rows, marks = _rows_by_rate(results, published, results.samples, of_paper, of_ours)
    return table("clc-table-1", "CLC Table I: what became of the scenes, all ranges together", columns, rows,
                 published_rows=marks)


def complete_table(results, published):
    """Table II."""
    samples = [sample for sample in results.samples if sample.has("complete")]
    if not samples:
        return left_out("clc-table-2", "CLC Table II", "no method enumerates.").html()
    columns = [Column("method", "text"), Column("false positives %"), Column("complete %"),
               Column("best candidate, mean IoU %")]

    def of_ours(part):
        best = part.best_candidate_iou
        known = ~np.isnan(best)
        return [percent(np.mean(part.complete == 1.0)),
                percent(np.where(known, best, 0.0).mean()) if known.any() else Cell("–")]

    rows, marks = _rows_by_rate(results, published, samples, lambda row: [_printed(row, "complete"), Cell("–")],
                                of_ours)
    return table("clc-table-2", "CLC Table II: enumerations that came to their end", columns, rows,
                 published_rows=marks)


def divergence(results):
    """Fig. 9."""
    name, title = "clc-fig-9", "CLC Fig. 9: where lanes diverge"
    samples = [_moderate(sample).known("divergence") for sample in results.samples]
    total = {sample.label: len(_moderate(sample)) for sample in results.samples}
    samples = [sample for sample in samples if len(sample)]
    if not samples:
        return left_out(name, title, "no lane diverges, or no annotated boundary was given.")
    figure, axes = new_figure()
    most = max(sample.divergence.max() for sample in samples)
    bins = np.arange(0.0, most + 5.0, 5.0) if most > 0 else np.array([0.0, 5.0])
    for sample, variant in variants(samples):
        counts, _ = np.histogram(sample.divergence, bins)
        axes.stairs(100 * counts / total[sample.label], bins, label=sample.label, linewidth=1.4,
                    color=method_colour(results.methods, sample.method),
                    linestyle=method_style(results.methods, sample.method, variant)["linestyle"])
    axes.axvline(20, color=ACCENT, linewidth=1)
    axes.set_xlabel("divergence distance [m]")
    axes.set_ylabel("of all scenes [%]")
    legend(axes)
    return drawn(name, title, "Distance along the boundary up to which a diverging lane is right, rates up to 30 %, "
                 "bins of 5 m. Left of the line a divergence is critical.", figure)


def first_candidate(results):
    """Fig. 11."""
    name, title = "clc-fig-11", "CLC Fig. 11: iterations to the first good candidate"
    samples = [_moderate(s) for s in results.samples if s.has("first_near_iteration")]
    samples = [sample for sample in samples if sample.has("first_near_iteration")]
    if not samples:
        return left_out(name, title, "no method kept its candidates.")
    figure, axes = new_figure()
    for sample, variant in variants(samples):
        iterations = np.sort(sample.known("first_near_iteration").first_near_iteration)
        shares = 100 * np.arange(1, len(iterations) + 1) / len(sample)
        places = np.unique(np.linspace(0, len(iterations) - 1, 200).astype(int))
        style = method_style(results.methods, sample.method, variant) | {"marker": ""}
        end = max(iterations[-1], np.nanmax(sample.iterations))  # the curve stays level to the limit
        axes.step([*iterations[places], end], [*shares[places], shares[-1]], where="post", label=sample.label,
                  **style)
    axes.set_xlabel("iterations")
    axes.set_ylabel("scenes with one [%]")
    axes.set_ylim(0, 102)
    axes.set_xlim(left=0)
    legend(axes)
    return drawn(name, title, "Share of scenes, rates up to 30 %, in which a candidate of IoU ≥ 98 % was enumerated "
                 "by then. A plateau below 100 % is what the search does not find within its limit.", figure)


def lengths(results):
    """Fig. 12."""
    name, title = "clc-fig-12", "CLC Fig. 12: lane lengths"
    samples = [_moderate(sample) for sample in results.samples]
    samples = [sample for sample in samples if len(sample)]
    if not samples:
        return left_out(name, title, "there is no scene with a rate up to 30 %.")
    figure, axes = new_figure()
    most = max(max(s.lane_length.max(), s.ground_truth_length.max()) for s in samples)
    bins = np.arange(0.0, most + 5.0, 5.0)
    truth = max(samples, key=len)
    counts, _ = np.histogram(truth.ground_truth_length, bins)
    axes.stairs(100 * counts / len(truth), bins, fill=True, color=INK, alpha=0.16, label="ground truth")
    for sample, variant in variants(samples):
        kept = sample.where(np.isin(sample.category, ("ground_truth", "near_ground_truth", "too_short")))
        counts, _ = np.histogram(kept.lane_length, bins)
        axes.stairs(100 * counts / len(sample), bins, label=sample.label, linewidth=1.4,
                    color=method_colour(results.methods, sample.method),
                    linestyle=method_style(results.methods, sample.method, variant)["linestyle"])
    axes.set_xlabel("length [m]")
    axes.set_ylabel("of all scenes [%]")
    legend(axes)
    return drawn(name, title, "Filled: the ground truth (12a). Lines: lanes that do not diverge (12b). Rates up to "
                 "30 %, bins of 5 m.", figure)


def latency(results, published):
    """Fig. 15."""
    name, title = "clc-fig-15", "CLC Fig. 15: latency of the graph search"
    samples = [sample for sample in results.samples if sample.has("iterations")]
    if not samples:
        return left_out(name, title, "no method enumerates.")
    figure, axes = new_figure(height=1.15 + 0.33 * len(samples))
    box_plot(axes, results, samples)
    for value, label, side in ((published["clc_median_below_ms"], "paper's median below", "right"),
                               (published["clc_max_ms"], "its maximum", "left")):
        axes.axvline(value, color=ACCENT, linewidth=1)
        axes.annotate(label, (value, 1.01), xycoords=("data", "axes fraction"), ha=side, va="bottom", color=ACCENT,
                      fontsize=8)
    return drawn(name, title, "Boxes as above, all rates and ranges. The paper's figures come from an Intel "
                 "i7-12700K.", figure)


def _latency_against(results, samples, column, name, title, xlabel):
    figure, axes = new_figure()
    for sample, variant in variants(samples):
        x = sample.values[column]
        edges = np.linspace(x.min(), x.max() + 1e-9, 11)
        bins = np.digitize(x, edges) - 1
        points = [(x[bins == i].mean(), sample.latency[bins == i].mean(), sample.latency[bins == i].std())
                  for i in range(10) if np.count_nonzero(bins == i) > 1]
        if not points:
            continue
        centre, mean, deviation = np.array(points).T
        axes.errorbar(centre, mean, yerr=(np.minimum(deviation, mean), deviation), elinewidth=0.8, capsize=2,
                      label=sample.label, **method_style(results.methods, sample.method, variant))
    axes.set_xlabel(xlabel)
    axes.set_ylabel("latency [ms]")
    axes.set_ylim(bottom=0)
    legend(axes)
    return drawn(name, title, "Mean and one standard deviation in ten bins of equal width; bins of a single scene "
                 "are left out.", figure)


def latency_by_effort(results):
    """Fig. 16."""
    samples = [sample.known("iterations") for sample in results.samples if sample.has("iterations")]
    title = "CLC Fig. 16: latency by iterations"
    if not samples:
        return [left_out("clc-fig-16", title, "no method enumerates.")]
    return [_latency_against(results, samples, "iterations", "clc-fig-16a", title, "iterations"),
            _latency_against(results, samples, "cones", "clc-fig-16b", "CLC Fig. 16: latency by map points",
                             "points in the map")]


def html(results, published):
    figures = [divergence(results), first_candidate(results), lengths(results), latency(results, published),
               *latency_by_effort(results)]
    return success_table(results, published) + complete_table(results, published) + group(figures)
