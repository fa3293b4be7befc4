"""Reads what `conelane compare` stored, and refuses what does not fit together."""

import json
import math
import os
import re
from dataclasses import dataclass, field

import numpy as np

SUCCESSES = ("ground_truth", "near_ground_truth", "too_short", "diverging_from_20")
CATEGORIES = SUCCESSES + ("diverging_below_20", "none")

# Columns of Sample that hold numbers, by their keys in scores.jsonl; NaN where a line has no such key.
_NUMBERS = {
    "rate": "false_positive_rate", "range": "range", "iou": "iou", "lane_length": "lane_length_m",
    "ground_truth_length": "ground_truth_length_m", "divergence": "divergence_m", "accurate": "accurate",
    "solved": "solved", "objective": "objective", "optimal": "optimal", "iterations": "iterations",
    "complete": "complete", "checked": "checked", "best_candidate_iou": "best_candidate_iou",
    "first_near_iteration": "first_near_iteration", "cones": "cones", "latency": "latency_ms"}
_REQUIRED = ("rate", "range", "iou", "lane_length", "ground_truth_length", "cones", "latency")


class InputError(Exception):
    """Names the file and, where there is one, the line and the key."""


def label_of(method, nearest):
    """How a method on a cone set is called in every table, as in results.jsonl's own table."""
    return method if nearest is None else f"{method} n={nearest}"


@dataclass(frozen=True)
class Sample:
    """The scores of one method on one cone-set size: a row per scene, columns as arrays of one length."""

    method: str
    nearest: int | None
    scene: np.ndarray
    track: np.ndarray
    category: np.ndarray
    status: np.ndarray
    values: dict

    def __getattr__(self, name):
        try:
            return self.__dict__["values"][name]
        except KeyError:
            raise AttributeError(name) from None

    def __len__(self):
        return len(self.scene)

    @property
    def label(self):
        return label_of(self.method, self.nearest)

    @property
    def carries_state(self):
        """From scene to scene of a lap, as the names of such methods say."""
        return self.method.endswith("-warm")

    @property
    def success(self):
        return np.isin(self.category, SUCCESSES).astype(float)

    def where(self, mask):
        return Sample(self.method, self.nearest, self.scene[mask], self.track[mask], self.category[mask],
                      self.status[mask], {key: column[mask] for key, column in self.values.items()})

    def at(self, rate=None, range_m=None):
        mask = np.ones(len(self), bool)
        if rate is not None:
            mask &= self.rate == rate
        if range_m is not None:
            mask &= self.range == range_m
        return self.where(mask)

    def known(self, name):
        """The rows that have a value in this column."""
        return self.where(~np.isnan(self.values[name]))

    def has(self, name):
        return bool(np.any(~np.isnan(self.values[name])))


@dataclass
class Results:
    directory: str
    run: dict
    rows: list  # of results.jsonl
    samples: list  # of Sample, in the order of results.jsonl
    sweep: list  # of Sample, by method and then size; empty where there was none
    tracks: dict  # name -> {"left", "right", "closed"}
    methods: list = field(default_factory=list)  # names, in order

    @property
    def rates(self):
        return sorted({row["false_positive_rate"] for row in self.rows})

    @property
    def ranges(self):
        return sorted({row["range"] for row in self.rows})

    def path(self, name):
        return os.path.join(self.directory, name)

    def origin(self, row):
        """A sentence where a stored row comes from another commit than the comparison; else nothing."""
        commit = row.get("commit", "unknown")
        return "" if commit == self.run.get("commit", "unknown") else f" Measured at commit {commit}."


_SCENE_AT_START = re.compile(r'\{"(?:id|scene)":"([^"\\]*)"')


def read_lines(path, scenes=None):
    """Yields (line number, object) of a file in JSON Lines. With `scenes`, lines that begin with the id of another
    scene are passed over unread: lanes with all their candidates are large."""
    try:
        stream = open(path, encoding="utf-8")
    except OSError as error:
        raise InputError(f"{path}: {error.strerror}") from None
    with stream:
        number = 0
        try:
            for number, line in enumerate(stream, 1):
                start = _SCENE_AT_START.match(line) if scenes is not None else None
                if not line.strip() or (start and start[1] not in scenes):
                    continue
                value = json.loads(line)
                if not isinstance(value, dict):
                    raise InputError(f"{path}:{number}: no JSON object")
                yield number, value
        except (json.JSONDecodeError, UnicodeDecodeError) as error:
            raise InputError(f"{path}:{number}: {error}") from None


