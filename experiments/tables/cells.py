"""What the tables of README and docs/ are made of: cells, rows, and figures of runs."""

import json


def lines_of(path):
    with open(path, encoding="utf-8") as stream:
        return [json.loads(line) for line in stream]


def provenance(record):
    return {key: record[key] for key in ("commit", "compiler", "machine")}


def version_of(path):
    """The commit and the compiler that `conelane --version` names."""
    with open(path, encoding="utf-8") as stream:
        words = dict(line.strip().split(" ", 1) for line in stream if " " in line)
    return {"commit": words["commit"], "compiler": words["compiler"], "machine": ""}


def rounded(value):
    return round(value, 6) if isinstance(value, float) else value


def percent(value, digits=1):
    return "–" if value is None else f"{100 * value:.{digits}f}"


def both(row):
    return "–" if row is None else f"{percent(row['usable'])} / {percent(row['iou'], 0)}"


def table(header, rows):
    lines = [header, ["---"] * len(header), *rows]
    return "\n".join("| " + " | ".join(line) + " |" for line in lines)
