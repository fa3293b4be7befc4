"""The first thing to read: one sentence that says which method to run, one table of all methods, and what each of them
does. Every sentence is computed."""

from html import escape

import numpy as np

from . import gallery, measures
from .conditions import short
from .experiments import optimality
from .figures import percent_label
from .leaders import REAL_TIME_BUDGET_MS, headline_values, leaders_of, usable_values
from .methods import CLC_PAPER, RLD_PAPER, described
from .rows import note_on_limit, note_on_training, scenes_cell
from .tables import Column, block_table, method_cell, milliseconds, percent, table
from .theme import METHOD_COLORS

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
            means.append(f"{escape(condition or 'none named')} {100 * np.mean(list(values.values())):.1f}{_NBSP}% of "
                         f"{len(values)}")
    return f" ({', '.join(means)})"


def _recommended(results, samples):
    """The one ahead over all scenes, as a sentence's end; None without scores."""
    values_of = headline_values(results.samples)
    leaders = leaders_of(samples, values_of)
    if leaders is None:
        return None, ""
    best = leaders[1][0]
    level = [f"<b>{escape(sample.label)}</b>" for sample in leaders[1][1:]]
    tail = f" On these tracks, {_joined(level)} cannot be distinguished from it." if level else ""
    what = "usable lanes" if values_of is usable_values else "success"
    return best, (f"<b>{escape(best.label)}</b>: {what} in {100 * leaders[0]:.1f}{_NBSP}% of {len(values_of(best)[0])} scenes"
                  f"{_by_condition(results, best, values_of)}, 99{_NBSP}% of the answers within "
                  f"{measures.quantile(best.latency, 0.99):.2f}{_NBSP}ms.{tail}")


def _sentence(results):
    """The method whose lanes are usable most often. If it does not keep the real-time budget, also the best that does;
    if it carries its last lane along, also the best of those that do not: false positives drawn at every pose
    reward memory more than a track would."""
    best, text_of_best = _recommended(results, results.samples)
    if best is None:
        return ""
    in_time = [sample for sample in results.samples
               if np.mean(sample.latency <= REAL_TIME_BUDGET_MS) >= _IN_TIME_SHARE]
    is_in_time = any(sample is best for sample in in_time)
    sentence = f'<p class="headline">{"Run" if is_in_time else "Most often right:"} {text_of_best}</p>'
    if best.carries_state:
        _, without = _recommended(results, [sample for sample in in_time if not sample.carries_state])
        sentence += f"<p>It keeps its last lane from scene to scene.{f' Without such memory, {without}' if without else ''}</p>"
    if not is_in_time:
        _, fast = _recommended(results, in_time)
        sentence += (f"<p>That is more than the {REAL_TIME_BUDGET_MS:g}{_NBSP}ms of a 20{_NBSP}Hz LiDAR. "
                     + (f"Of the methods that keep them in {100 * _IN_TIME_SHARE:g}{_NBSP}% of the scenes the best is {fast}"
                        if fast else f"No method keeps them in {100 * _IN_TIME_SHARE:g}{_NBSP}% of the scenes.") + "</p>")
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


def _mean(part, name):
    """Mean and interval of a column where it is known; None twice where it never is."""
    known = part.known(name)
    values = known.values[name]
    return (float(values.mean()), measures.mean_interval(values, known.track)) if len(values) else (None, None)


def _block(results, conditions, condition, rate):
    parts = [part for part in (sample.at(rate, condition=condition) for sample in results.samples) if len(part)]
    leaders = leaders_of(parts, headline_values(results.samples))
    ahead = {part.label for part in leaders[1]} if leaders else set()
    rows, attributes = [], []
    for part in parts:
        usable, interval = _mean(part, "usable")
        marks = {"ahead": "yes"} if part.label in ahead else {}
        rows.append([method_cell(results.methods, part.method, part.label), percent(usable, interval=interval, **marks)] +
                    _measured(results, part, not part.has("usable"), marks))
        attributes.append({"method": part.label, "condition": condition, "rate": rate})
    where = f"{percent_label(rate)} % false positives"
    known = short(conditions, condition)
    return (f"{condition}{f' ({known})' if known else ''}: {where}" if condition else where), rows, attributes


_COLUMNS = (Column("success %"), Column("mean IoU %"), Column("exact %"), Column("p99 ms"), Column("max ms"),
            Column("scenes"))
_NOTE = ("Usable: the lane is right for the first 20 m and long enough to drive by. Success: that of the CLC paper, which a lane of "
         "two metres has too. Exact: exactly the cones of the ground truth. Small: 95 % interval, tracks resampled. Bold: "
         "the best, or not distinguishable from it by the paired difference, tracks resampled.")


def _measured(results, part, is_marked_by_success, marks):
    """Cells of _COLUMNS."""
    return [percent(part.success.mean(), **(marks if is_marked_by_success else {})), percent(part.mean_iou),
            percent(float(np.mean(part.category == "ground_truth"))),
            milliseconds(measures.quantile(part.latency, 0.99), limit_ms=results.time_limit_ms),
            milliseconds(part.latency.max(), limit_ms=results.time_limit_ms),
            scenes_cell(len(part), part.has("trained_on"))]


