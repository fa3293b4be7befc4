"""Reads what `conelane compare` stored, and refuses what does not fit together."""

import dataclasses
import json
import math
import os
from array import array
from dataclasses import dataclass, field

import numpy as np

from .records import NUMBER, TEXT, WHOLE, InputError, label_of, read_json, read_lines, require, require_all

# Folders of further comparisons in the results, for experiments that take other scenes or options: cone-set sizes, the
# RLD paper's topologies, all candidates scored.
BESIDE = ("sweep", "topologies", "candidates")
# Files of `conelane study` that make a page without a comparison.
STUDIES = ("optimality.jsonl", "backends.jsonl", "growth.jsonl", "formulations.jsonl", "relaxations.jsonl")
SUCCESSES = ("ground_truth", "near_ground_truth", "too_short", "diverging_from_20")
CATEGORIES = SUCCESSES + ("diverging_below_20", "none")
PAPER_CONDITION = "paper"

# Why a lane is not usable, as the scores name it.
CAUSES = {"wrong_start": "wrong start", "wrong_leg": "wrong leg", "wrong_side": "wrong side",
          "false_cone": "false cone taken", "cone_skipped": "cone skipped", "gap_not_bridged": "gap not bridged",
          "stopped_early": "stopped early", "leaves_path": "leaves the path", "nothing_found": "nothing found",
          "error": "error"}

# Columns of Sample that hold texts and numbers, by their keys in scores.jsonl; "" and NaN where a line has no such key.
_TEXTS = ("scene", "track", "category", "status", "condition", "cause")
_OPTIONAL_TEXTS = ("condition", "cause")
_NUMBERS = {
    "rate": "false_positive_rate", "range": "range", "usable": "usable", "iou": "iou", "lane_length": "lane_length_m",
    "ground_truth_length": "ground_truth_length_m", "divergence": "divergence_m", "lateral": "lateral_median_m",
    "lateral_most": "lateral_max_m", "heading": "heading_error_rad", "steady": "steady", "accurate": "accurate",
    "solved": "solved", "objective": "objective", "optimal": "optimal", "iterations": "iterations",
    "complete": "complete", "checked": "checked", "best_candidate_iou": "best_candidate_iou",
    "first_near_iteration": "first_near_iteration", "trained_on": "trained_on", "cones": "cones", "latency": "latency_ms"}
_REQUIRED = ("rate", "range", "lane_length", "ground_truth_length", "cones", "latency")


class Missing(Exception):
    """The results do not hold what an experiment shows; says what."""


@dataclass(frozen=True)
class Sample:
    """The scores of one method on one cone-set size: a row per scene, columns as arrays of one length, of texts (see
    _TEXTS) and of numbers (see _NUMBERS)."""

    method: str
    nearest: int | None
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

    @property
    def mean_iou(self):
        """None where no scene has one: the truth is a driven path, or the answer a centre line alone."""
        return float(np.nanmean(self.iou)) if self.has("iou") else None

    def where(self, mask):
        return Sample(self.method, self.nearest, {key: column[mask] for key, column in self.values.items()})

    def at(self, rate=None, range_m=None, condition=None):
        mask = np.ones(len(self), bool)
        if rate is not None:
            mask &= self.rate == rate
        if range_m is not None:
            mask &= self.range == range_m
        if condition is not None:
            mask &= self.condition == condition
        return self if mask.all() else self.where(mask)

    def known(self, name):
        """The rows that have a value in this column."""
        mask = ~np.isnan(self.values[name])
        return self if mask.all() else self.where(mask)

    def has(self, name):
        return bool(np.any(~np.isnan(self.values[name])))

    def measured(self, name):
        """The rows that have this measure, and its values."""
        part = self if name == "success" else self.known(name)
        return part, getattr(part, name)


