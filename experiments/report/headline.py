"""The first thing to read: one sentence that says which method to run, one table of all methods, and what each of them
does. Every sentence is computed."""

from html import escape

import numpy as np

from . import gallery, measures
from .experiments.exactness import Compared, read_optimality
from .load import Missing
from .measures import REAL_TIME_BUDGET_MS, headline_measure, leaders_of, share_and_interval
from .methods import CLC_PAPER, RLD_PAPER, described, short
from .rows import note_on_limit, note_on_training, scenes_cell
from .summaries import percent_label, quantile
from .tables import Column, column, method_column, milliseconds, percent, table
from .theme import METHOD_COLORS

_IN_TIME_SHARE = 0.99  # of the scenes
_NBSP = "\u00a0"


def _joined(names):
    return names[0] if len(names) == 1 else ", ".join(names[:-1]) + " and " + names[-1]


def _recommended(results, samples):
    """The one ahead over all scenes, and a sentence's end on it; None without scores."""
    name = headline_measure(results.samples)
    leaders = leaders_of(samples, name)
    if leaders is None:
        return None, ""
    best, *others = leaders[1]
    means = [(condition, best.at(condition=condition).measured(name)[1]) for condition in results.conditions]
    by_condition = ", ".join(f"{escape(condition or 'none named')} {100 * values.mean():.1f}{_NBSP}% of {len(values)}"
                             for condition, values in means if len(values)) if len(means) > 1 else ""
    level = [f"<b>{escape(sample.label)}</b>" for sample in others]
    tail = f" On these tracks, {_joined(level)} cannot be distinguished from it." if level else ""
    what = "usable lanes" if name == "usable" else "success"
    return best, (f"<b>{escape(best.label)}</b>: {what} in {100 * leaders[0]:.1f}{_NBSP}% of {len(best.measured(name)[1])} scenes"
                  f"{f' ({by_condition})' if by_condition else ''}, 99{_NBSP}% of the answers within "
                  f"{quantile(best.latency, 0.99):.2f}{_NBSP}ms.{tail}")


