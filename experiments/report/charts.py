"""Figures of the page: curves, rules at given values, boxes; and how figures stand on the page."""

from dataclasses import dataclass, field
from html import escape

import numpy as np

from .measures import REAL_TIME_BUDGET_MS
from .summaries import median, percent_label, quantile
from .theme import (ACCENT, INK, MARKERS, MUTED, SURFACE, legend, logarithmic, method_color, method_style, new_figure, pyplot, series_style,
                    svg_of)

THIN = {"linewidth": 0.8, "markersize": 2.5, "alpha": 0.75}
TOP_SHARE = {"marker": "*", "markersize": 11, "linestyle": "", "color": ACCENT}  # of a paper's figures


@dataclass
class Curve:
    """`points`: (x, y) or, with error bars, (x, y, below, above). `draw`: a line, "steps", "bins", of which x are the edges,
    or "filled" ones."""

    label: str
    points: object
    style: dict = field(default_factory=dict)
    draw: str = "line"

    def on(self, axes):
        if self.draw in ("bins", "filled"):
            edges, counts = self.points
            look = {key: value for key, value in self.style.items() if key != "marker"} | {"linewidth": 1.4}
            axes.stairs(counts, edges, label=self.label, **{"fill": True, **self.style} if self.draw == "filled" else look)
            return
        x, y, *error = np.array(self.points, dtype=float).T
        if self.draw == "steps":
            axes.step(x, y, where="post", label=self.label, **self.style | {"marker": ""})
        elif error:
            axes.errorbar(x, y, yerr=error, elinewidth=0.8, capsize=2, label=self.label, **self.style)
        else:
            axes.plot(x, y, label=self.label or None, **self.style)


def variants(samples):
    """For each sample, how many of the same method come before it."""
    seen = {}
    for sample in samples:
        seen[sample.method] = seen.get(sample.method, -1) + 1
        yield sample, seen[sample.method]


def method_curves(results, samples, points, draw="line", style=None):
    """A curve of each sample for which `points` finds some. `style` is added to that of the method."""
    found = [(sample, variant, points(sample)) for sample, variant in variants(samples)]
    return [Curve("" if style == THIN else sample.label, of_sample, method_style(results.methods, sample.method, variant) | (style or {}), draw)
            for sample, variant, of_sample in found if len(of_sample)]


def series(curves, draw="line", markers=MARKERS):
    """Curves that are not of methods, of (label, points)."""
    return [Curve(label, points, series_style(index) | ({"marker": markers[index % len(markers)]} if draw == "line" else {}), draw)
            for index, (label, points) in enumerate(curves)]


def with_interval(x, mean, interval):
    """A point in per cent, with its error bar."""
    low, high = interval or (mean, mean)
    return (x, 100 * mean, 100 * max(0, mean - low), 100 * max(0, high - mean))


def histogram(values, of, bins):
    """Points of a curve of bins: per cent of so many scenes."""
    return bins, 100 * np.histogram(values, bins)[0] / of


def rule(axes, value, label="", upright=True, side="right", color=ACCENT, dashes="-"):
    """A line at a value, its label at its upper end or above its beginning."""
    (axes.axvline if upright else axes.axhline)(value, color=color, linewidth=1, linestyle=dashes)
    if upright:
        axes.annotate(label, (value, 1.01), xycoords=("data", "axes fraction"), ha=side, va="bottom", color=color, fontsize=8)
    else:
        axes.annotate(label, (0.01, value), xycoords=("axes fraction", "data"), xytext=(0, 3), textcoords="offset points", color=color, fontsize=8)


def time_rules(axes, upright, limit_ms=np.inf, samples=()):
    """The real-time budget, and the time limit where it ended an answer."""
    rule(axes, REAL_TIME_BUDGET_MS, f"{REAL_TIME_BUDGET_MS:g} ms", upright)
    if np.isfinite(limit_ms) and any(sample.latency.max() >= limit_ms for sample in samples):
        rule(axes, limit_ms, f"limit {limit_ms:g} ms", upright, "left", MUTED, ":")


