"""What the tables of README and docs/ are made of: records, cells, and tables as Markdown."""

import os
import sys
from statistics import fmean

sys.path.insert(0, os.path.dirname(os.path.dirname(os.path.abspath(__file__))))  # of the package report, which reads and rounds as these tables do
from report.records import InputError, read_json, read_lines  # noqa: E402, F401
from report.summaries import UNKNOWN, fixed, median, percent, quantile, race_measures  # noqa: E402, F401


def lines_of(path):
    return [line for _, line in read_lines(path)]


def provenance(record):
    return {key: record[key] for key in ("commit", "compiler", "machine")}


def version_of(path):
    """The commit and the compiler that `conelane --version` names."""
    with open(path, encoding="utf-8") as stream:
        words = dict(line.strip().split(" ", 1) for line in stream if " " in line)
    return {"commit": words["commit"], "compiler": words["compiler"], "machine": ""}


def rounded(value):
    if isinstance(value, list):
        return list(map(rounded, value))
    return round(value, 6) if isinstance(value, float) else value


def mean(values):
    """None without values."""
    values = list(values)
    return rounded(fmean(values)) if values else None


def grouped(rows, key):
    """{key: rows}; `key` is of a row, or names of its keys."""
    cells = {}
    for row in rows:
        cells.setdefault(key(row) if callable(key) else tuple(row[name] for name in key), []).append(row)
    return cells


def over(rows, key, weight="scenes"):
    """The mean of a share, weighted; None where nothing is known."""
    known = [(row[key], row[weight]) for row in rows if row.get(key) is not None]
    return sum(share * scenes for share, scenes in known) / sum(scenes for _, scenes in known) if known else None


def pair(shares, digits=(1, 1)):
    """Two shares in per cent; a dash without them."""
    return percent(None) if shares is None else "/".join(map(percent, shares, digits))


def both(row):
    return pair(row and (row["usable"], row["iou"]), (1, 0))


def table(header, rows):
    lines = [header, ["---"] * len(header), *rows]
    return "\n".join("| " + " | ".join(line) + " |" for line in lines)


def columns_table(title, label, columns, rows):
    """The first column, and the others by their titles: texts of a row each, or format strings for its figures."""
    shown = [label, *columns.values()]
    return table([title, *columns], [[show(row) if callable(show) else show.format(**row) for show in shown] for row in rows])


def share(key, digits=1):
    """A column of shares in per cent."""
    return lambda row: percent(row[key], digits)
