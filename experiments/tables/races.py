"""Figures of the races in a race.json, and the cells of their tables."""

import statistics
from collections import defaultdict

from cells import percent, rounded


def mean(values):
    return rounded(statistics.fmean(values)) if values else None


def race_rows(record):
    """A row for each method and share of false positives. The measures are those of docs/race.md."""
    cells = defaultdict(list)
    for heat in record["races"]:
        cells[heat["method"], heat["false_positive_rate"]].append(heat)
    rows = []
    for (method, rate), heats in sorted(cells.items()):
        def known(key):
            return [heat[key] for heat in heats if heat[key] is not None]
        errors, said = known("lateral_error_p95_m"), known("stop_said_m")
        rows.append({"method": method, "condition": record["condition"], "rate": rate, "races": len(heats),
                     "finished": mean([float(heat["finished"]) for heat in heats]),
                     # The lap in which a race ended counts as one.
                     "hit_a_lap": mean([heat["cones_hit"] / max(1, heat["finished_laps"] + (not heat["finished"])) for heat in heats]),
                     "lateral_error_p95_m": rounded(statistics.median(errors)) if errors else None,
                     "unsteady": mean(known("unsteady_share")),
                     "wrong": rounded(sum(heat["wrong_unflagged"] for heat in heats) / max(1, sum(heat["frames"] for heat in heats))),
                     "stop_said_m": [rounded(min(said)), rounded(statistics.median(said)), rounded(max(said))] if said else None,
                     "not_finished": sorted(f"{heat['track']} {heat['seed']}" for heat in heats if not heat["finished"])})
    return rows


def fixed(value, digits):
    return "–" if value is None else f"{value:.{digits}f}"


def measure_cells(row):
    """finished, hit a lap, error, unsteady and wrong paths."""
    return [percent(row.get("finished")), fixed(row.get("hit_a_lap"), 2), fixed(row.get("lateral_error_p95_m"), 2), percent(row.get("unsteady")),
            percent(row.get("wrong"), 2)]


MEASURES = ["finished, %", "hit a lap", "error p95, m", "unsteady, %", "wrong path, %"]