def chart(curves, xlabel, ylabel, height=2.9, log="", rates=(), scale=None, key=legend, **limits):
    """`log`: axes that are logarithmic. `rates`: ticks in per cent. `scale`: percent_axis or leaders_axis. `key`: the legend.
    `limits`: xlim, ylim."""
    figure, axes = new_figure(height)
    for curve in curves:
        curve.on(axes)
    axes.set(xlabel=xlabel, ylabel=ylabel, **limits, **{f"{axis}scale": "log" for axis in log})
    for axis in log:
        logarithmic(getattr(axes, f"{axis}axis"))
    if scale:
        scale(axes)
    if len(rates):
        axes.set_xticks([100 * rate for rate in rates], [percent_label(rate) for rate in rates])
    key(axes)
    return figure, axes


FALSE_POSITIVES = "false positives [% of all points]"


def by_rate(curves, ylabel, rates, **options):
    return chart(curves, FALSE_POSITIVES, ylabel, rates=rates, **options)


def box_plot(results, samples, height):
    """On a logarithmic axis: quartiles, median, whiskers to the 1st and 99th percentile, maximum."""
    figure, axes = new_figure(height + 0.33 * len(samples))
    ends = {"whislo": 0.01, "q1": 0.25, "q3": 0.75, "whishi": 0.99}
    boxes = [{key: quantile(s.latency, share) for key, share in ends.items()} |
             {"med": median(s.latency), "fliers": [s.latency.max()], "label": s.label} for s in samples]
    shapes = axes.bxp(boxes, positions=np.arange(len(boxes), 0, -1), vert=False, widths=0.5, patch_artist=True,
                      flierprops={"marker": "|", "markersize": 7})
    for i, sample in enumerate(samples):
        color = method_color(results.methods, sample.method)
        shapes["boxes"][i].set(facecolor=color, edgecolor=color)
        shapes["medians"][i].set(color=SURFACE, linewidth=1.8)
        shapes["fliers"][i].set(markeredgecolor=color)
        for line in shapes["whiskers"][2 * i:2 * i + 2] + shapes["caps"][2 * i:2 * i + 2]:
            line.set(color=color)
    axes.set(xscale="log", xlabel="latency [ms]")
    logarithmic(axes.xaxis)
    axes.grid(False, axis="y")
    axes.tick_params(axis="y", labelcolor=INK)
    return figure, axes


def drawn(name, caption, figure, title="", condition=""):
    """A figure with its caption; `title` where it does not stand alone below an experiment's, `condition` where it is
    of one of several."""
    head = f"<h4>{escape(title)}</h4>" if title else ""
    of_condition = f' data-condition="{escape(condition)}"' if condition else ""
    return (f'<figure id="{name}"{of_condition}>{head}<div class="plot" role="img" aria-label="{escape(title or name)}. '
            f'{escape(caption)}">{svg_of(figure[0], name)}</div><figcaption>{escape(caption)}</figcaption></figure>')


def method_key(results, samples, name):
    """The legend of the methods' curves, once for all figures below it."""
    entries = []
    for number, (sample, variant) in enumerate(variants(samples)):
        style = method_style(results.methods, sample.method, variant) | {"gid": None, "markevery": [1]}
        figure = pyplot.figure(figsize=(0.42, 0.17))
        figure.add_artist(pyplot.Line2D([0, 0.5, 1], [0.5, 0.5, 0.5], **style))
        entries.append(f'<span class="key">{svg_of(figure, f"{name}-key-{number}").strip()}{escape(sample.label)}</span>')
    return f'<p class="method-key">{" ".join(entries)}</p>'


def group(figures, key=""):
    """Side by side where there is room, below a `key` that serves them all."""
    return f'{key}<div class="figures">{"".join(figures)}</div>' if figures else ""


def counts_of_points(results, samples):
    """How many scenes a point of a curve by rate has: n = 115 scenes a point."""
    counts = sorted({len(sample.at(rate)) for sample in samples for rate in results.rates} - {0})
    between = f"{counts[0]} to {counts[-1]}" if len(counts) > 1 else f"{counts[0]}" if counts else "0"
    return f"n = {between} scenes a point."


def in_condition(results):
    """What a caption adds where a figure takes one of several conditions."""
    return f" Condition {results.main_condition} alone." if len(results.conditions) > 1 else ""
