"""The whole run of experiments/reproduce: commit, machine, dates, and how long each part took."""

import json
import os
from datetime import datetime

from cells import lines_of, table

WHAT = {"held_out": "lanes and races of weights that have not learned from the course", "shipped": "colours, uncertain positions, acceleration and skidpad",
        "solvers": "solvers, exactness, the beam of `front`, the report", "pictures": "pictures of single scenes"}


def at(event):
    return datetime.fromisoformat(event["time"].replace("Z", "+00:00"))


def part_rows(events):
    """Minutes of the call that ended a part, and how many calls it took: a call that was killed has no end, so its time is unknown."""
    rows = []
    for part in WHAT:
        begins = [event for event in events if event["part"] == part and event["event"] == "begin"]
        ends = [event for event in events if event["part"] == part and event["event"] == "end"]
        if len(ends) != 1:
            raise SystemExit(f"tables.py: parts.jsonl has {len(ends)} ends of {part}")
        rows.append({"part": part, "minutes": round((at(ends[0]) - at(begins[-1])).total_seconds() / 60, 1), "calls": len(begins)})
    return rows


def collect(folder):
    events = lines_of(os.path.join(folder, "parts.jsonl"))
    with open(os.path.join(folder, "held_out.json"), encoding="utf-8") as stream:
        run = next(iter(json.load(stream)["runs"].values()))
    times = sorted(map(at, events))
    return {"runs": {}, "commit": run["commit"], "compiler": run["compiler"], "machine": run["machine"], "begun": f"{times[0]:%Y-%m-%d %H:%M}",
            "ended": f"{times[-1]:%Y-%m-%d %H:%M}", "parts": part_rows(events)}


def run_table(stored):
    lines = [[key, str(stored.get(name, "–"))] for key, name in (("commit", "commit"), ("compiler", "compiler"), ("machine", "machine"),
                                                                 ("begun, UTC", "begun"), ("ended, UTC", "ended"))]
    return table(["whole run", ""], lines)


def part_table(stored):
    rows = {row["part"]: row for row in stored.get("parts", [])}
    lines = [[f"`experiments/tables/{part}`", what, f"{rows[part]['minutes']:.1f}" if part in rows else "–", str(rows[part]["calls"]) if part in rows else "–"]
             for part, what in WHAT.items()]
    return table(["part", "of what", "minutes", "calls"], lines)


def tables(stored):
    """The text of each table by its name."""
    return {"whole run": run_table(stored), "parts of the run": part_table(stored)}