def read_object(path):
    try:
        with open(path, encoding="utf-8") as stream:
            value = json.load(stream)
    except OSError as error:
        raise InputError(f"{path}: {error.strerror}") from None
    except (json.JSONDecodeError, UnicodeDecodeError) as error:
        raise InputError(f"{path}: {error}") from None
    if not isinstance(value, dict):
        raise InputError(f"{path}: no JSON object")
    return value


def require(path, number, value, key, kinds):
    """value[key], where it is there and of one of these kinds."""
    if key not in value:
        raise InputError(f"{path}:{number}: {key}: is missing")
    found = value[key]
    if not isinstance(found, kinds) or (isinstance(found, bool) and bool not in kinds):
        raise InputError(f"{path}:{number}: {key}: has a value of the wrong kind")
    if isinstance(found, float) and not math.isfinite(found):
        raise InputError(f"{path}:{number}: {key}: is not finite")
    return found


def _read_samples(path):
    texts = {}  # (method, nearest) -> rows
    for number, line in read_lines(path):
        key = (require(path, number, line, "method", (str,)), line.get("nearest"))
        if key[1] is not None:
            require(path, number, line, "nearest", (int,))
        category = require(path, number, line, "category", (str,))
        if category not in CATEGORIES:
            raise InputError(f"{path}:{number}: category: there is no '{category}'")
        row = [require(path, number, line, key, (str,)) for key in ("scene", "track", "category", "status")]
        for name, source in _NUMBERS.items():
            if source not in line and name not in _REQUIRED:
                row.append(math.nan)
            else:
                row.append(float(require(path, number, line, source, (int, float, bool))))
        texts.setdefault(key, []).append(row)
    samples = []
    for (method, nearest), rows in texts.items():
        columns = list(zip(*rows))
        samples.append(Sample(method, nearest, *(np.array(column, dtype=object) for column in columns[:4]),
                              {name: np.array(column) for name, column in zip(_NUMBERS, columns[4:])}))
    return samples


def _read_rows(path):
    rows = []
    for number, row in read_lines(path):
        for key, kinds in (("method", (str,)), ("false_positive_rate", (int, float)), ("range", (int, float)),
                           ("scenes", (int,)), ("success_share", (int, float)), ("mean_iou", (int, float)),
                           ("share", (dict,)), ("latency_ms", (dict,))):
            require(path, number, row, key, kinds)
        for key in ("median", "mean", "p95", "p99", "max", "shifted_geometric_mean"):
            require(path, number, row["latency_ms"], key, (int, float))
        rows.append(row)
    if not rows:
        raise InputError(f"{path}: has no line")
    return rows


def _check_same_run(path, rows, samples):
    """The summaries must be those of the scores, else page and figures would tell of different runs."""
    by_label = {sample.label: sample for sample in samples}
    for row in rows:
        label = label_of(row["method"], row.get("nearest"))
        name = f"{label} at rate {row['false_positive_rate']}, range {row['range']}"
        sample = by_label.get(label)
        part = sample.at(row["false_positive_rate"], row["range"]) if sample else ()
        if len(part) != row["scenes"]:
            raise InputError(f"{path}: {len(part)} scores of {name}, results.jsonl has {row['scenes']}")
        for key, mean in (("success_share", part.success.mean()), ("mean_iou", part.iou.mean())):
            if abs(mean - row[key]) > 1e-6:
                raise InputError(f"{path}: {key} of {name} is {mean}, results.jsonl has {row[key]}")


def load_results(directory):
    """Reads run.json, results.jsonl, scores.jsonl, and, where they are, scenes.tracks.json and
    sweep/scores.jsonl. Scenes and lanes are large; viewer and gallery read them themselves."""
    def path(name):
        return os.path.join(directory, name)

    if not os.path.isdir(directory):
        raise InputError(f"{directory}: is no directory")
    run = read_object(path("run.json"))
    rows = _read_rows(path("results.jsonl"))
    samples = _read_samples(path("scores.jsonl"))
    _check_same_run(path("scores.jsonl"), rows, samples)
    order = list(dict.fromkeys(label_of(row["method"], row.get("nearest")) for row in rows))
    samples = sorted((s for s in samples if s.label in order), key=lambda sample: order.index(sample.label))
    sweep_file = path(os.path.join("sweep", "scores.jsonl"))
    sweep = _read_samples(sweep_file) if os.path.exists(sweep_file) else []
    sweep = [sample for sample in sweep if sample.nearest is not None]
    methods = list(dict.fromkeys([row["method"] for row in rows] + [sample.method for sample in sweep]))
    sweep.sort(key=lambda sample: (methods.index(sample.method), sample.nearest))
    tracks_file = path("scenes.tracks.json")
    tracks = read_object(tracks_file) if os.path.exists(tracks_file) else {}
    return Results(directory, run, rows, samples, sweep, tracks, methods)
