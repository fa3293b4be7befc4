"""The comparison itself: quality, certainty, time and failures of all methods."""

import dataclasses

import numpy as np

from ..charts import (THIN, Curve, box_plot, by_rate, chart, counts_of_points, drawn, group, in_condition, method_curves, method_key, time_rules,
                      with_interval)
from ..experiment import Experiment
from ..load import CATEGORIES, CAUSES, Missing
from ..measures import headline_measure, median_interval, share_and_interval
from ..rows import CATEGORY_NOTE, condition_column, note_on_limit, note_on_training, part, rows_table
from ..summaries import median, quantile
from ..tables import Column, column, count, degrees, fixed, method_cell, method_column, milliseconds, percent, table, text
from ..theme import MUTED, leaders_axis, method_color, method_legend, method_style


def by_rate_figure(results, what, name):
    """A measure by rate of false positives, with 95 % intervals."""
    def points(sample):
        shares = [(rate, *share_and_interval(sample.at(rate), name)) for rate in results.rates]
        return [with_interval(100 * rate, share, interval) for rate, share, interval in shares if share is not None]
    return by_rate(method_curves(results, results.samples, points), what, results.rates, scale=leaders_axis, key=method_legend)


_QUALITY = (("usable", "usable_share", "usable %"), ("success", "success_share", "success %"), ("iou", "mean_iou", "mean IoU %"),
            ("accurate", "accurate_share", "accurate %"))


@Experiment
def quality(results, published):
    """Quality of the lanes
    Claim: Which method finds a usable lane most often, and how does this depend on false positives?
    Protocol: every method on the same scenes, each on the cone set it was made for (its own n, or all that is visible).
    Usable: a lane that does not leave the track within 20 m; if it never leaves it, it must be at least 20 m or 75 % of the
    ground truth long. Success: it does not leave the track within 20 m, as in the CLC paper. IoU: overlap with the ground truth
    of all that is visible, so a small cone set limits it. Accurate: the four checks of the RLD paper, against the ground truth
    of the method's own cone set. A method whose name ends in warm keeps its last lane; this helps it if false positives are new
    at every pose, as in condition paper. Intervals are 95 % bootstrap, tracks resampled, because scenes of one track are
    similar. Failures and time-outs count in every mean.
    Source: usable is this project's; success and IoU as in the CLC paper, VIII; accurate as in the RLD paper, IV-B.
    Command: conelane compare --out RESULTS"""
    under, alone = results.under(results.main_condition), in_condition(results)
    bars = ("Error bars: 95 % intervals, tracks resampled. The axis is stretched towards 100 %. "
            + counts_of_points(under, under.samples))
    figures = []
    for condition in results.conditions:
        of_condition = results.under(condition)
        if any(sample.has("usable") for sample in of_condition.samples):
            name, title = (f"-{condition}", f", condition {condition}") if condition else ("", "")
            figures.append(drawn(f"usable-by-rate{name}", f"High and level curves are good. Share of scenes with a usable lane, by the share of "
                                 f"false positives. {bars}", by_rate_figure(of_condition, "usable [%]", "usable"), f"Usable lanes{title}",
                                 condition if len(results.conditions) > 1 else ""))
    for name, title, what, caption in (
            ("success", "Success", "success [%]",
             "High and level curves are good. Share of scenes whose lane does not diverge within 20 m, also if it is short."),
            ("iou", "Overlap", "mean IoU [%]",
             "High is good, compared with everything visible, so a method with a small cone set stays low."),
            ("accurate", "Accurate lanes", "accurate [%]",
             "High is good: all four checks of the RLD paper pass, compared with the ground truth of the method's own cone set.")):
        if name == "success" or any(sample.has(name) for sample in under.samples):
            figures.append(drawn(f"{name}-by-rate", f"{caption} {bars}{alone}", by_rate_figure(under, what, name), title))
    columns = [
        column(title, percent, key, interval=lambda row, name=name: share_and_interval(part(results, row), name)[1])
        for name, key, title in _QUALITY] + [column("solved %", percent, "solved_share"), column("complete %", percent, "complete_share")]
    return group(figures, method_key(results, results.samples, "quality")) + rows_table(
        "quality", results, columns, "Small: 95 % interval. Solved: within 0.4 s proven optimal, or proven to have no lane. Complete: the enumeration came to "
             f"its end.{note_on_training(results)}")


