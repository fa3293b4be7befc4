"""Figures of the races in a race.json, and the cells of their tables."""

from cells import fixed, grouped, mean, median, percent, race_measures, rounded


def race_rows(record):
    """A row for each method and share of false positives."""
    rows = []
    for (method, rate), heats in sorted(grouped(record["races"], ("method", "false_positive_rate")).items()):
        found, said = race_measures(heats), [heat["stop_said_m"] for heat in heats if heat["stop_said_m"] is not None]
        rows.append({"method": method, "condition": record["condition"], "rate": rate} | {
            key: rounded(found[key]) for key in ("races", "finished", "hit_a_lap", "lateral_error_p95_m", "unsteady", "wrong")} | {
                "stop_said_m": [rounded(of(said)) for of in (min, median, max)] if said else None,
                "not_finished": sorted(f"{heat['track']} {heat['seed']}" for heat in heats if not heat["finished"])})
    return rows


def lap_rows(record):
    """A row for each method, share of false positives, and first or later laps, as the second table of `race --speed safe` has them."""
    rows = []
    for (method, rate), heats in sorted(grouped(record["races"], ("method", "false_positive_rate")).items()):
        for laps, key in (("first", "first_lap"), ("later", "later_laps")):
            driven = [heat[key] for heat in heats if key in heat]
            frames = sum(lap["frames"] for lap in driven)
            if frames:
                rows.append({"method": method, "rate": rate, "laps": laps, "courses": len(heats)} | {name: rounded(value) for name, value in {
                    "time_ratio": mean(lap["time_s"] / lap["laps"] / lap["known_course_lap_s"] for lap in driven if lap["laps"]),
                    "short": sum(lap["short_frames"] for lap in driven) / frames, "wrong_trusted": sum(lap["wrong_trusted"] for lap in driven) / frames,
                    "sideways_p95_m": mean(lap["sideways_p95_m"] for lap in driven if lap["sideways_p95_m"] is not None),
                    "curvature_1pm": median([lap["max_curvature_1pm"] for lap in driven])}.items()})
    return rows


def measure_cells(row):
    """finished, hit a lap, error, unsteady and wrong paths."""
    return [percent(row.get("finished")), fixed(row.get("hit_a_lap"), 2), fixed(row.get("lateral_error_p95_m"), 2), percent(row.get("unsteady")),
            percent(row.get("wrong"), 2)]


MEASURES = ["finished, %", "hit a lap", "error p95, m", "unsteady, %", "wrong path, %"]
