"""Quantiles, and numbers as texts: one definition for the report and experiments/tables, the first one that of
evaluation/scoring/statistics.cpp, too."""

import math
from statistics import fmean, median  # median: the mean of the two in the middle where the number of values is even

UNKNOWN = "–"


def quantile(values, share):
    """Nearest rank: the smallest value that at least `share` of the sample does not exceed."""
    ordered = sorted(values)
    # A rank that is whole in exact arithmetic, such as 0.95 * 20, must not be rounded up to the next one.
    return ordered[max(1, math.ceil(share * len(ordered) - 1e-9)) - 1]


def fixed(value, digits):
    return UNKNOWN if value is None else f"{value:.{digits}f}"


def percent(share, digits=1):
    return UNKNOWN if share is None else f"{100.0 * share:.{digits}f}"


def percent_label(rate):
    """A rate as axes and tables name it: 16.7, not 16.66; 30, not 30.0."""
    return percent(rate).rstrip("0").rstrip(".")


def race_measures(races):
    """What the races of one driver come to, as docs/race.md has it; None where nothing is known."""
    def known(key):
        return [race[key] for race in races if race.get(key) is not None]

    def total(key):
        return sum(known(key))

    def of_known(statistic, key):
        return statistic(known(key)) if known(key) else None
    frames = max(1, total("frames"))
    return {"races": len(races), "finished": fmean(float(race["finished"]) for race in races),
            # The lap in which a race ended counts as one.
            "hit_a_lap": fmean(race["cones_hit"] / max(1, race["finished_laps"] + (not race["finished"])) for race in races),
            "lateral_error_p95_m": of_known(median, "lateral_error_p95_m"), "unsteady": of_known(fmean, "unsteady_share"),
            "wrong": total("wrong_unflagged") / frames, "departure_m": of_known(median, "departure_m"),
            "without_path": total("frames_without_path") / frames, "old_path": total("old_path_s") / max(1e-9, total("time_s"))}