@Experiment
def steering(results, published):
    """Centre line and steadiness
    Claim: How near is the centre line of a usable lane to the true one, and how steady is it from pose to pose?
    Protocol: centre lines of usable lanes compared with the ground truth's over the first 20 m: distance at every half metre,
    heading at 10 m. Unsteady: share of poses whose centre line differs by more than 0.5 m anywhere over the first 15 m
    from that of the pose before; a pose without a lane counts as unsteady.
    Source: this project.
    Command: conelane compare --out RESULTS"""
    if not any("lateral_median_m" in row or "unsteady_share" in row for row in results.rows):
        raise Missing("no lane was compared with a true centre line.")
    return rows_table("steering", results, [
        column("usable %", percent, lambda row: row.get("usable_share")),
        column("lateral median m", fixed, "lateral_median_m", digits=2), column("lateral p95 m", fixed, "lateral_p95_m", digits=2),
        column("heading median °", degrees, "heading_median_rad"), column("heading p95 °", degrees, "heading_p95_rad"),
        column("unsteady %", percent, "unsteady_share")])


def _bins(rows):
    """{confidence, usable, lanes} of the bins of several rows together."""
    sums = {}
    for row in rows:
        for lanes, confidence, usable in row["calibration"].get("bins", ()):
            found = sums.setdefault(min(int(10 * confidence), 9), np.zeros(3))
            found += (lanes, lanes * confidence, lanes * usable)
    return [{"lanes": int(lanes), "confidence": confidence / lanes, "usable": usable / lanes}
            for _, (lanes, confidence, usable) in sorted(sums.items())]


def _calibration_figure(shown, condition, bins):
    curves = [Curve("", [(0, 0), (1, 1)], {"color": MUTED, "linewidth": 0.8, "linestyle": ":"})] + [
        Curve(method, [(one["confidence"], one["usable"]) for one in of_method], method_style(shown.methods, method))
        for method, of_method in bins.items() if of_method]
    figure, axes = chart(curves, "confidence", "share usable", key=method_legend)
    for method, of_method in bins.items():
        for one in of_method:
            axes.annotate(str(one["lanes"]), (one["confidence"], one["usable"]), xytext=(4, -9 if shown.methods.index(method) % 2 else 4),
                          textcoords="offset points", fontsize=6, color=method_color(shown.methods, method))
    return drawn(f"calibration-{condition}" if condition else "calibration",
                 "Near the dotted line, the confidence is right; above it, the method is better than its confidence. "
                 "Numbers: lanes at a point.", (figure, axes), title=f"Confidence, condition {condition}" if condition else "",
                 condition=condition)


@Experiment
def calibration(results, published):
    """Confidence and trusted length
    Claim: Does a method know when its lane is wrong, and how far it is right?
    Protocol: the share of usable lanes among lanes with about the same confidence, in bins of 0.1, all rates and ranges
    together; on the dotted line, share and confidence are equal. Error: mean over the lanes of the distance from that line. Sure:
    confidence of 0.99 or more. Right where trusted: the lane does not leave the true boundaries within its trusted length;
    trusted: these lengths together, as a share of the lanes' lengths.
    Source: this project.
    Command: conelane compare --out RESULTS"""
    shown = dataclasses.replace(results, rows=[row for row in results.rows if row.get("calibration")])
    if not shown.rows:
        raise Missing("no method says how sure it is.")
    methods = list(dict.fromkeys(row["method"] for row in shown.rows))
    figures, bins = [], []
    for condition in shown.conditions:
        of_condition = {method: _bins(row for row in shown.rows if (row["method"], row.get("condition", "")) == (method, condition))
                        for method in methods}
        bins += [{"method": method, "condition": condition} | one for method, found in of_condition.items() for one in found]
        if any(of_condition.values()):
            figures.append(_calibration_figure(shown, condition, of_condition))
    of_bins = table("calibration-bins", [
        Column("method", lambda row: method_cell(shown, row["method"]), "text"), *condition_column(shown),
        column("mean confidence %", percent, lambda row: row["confidence"]), column("usable %", percent, lambda row: row["usable"]),
        column("lanes", count, lambda row: row["lanes"])], bins, caption="Lanes of about the same confidence, all rates and ranges together",
        attributes=lambda row: {"method": row["method"], "condition": row["condition"]}) if bins else ""
    columns = [column("lanes", count, lambda row: sum(found for found, _, _ in row["calibration"].get("bins", ())) or None)] + [
        column(title, percent, lambda row, key=key: row["calibration"].get(key), digits=2) for key, title in (
            ("error", "confidence error %"), ("sure_share", "sure %"), ("usable_where_sure_share", "usable where sure %"),
            ("trusted_share", "trusted %"), ("right_where_trusted_share", "right where trusted %"))]
    return group(figures, method_key(results, [sample for sample in results.samples if sample.method in methods], "calibration")) + of_bins + rows_table(
        "calibration-table", shown, columns)


