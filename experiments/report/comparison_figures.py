"""Figures of the comparison itself: quality by false-positive rate, latency, performance profiles."""

import numpy as np

from . import measures
from .figures import drawn, left_out, percent_label
from .theme import ACCENT, INK, SURFACE, legend, logarithmic, method_colour, method_style, new_figure

REAL_TIME_BUDGET_MS = 50.0


def variants(samples):
    """For each sample, how many of the same method come before it."""
    seen = {}
    for sample in samples:
        seen[sample.method] = seen.get(sample.method, -1) + 1
        yield sample, seen[sample.method]


def _by_rate(results, name, title, what, values_of, caption):
    figure, axes = new_figure()
    drawn_any = False
    for sample, variant in variants(results.samples):
        points = []
        for rate in results.rates:
            part = sample.at(rate)
            values, tracks = values_of(part)
            if len(values):
                mean = values.mean()
                interval = measures.mean_interval(values, tracks) or (mean, mean)
                points.append((100 * rate, 100 * mean, 100 * max(0, mean - interval[0]),
                               100 * max(0, interval[1] - mean)))
        if not points:
            continue
        drawn_any = True
        x, y, below, above = np.array(points).T
        axes.errorbar(x, y, yerr=(below, above), elinewidth=0.8, capsize=2, label=sample.label,
                      **method_style(results.methods, sample.method, variant))
    if not drawn_any:
        return left_out(name, title, "no score has this measure.")
    axes.set_xlabel("false positives [% of all points]")
    axes.set_ylabel(what)
    axes.set_ylim(top=102)
    axes.set_xticks([100 * rate for rate in results.rates], [percent_label(rate) for rate in results.rates])
    legend(axes)
    return drawn(name, title, caption, figure)


def _accurate(part):
    part = part.known("accurate")
    return part.accurate, part.track


def quality_figures(results):
    error_bars = "Error bars: 95 % intervals, tracks resampled."
    return [
        _by_rate(results, "success-by-rate", "Success by false-positive rate", "success [%]",
                 lambda part: (part.success, part.track),
                 f"Share of scenes with a lane that does not diverge within 20 m. {error_bars}"),
        _by_rate(results, "accurate-by-rate", "Accurate lanes by false-positive rate", "accurate [%]", _accurate,
                 f"All four checks of the RLD paper hold, against the ground truth of the method's own cone set. "
                 f"{error_bars}"),
        _by_rate(results, "iou-by-rate", "Overlap by false-positive rate", "mean IoU [%]",
                 lambda part: (part.iou, part.track),
                 f"Against all that is visible: a small cone set bounds it from above. {error_bars}"),
        latency_figure(results),
    ]


def box_plot(axes, results, samples):
    """Latency boxes on a logarithmic axis: quartiles, median, whiskers to the 1st and 99th percentile, maximum."""
    boxes = [{"med": np.median(s.latency), "q1": np.percentile(s.latency, 25), "q3": np.percentile(s.latency, 75),
              "whislo": np.percentile(s.latency, 1), "whishi": np.percentile(s.latency, 99),
              "fliers": [s.latency.max()], "label": s.label} for s in samples]
    places = np.arange(len(boxes), 0, -1)
    shapes = axes.bxp(boxes, positions=places, vert=False, widths=0.5, patch_artist=True,
                      flierprops={"marker": "|", "markersize": 7})
    for i, sample in enumerate(samples):
        colour = method_colour(results.methods, sample.method)
        shapes["boxes"][i].set(facecolor=colour, edgecolor=colour)
        shapes["medians"][i].set(color=SURFACE, linewidth=1.8)
        shapes["fliers"][i].set(markeredgecolor=colour)
        for line in shapes["whiskers"][2 * i:2 * i + 2] + shapes["caps"][2 * i:2 * i + 2]:
            line.set(color=colour)
    axes.set_xscale("log")
    logarithmic(axes.xaxis)
    axes.grid(False, axis="y")
    axes.set_xlabel("latency [ms]")
    axes.tick_params(axis="y", labelcolor=INK)


def latency_figure(results):
    figure, axes = new_figure(height=0.95 + 0.33 * len(results.samples))
    box_plot(axes, results, results.samples)
    axes.axvline(REAL_TIME_BUDGET_MS, color=ACCENT, linewidth=1)
    axes.annotate("50 ms", (REAL_TIME_BUDGET_MS, 1), xycoords=("data", "axes fraction"), xytext=(-3, -1),
                  textcoords="offset points", ha="right", va="top", color=ACCENT, fontsize=8)
    return drawn("latency", "Latency over all scenes",
                 "Quartiles and median; whiskers to the 1st and 99th percentile; the tick is the maximum. "
                 "The line is the real-time budget, the period of a 20 Hz LiDAR.", figure)


def profile_figures(results):
    """A performance profile for each cone-set size on which two methods or more optimise a stated objective."""
    figures = []
    sizes = list(dict.fromkeys(sample.nearest for sample in results.samples if sample.has("solved")))
    for nearest in sizes:
        samples = [s for s in results.samples if s.nearest == nearest and s.has("solved")]
        where = "all that is visible" if nearest is None else f"the {nearest} nearest cones"
        name = f"profile-{nearest or 'all'}"
        title = f"Performance profile on {where}"
        if len(samples) < 2:
            figures.append(left_out(name, title, f"{samples[0].label} alone optimises a stated objective on it."))
            continue
        scenes = sorted(set.intersection(*(set(sample.scene) for sample in samples)))
        if not scenes:
            figures.append(left_out(name, title, "the methods have no scene in common."))
            continue
        columns = []
        for sample in samples:
            solved = np.where(sample.solved == 1.0, sample.latency, np.inf)
            times = dict(zip(sample.scene, solved))
            columns.append([times[scene] for scene in scenes])
        ratios = measures.performance_profiles(np.array(columns).T)
        figure, axes = new_figure()
        finite = ratios[np.isfinite(ratios)]
        most = max(2.0, finite.max() if len(finite) else 2.0)
        places = np.geomspace(1.0, most, 200)
        for i, sample in enumerate(samples):
            shares = np.searchsorted(ratios[:, i], places, side="right") / len(scenes)
            style = method_style(results.methods, sample.method) | {"marker": ""}
            axes.step(places, 100 * shares, where="post", label=sample.label, **style)
        axes.set_xscale("log")
        axes.set_xticks([tick for tick in (1, 2, 5, 10, 20, 50, 100, 200, 500, 1000) if tick <= most])
        logarithmic(axes.xaxis)
        axes.set_xlabel("time / fastest method's time on the same scene")
        axes.set_ylabel("scenes solved [%]")
        axes.set_ylim(-2, 103)
        legend(axes)
        figures.append(drawn(
            name, title, f"Dolan and Moré, {len(scenes)} scenes: share that a method solves to proven optimality "
            "within that multiple of the fastest time. Height at 1: how often it is the fastest.", figure))
    if not figures:
        figures.append(left_out("profile", "Performance profile", "no method states an objective."))
    return figures
