"""Scenes as small drawings, the car below looking up: the best, the median and the worst of each method."""

from html import escape

from .figures import percent_label
from .load import CATEGORIES
from .scenes import gallery_rate
from .theme import METHOD_COLOURS

CATEGORY_WORDS = {"ground_truth": "ground truth", "near_ground_truth": "near ground truth", "too_short": "too short",
                  "diverging_from_20": "diverges after 20 m", "diverging_below_20": "diverges within 20 m",
                  "none": "no lane"}


_ASPECT = 1.35  # width over height of a drawing


def _points(frame, indices):
    """Car frame to drawing: x ahead becomes up, y to the left stays left; metres."""
    cones = frame["c"]
    return [(-cones[2 * i + 1] / 100, -cones[2 * i] / 100) for i in indices]


def _path(points, closed=False):
    return "M" + "L".join(f"{x:.1f} {y:.1f}" for x, y in points) + ("Z" if closed else "") if points else ""


def _band(frame):
    left, right, closed = frame["g"]
    left, right = _points(frame, left), _points(frame, right)
    if closed:
        return _path(left, True) + _path(right[::-1], True)
    return _path(left + right[::-1], True)


def drawing(frame, samples, methods, subject):
    """All lanes of a scene, that of `subject` above the others."""
    shown = set(frame["g"][0] + frame["g"][1])
    for answer in frame["a"]:
        shown.update(answer[0] + answer[1] if answer else ())
    xs, ys = zip(*_points(frame, sorted(shown)), (0.0, 0.0))
    middle = 0.5 * (min(xs) + max(xs))
    half = 0.5 * max(max(xs) - min(xs), _ASPECT * (max(ys) - min(ys)), 12.0) + 3.0  # round what matters: the lanes
    height = 2.0 * half / _ASPECT
    top = 0.5 * (min(ys) + max(ys)) - 0.5 * height
    parts = [f'<path class="band" fill-rule="evenodd" d="{_band(frame)}"/>']
    split = len(frame["c"]) // 2 - frame["f"]
    radius = half / 70
    for x, y in _points(frame, range(split, len(frame["c"]) // 2)):
        r = radius * 1.1
        parts.append(f'<path class="stray" d="M{x - r:.2f} {y - r:.2f}l{2 * r:.2f} {2 * r:.2f}m0 {-2 * r:.2f}'
                     f'l{-2 * r:.2f} {2 * r:.2f}"/>')
    order = [i for i in range(len(samples)) if samples[i].label != subject]
    order += [i for i in range(len(samples)) if samples[i].label == subject]
    for i in order:
        answer = frame["a"][i]
        if not answer:
            continue
        path = "".join(_path(_points(frame, side), answer[2]) for side in answer[:2])
        if path:
            kind = "lane" if samples[i].label == subject else "lane other"
            colour = methods.index(samples[i].method) % METHOD_COLOURS
            parts.append(f'<path class="{kind}" style="stroke:var(--m{colour})" d="{path}"/>')
    for x, y in _points(frame, range(split)):
        parts.append(f'<circle class="cone" cx="{x:.2f}" cy="{y:.2f}" r="{radius:.2f}"/>')
    car = half / 26
    parts.append(f'<path class="car" d="M0 {-car:.2f}L{0.7 * car:.2f} {car:.2f}H{-0.7 * car:.2f}Z"/>')
    return (f'<svg viewBox="{middle - half:.1f} {top:.1f} {2 * half:.1f} {height:.1f}" aria-hidden="true">'
            f'{"".join(parts)}</svg>')


def _card(data, samples, methods, label, word, scene):
    frame = data.frames[scene]
    slot = next(i for i, sample in enumerate(samples) if sample.label == label)
    answer = frame["a"][slot]
    what = (f"IoU {100 * answer[4]:.1f} %, {CATEGORY_WORDS[CATEGORIES[answer[5]]]}, {answer[3]:.2f} ms" if answer
            else "no answer stored")
    return (f'<figure class="scene"><div role="img" aria-label="{escape(f"{word} scene of {label}: {what}")}">'
            f"{drawing(frame, samples, methods, label)}</div>"
            f"<figcaption><b>{word}</b> {escape(what)}<br>"
            f'<button type="button" class="link" data-open="{escape(scene)}">{escape(scene)}</button>'
            f"</figcaption></figure>")


def html(results, data):
    if data.missing:
        return f'<p class="left-out"><b>Gallery.</b> Left out: {escape(data.missing)}</p>'
    blocks = []
    for sample in results.samples:
        cards = "".join(_card(data, results.samples, results.methods, sample.label, word, scene)
                        for word, scene in data.picks.get(sample.label, ()))
        colour = results.methods.index(sample.method) % METHOD_COLOURS
        blocks.append(f'<h4><span class="swatch" style="background:var(--m{colour})"></span>{escape(sample.label)}</h4>'
                      f'<div class="scenes">{cards}</div>')
    rate = percent_label(gallery_rate(results))
    return (f"<p>Best, median and worst scene of each method by IoU, at {rate} % false positives. The band is the "
            "ground truth, the strong lines are the method's lane, the faint ones the other methods'; dots are cones, "
            "crosses false positives. A scene's name opens it in the viewer.</p>" + "".join(blocks))
