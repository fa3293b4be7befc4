"""Update against rebuild

Claim: A program built at start and updated before each solve, as the RLD paper does it, saves building it.
Protocol: Google Benchmark; the scenes take turns. Problem: the numbers of a scene. Build: a new program from \
them. Update: the same program with the new numbers.
Source: this project; the RLD paper, III, builds its model at program start.
Command: conelane_benchmarks --benchmark_filter=problem/|build/|update/ --benchmark_out_format=json \
--benchmark_out=RESULTS/benchmarks.json
"""

import os
import re

from ..experiment import Missing
from ..load import InputError, read_object
from ..tables import Cell, Column, table, text

FILE = "benchmarks.json"
_STAGES = ("problem", "build", "update")
_MICROSECONDS = {"ns": 1e-3, "us": 1.0, "ms": 1e3, "s": 1e6}


def html(results, published):
    path = results.path(FILE)
    if not os.path.exists(path):
        raise Missing(f"there is no {FILE}.")
    times = {}
    try:
        for run in read_object(path)["benchmarks"]:
            found = re.fullmatch(rf"({'|'.join(_STAGES)})/(\w+)/(\d+)", run["name"])
            if found and not run.get("error_occurred"):
                times.setdefault((int(found[3]), found[2]), {})[found[1]] = (
                    run["cpu_time"] * _MICROSECONDS[run["time_unit"]])
    except (KeyError, TypeError) as error:
        raise InputError(f"{path}: no output of Google Benchmark ({error})") from None
    rows = []
    for (size, formulation), stages in sorted(times.items()):
        if not all(stage in stages for stage in _STAGES):
            continue
        ratio = stages["build"] / stages["update"]
        rows.append([Cell(str(size), size), text(formulation)] +
                    [Cell(f"{stages[stage]:.1f}", stages[stage]) for stage in _STAGES] + [Cell(f"{ratio:.1f}", ratio)])
    if not rows:
        raise Missing(f"{FILE} has no stage of model building.")
    columns = [Column("n"), Column("formulation", "text"), Column("problem µs"), Column("build µs"),
               Column("update µs"), Column("build / update")]
    return table("update-or-rebuild", "", columns, rows)