def answer(results):
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
    groups = {}
    for sample in results.samples:
        if sample.has("objective"):
            groups.setdefault((sample.nearest, results.objective_of(sample)), []).append(sample)
    pieces = []
    for samples in groups.values():
        apart, shared = measures.disagreements([{scene: value for scene, value, optimal in zip(s.scene, s.objective, s.optimal) if optimal == 1.0}
                                                for s in samples])
        if shared:
            pieces.append(f"<li>{_joined([escape(s.label) for s in samples])} minimise one objective and find the same optimum within "
                          f"10<sup>−6</sup> in {shared - apart} of {shared} scenes that more than one of them solved to proven "
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
    try:
        both = Compared(read_optimality(results))
    except Missing:
        return ""
    if not len(both):
        return ""
    best, candidate = both.success("optimum"), both.success("candidate")
    interval = measures.mean_interval(best - candidate, both.track)
    told = interval and not interval[0] <= 0.0 <= interval[1]
    drives = ("drives no better or worse" if not told else
              "drives better" if best.mean() > candidate.mean() else "drives worse")
    return (f"<li>Under RLD's objective, the best of CLC's candidates is the proven optimum in "
            f"{100 * both.equal.mean():.1f}{_NBSP}% of {len(both)} scenes. The optimum {drives}: success "
            f"{100 * best.mean():.1f}{_NBSP}% against {100 * candidate.mean():.1f}{_NBSP}%.</li>")


_NOTE = ("Usable: the lane is right for the first 20 m and long enough to drive by. Success: that of the CLC paper, which a lane of "
         "two metres has too. Exact: exactly the cones of the ground truth. Small: 95 % interval, tracks resampled. Bold: "
         "the best, or not distinguishable from it by the paired difference, tracks resampled.")


def _ahead(results, samples):
    """Those that are ahead by the headline's measure."""
    leaders = leaders_of(samples, headline_measure(results.samples))
    return leaders[1] if leaders else []


def _columns(results, ahead, of_conditions=()):
    """Of rows that are samples; the cell of the headline's measure is marked for those ahead."""
    marks = {id(sample): {"ahead": "yes"} for sample in ahead}

    def usable(sample):
        share, interval = share_and_interval(sample, "usable")
        return percent(share, interval=interval, **marks.get(id(sample), {}))

    def success(sample):
        return percent(sample.success.mean(), **({} if sample.has("usable") else marks.get(id(sample), {})))

    def time(title, of):
        return column(title, milliseconds, lambda sample: of(sample.latency), limit_ms=results.time_limit_ms)
    return [method_column(results), Column("usable %", usable), *of_conditions,
            Column("success %", success),
            column("mean IoU %", percent, lambda sample: sample.mean_iou),
            column("exact %", percent, lambda sample: np.mean(sample.category == "ground_truth")),
            time("p99 ms", lambda latency: quantile(latency, 0.99)), time("max ms", max),
            Column("scenes", lambda sample: scenes_cell(len(sample), sample.has("trained_on")))]


def _summary(results, conditions):
    """A row for each method over all that was measured, the best first."""
    def hint(condition):
        scenes = max(len(sample.at(condition=condition)) for sample in results.samples)
        return ", ".join(filter(None, (short(conditions, condition), f"n\u00a0=\u00a0{scenes}")))

    def in_condition(condition):
        return column(f"in {condition or 'none named'} %", percent,
                      lambda sample: share_and_interval(sample.at(condition=condition), "usable")[0], hint=hint(condition))
    of_conditions = list(map(in_condition, results.conditions)) if len(results.conditions) > 1 else []
    return table("headline", _columns(results, _ahead(results, results.samples), of_conditions),
                 results.samples, attributes=lambda sample: {"method": sample.label},
                 note=f"All conditions, rates and ranges together. {_NOTE}{note_on_limit(results)}{note_on_training(results)}")


def by_rate(results, conditions):
    """The same measures by condition and rate of false positives."""
    blocks = []
    for condition in results.conditions:
        known = short(conditions, condition)
        for rate in results.rates:
            where = f"{percent_label(rate)} % false positives"
            parts = [part for sample in results.samples if len(part := sample.at(rate, condition=condition))]
            blocks.append((f"{condition}{f' ({known})' if known else ''}: {where}" if condition else where, parts))
    return table("by-rate", _columns(results, [part for _, parts in blocks for part in _ahead(results, parts)]),
                 blocks=[block for block in blocks if block[1]], caption="All methods by condition and false positives",
                 attributes=lambda sample: {"method": sample.label, "condition": sample.condition[0], "rate": sample.rate[0]},
                 note=f"All ranges together. {_NOTE}{note_on_limit(results)}{note_on_training(results)}")


def picture(results, data):
    """What a cone lane is: the lane of the first method that has one right, in the scene that the page begins with.
    Empty where the page has no scenes."""
    frame = data.frames.get(data.start)
    if frame is None:
        return ""
    slot = next((slot for slot, answer in enumerate(frame["a"]) if answer and answer[7] == 1), 0)
    label = results.samples[slot].label
    said = f"A cone lane: cones, false positives and the left and right boundary that {label} found"
    return (f'<figure id="cone-lane" class="scene">{gallery.drawing(data.start, slot, said, zoom=True)}<figcaption>A cone lane in a scene of '
            f"these results, as {escape(label)} found it. {gallery.short_legend()}</figcaption></figure>")


def _methods(results, data):
    """A line and a small picture of each method: its lane in the same scene."""
    scene = data.start or None
    answers = data.frames[scene]["a"] if scene else []
    right = sum(1 for answer in answers if answer and answer[7] == 1)
    cards = []
    for slot, sample in enumerate(results.samples):
        line, source = described(results, sample.method)
        here = f"<br>Here: {escape(gallery.said(answers[slot]))}." if answers else ""
        color = results.methods.index(sample.method) % METHOD_COLORS
        picture = "" if scene is None else gallery.drawing(scene, slot, f"lane of {sample.label}", zoom=True)
        cards.append(f'<figure class="scene" data-method="{escape(sample.label)}">{picture}<figcaption>'
                     f'<span class="swatch" style="background:var(--m{color})"></span><b>{escape(sample.label)}</b> '
                     f"{escape(line)} <i>{escape(source)}</i>{here}</figcaption></figure>")
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


def html(results, data, conditions):
    return _summary(results, conditions) + _methods(results, data)
