"""plot SCENE TRACKS LANES HOW PICTURE: one scene and its lanes as PICTURE, an .svg or .png. SCENE and LANES hold one
scene and the lanes to draw, TRACKS the scene's track or nothing, HOW what the caller knows beside. The caller has
checked them all, and gives a place of its own for PICTURE."""

import json
import math
import pkgutil
import warnings

import numpy as np
from matplotlib.patches import PathPatch
from matplotlib.path import Path

from .records import label_of, read_json, read_lines, run
from .scenes import boundary_points, frame_of, in_car_frame, sides_of
from .theme import METHOD_COLORS, SURFACE, picture_colors, pyplot

# How each part of a drawing is marked, here and in drawing.mjs: sizes, widths and dashes in pixels of the viewer, colours
# as names of style.css.
MARKS = json.loads(pkgutil.get_data(__package__, "marks.json"))
_POINTS = 0.75  # of a pixel
_ARC_EVERY_M = 10.0
_MARGIN_M = 1.5
_LEGEND_COLUMNS = 4
_LEGEND_ROW_IN = 0.21
_INCHES = {1: 6.4, 2: 12.0}  # across, by the number of panels


def _up(points):
    """(ahead, left) to a page on which the car looks up."""
    points = np.asarray(points, dtype=float).reshape(-1, 2)
    return np.column_stack([-points[:, 1], points[:, 0]])


def _of_frame(flat):
    """Centimetres of a frame, ahead and left in turn."""
    return _up(np.array(flat, dtype=float).reshape(-1, 2) / 100.0)


def _color(name):
    return f"conelane:{name}"


def _line_style(mark):
    """Width and dashes of a mark, in matplotlib's units: points, and dashes as multiples of the width."""
    width = mark.get("width", MARKS["lane"]["width"])
    dashes = {"linestyle": (0, [part / width for part in mark["dash"]])} if "dash" in mark else {}
    return {"linewidth": _POINTS * width} | dashes | ({"color": _color(mark["color"])} if "color" in mark else {})


class _Panel:
    """One drawing. Remembers what it holds, for the legend. In an SVG its points are groups with ids NAME-KIND."""

    def __init__(self, axes, name):
        self.axes, self.name, self.shown = axes, name, {}
        axes.set_aspect("equal")
        axes.axis("off")

    def line(self, points, kind, color=None, **style):
        if len(points) > 1:
            style = {"zorder": 2} | _line_style(MARKS[kind]) | ({"color": color} if color else {}) | style
            drawn, = self.axes.plot(*_columns(points), solid_joinstyle="round", **style)
            self.shown.setdefault(kind, drawn)

    def points(self, points, kind):
        if not len(points):
            return
        mark = MARKS[kind]
        color = _color(mark["color"])
        marker = {"dot": "o", "cross": "x", "ring": "o"}[mark["shape"]]
        drawn, = self.axes.plot(*_columns(points), marker, markersize=2 * _POINTS * mark["radius"], markeredgecolor=color,
                                markerfacecolor=color if mark["shape"] == "dot" else "none",
                                markeredgewidth=_POINTS * mark.get("width", 0.0), linestyle="", zorder=4)
        drawn.set_gid(f"{self.name}-{kind}")
        self.shown.setdefault(kind, drawn)

    def arcs(self, reach, right):
        """Distances from the car, named beside it on the right, where no lane is; as far as the drawing goes there."""
        angles = np.linspace(0.0, math.pi, 91)
        for radius in np.arange(_ARC_EVERY_M, reach + 1e-6, _ARC_EVERY_M):
            self.axes.plot(radius * np.cos(angles), radius * np.sin(angles), color=_color("grid"), linewidth=0.75,
                           zorder=0)
            if radius <= right:
                self.axes.annotate(f"{radius:g} m", (radius, 0), xytext=(-2, -9), textcoords="offset points", ha="right",
                                   fontsize=7, color=_color("muted"), annotation_clip=False)

    def car(self):
        outline = _up(MARKS["car"]["outline"])
        span = np.abs(outline).max()
        self.axes.plot(0, 0, marker=np.vstack([outline, outline[:1]]), markersize=2 * _POINTS * span, linestyle="",
                       color=_color(MARKS["car"]["color"]), markeredgewidth=0, zorder=5)


