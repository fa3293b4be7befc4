"""Speed on the same cones, and races driven with the answers."""

import os
from html import escape

import numpy as np

from .. import measures
from ..charts import THIN, Curve, chart, drawn, group, series, time_rules, with_interval
from ..experiment import Experiment
from ..load import Missing
from ..records import NUMBER, TEXT, WHOLE, YES_OR_NO, InputError, read_json, read_lines, require_all
from ..replay import player
from ..summaries import median, percent_label, quantile, race_measures
from ..tables import Cell, Column, column, count, fixed, method_cell, milliseconds, percent, table, text
from ..theme import method_style, percent_axis

_MEASURES = {"accurate": "accurate", "solved": "proven", "usable": "usable"}  # few cones end before a lane is usable


def of_methods(results):
    """The samples of the sweep by method."""
    if not results.sweep:
        raise Missing("there is no sweep over cone-set sizes.")
    return {method: [sample for sample in results.sweep if sample.method == method]
            for method in dict.fromkeys(sample.method for sample in results.sweep)}


def by_size(results, points, ylabel, more=(), **options):
    """A curve of each method by cone-set size for each (point of a sample or None, style), and `more` curves."""
    curves = [Curve("" if one == THIN else method, of_method, method_style(results.methods, method) | one)
              for points, one in points for method, samples in of_methods(results).items()
              if (of_method := [point for point in map(points, samples) if point])]
    return chart(curves + list(more), "cones in the set, n", ylabel, **options)


def growth_figure(results):
    """Median and 99th percentile of latency by cone-set size."""
    figure = by_size(results, [(lambda sample: (sample.nearest, median(sample.latency)), {}),
                               (lambda sample: (sample.nearest, quantile(sample.latency, 0.99)), THIN)],
                     "latency [ms], thin: p99", height=3.1, log="y")
    time_rules(figure[1], False)
    return figure


@Experiment
def same_cone_set(results, published):
    """The same cone set for all
    Claim: Which method is ahead at which cone-set size, and how does its time grow?
    Protocol: every method on the n nearest cones ahead, the same scenes at every size. If several names are listed, zero
    is within the 95 % interval of the paired difference from the best (tracks resampled). Fastest: least geometric mean.
    Source: this project; the sizes are those of the RLD paper's Fig. 5 and beyond.
    Command: conelane compare --by-size --out RESULTS/sweep"""
    def share(name):
        def point(sample):
            mean, interval = measures.share_and_interval(sample, name)
            return None if mean is None else with_interval(sample.nearest, mean, interval)
        return point
    figures = [drawn("growth", "A level curve: more cones cost no time. Strong curves: the median. Thin curves: the 99th percentile.",
                     growth_figure(results), "Latency")]
    figures += [drawn(f"{name}-by-size", "High is good, and where a curve is level, more cones do not help. Error bars: 95 % intervals, tracks "
                      "resampled.", by_size(results, [(share(name), {})], f"{words} [%]", height=3.1, scale=percent_axis), words.capitalize())
                for name, words in _MEASURES.items() if any(sample.has(name) for sample in results.sweep)]
    rows = []
    for size in sorted({sample.nearest for sample in results.sweep}):
        samples = [sample for sample in results.sweep if sample.nearest == size]
        rows.append({"size": size, "samples": samples, "fastest": measures.fastest_of(samples)})

    def ahead(name):
        def cell(row):
            share, level = measures.leaders_of(row["samples"], name) or (None, [])
            return text(", ".join(sorted(sample.method for sample in level)) or "–", extra=f"{100 * share:.1f} %" if level else "")
        return cell
    rates = ", ".join(percent_label(rate) for rate in sorted({rate for sample in results.sweep for rate in sample.rate}))
    return group(figures) + table("by-size", [
        column("cones n", count, lambda row: row["size"]),
        *(Column(f"most often {words}", ahead(name), "text") for name, words in _MEASURES.items()),
        Column("fastest", lambda row: method_cell(results, row["fastest"].method), "text"),
        column("its median ms", milliseconds, lambda row: median(row["fastest"].latency)),
        column("scenes", count, lambda row: max(map(len, row["samples"])))], rows, note=f"{rates} % false positives.")


def ratio(title, of):
    """A column of what measures.latency_ratio gave."""
    return column(title, fixed, lambda row: of(row)[0], digits=2, interval=lambda row: of(row)[1])


@Experiment
def paired_latency(results, published):
    """Paired latencies
    Claim: By what factor do methods of the same cone set differ in time on the same scene?
    Protocol: geometric mean over scenes of a method's time divided by that of the method with the least
    geometric mean on the same cone set, of the comparison and of the sweep; 2.00 is twice the time. 95 % bootstrap
    interval, tracks resampled.
    Source: this project.
    Command: conelane compare --methods rld-cbc,rld-paper --out RESULTS"""
    of_set = {}  # by cone-set size: of the comparison, then of the sweep where that has no two
    for sample in results.samples:
        of_set.setdefault(sample.nearest, []).append(sample)
    of_set = {nearest: samples for nearest, samples in of_set.items() if len(samples) > 1}
    for size in sorted({sample.nearest for sample in results.sweep} - set(of_set)):
        of_set[size] = [sample for sample in results.sweep if sample.nearest == size]
    rows = []
    for samples in of_set.values():
        fastest = measures.fastest_of(samples)
        rows += [{"sample": sample, "fastest": fastest, "ratio": found} for sample in samples
                 if sample is not fastest and (found := measures.latency_ratio(sample, fastest))]
    if not rows:
        raise Missing("no two methods saw the same cone sets.")
    return table("ratios", [
        Column("method", lambda row: method_cell(results, row["sample"].method, row["sample"].label), "text"),
        column("against", text, lambda row: row["fastest"].label), ratio("time ratio", lambda row: row["ratio"]),
        column("scenes of both", count, lambda row: row["ratio"][2])], rows, note="Small: 95 % interval.")


