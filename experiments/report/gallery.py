"""The error gallery: the worst scenes of each method in each condition as small pictures."""

from html import escape

from .load import CATEGORIES, CAUSES
from .scenes import WORST, WORST_APART_M, WORST_OF_A_TRACK
from .theme import METHOD_COLORS

CATEGORY_WORDS = {"ground_truth": "ground truth", "near_ground_truth": "near ground truth", "too_short": "too short",
                  "diverging_from_20": "diverges after 20 m", "diverging_below_20": "diverges within 20 m",
                  "none": "no lane"}
CAUSE_WORDS = list(CAUSES.values())


def drawing(scene, slot, said, zoom=False):
    """A place for one scene with the lane of one method, which frames.js fills; with `zoom` around the usable lanes of all."""
    return (f'<div role="img" aria-label="{escape(said)}"><canvas data-scene="{escape(scene)}" data-slot="{slot}"'
            f'{" data-zoom=all" if zoom else ""}></canvas></div>')


def said(answer):
    """The outcome of an answer, in words."""
    if not answer:
        return "no answer stored"
    iou, category, usable, cause = answer[4], answer[5], answer[7], answer[8]
    words = (CAUSE_WORDS[cause] if cause is not None else
             "usable" if usable else CATEGORY_WORDS[CATEGORIES[category]])
    return f"{words}, IoU {'unknown' if iou is None else f'{100 * iou:.1f} %'}"


def _card(data, slot, scene):
    what = said(data.frames[scene]["a"][slot])
    return (f'<figure class="scene">{drawing(scene, slot, what)}<figcaption>{escape(what)}<br>'
            f'<button type="button" class="link" data-open="{escape(scene)}">{escape(scene)}</button></figcaption></figure>')


def short_legend():
    """What the parts are that a reader must know first."""
    return ("<b class='left-key'>━</b> left, <b class='right-key'>━</b> right boundary; ● cone; × false positive; "
            '<span class="driven-key">▲</span> car.')


def legend():
    """What the parts of a drawing are."""
    marks = (("<b class='left-key'>━</b> left boundary", "<b class='right-key'>━</b> right boundary",
              "┅ bridges a gap", '<span class="band-key"></span> ground truth', "● cone", "○ cone that was missed",
              "× false positive", '<span class="driven-key">┅</span> path that was driven',
              '<span class="driven-key">▲</span> car'))
    return '<p class="note marks">' + " ".join(f'<span class="key">{mark}</span>' for mark in marks) + "</p>"


def html(results, data):
    if data.missing:
        return f'<p class="left-out"><b>Gallery.</b> Left out: {escape(data.missing)}</p>'
    blocks = []
    for slot, sample in enumerate(results.samples):
        color = results.methods.index(sample.method) % METHOD_COLORS
        for condition in results.conditions:
            scenes = data.worst.get((sample.label, condition), ())
            if not scenes:
                continue
            title = f"{sample.label}, {condition}" if condition else sample.label
            wrong = data.wrong.get((sample.label, condition), len(scenes))
            tail = f"{len(scenes)} of {wrong} lanes that are not usable" if wrong > len(scenes) else (
                f"{wrong} lane{'s are' if wrong > 1 else ' is'} not usable")
            cards = "".join(_card(data, slot, scene) for scene in scenes)
            blocks.append(f'<details class="worst" open data-method="{escape(sample.label)}" '
                          f'data-condition="{escape(condition)}"><summary>'
                          f'<span class="swatch" style="background:var(--m{color})"></span><b>{escape(title)}</b> '
                          f'<small>{tail}</small></summary><div class="scenes">{cards}</div></details>')
    if not blocks:
        return "<p>Every lane of the scenes on this page is usable: there is nothing to show.</p>"
    return (f"<p>What went wrong: up to {WORST} lanes of each method in each condition that are not usable, over all rates "
            f"and ranges, the lowest IoU first. At most {WORST_OF_A_TRACK} are of one track, and these at least "
            f"{WORST_APART_M:g} m apart. A scene's name opens it in the viewer.</p>{legend()}" + "".join(blocks))