@dataclass
class Results:
    directory: str
    run: dict
    rows: list  # of results.jsonl, best method first
    samples: list  # of Sample, best first
    beside: dict  # of BESIDE: folder -> list of Sample, by method and then size; empty where there is none
    tracks: dict  # name -> {"left", "right", "closed"}
    methods: list = field(default_factory=list)  # names, in order
    runs_beside: list = field(default_factory=list)  # run.json of the comparisons beside

    @property
    def sweep(self):
        """The samples of the sweep over cone-set sizes."""
        return [sample for sample in self.beside["sweep"] if sample.nearest is not None]

    @property
    def conditions(self):
        """In the order of the rows; "" where none was named."""
        return list(dict.fromkeys(row.get("condition", "") for row in self.rows))

    @property
    def main_condition(self):
        """The one that the papers' figures take."""
        return PAPER_CONDITION if PAPER_CONDITION in self.conditions else self.conditions[0]

    def under(self, condition):
        """What was measured in this condition alone; of a comparison beside that names none, all."""
        def parts(samples):
            named = any(np.any(sample.condition != "") for sample in samples)
            wanted = condition if named else ""
            return [part for part in (sample.at(condition=wanted) for sample in samples) if len(part)]

        return dataclasses.replace(
            self, rows=[row for row in self.rows if row.get("condition", "") == condition],
            samples=parts(self.samples), beside={folder: parts(samples) for folder, samples in self.beside.items()})

    def objective_of(self, sample):
        """What stands for the objective that a method minimises: methods of the same parameters have the same."""
        known = (method for run in [self.run, *self.runs_beside] for method in run.get("methods", ())
                 if isinstance(method, dict) and method.get("name") == sample.method)
        return json.dumps(next(known, {}).get("rld_parameters"), sort_keys=True)

    @property
    def time_limit_ms(self):
        """Of an answer; infinite where the record names none."""
        limit = self.run.get("time_limit_ms")
        return float(limit) if isinstance(limit, (int, float)) and not isinstance(limit, bool) else math.inf

    @property
    def rates(self):
        return sorted({row["false_positive_rate"] for row in self.rows})

    @property
    def ranges(self):
        return sorted({row["range"] for row in self.rows})

    def path(self, name):
        return os.path.join(self.directory, name)

    def path_of(self, name):
        """Of a file that has to be there; raises Missing."""
        if not os.path.exists(self.path(name)):
            raise Missing(f"there is no {name}.")
        return self.path(name)

    def origin(self, row):
        """A sentence where a stored row comes from another commit than the comparison; else nothing."""
        commit = row.get("commit", "unknown")
        return "" if commit == self.run.get("commit", "unknown") else f" Measured at commit {commit}."

    def stored(self, file, kinds, is_wanted=lambda row: True):
        """The wanted rows of a study's file, which have these keys, or those that `kinds` names for a row. Raises Missing where
        there is none."""
        path, rows = self.path_of(file), []
        for number, row in read_lines(path):
            if is_wanted(row):
                require_all(path, number, row, kinds(row) if callable(kinds) else kinds)
                rows.append(row)
        if not rows:
            raise Missing(f"{file} holds no row.")
        return rows


class _Columns:
    """The columns of a Sample while they are read. Texts are shared: the same scenes come with every method."""

    def __init__(self):
        self.texts = [[] for _ in _TEXTS]
        self.numbers = [array("d") for _ in _NUMBERS]

    def add(self, path, number, line, shared):
        for column, key in zip(self.texts, _TEXTS):
            value = line.get(key, "") if key in _OPTIONAL_TEXTS else require(path, number, line, key, TEXT)
            if not isinstance(value, str):
                require(path, number, line, key, TEXT)
            column.append(shared.setdefault(value, value))
        for column, (name, key) in zip(self.numbers, _NUMBERS.items()):
            value = line.get(key)
            if value is None and key not in line and name not in _REQUIRED:
                column.append(math.nan)
            else:
                column.append(value if type(value) is float and math.isfinite(value) else
                              require(path, number, line, key, (int, float, bool)))

    def sample(self, method, nearest):
        columns = {name: np.array(column, dtype=object) for name, column in zip(_TEXTS, self.texts)}
        columns |= {name: np.array(column) for name, column in zip(_NUMBERS, self.numbers)}
        return Sample(method, nearest, columns)


def _read_samples(path):
    read, shared = {}, {}  # (method, nearest) -> columns; each text once
    for number, line in read_lines(path):
        key = (require(path, number, line, "method", TEXT), line.get("nearest"))
        if key[1] is not None:
            require(path, number, line, "nearest", WHOLE)
        if key not in read:
            read[key] = _Columns()
        read[key].add(path, number, line, shared)
        if line["category"] not in CATEGORIES:
            raise InputError(f"{path}:{number}: category: there is no '{line['category']}'")
        if line.get("cause", "error") not in CAUSES:
            raise InputError(f"{path}:{number}: cause: there is no '{line['cause']}'")
    return [columns.sample(method, nearest) for (method, nearest), columns in read.items()]


_ROW = {"method": TEXT, "false_positive_rate": NUMBER, "range": NUMBER, "scenes": WHOLE, "success_share": NUMBER, "share": (dict,),
        "latency_ms": (dict,), "condition?": TEXT, "calibration?": (dict,)} | {f"{key}?": NUMBER for key in (
            "mean_iou", "usable_share", "unsteady_share", "lateral_median_m", "lateral_p95_m", "heading_median_rad", "heading_p95_rad")}
