"""What the tables with a row per method, condition, rate and range share."""

from .records import label_of
from .tables import Cell, Column, column, method_cell, percent, table, text

CATEGORY_NOTE = ("Ground truth: exactly the same cones. Near: does not diverge and is long enough, but has other "
                 "cones. Too short: does not diverge, but is below 75 % of the ground truth's length.")
TRAINED = " *: with courses that the method has learned from, no held-out figure."


def scenes_cell(count, trained_on):
    """A number of scenes, marked where some of them are of courses that the method has learned from."""
    return Cell(f"{count}{'*' if trained_on else ''}", count)


def note_on_training(results):
    """What a table says of the mark, where it has one."""
    return TRAINED if any(sample.has("trained_on") for sample in results.samples) else ""


def note_on_limit(results):
    """What a table says of times that the limit ended, where there are some."""
    limit = results.time_limit_ms
    if not any(sample.latency.max() >= limit for sample in results.samples):
        return ""
    return f" Limit: the time limit of {limit:g} ms ended the search, which would have taken longer."


def label(row):
    return label_of(row["method"], row.get("nearest"))


def condition_column(results, of=lambda row: row.get("condition", "")):
    """Where conditions are named."""
    return [column("condition", text, of)] if results.conditions != [""] else []


def keys(results):
    """The first columns of a table of rows of results.jsonl."""
    return [Column("method", lambda row: method_cell(results, row["method"], label(row)), "text"), *condition_column(results),
            column("false positives %", percent, lambda row: row["false_positive_rate"]),
            Column("range m", lambda row: Cell(f"{row['range']:g}", row["range"])),
            Column("scenes", lambda row: scenes_cell(row["scenes"], row.get("trained_on", 0)))]


def rows_table(name, results, columns, note=""):
    """A table of the rows of results.jsonl, with what the filters of the page go by."""
    return table(name, keys(results) + columns, results.rows, note=note, attributes=lambda row: {
        "method": label(row), "condition": row.get("condition", ""), "rate": row["false_positive_rate"], "range": row["range"]})


def part(results, row):
    """The scores that a row of results.jsonl sums up."""
    sample = next(sample for sample in results.samples if sample.label == label(row))
    return sample.at(row["false_positive_rate"], row["range"], row.get("condition", ""))
