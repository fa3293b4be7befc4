"""The error gallery: the worst scenes of each method in each condition as small drawings, the car below looking up."""

from html import escape

from .drawing import MARKS, driven_ahead, solid_and_bridged
from .load import CATEGORIES, CAUSES
from .scenes import WORST, WORST_APART_M, WORST_OF_A_TRACK
from .theme import METHOD_COLORS

CATEGORY_WORDS = {"ground_truth": "ground truth", "near_ground_truth": "near ground truth", "too_short": "too short",
                  "diverging_from_20": "diverges after 20 m", "diverging_below_20": "diverges within 20 m",
                  "none": "no lane"}
CAUSE_WORDS = list(CAUSES.values())

_ASPECT = 1.2  # width over height of a drawing
_CONE_PX = 3.4  # across; the drawings are small


def _points(flat):
    """Car frame in centimetres to drawing: x ahead becomes up, y to the left stays left; metres."""
    return [(-flat[i + 1] / 100, -flat[i] / 100) for i in range(0, len(flat), 2)]


def _number(value):
    """As short as SVG takes it: -.5, 3, 12.1."""
    text = f"{value:.1f}".removesuffix(".0")
    return "0" if text in ("-0", "0") else text.replace("0.", ".", 1) if abs(value) < 0.95 else text


def _path(points, closed=False):
    if not points:
        return ""
    return "M" + "L".join(f"{_number(x)} {_number(y)}" for x, y in points) + ("Z" if closed else "")


def _side(cones, side):
    return _points(side["p"]) if isinstance(side, dict) else [cones[i] for i in side]


class _View:
    """What a drawing shows: round the truth and the lane, for these matter."""

    def __init__(self, points):
        xs, ys = zip(*points, (0.0, 0.0))
        self.half = 0.5 * max(max(xs) - min(xs), _ASPECT * (max(ys) - min(ys)), 12.0) + 2.0
        self.middle = 0.5 * (min(xs) + max(xs))
        self.height = 2.0 * self.half / _ASPECT
        self.top = 0.5 * (min(ys) + max(ys)) - 0.5 * self.height

    def box(self):
        return (f"{_number(self.middle - self.half)} {_number(self.top)} {_number(2 * self.half)} "
                f"{_number(self.height)}")

    def _has(self, point):
        return abs(point[0] - self.middle) < self.half and self.top < point[1] < self.top + self.height

    def inside(self, points):
        return [point for point in points if self._has(point)]

    def pieces(self, line):
        """The stretches of a line that are inside."""
        found = [[]]
        for point in line:
            if self._has(point):
                found[-1].append(point)
            elif found[-1]:
                found.append([])
        return [piece for piece in found if len(piece) > 1]


def _driven(results, frame, track):
    """The path that was driven, from above as the car looks; empty where boundaries are the truth."""
    x, y, yaw = frame["p"]
    ahead = driven_ahead(results.tracks.get(track, {}), (x / 100, y / 100, yaw / 1000))
    return [(-left, -along) for along, left in ahead]


def _dashes(mark):
    return " ".join(f"{part:g}" for part in mark["dash"])


def style():
    """The look of the drawings, from marks.json, for the page."""
    rules = [f'.scene .band {{ fill: var(--{MARKS["band"]["color"]}); fill-opacity: {MARKS["band"]["opacity"]:g}; }}',
             f'.scene .car {{ fill: var(--{MARKS["car"]["color"]}); }}']
    for kind in ("driven", "false", "missed"):
        mark = MARKS[kind]
        dash = f"; stroke-dasharray: {_dashes(mark)}" if "dash" in mark else ""
        rules.append(f'.scene .{kind} {{ stroke: var(--{mark["color"]}); stroke-width: {mark["width"]:g}{dash}; }}')
    rules.append(f'.scene .cone {{ stroke: var(--{MARKS["cone"]["color"]}); stroke-width: {_CONE_PX:g}; '
                 "stroke-linecap: round; }")
    rules.append(f'.scene .lane {{ stroke-width: {MARKS["lane"]["width"]:g}; stroke-linejoin: round; }}')
    rules += [f'.scene .lane.{side} {{ stroke: var(--{side}); }}' for side in ("left", "right")]
    rules.append(f'.scene .bridged {{ stroke-dasharray: {_dashes(MARKS["bridged"])}; }}')
    return "\n".join(rules)


def view_of(frame):
    """One view of a scene for all methods: round the truth and the usable lanes."""
    cones = _points(frame["c"])
    truth = [cones[i] for side in frame["g"][:2] for i in side]
    lanes = [point for answer in frame["a"] if answer and answer[7] == 1
             for side in answer[:2] for point in _side(cones, side)]
    return _View(truth + lanes or cones)


