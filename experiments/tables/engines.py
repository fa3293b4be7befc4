"""Time to a proven optimum by number of cones, and lanes among the same cones: the runs of experiments/tables/engines, and their tables."""

import math
import os

from cells import UNKNOWN, columns_table, grouped, lines_of, median, percent, provenance, quantile, rounded, table
from solvers import PROVEN, milliseconds, only, pivot

METHODS = {"front": "`front`", "clc": "`clc`", "rld-shape": "`rld-shape`", "rld-pair": "`rld-pair`: RLD's own objective"}
MEASURED = ("geometric_ms", "geometric_ms_interval", "par10_ms", "par10_ms_interval", "median_engine_ms", "contribution_ms")


def known(time_ms):
    """None for a scene of this rank that was not proven."""
    return rounded(time_ms) if time_ms < math.inf else None


def size_rows(lines):
    """A row for each solver and size, of the scenes in their own order: the times to a proof, and what the study works out itself."""
    def of_kind(kind, name):
        return {(line[name], line["nearest"]): line for line in lines if line.get("row") == kind and "condition" not in line}
    blocks, summaries, pairs = of_kind("block", "backend"), of_kind("summary", "backend"), of_kind("pair", "first")
    rows = []
    for key, cell in grouped((line for line in lines if "scene" in line and not line.get("permutation")), ("backend", "nearest")).items():
        times = [line["latency_ms"] if line["status"] in PROVEN else math.inf for line in cell]
        rows.append({"table": "sizes", "backend": key[0], "nearest": key[1], "version": blocks.get(key, {}).get("version", ""), "scenes": len(cell),
                     "courses": len({line["track"] for line in cell}), "solved": sum(time < math.inf for time in times),
                     "median_ms": known(median(times)), "p95_ms": known(quantile(times, 0.95))} |
                    {name: rounded(summaries.get(key, {}).get(name)) for name in MEASURED} |
                    {name: rounded(pairs.get(key, {}).get(name)) for name in ("ratio", "ratio_interval", "corrected_p_value")})
    return rows


def collect(folder):
    runs = os.path.join(folder, "engines")
    lines, sweep = (lines_of(os.path.join(runs, name)) for name in ("backends.jsonl", "sweep/results.jsonl"))
    return {"runs": {"engines": provenance(lines[0]), "cone_sets": provenance(sweep[0])}, "rows": size_rows(lines) + [
        {"table": "cone sets", "method": line["method"], "nearest": line.get("nearest", 0), "scenes": line["scenes"],
         "usable": rounded(line.get("usable_share")), "accurate": rounded(line.get("accurate_share")), "solved": rounded(line.get("solved_share"))}
        for line in sweep]}


# Tables


def by_size(title, rows, labels, cell):
    """A line for each of `labels`, a column for each size; all visible cones are the last."""
    sizes = sorted({row["nearest"] for row in rows}, key=lambda size: size or math.inf)
    return table([title, *(f"n = {size}" if size else "all visible" for size in sizes)], pivot(rows, labels, [only(nearest=size) for size in sizes], cell))


def time(value):
    return milliseconds(value) or UNKNOWN


def size_table(rows):
    versions = {row["backend"]: row["version"] for row in reversed(rows)}
    return by_size("solver, formulation", rows, {only(backend=backend): f"`{backend}`, {version.partition(' (git')[0]}" for backend, version in reversed(versions.items())},
                   lambda row: f"{time(row['median_ms'])}/{time(row['p95_ms'])}/{percent(row['solved'] / row['scenes'])}")


def better_treatment(rows):
    """Of rows on demand and all rows (`whole`), those with the lower PAR10 of each solver."""
    of_solver = grouped([dict(row, solver=row["backend"].removesuffix(" whole")) for row in rows], ("solver",))
    return [min(treatments, key=lambda row: row["par10_ms"]) for treatments in of_solver.values()]


def between(row, key):
    """A figure and its 95 % interval."""
    interval = row.get(f"{key}_interval")
    return time(row.get(key)) + (f" ({' to '.join(map(time, interval))})" if interval else "")


def compared_table(rows):
    return columns_table("solver, formulation", "`{backend}`", {
        "geometric mean ms": lambda row: between(row, "geometric_ms"), "PAR10 ms": lambda row: between(row, "par10_ms"),
        "own time, median ms": lambda row: time(row["median_engine_ms"]), "time / `path-pair`": lambda row: between(row, "ratio"),
        "p (Holm)": lambda row: UNKNOWN if row["corrected_p_value"] is None else f"{row['corrected_p_value']:.2g}",
        "adds ms": lambda row: time(row["contribution_ms"])}, better_treatment([row for row in rows if row["nearest"] == 0]))


def tables(stored):
    """The text of each table by its name."""
    rows = grouped(stored.get("rows", []), ("table",))
    sizes, sets = rows.get(("sizes",), []), rows.get(("cone sets",), [])
    return {"solvers by size": size_table(sizes), "solvers compared": compared_table(sizes), "usable by cone set": by_size(
        "usable, %", [row for row in sets if row["nearest"] != 6], {only(method=method): label for method, label in METHODS.items()},
        lambda row: percent(row["usable"]))}