_LATENCY = dict.fromkeys(("median", "mean", "p95", "p99", "max", "shifted_geometric_mean"), NUMBER)


def _read_rows(path):
    rows = []
    for number, row in read_lines(path):
        require_all(path, number, row, _ROW)
        require_all(path, number, row["latency_ms"], _LATENCY)
        rows.append(row)
    if not rows:
        raise InputError(f"{path}: has no line")
    return rows


def row_name(row):
    """How a row of results.jsonl is called in an error."""
    condition = f" in condition {row['condition']}" if row.get("condition") else ""
    return (f"{label_of(row['method'], row.get('nearest'))} at rate {row['false_positive_rate']}, range "
            f"{row['range']}{condition}")


def _check_same_run(path, rows, samples):
    """The summaries must be those of the scores, else page and figures would tell of different runs."""
    by_label = {sample.label: sample for sample in samples}
    for row in rows:
        sample = by_label.get(label_of(row["method"], row.get("nearest")))
        part = (sample.at(row["false_positive_rate"], row["range"], row.get("condition", "")) if sample else ())
        if len(part) != row["scenes"]:
            raise InputError(f"{path}: {len(part)} scores of {row_name(row)}, results.jsonl has {row['scenes']}")
        means = [("success_share", part.success.mean()), ("mean_iou", part.mean_iou)]
        if "usable_share" in row:  # results of earlier versions have none
            means.append(("usable_share", float(np.nanmean(part.usable)) if part.has("usable") else None))
        for key, mean in means:
            stored = row.get(key)
            if (mean is None) != (stored is None) or (mean is not None and abs(mean - stored) > 1e-6):
                raise InputError(f"{path}: {key} of {row_name(row)} is {mean}, results.jsonl has {stored}")


def _share(sample):
    """Of usable lanes, of success where that is unknown."""
    return float(np.nanmean(sample.usable)) if sample.has("usable") else float(sample.success.mean())


def _read_beside(path):
    return _read_samples(path) if os.path.exists(path) else []


def load_results(directory):
    """Reads run.json, results.jsonl, scores.jsonl, and, where they are, scenes.tracks.json and the scores of the
    comparisons beside. Scenes and lanes are large; viewer and gallery read them themselves. A folder of studies alone
    gives results without rows and samples."""
    def path(name):
        return os.path.join(directory, name)

    if not os.path.isdir(directory):
        raise InputError(f"{directory}: is not a directory")
    studies = [path(name) for name in STUDIES if os.path.exists(path(name))]
    if studies and not any(os.path.exists(path(name)) for name in ("run.json", "results.jsonl", "scores.jsonl")):
        _, row = next(read_lines(studies[0]), (0, {}))
        run = {key: row[key] for key in ("commit", "compiler", "machine") if key in row}
        beside = {folder: _read_beside(path(os.path.join(folder, "scores.jsonl"))) for folder in BESIDE}
        return Results(directory, run, [], [], beside, {}, list(dict.fromkeys(sample.method for sample in beside["sweep"])))
    if not os.path.exists(path("run.json")):
        raise InputError(f"{path('run.json')}: is missing; studies without a comparison are read from {', '.join(STUDIES)}")
    run = read_json(path("run.json"))
    rows = _read_rows(path("results.jsonl"))
    samples = _read_samples(path("scores.jsonl"))
    _check_same_run(path("scores.jsonl"), rows, samples)
    order = list(dict.fromkeys(label_of(row["method"], row.get("nearest")) for row in rows))
    # The best first in tables, legends and pictures; colours are by the order in the file.
    samples = sorted((s for s in samples if s.label in order), key=lambda sample: (-_share(sample), order.index(sample.label)))
    beside = {folder: _read_beside(path(os.path.join(folder, "scores.jsonl"))) for folder in BESIDE}
    methods = list(dict.fromkeys([row["method"] for row in rows] +
                                 [sample.method for samples in beside.values() for sample in samples]))
    for stored in beside.values():
        stored.sort(key=lambda sample: (methods.index(sample.method), sample.nearest or math.inf))
    tracks_file = path("scenes.tracks.json")
    tracks = read_json(tracks_file) if os.path.exists(tracks_file) else {}
    runs_beside = [read_json(path(os.path.join(folder, "run.json"))) for folder in BESIDE
                   if os.path.exists(path(os.path.join(folder, "run.json")))]
    labels = [sample.label for sample in samples]
    rows.sort(key=lambda row: labels.index(label_of(row["method"], row.get("nearest"))))
    return Results(directory, run, rows, samples, beside, tracks, methods, runs_beside)
