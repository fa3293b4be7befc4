"""Figures of the races in a race.json, and the cells of their tables."""

from cells import fixed, grouped, mean, median, percent, rounded


def race_rows(record):
    """A row for each method and share of false positives. The measures are those of docs/race.md."""
    rows = []
    for (method, rate), heats in sorted(grouped(record["races"], ("method", "false_positive_rate")).items()):
        def known(key):
            return [heat[key] for heat in heats if heat[key] is not None]
        errors, said = known("lateral_error_p95_m"), known("stop_said_m")
        rows.append({"method": method, "condition": record["condition"], "rate": rate, "races": len(heats),
                     "finished": mean([float(heat["finished"]) for heat in heats]),
                     # The lap in which a race ended counts as one.
                     "hit_a_lap": mean([heat["cones_hit"] / max(1, heat["finished_laps"] + (not heat["finished"])) for heat in heats]),
                     "lateral_error_p95_m": rounded(median(errors)) if errors else None,
                     "unsteady": mean(known("unsteady_share")),
                     "wrong": rounded(sum(heat["wrong_unflagged"] for heat in heats) / max(1, sum(heat["frames"] for heat in heats))),
                     "stop_said_m": [rounded(min(said)), rounded(median(said)), rounded(max(said))] if said else None,
                     "not_finished": sorted(f"{heat['track']} {heat['seed']}" for heat in heats if not heat["finished"])})
    return rows


def measure_cells(row):
    """finished, hit a lap, error, unsteady and wrong paths."""
    return [percent(row.get("finished")), fixed(row.get("hit_a_lap"), 2), fixed(row.get("lateral_error_p95_m"), 2), percent(row.get("unsteady")),
            percent(row.get("wrong"), 2)]


MEASURES = ["finished, %", "hit a lap", "error p95, m", "unsteady, %", "wrong path, %"]