def _columns(points):
    return np.asarray(points, dtype=float).T


def _band(panel, cones, truth):
    left, right = cones[truth[0]], cones[truth[1]]
    if not len(left) or not len(right):
        return
    if truth[2]:  # the ring between both, the inner one run backwards
        rings = [np.vstack([left, left[:1]]), np.vstack([right[::-1], right[-1:]])]
        codes = [code for ring in rings for code in [Path.MOVETO] + [Path.LINETO] * (len(ring) - 1)]
        patch = PathPatch(Path(np.vstack(rings), codes), linewidth=0, zorder=1)
        panel.axes.add_patch(patch)
    else:
        patch, = panel.axes.fill(*np.vstack([left, right[::-1]]).T, linewidth=0, zorder=1)
    patch.set(color=_color(MARKS["band"]["color"]), alpha=MARKS["band"]["opacity"], linewidth=0)
    panel.shown["band"] = patch


def _lane(panel, cones, lane, pose, color, width, longest_gap_m):
    """`lane`: sides and closed as in a frame, and what is drawn beside. Steps longer than `longest_gap_m` are bridged."""
    gap = [(np.nan, np.nan)]
    for side in lane["sides"]:
        line = list(_of_frame(side["p"]) if isinstance(side, dict) else cones[side])
        line += line[:1] if lane["closed"] and len(line) > 2 else []
        solid, bridged = line[:1], []
        for start, end in zip(line, line[1:]):
            is_bridged = math.dist(start, end) > longest_gap_m
            solid += gap + [end] if is_bridged else [end]
            bridged += [start, end] + gap if is_bridged else []
        panel.line(solid, "lane", color, linewidth=width)
        panel.line(bridged, "bridged", color, linewidth=width)
    beside = lane["beside"]
    if "inferred" in beside:
        panel.line(_up(in_car_frame(pose, beside["inferred"])), "inferred", color, linewidth=width)
    if "trusted_end" in beside:
        panel.line(_up(in_car_frame(pose, beside["trusted_end"])), "trusted", color, zorder=3)


def _candidates(panel, cones, candidates, color):
    """Every step that a candidate takes, once."""
    steps = {(min(step), max(step)) for sides in candidates for side in sides for step in zip(side, side[1:])}
    gap = (np.nan, np.nan)
    panel.line([point for start, end in sorted(steps) for point in (cones[start], cones[end], gap)], "candidate", color,
               alpha=MARKS["candidate"]["opacity"])


def _said(line):
    """The method, and what it says of its lane."""
    words = [label_of(line["method"], line.get("nearest"))]
    if line["status"] != "found":
        words.append({"none": "no lane", "stopped": "stopped"}.get(line["status"], line["status"]))
    if "confidence" in line:
        words.append(f"confidence {100 * line['confidence']:.1f} %")
    if "trusted_m" in line:
        words.append(f"trusted {line['trusted_m']:.1f} m")
    return ", ".join(words)


def _legend(figure, panel, lanes):
    """Below: a row of the lanes, then what the marks mean; the order is that of marks.json. Its height in inches."""
    entries = lanes + [(panel.shown[kind], mark["word"]) for kind, mark in MARKS.items() if kind in panel.shown and "word" in mark]
    if entries:
        figure.legend(*zip(*entries), loc="lower center", ncol=min(_LEGEND_COLUMNS, len(entries)), handlelength=2.2)
    return _LEGEND_ROW_IN * math.ceil(len(entries) / _LEGEND_COLUMNS)