def latency_figure(results):
    """Median and 99th percentile by rate of false positives."""
    def points(of):
        return lambda sample: [(100 * rate, of(sample.at(rate).latency)) for rate in results.rates if len(sample.at(rate))]
    figure = by_rate(method_curves(results, results.samples, points(median)) +
                     method_curves(results, results.samples, points(lambda latency: quantile(latency, 0.99)), style=THIN),
                     "latency [ms], thin: p99", results.rates, height=3.1, log="y", key=method_legend)
    time_rules(figure[1], False, results.time_limit_ms, results.samples)
    return figure


@Experiment
def latency(results, published):
    """Latency
    Claim: Which method answers in time, at the median and in the tail?
    Protocol: from the scene in memory to the lane in memory, the building of any model included; one thread, pinned to
    one processor; one untimed call before each lap. A run at its time limit counts with the time it took. The real-time
    budget is 50 ms, the period of a 20 Hz LiDAR.
    Source: this project.
    Command: conelane compare --out RESULTS"""
    under, alone = results.under(results.main_condition), in_condition(results)
    boxes = box_plot(under, under.samples, 0.95)
    time_rules(boxes[1], True, results.time_limit_ms, under.samples)

    def time(title, key, limit_ms=np.inf):
        return column(title, milliseconds, lambda row: row["latency_ms"].get(key), measure=key, limit_ms=limit_ms)
    columns = [column("median ms", milliseconds, lambda row: row["latency_ms"]["median"], measure="median",
                                      interval=lambda row: median_interval(part(results, row).latency, part(results, row).track))] + [
        time(title, key) for title, key in (("mean ms", "mean"), ("standard deviation ms", "standard_deviation"),
                                            ("geometric mean ms", "shifted_geometric_mean"))] + [
        time(f"{key} ms", key, results.time_limit_ms) for key in ("p95", "p99", "max")] + [
        column("within 50 ms %", percent, "within_budget_share")]
    return group([
        drawn("latency-by-rate", "Below the line, a method answers in time. Strong curves: the median. Thin curves: the 99th percentile, the slowest "
              f"answers. {counts_of_points(under, under.samples)}{alone}", latency_figure(under), "Latency by false-positive rate"),
        drawn("latency", "A tick (the maximum) right of the line: at least one answer was too late for real time. Boxes: quartiles and "
              f"median; whiskers to the 1st and 99th percentile.{alone}", boxes, "Latency over all rates and ranges")
    ], method_key(results, under.samples, "latencies")) + rows_table(
        "latencies", results, columns, f"Geometric mean: shifted by 1 ms. Small: 95 % interval, tracks resampled.{note_on_limit(results)}")


@Experiment
def outcomes(results, published):
    """Outcomes of the scenes
    Claim: How do methods fail, not only how often?
    Protocol: the first category that fits: no lane, ground truth (exactly the same cones), diverging, too short (below 75 % of
    the ground truth's length), near (all other lanes, which do not diverge). All but none and diverging below 20 m are
    successes. Errors, a part of none: the method failed, or the independent checker rejected the answer of an RLD
    method; the checker recomputes every constraint, objective and bound from the scene.
    Source: categories of the CLC paper, VIII-D; the checker is this project's.
    Command: conelane compare --out RESULTS"""
    return rows_table("categories", results, [
        column(title, percent, lambda row, key=key: row["share"].get(key), measure=key) for key, title in CATEGORY_TITLES.items()] + [
        column("errors", count, lambda row: int(np.sum(part(results, row).status == "error"))),
        column("checker accepts", count, lambda row: int(np.nansum(part(results, row).checked)) or None)], CATEGORY_NOTE)


CATEGORY_TITLES = dict(zip(CATEGORIES, ("ground truth %", "near %", "too short %", "diverging ≥ 20 m %", "diverging < 20 m %", "none %")))


