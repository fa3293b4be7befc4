"""Races: driving the course with the answers

Claim: Does a car that follows a method's lanes finish the race?
Protocol: a kinematic car with pure pursuit follows the centre line of each answer, 10 frames a second; the race ends \
after the last lap, or where the car's middle leaves the lane. Finished: races driven to their end. To departure: median of \
the metres along the course of the races that left the lane. Unsteady: the path moved by more than 0.3 m within 10 m \
from one frame to the next. Wrong path: frames whose path leaves the lane within 10 m and does not say that it is old.
Source: this project.
Command: conelane race --tracks TRACKS --methods front,clc --fp 0,0.3,0.5 --out RESULTS/race
"""

import json
import os
from html import escape

import numpy as np

from ..experiment import Missing
from ..figures import drawn, group, percent_label
from ..load import InputError, read_lines, require
from ..tables import Cell, Column, percent, table, text
from ..theme import MARKERS, legend, new_figure, percent_axis, series_style

FOLDER = "race"
_MAX_FRAMES = 1500  # of the replay: what a page has room for
_NUMBER = (int, float)
_KEYS = (("track", (str,)), ("method", (str,)), ("false_positive_rate", _NUMBER), ("finished", (bool,)),
         ("cones_hit", (int,)), ("finished_laps", (int,)), ("frames", (int,)), ("frames_without_path", (int,)),
         ("wrong_unflagged", (int,)), ("time_s", _NUMBER), ("old_path_s", _NUMBER))


def read(results):
    """The parameters of the races, and the races by method and rate."""
    path = results.path(os.path.join(FOLDER, "race.json"))
    if not os.path.exists(path):
        raise Missing(f"there is no {FOLDER}/race.json.")
    try:
        with open(path, encoding="utf-8") as stream:
            run = json.load(stream)
    except ValueError as error:
        raise InputError(f"{path}: {error}") from None
    races = run.get("races") if isinstance(run, dict) else None
    if not isinstance(races, list) or not races:
        raise InputError(f"{path}: races: is not a list of races")
    rows = {}
    for number, race in enumerate(races):
        for key, kinds in _KEYS:
            if not isinstance(race, dict) or type(race.get(key)) not in kinds:
                raise InputError(f"{path}: races[{number}].{key}: is missing or of another kind")
        rows.setdefault((race["method"], race["false_positive_rate"]), []).append(race)
    return run, rows


def _median(races, key):
    values = [race[key] for race in races if race.get(key) is not None]
    return float(np.median(values)) if values else None


def _fixed(value, digits):
    return Cell("–") if value is None else Cell(f"{value:.{digits}f}", float(value))


def _cells(method, rate, races):
    frames = max(1, sum(race["frames"] for race in races))
    unsteady = [race["unsteady_share"] for race in races if race.get("unsteady_share") is not None]
    hit = np.mean([race["cones_hit"] / max(1, race["finished_laps"] + (not race["finished"])) for race in races])
    return [text(method), Cell(percent_label(rate), rate), Cell(str(len(races)), len(races)),
            percent(np.mean([race["finished"] for race in races])), _fixed(_median(races, "departure_m"), 0),
            _fixed(float(hit), 2), _fixed(_median(races, "lateral_error_p95_m"), 2),
            percent(sum(race["frames_without_path"] for race in races) / frames, 2),
            percent(sum(race["old_path_s"] for race in races) / max(1e-9, sum(race["time_s"] for race in races)), 2),
            percent(float(np.mean(unsteady)) if unsteady else None),
            percent(sum(race["wrong_unflagged"] for race in races) / frames, 2)]


_COLUMNS = [Column("method", "text"), Column("false positives %"), Column("races"), Column("finished %"),
            Column("m to departure"), Column("cones hit a lap"), Column("lateral p95 m"), Column("no path %"),
            Column("old path %"), Column("unsteady %"), Column("wrong path %")]


def _figure(rows):
    figure, axes = new_figure()
    methods = list(dict.fromkeys(method for method, _ in rows))
    for index, method in enumerate(methods):
        rates = sorted(rate for other, rate in rows if other == method)
        axes.plot([100.0 * rate for rate in rates],
                  [100.0 * np.mean([race["finished"] for race in rows[method, rate]]) for rate in rates],
                  marker=MARKERS[index % len(MARKERS)], label=method, **series_style(index))
    axes.set(xlabel="false positives [%]", ylabel="races finished [%]")
    percent_axis(axes)
    legend(axes)
    return figure


def _replay(results):
    """The first stored race that was not finished, else the first one; a page has room for one."""
    path = results.path(os.path.join(FOLDER, "replay.jsonl"))
    chosen = None
    if os.path.exists(path):
        for number, row in read_lines(path):
            require(path, number, row, "frames", (list,))
            require(path, number, row, "end", (str,))
            if chosen is None or (chosen["end"] == "finished" and row["end"] != "finished"):
                chosen = row
            if chosen["end"] != "finished":
                break
    if chosen is None:
        return ""
    chosen["frames"] = chosen["frames"][-_MAX_FRAMES:]
    data = json.dumps(chosen, separators=(",", ":"), allow_nan=False).replace("<", "\\u003c")
    what = (f"{escape(chosen['track'])}, {escape(chosen['method'])}, "
            f"{percent_label(chosen['false_positive_rate'])} % false positives: {escape(chosen['end'])}")
    return (f'<div id="race-replay"><h4>What was driven: {what}</h4>'
            '<div class="stage"><canvas id="race-scene" role="img" aria-label="Race, seen from above"></canvas></div>'
            '<div class="transport"><button type="button" id="race-play" aria-label="play the race">▶</button>'
            '<input type="range" id="race-frame" min="0" value="0" aria-label="frame"><output id="race-time"></output>'
            '</div><p class="note">Filled: cones. × false positives. Large: seen in this frame. The line ahead of the car is '
            'the path it was given.</p>'
            f'<script type="application/json" id="race-data">{data}</script></div>')


def html(results, published):
    run, rows = read(results)
    told = ", ".join(f"{name} {run[key]}" for name, key in (
        ("condition", "condition"), ("mission", "mission"), ("laps", "laps"), ("sight in m", "range_m"),
        ("m/s", "speed_mps"), ("latency in ms", "latency_ms"), ("fault", "fault")) if run.get(key) not in (None, ""))
    tracks = len({race["track"] for races in rows.values() for race in races})
    note = f"{tracks} courses; {told}.{results.origin(run)}"
    figure = drawn("race-finished", f"High is good: share of races that were finished. {note}", _figure(rows),
                   "Races finished")
    body = table("race-table", "", _COLUMNS, [_cells(method, rate, races) for (method, rate), races in rows.items()],
                 note=note)
    return body + group([figure]) + _replay(results)
