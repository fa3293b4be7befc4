"""The first thing to read: which method to run, and one table of all methods by condition and rate of false positives.
Every sentence is computed."""

from html import escape

import numpy as np

from . import measures
from .experiments import optimality
from .figures import percent_label
from .leaders import REAL_TIME_BUDGET_MS, headline_values, leaders_of, usable_values
from .rows import note_on_training, scenes_cell
from .tables import Column, block_table, method_cell, milliseconds, percent

_IN_TIME_SHARE = 0.99  # of the scenes
_NBSP = "\u00a0"


def _joined(names):
    return names[0] if len(names) == 1 else ", ".join(names[:-1]) + " and " + names[-1]


def _by_condition(results, best, values_of):
    """The mean under each condition, where there are several."""
    if len(results.conditions) < 2:
        return ""
    means = []
    for condition in results.conditions:
        values = values_of(best.at(condition=condition))[0]
        if values:
            means.append(f"{escape(condition or 'none named')} {100 * np.mean(list(values.values())):.1f}{_NBSP}%")
    return f" ({', '.join(means)})"


def _recommended(results, samples):
    """The one ahead over all scenes, as a sentence's end; None without scores."""
    values_of = headline_values(results.samples)
    leaders = leaders_of(samples, values_of)
    if leaders is None:
        return None, ""
    best = leaders[1][0]
    level = [f"<b>{escape(sample.label)}</b>" for sample in leaders[1][1:]]
    tail = f" The tracks do not tell {_joined(level)} from it." if level else ""
    what = "usable lanes" if values_of is usable_values else "success"
    return best, (f"<b>{escape(best.label)}</b>: {what} in {100 * leaders[0]:.1f}{_NBSP}% of all scenes"
                  f"{_by_condition(results, best, values_of)}, 99{_NBSP}% of the answers within "
                  f"{measures.quantile(best.latency, 0.99):.2f}{_NBSP}ms.{tail}")


def _sentence(results):
    """The method to run among those that keep the real-time budget, and where it carries its last lane along also the
    best of those that do not: false positives drawn anew at every pose reward memory more than a track would."""
    in_time = [sample for sample in results.samples
               if np.mean(sample.latency <= REAL_TIME_BUDGET_MS) >= _IN_TIME_SHARE]
    best, text_of_best = _recommended(results, in_time)
    if best is None:
        return ""
    sentence = f'<p class="headline">Run {text_of_best}</p>'
    if best.carries_state:
        _, without = _recommended(results, [sample for sample in in_time if not sample.carries_state])
        sentence += f"<p>It carries its last lane along.{f' Without such memory, {without}' if without else ''}</p>"
    return sentence


def _agreement_sentences(results):
    """Whether methods that proved optimality of one objective on the same cone sets found the same optimum."""
    tolerance = 1e-6
    groups = {}
    for sample in results.samples:
        if sample.has("objective"):
            groups.setdefault((sample.nearest, results.objective_of(sample)), []).append(sample)
    pieces = []
    for samples in groups.values():
        proven = [{scene: value for scene, value, optimal in zip(s.scene, s.objective, s.optimal) if optimal == 1.0}
                  for s in samples]
        scenes = [scene for scene in dict.fromkeys(scene for values in proven for scene in values)
                  if sum(scene in values for values in proven) > 1]
        if not scenes:
            continue
        apart = sum(max(found) - min(found) > tolerance for found in
                    ([values[scene] for values in proven if scene in values] for scene in scenes))
        names = _joined([escape(s.label) for s in samples])
        pieces.append(f"<li>{names} minimise one objective and find the same optimum within 10<sup>−6</sup> in "
                      f"{len(scenes) - apart} of {len(scenes)} scenes that more than one of them solved to proven "
                      "optimality.</li>")
    return "".join(pieces)


def _checker_sentence(results):
    """What the independent checker said of what the RLD methods answered."""
    accepted = int(sum(np.nansum(sample.checked) for sample in results.samples))
    errors = int(sum(np.sum(sample.status == "error") for sample in results.samples))
    if not accepted:
        return ""
    failed = (f"accepted {accepted} lane graphs; {errors} answers were errors and count as failures" if errors else
              f"accepted all {accepted} lane graphs; no answer was an error")
    return f"<li>Of what the RLD methods answered, the independent checker {failed}.</li>"


