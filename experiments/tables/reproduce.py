"""The whole run of experiments/reproduce: commit, machine, dates, and how long each part took."""

import os
from datetime import datetime

from cells import UNKNOWN, columns_table, fixed, lines_of, read_json, table

WHAT = {"held_out": "lanes and races of weights that have not learned from the course", "shipped": "colours, uncertain positions, acceleration and skidpad",
        "solvers": "solvers, exactness, the beam of `front`, the report",
        "engines": "time to a proven optimum by number of cones", "pictures": "pictures of single scenes"}


def at(event):
    return datetime.fromisoformat(event["time"].replace("Z", "+00:00"))


def part_rows(events):
    """Minutes of the call that ended a part, and how many calls it took: a call that was killed has no end, so its time is unknown. A part that
    was not asked for has no row."""
    rows = []
    for part in WHAT:
        begins = [event for event in events if event["part"] == part and event["event"] == "begin"]
        ends = [event for event in events if event["part"] == part and event["event"] == "end"]
        if not begins:
            continue
        if len(ends) != 1:
            raise SystemExit(f"tables.py: parts.jsonl has {len(ends)} ends of {part}")
        rows.append({"part": part, "minutes": round((at(ends[0]) - at(begins[-1])).total_seconds() / 60, 1), "calls": len(begins)})
    return rows


def collect(folder):
    events = lines_of(os.path.join(folder, "parts.jsonl"))
    run = next(iter(read_json(os.path.join(folder, "held_out.json"))["runs"].values()))
    times = sorted(map(at, events))
    return {"runs": {}, "commit": run["commit"], "compiler": run["compiler"], "machine": run["machine"], "begun": f"{times[0]:%Y-%m-%d %H:%M}",
            "ended": f"{times[-1]:%Y-%m-%d %H:%M}", "parts": part_rows(events)}


def run_table(stored):
    return table(["whole run", ""], [[title, str(stored.get(title.partition(",")[0], UNKNOWN))]
                                     for title in ("commit", "compiler", "machine", "begun, UTC", "ended, UTC")])


def part_table(stored):
    rows = {row["part"]: row for row in stored.get("parts", [])}
    return columns_table("part", "`experiments/tables/{part}`", {
        "of what": "{what}", "minutes": lambda row: fixed(row.get("minutes"), 1), "calls": lambda row: str(row.get("calls", UNKNOWN))},
        [{"part": part, "what": what} | rows.get(part, {}) for part, what in WHAT.items()])


def tables(stored):
    """The text of each table by its name."""
    return {"whole run": run_table(stored), "parts of the run": part_table(stored)}
