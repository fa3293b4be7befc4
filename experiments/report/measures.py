"""Statistics of samples. Intervals resample tracks, not scenes: scenes of one track are alike, so an interval that
took them for independent would be far too narrow."""

import functools

import numpy as np

from .summaries import quantile

REAL_TIME_BUDGET_MS = 50.0
CONFIDENCE = 0.95
RESAMPLES = 2000
AGREEMENT = 1e-6  # of optima that are the same
GEOMETRIC_MEAN_SHIFT_MS = 1.0
SMALLEST_MS = 1e-6  # a clock's tick keeps logarithms finite


def shifted_geometric_mean(values, shift=GEOMETRIC_MEAN_SHIFT_MS):
    return float(np.exp(np.mean(np.log(np.asarray(values) + shift))) - shift)


@functools.lru_cache
def _track_weights(track_count):
    """How often each track is drawn in each resample: (RESAMPLES, track_count). The same draws every time."""
    drawn = np.random.default_rng(20).integers(0, track_count, size=(RESAMPLES, track_count))
    weights = np.zeros((RESAMPLES, track_count))
    np.add.at(weights, (np.arange(RESAMPLES)[:, None], drawn), 1.0)
    weights.flags.writeable = False  # it is shared
    return weights


def _track_index(tracks):
    """For each row the number of its track, in the order of names, and how many there are."""
    number = {name: i for i, name in enumerate(sorted(set(tracks)))}
    return np.fromiter((number[name] for name in tracks), int, len(tracks)), len(number)


def _interval(estimates):
    return tuple(float(quantile(estimates, (1.0 + sign * CONFIDENCE) / 2.0)) for sign in (-1, 1))


def mean_interval(values, tracks):
    """Bootstrap interval of the mean; None where there are not two tracks to resample."""
    index, track_count = _track_index(tracks)
    if track_count < 2:
        return None
    weights = _track_weights(track_count)
    sums = np.bincount(index, weights=values, minlength=track_count)
    counts = np.bincount(index, minlength=track_count)
    return _interval(weights @ sums / (weights @ counts))


def median_interval(values, tracks):
    """As mean_interval, of the median."""
    index, track_count = _track_index(tracks)
    if track_count < 2:
        return None
    order = np.argsort(values, kind="stable")
    ordered, weights = values[order], _track_weights(track_count)
    # How many rows of each track are among the first ones: a resample's running weight is a weighted sum of these.
    running = np.zeros((len(ordered), track_count), dtype=np.int32)
    running[np.arange(len(ordered)), index[order]] = 1
    np.cumsum(running, axis=0, out=running)
    half = weights @ running[-1] / 2.0
    low, high = np.zeros(RESAMPLES, int), np.full(RESAMPLES, len(ordered) - 1)  # the first row that reaches the half
    while np.any(low < high):
        middle = (low + high) // 2
        reached = np.einsum("ij,ij->i", weights, running[middle]) >= half
        high = np.where(reached, middle, high)
        low = np.where(reached, low, middle + 1)
    return _interval(ordered[low])


def paired(first, second):
    """Row numbers in `first` and `second` of the scenes that both have."""
    row_of = {scene: i for i, scene in enumerate(second.scene)}
    pairs = [(i, row_of[scene]) for i, scene in enumerate(first.scene) if scene in row_of]
    if not pairs:
        return np.empty(0, int), np.empty(0, int)
    return tuple(np.array(side) for side in zip(*pairs))


def latency_ratio(sample, reference):
    """Geometric mean of latency / reference's latency over the scenes of both, its interval, their number."""
    rows, reference_rows = paired(sample, reference)
    if not len(rows):
        return None
    logs = np.log(np.maximum(sample.latency[rows], SMALLEST_MS) /
                  np.maximum(reference.latency[reference_rows], SMALLEST_MS))
    interval = mean_interval(logs, sample.track[rows])
    return (float(np.exp(logs.mean())), tuple(float(np.exp(end)) for end in interval) if interval else None,
            len(rows))


def disagreements(proven):
    """Of optima that several prove, by scene (infinite: there is no lane graph): how many differ, of how many that two of them prove."""
    found = {}
    for scene, value in (item for of_one in proven for item in of_one.items()):
        found.setdefault(scene, []).append(value)
    shared = [values for values in found.values() if len(values) > 1]
    return sum(not (max(values) == min(values) or max(values) - min(values) <= AGREEMENT) for values in shared), len(shared)


def headline_measure(samples):
    """Usable; success in results of earlier versions, which do not have it."""
    return "usable" if any(sample.has("usable") for sample in samples) else "success"


def share_and_interval(sample, name):
    """Mean and interval of a measure where it is known; None twice where it never is."""
    part, values = sample.measured(name)
    return (float(values.mean()), mean_interval(values, part.track)) if len(values) else (None, None)


def leaders_of(samples, name):
    """(mean, samples): the highest mean of a measure, and all that the tracks do not tell from it by the paired difference.
    None without values."""
    means = [(share, sample) for sample in samples for share, _ in [share_and_interval(sample, name)] if share is not None]
    if not means:
        return None
    best_mean, best = max(means, key=lambda pair: pair[0])
    level = [best]
    for mean, sample in means:
        if sample is best:
            continue
        (a, of_best), (b, others) = best.measured(name), sample.measured(name)
        rows, other_rows = paired(a, b)
        interval = mean_interval(of_best[rows] - others[other_rows], a.track[rows]) if len(rows) else None
        if mean == best_mean or (interval and interval[0] <= 0.0 <= interval[1]):
            level.append(sample)
    return best_mean, level


def fastest_of(samples):
    """The one with the least geometric mean of its latencies over the scenes that all have, so that no paired ratio
    to it is below 1; over its own scenes where there is none in common."""
    common = set.intersection(*(set(sample.scene) for sample in samples))

    def mean_log(sample):
        kept = np.array([scene in common for scene in sample.scene]) if common else np.ones(len(sample), bool)
        return float(np.mean(np.log(np.maximum(sample.latency[kept], SMALLEST_MS))))
    return min(samples, key=mean_log)