@Experiment
def by_track(results, published):
    """Usable lanes by track
    Claim: How much does the share of usable lanes depend on the track?
    Protocol: share of usable lanes (success in results of earlier versions), all rates and ranges of a track together.
    Source: this project.
    Command: conelane compare --out RESULTS"""
    name = headline_measure(results.samples)
    trained = {sample.label: set(sample.track[sample.trained_on == 1.0]) for sample in results.samples}
    rows = []
    for condition in results.conditions:
        parts = {sample.label: sample.at(condition=condition).measured(name) for sample in results.samples}
        for track in sorted(set().union(*(set(sample.track) for sample in results.samples))):
            values = {label: found for label, (of_method, known) in parts.items() if len(found := known[of_method.track == track])}
            if values:
                rows.append({"track": track, "condition": condition, "scenes": max(map(len, values.values()))} |
                            {label: float(found.mean()) for label, found in values.items()})
    return table("by-track", [column("track", text, lambda row: row["track"]), *condition_column(results),
                              column("scenes", count, lambda row: row["scenes"])] + [
        column(f"{label} %", percent, lambda row, label=label: row.get(label),
               extra=lambda row, known=known: "trained" if row["track"] in known else "") for label, known in trained.items()],
        rows, attributes=lambda row: {"condition": row["condition"]},
        note="Trained: the method has learned from this course: no held-out figure." if any(trained.values()) else "")


_KINDS = {"exec": "program", "lanes": "lanes file", "solver": "RLD by a solver"}


@Experiment
def outside(results, published):
    """Methods from outside
    Claim: Which of these methods are not this project's, and how do their authors describe them?
    Protocol: a program answers scene by scene through a pipe; its latency is the whole round trip.
    Self-timed: the time that the method itself reports. All latencies of a finished lanes file are self-timed. The other columns are from the method's own card.
    Source: this project; the cards are their authors'.
    Command: conelane compare --methods exec:NAME=COMMAND,lanes:NAME=FILE --out RESULTS"""
    rows = list({row["method"]: row for row in reversed(results.rows) if "outside" in row}.values())[::-1]
    if not rows:
        raise Missing("no method from outside took part.")

    def of_card(title, key, show=str):
        return column(title, text, lambda row: show(row["card"][key]) if row.get("card", {}).get(key) is not None else None)

    def time(title, of, key):
        return column(title, milliseconds, lambda row: row[of].get(key) if isinstance(row.get(of), dict) else None)

    def yes_or_no(value):
        return "yes" if value else "no"
    return table("outside", [
        Column("method", lambda row: method_cell(results, row["method"]), "text"),
        column("kind", text, lambda row: _KINDS.get(row["outside"], str(row["outside"]))),
        *(of_card(key, key) for key in ("name", "address", "licence")), of_card("uses colour", "colour_used", yes_or_no),
        of_card("uses history", "history_used", yes_or_no),
        of_card("trained on", "training_courses", lambda courses: ", ".join(map(str, courses)) or "none"),
        time("self-timed median ms", "self_timed_ms", "median"), time("self-timed p95 ms", "self_timed_ms", "p95")], rows, note="Times: of the first condition, rate and range of each.")


@Experiment
def failure_causes(results, published):
    """Why lanes are not usable
    Claim: What is the first error in lanes that are not usable?
    Protocol: every lane that is not usable, all rates and ranges together, by the first place where it leaves the truth.
    If a lane diverges within 20 m, this place is its first vertex off the annotated boundary. Wrong start: the first vertex
    of its side. False cone taken: a cone on no boundary of the course. Wrong leg: a cone of another stretch of the course.
    Wrong side: a cone of the opposite boundary of this stretch. Cone skipped: a later cone of its own boundary, so cones
    before it were left out. A lane that is too short stopped early, or before a gap, a step longer than one and a half times the
    median step of the ground truth; it has a wrong start if most of the missing length is before it. Leaves the path:
    only a driven path, or a centre line without boundaries, is known, which does not show the cause.
    Source: this project.
    Command: conelane compare --out RESULTS"""
    seen = [cause for cause in CAUSES if any(np.any(sample.cause == cause) for sample in results.samples)]
    if not seen:
        raise Missing("no score names a cause.")
    parts = [part for condition in results.conditions for sample in results.samples
             if len(part := sample.at(condition=condition).known("usable"))]

    def wrong(part):
        return int(np.sum(part.usable == 0.0))

    def caused(part, cause):
        return int(np.sum(part.cause == cause))
    return table("failure-causes", [
        method_column(results), *condition_column(results, lambda part: part.condition[0]), column("scenes", count, len),
        column("not usable", count, wrong), column("of all scenes %", percent, lambda part: wrong(part) / len(part), measure="not_usable")] + [
        column(f"{CAUSES[cause]} %", percent, lambda part, cause=cause: caused(part, cause) / wrong(part) if wrong(part) else None,
               measure=cause, extra=lambda part, cause=cause: str(caused(part, cause) or "")) for cause in seen],
        parts, attributes=lambda part: {"method": part.label, "condition": part.condition[0]},
        note="Causes in per cent of the scenes that are not usable; small: their number.")