_FOLDER = "race"
_MAX_FRAMES = 1500  # of the replay: what a page has room for
_RACE = {"track": TEXT, "method": TEXT, "false_positive_rate": NUMBER, "finished": YES_OR_NO, "cones_hit": WHOLE, "finished_laps": WHOLE,
         "frames": WHOLE, "frames_without_path": WHOLE, "wrong_unflagged": WHOLE, "time_s": NUMBER, "old_path_s": NUMBER}


def _read_races(results):
    """The parameters of the races, and the races by method and rate."""
    path = results.path_of(f"{_FOLDER}/race.json")
    run = read_json(path)
    races = run.get("races")
    if not isinstance(races, list) or not races:
        raise InputError(f"{path}: races: is not a list of races")
    rows = {}
    for number, race in enumerate(races):
        for key, kinds in _RACE.items():
            if not isinstance(race, dict) or type(race.get(key)) not in kinds:
                raise InputError(f"{path}: races[{number}].{key}: is missing or of another kind")
        rows.setdefault((race["method"], race["false_positive_rate"]), []).append(race)
    return run, rows


def _replay(results):
    """The first stored race that was not finished, else the first one; a page has room for one."""
    path = results.path(f"{_FOLDER}/replay.jsonl")
    chosen = None
    for number, row in read_lines(path) if os.path.exists(path) else ():
        require_all(path, number, row, {"frames": (list,), "end": TEXT})
        if chosen is None or row["end"] != "finished":
            chosen = row
        if chosen["end"] != "finished":
            break
    if chosen is None:
        return ""
    chosen["frames"] = chosen["frames"][-_MAX_FRAMES:]
    what = (f"{escape(chosen['track'])}, {escape(chosen['method'])}, "
            f"{percent_label(chosen['false_positive_rate'])} % false positives: {escape(chosen['end'])}")
    note = "Filled: cones. × false positives. Large: seen in this frame. The line ahead of the car is the path it was given."
    return f'<div id="race-replay"><h4>What was driven: {what}</h4>{player(chosen, note)}</div>'


@Experiment
def race(results, published):
    """Races: driving the course with the answers
    Claim: Does a car that follows a method's lanes finish the race?
    Protocol: a kinematic car with pure pursuit follows the centre line of each answer, 10 frames a second; the race ends
    after the last lap, or where the car's middle leaves the lane. Finished: races driven to their end. To departure: median of
    the metres along the course of the races that left the lane. Unsteady: the path moved by more than 0.3 m within 10 m
    from one frame to the next. Wrong path: frames whose path leaves the lane within 10 m and does not say that it is old.
    Source: this project.
    Command: conelane race --tracks TRACKS --methods front,clc --fp 0,0.3,0.5 --out RESULTS/race"""
    run, of_driver = _read_races(results)
    rows = [{"method": method, "rate": rate} | race_measures(races) for (method, rate), races in of_driver.items()]
    told = ", ".join(f"{name} {run[key]}" for name, key in (
        ("condition", "condition"), ("mission", "mission"), ("laps", "laps"), ("sight in m", "range_m"),
        ("m/s", "speed_mps"), ("latency in ms", "latency_ms"), ("fault", "fault")) if run.get(key) not in (None, ""))
    tracks = len({race["track"] for races in of_driver.values() for race in races})
    note = f"{tracks} courses; {told}.{results.origin(run)}"
    curves = series([(method, sorted((100 * row["rate"], 100 * row["finished"]) for row in rows if row["method"] == method))
                     for method in dict.fromkeys(row["method"] for row in rows)])
    return table("race-table", [
        column("method", text, lambda row: row["method"]),
        column("false positives %", lambda rate: Cell(percent_label(rate), rate), lambda row: row["rate"]),
        *(column(title, show, lambda row, key=key: row[key], **digits) for title, show, key, digits in (
            ("races", count, "races", {}), ("finished %", percent, "finished", {}), ("m to departure", fixed, "departure_m", {"digits": 0}),
            ("cones hit a lap", fixed, "hit_a_lap", {"digits": 2}), ("lateral p95 m", fixed, "lateral_error_p95_m", {"digits": 2}),
            ("no path %", percent, "without_path", {"digits": 2}), ("old path %", percent, "old_path", {"digits": 2}),
            ("unsteady %", percent, "unsteady", {}), ("wrong path %", percent, "wrong", {"digits": 2})))], rows, note=note) + group([
            drawn("race-finished", f"High is good: share of races that were finished. {note}",
                  chart(curves, "false positives [%]", "races finished [%]", scale=percent_axis), "Races finished")]) + _replay(results)
