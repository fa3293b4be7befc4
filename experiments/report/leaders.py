"""Who is ahead: the highest mean, and all that the tracks do not tell from it."""

import numpy as np

from . import measures

REAL_TIME_BUDGET_MS = 50.0


def usable_values(part):
    part = part.known("usable")
    return dict(zip(part.scene, part.usable)), dict(zip(part.scene, part.track))


def accurate_values(part):
    part = part.known("accurate")
    return dict(zip(part.scene, part.accurate)), dict(zip(part.scene, part.track))


def success_values(part):
    return dict(zip(part.scene, part.success)), dict(zip(part.scene, part.track))


def headline_values(samples):
    """Usable; success in results of earlier versions, which do not have it."""
    return usable_values if any(sample.has("usable") for sample in samples) else success_values


def difference_interval(first, second, values_of):
    """Interval of the mean of first - second over the scenes that both have; None for a single track."""
    (a, tracks), (b, _) = values_of(first), values_of(second)
    scenes = [scene for scene in a if scene in b]
    if not scenes:
        return None
    differences = np.array([a[scene] - b[scene] for scene in scenes])
    return measures.mean_interval(differences, np.array([tracks[scene] for scene in scenes], dtype=object))


MEASURES = (("usable", "usable", usable_values), ("accurate", "accurate", accurate_values), ("success", "successful", success_values))


def leaders_of(parts, values_of):
    """(mean, samples): the highest mean, and all that the tracks do not tell from it. None without values."""
    values = [(values_of(part)[0], part) for part in parts]
    means = [(float(np.mean(list(known.values()))), part) for known, part in values if known]
    if not means:
        return None
    best_mean, best = max(means, key=lambda pair: pair[0])
    level = [best]
    for mean, part in means:
        if part is best:
            continue
        interval = difference_interval(best, part, values_of)
        if mean == best_mean or (interval and interval[0] <= 0.0 <= interval[1]):
            level.append(part)
    return best_mean, level


def fastest_of(samples):
    """The one with the least geometric mean of its latencies over the scenes that all have, so that no paired ratio
    to it is below 1; over its own scenes where there is none in common."""
    common = set.intersection(*(set(sample.scene) for sample in samples))

    def mean_log(sample):
        kept = np.array([scene in common for scene in sample.scene]) if common else np.ones(len(sample), bool)
        return float(np.mean(np.log(np.maximum(sample.latency[kept], measures.SMALLEST_MS))))
    return min(samples, key=mean_log)