def _optimality_sentence(results):
    """How far the graph search is from RLD's optimum, and which of the two drives better."""
    rows = optimality.compared(optimality.read(results))
    if not rows:
        return ""
    equal = np.mean([float(row["equal"]) for row in rows])
    best, candidate = (optimality.success(rows, name) for name in ("optimum", "candidate"))
    interval = measures.mean_interval(best - candidate, optimality.tracks_of(rows))
    told = interval and not interval[0] <= 0.0 <= interval[1]
    drives = ("drives no better or worse" if not told else
              "drives better" if best.mean() > candidate.mean() else "drives worse")
    return (f"<li>Under RLD's objective, the best of CLC's candidates is the proven optimum in "
            f"{100 * equal:.1f}{_NBSP}% of {len(rows)} scenes. The optimum {drives}: success "
            f"{100 * best.mean():.1f}{_NBSP}% against {100 * candidate.mean():.1f}{_NBSP}%.</li>")


def _tiles(results):
    scenes = len(set().union(*(set(sample.scene) for sample in results.samples)))
    tracks = len(set().union(*(set(sample.track) for sample in results.samples)))
    answers = sum(len(sample) for sample in results.samples)
    tiles = ((f"{scenes:,}".replace(",", "\u202f"), "scenes"), (str(tracks), "tracks"),
             (str(len(results.samples)), "methods"), (f"{answers:,}".replace(",", "\u202f"), "answers scored"))
    return '<dl class="tiles">' + "".join(f"<div><dd>{n}</dd><dt>{what}</dt></div>" for n, what in tiles) + "</dl>"


def _mean(part, name):
    """Mean and interval of a column where it is known; None twice where it never is."""
    known = part.known(name)
    values = known.values[name]
    return (float(values.mean()), measures.mean_interval(values, known.track)) if len(values) else (None, None)


def _block(results, condition, rate):
    parts = [part for part in (sample.at(rate, condition=condition) for sample in results.samples) if len(part)]
    leaders = leaders_of(parts, headline_values(results.samples))
    ahead = {part.label for part in leaders[1]} if leaders else set()
    rows, attributes = [], []
    for part in parts:
        usable, interval = _mean(part, "usable")
        marks = {"ahead": "yes"} if part.label in ahead else {}
        rows.append([method_cell(results.methods, part.method, part.label),
                     percent(usable, interval=interval, **marks),
                     percent(part.success.mean(), **({} if part.has("usable") else marks)), percent(part.mean_iou),
                     percent(float(np.mean(part.category == "ground_truth"))),
                     milliseconds(measures.quantile(part.latency, 0.99)), milliseconds(part.latency.max()),
                     scenes_cell(len(part), part.has("trained_on"))])
        attributes.append({"method": part.label, "condition": condition, "rate": rate})
    where = f"{percent_label(rate)} % false positives"
    return (f"{condition}: {where}" if condition else where), rows, attributes


def _table(results):
    columns = [Column("method", "text"), Column("usable %"), Column("success %"), Column("mean IoU %"),
               Column("exact %"), Column("p99 ms"), Column("max ms"), Column("scenes")]
    blocks = [_block(results, condition, rate) for condition in results.conditions for rate in results.rates]
    return block_table(
        "headline", "All methods", columns, [block for block in blocks if block[1]],
        note="All ranges together. Usable: the lane is right for the first 20 m and long enough to drive by. Success: "
        "the CLC paper's, which a stub of two metres has too. Exact: the very cones of the ground truth. Small: 95 % "
        "interval, tracks resampled. Bold: ahead, or not told from the method ahead by its paired difference, tracks "
        f"resampled.{note_on_training(results)}")


def html(results):
    sentences = f"{_agreement_sentences(results)}{_optimality_sentence(results)}{_checker_sentence(results)}"
    return _sentence(results) + _table(results) + _tiles(results) + f'<ul class="verdict">{sentences}</ul>'