def drawing(results, frame, slot, track, longest_gap_m, view=None):
    """One scene with the lane of one method, its left and right boundary in their colours; a centre line alone in that
    of the method. Without a `view` one round the truth and the lane."""
    cones = _points(frame["c"])
    split = len(cones) - frame["f"]
    left, right, closed = ([cones[i] for i in frame["g"][0]], [cones[i] for i in frame["g"][1]], frame["g"][2])
    answer = frame["a"][slot]
    sides = [_side(cones, side) for side in answer[:2]] if answer else []
    view = view or _View(left + right + [point for side in sides for point in side] + ([] if left else cones[:split]))
    band = _path(left, True) + _path(right[::-1], True) if closed else _path(left + right[::-1], True)
    radius = view.half / 60
    parts = [f'<path class="band" d="{band}"/>'] if band else []
    driven = "".join(map(_path, view.pieces(_driven(results, frame, track))))
    if driven:
        parts.append(f'<path class="driven" d="{driven}"/>')
    cross = _number(2 * radius)
    strays = "".join(f"M{_number(x - radius)} {_number(y - radius)}l{cross} {cross}m0-{cross}l-{cross} {cross}"
                     for x, y in view.inside(cones[split:]))
    if strays:
        parts.append(f'<path class="false" d="{strays}"/>')
    color = results.methods.index(results.samples[slot].method) % METHOD_COLORS
    is_line = len(sides) == 2 and not sides[1] and isinstance(answer[0], dict)
    for name, side in zip(("left", "right"), sides):
        look = f'style="stroke:var(--m{color})" ' if is_line else ""
        for kind, lines in zip(("lane", "lane bridged"), solid_and_bridged(side, answer[2], longest_gap_m)):
            if lines:
                parts.append(f'<path class="{kind}{"" if is_line else " " + name}" {look}d="{"".join(map(_path, lines))}"/>')
    dots = "".join(f"M{_number(x)} {_number(y)}h0" for x, y in view.inside(cones[:split]))
    if dots:
        parts.append(f'<path class="cone" d="{dots}"/>')
    for x, y in view.inside(_points(frame.get("m", []))):
        parts.append(f'<circle class="missed" cx="{_number(x)}" cy="{_number(y)}" r="{radius:.2f}"/>')
    car = view.half / 22
    parts.append(f'<path class="car" d="M0-{car:.1f}L{0.7 * car:.1f} {car:.1f}H-{0.7 * car:.1f}Z"/>')
    return f'<svg viewBox="{view.box()}" aria-hidden="true">{"".join(parts)}</svg>'


def said(answer):
    """The outcome of an answer, in words."""
    if not answer:
        return "no answer stored"
    iou, category, usable, cause = answer[4], answer[5], answer[7], answer[8]
    words = (CAUSE_WORDS[cause] if cause is not None else
             "usable" if usable else CATEGORY_WORDS[CATEGORIES[category]])
    return f"{words}, IoU {'unknown' if iou is None else f'{100 * iou:.1f} %'}"


def _card(results, data, slot, track_of, scene):
    frame = data.frames[scene]
    what = said(frame["a"][slot])
    return (f'<figure class="scene"><div role="img" aria-label="{escape(what)}">'
            f"{drawing(results, frame, slot, track_of[scene], data.longest_gap_m)}</div><figcaption>{escape(what)}<br>"
            f'<button type="button" class="link" data-open="{escape(scene)}">{escape(scene)}</button>'
            "</figcaption></figure>")


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
    track_of = {scene: lap["track"] for lap in data.laps for scene in lap["scenes"]}
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
            cards = "".join(_card(results, data, slot, track_of, scene) for scene in scenes)
            blocks.append(f'<details class="worst" open data-method="{escape(sample.label)}" '
                          f'data-condition="{escape(condition)}"><summary>'
                          f'<span class="swatch" style="background:var(--m{color})"></span><b>{escape(title)}</b> '
                          f'<small>{tail}</small></summary><div class="scenes">{cards}</div></details>')
    if not blocks:
        return "<p>Every lane of the scenes on this page is usable: there is nothing to show.</p>"
    return (f"<p>What went wrong: up to {WORST} lanes of each method in each condition that are not usable, over all rates "
            f"and ranges, the lowest IoU first. At most {WORST_OF_A_TRACK} are of one track, and these at least "
            f"{WORST_APART_M:g} m apart. A scene's name opens it in the viewer.</p>{legend()}" + "".join(blocks))