def _limits(panels, points, reach):
    """All that is drawn is inside, and no more."""
    points = np.vstack([points, [(0, 0)]])
    low, high = points.min(axis=0) - _MARGIN_M, points.max(axis=0) + _MARGIN_M
    low[1] = min(low[1], -2.0)
    for panel in panels:
        panel.arcs(min(reach, max(abs(low[0]), abs(high[0]), high[1])), high[0])
        panel.axes.set_xlim(low[0], high[0])
        panel.axes.set_ylim(low[1], high[1])
    return high - low


def draw(scene_file, tracks_file, lanes_file, how):
    """The figure."""
    (number, scene), = read_lines(scene_file)
    boundaries = read_json(tracks_file).get(scene.get("track", ""), {})
    frame, pose, index_of = frame_of(scene_file, number, scene, boundary_points(boundaries), how["noise_m"])
    lines = list(read_lines(lanes_file))
    lanes = [{"sides": sides_of(lanes_file, number, line, pose, index_of), "closed": line.get("closed", False),
              "candidates": [sides_of(lanes_file, number, one, pose, index_of) for one in line.get("candidates", ())],
              "beside": beside, "said": _said(line)} for (number, line), beside in zip(lines, how["overlays"])]
    cones = _of_frame(frame["c"])
    count = len(cones) - frame["f"]
    figure, all_axes = pyplot.subplots(1, 2 if how["with_given"] else 1, squeeze=False, layout="constrained")
    panels = [_Panel(axes, name) for axes, name in zip(all_axes[0], (["given"] if how["with_given"] else []) + ["found"])]
    if how["with_given"]:
        panels[0].points(cones, "cone")
        panels[0].axes.set_title(f"given: {len(cones)} cones and the pose", fontsize=10)
    found = panels[-1]
    if how["with_truth"]:
        _band(found, cones, frame["g"])
    found.line(_up(in_car_frame(pose, boundaries.get("driven", []))), "driven")
    handles = []
    mark = MARKS["lane"]
    wider = min(mark["wider"], (mark["widest"] - mark["width"]) / max(1, len(lanes) - 1))
    for place, lane in enumerate(lanes):  # lanes that lie on one another show as stripes: the first ones are broader
        color = _color(f"m{place % METHOD_COLORS}")
        width = _POINTS * (mark["width"] + wider * (len(lanes) - 1 - place))
        _candidates(found, cones, lane["candidates"], color)
        _lane(found, cones, lane, pose, color, width, how["longest_gap_m"])
        handles.append((pyplot.Line2D([], [], color=color, linewidth=width), lane["said"]))
    found.points(cones[:count], "cone")
    found.points(cones[count:], "false")
    found.points(_of_frame(frame.get("m", [])), "missed")
    found.axes.set_title(how["title"] or scene["id"], fontsize=10)
    for panel in panels:
        panel.car()
    shown = np.vstack([cones, _of_frame(frame.get("m", []))] +
                      [_of_frame(side["p"]) for lane in lanes for side in lane["sides"] if isinstance(side, dict)])
    reach = scene.get("range", float(np.hypot(*shown.T).max()) if len(shown) else _ARC_EVERY_M)
    width_m, height_m = _limits(panels, shown, reach)
    below = _legend(figure, found, handles) + 0.1
    across = _INCHES[len(panels)]
    high = across / len(panels) * height_m / width_m + 0.35
    figure.set_size_inches(across, high + below)
    figure.get_layout_engine().set(rect=(0, below / (high + below), 1, high / (high + below)))
    return figure


def main(arguments):
    scene_file, tracks_file, lanes_file, how_file, picture = arguments
    warnings.simplefilter("ignore")
    with picture_colors(), pyplot.rc_context({"svg.hashsalt": "conelane"}):
        figure = draw(scene_file, tracks_file, lanes_file, read_json(how_file))
        metadata = {"Date": None} if picture.endswith(".svg") else {"Software": None}
        figure.savefig(picture, dpi=160, facecolor=SURFACE, metadata=metadata)


if __name__ == "__main__":
    run(main)