def _hint(results, conditions, condition):
    """What a condition is, and how many scenes it has."""
    scenes = max(len(sample.at(condition=condition)) for sample in results.samples)
    return ", ".join(filter(None, (short(conditions, condition), f"n\u00a0=\u00a0{scenes}")))


def _summary(results, conditions):
    """A row for each method over all that was measured, the best first."""
    values_of = headline_values(results.samples)
    leaders = leaders_of(results.samples, values_of)
    ahead = {part.label for part in leaders[1]} if leaders else set()
    several = results.conditions if len(results.conditions) > 1 else []
    rows = []
    for sample in results.samples:
        usable, interval = _mean(sample, "usable")
        marks = {"ahead": "yes"} if sample.label in ahead else {}
        of_conditions = [percent(_mean(sample.at(condition=condition), "usable")[0]) for condition in several]
        rank = usable if usable is not None else float(sample.success.mean())
        rows.append((rank, sample.label,
                     [method_cell(results.methods, sample.method, sample.label), percent(usable, interval=interval, **marks)]
                     + of_conditions + _measured(results, sample, not sample.has("usable"), marks)))
    rows.sort(key=lambda row: -row[0])
    columns = [Column("method", "text"), Column("usable %")] + [
        Column(f"in {condition or 'none named'} %", hint=_hint(results, conditions, condition)) for condition in several] + list(_COLUMNS)
    return table("headline", "", columns, [cells for _, _, cells in rows],
                 row_attributes=[{"method": label} for _, label, _ in rows],
                 note=f"All conditions, rates and ranges together. {_NOTE}{note_on_limit(results)}"
                      f"{note_on_training(results)}")


def by_rate(results, conditions):
    """The same measures by condition and rate of false positives."""
    columns = [Column("method", "text"), Column("usable %")] + list(_COLUMNS)
    blocks = [_block(results, conditions, condition, rate) for condition in results.conditions for rate in results.rates]
    return block_table("by-rate", "All methods by condition and false positives", columns,
                       [block for block in blocks if block[1]], note=f"All ranges together. {_NOTE}{note_on_limit(results)}{note_on_training(results)}")


def picture(results, data):
    """What a cone lane is: the lane of the first method that has one right, in the scene that the page begins with.
    Empty where the page has no scenes."""
    frame = data.frames.get(data.start)
    if frame is None:
        return ""
    slot = next((slot for slot, answer in enumerate(frame["a"]) if answer and answer[7] == 1), 0)
    track = next(lap["track"] for lap in data.laps if data.start in lap["scenes"])
    svg = gallery.drawing(results, frame, slot, track, data.longest_gap_m, gallery.view_of(frame))
    label = escape(results.samples[slot].label)
    return (f'<figure id="cone-lane" class="scene"><div role="img" aria-label="A cone lane: cones, false positives and the '
            f'left and right boundary that {label} found">{svg}</div><figcaption>A cone lane in a scene of these results, as {label} found it. '
            f"{gallery.short_legend()}</figcaption></figure>")


def _methods(results, data):
    """A line and a small picture of each method: its lane in the same scene."""
    scene = data.start or None
    view = gallery.view_of(data.frames[scene]) if scene else None
    track_of = {name: lap["track"] for lap in data.laps for name in lap["scenes"]}
    answers = data.frames[scene]["a"] if scene else []
    right = sum(1 for answer in answers if answer and answer[7] == 1)
    cards = []
    for slot, sample in enumerate(results.samples):
        about = described(results, sample.method)
        here = f"<br>Here: {escape(gallery.said(answers[slot]))}." if answers else ""
        color = results.methods.index(sample.method) % METHOD_COLORS
        picture = "" if scene is None else (
            f'<div role="img" aria-label="lane of {escape(sample.label)}">'
            f"{gallery.drawing(results, data.frames[scene], slot, track_of[scene], data.longest_gap_m, view)}</div>")
        cards.append(f'<figure class="scene" data-method="{escape(sample.label)}">{picture}<figcaption>'
                     f'<span class="swatch" style="background:var(--m{color})"></span><b>{escape(sample.label)}</b> '
                     f"{escape(about.line)} <i>{escape(about.source)}</i>{here}</figcaption></figure>")
    shown = ("" if scene is None else
             f'<p class="note">The same scene for all, <button type="button" class="link" data-open="{escape(scene)}">'
             f"{escape(scene)}</button>, at the same zoom, with turns ahead and not the hardest: {right} of "
             f"{len(results.samples)} methods have it right. The band is the ground truth. {gallery.short_legend()}</p>")
    papers = "".join(f"<li><b>{short}</b>: {escape(title)}.</li>" for short, title in (RLD_PAPER, CLC_PAPER))
    return (f'<div id="methods"><h3>What the methods do</h3><div class="scenes">{"".join(cards)}</div>{shown}'
            f'<ul class="papers">{papers}</ul></div>')


def exactness(results):
    """Sentences on proofs: what was proven, checked, and how near the graph search comes to it."""
    sentences = f"{_agreement_sentences(results)}{_optimality_sentence(results)}{_checker_sentence(results)}"
    return f'<ul class="verdict">{sentences}</ul>' if sentences else ""


def answer(results):
    """The answer to what is compared, in a sentence or two."""
    return _sentence(results)


def html(results, data, conditions):
    return _summary(results, conditions) + _methods(results, data)
