#!/usr/bin/env python3
"""Draws a scene as a detector gets it, and beside it the lane that was found.

docs/lane.svg was made by

    conelane scenes --tracks generated:hairpins --fp 0.5 --range 30 --every 5 --seed 1 --out h.scenes.jsonl
    conelane detect --method clc --time-limit 50 --scenes h.scenes.jsonl --out h.lanes.jsonl
    docs/draw_lane.py h.scenes.jsonl h.lanes.jsonl hairpins/pose_0016/fp_0.50/range_30 docs/lane.svg
"""

import json
import math
import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt

LEFT, RIGHT, OTHER, LANE = "#1f5fbf", "#e0a500", "#8a8a8a", "#dbe9f6"


def line_of(file, key, scene_id):
    with open(file, encoding="utf-8") as lines:
        for line in lines:
            record = json.loads(line)
            if record[key] == scene_id:
                return record
    sys.exit(f"draw_lane.py: {file} has no scene {scene_id}")


def in_car_frame(scene):
    """Cone id -> (right, ahead) of the car [m]: it drives up the page."""
    x, y, yaw = (scene["pose"][key] for key in ("x", "y", "yaw"))
    cos, sin = math.cos(yaw), math.sin(yaw)
    return {
        cone["id"]: (
            (cone["x"] - x) * sin - (cone["y"] - y) * cos,
            (cone["x"] - x) * cos + (cone["y"] - y) * sin,
        )
        for cone in scene["cones"]
    }


def draw_car(axes):
    axes.fill([0, 0.7, -0.7], [1.2, -0.8, -0.8], color="black", zorder=4)


def draw(scene, answer, out):
    # Same input, same bytes.
    plt.rcParams.update({"svg.fonttype": "none", "svg.hashsalt": "conelane", "font.size": 11})
    cones = in_car_frame(scene)
    figure, (given, found) = plt.subplots(1, 2, figsize=(12, 3.9), layout="constrained")
    for axes in (given, found):
        axes.set_aspect("equal")
        axes.axis("off")
        draw_car(axes)
    given.set_title(f"given: {len(cones)} cones without colours, and the pose")
    given.plot(*zip(*cones.values()), "o", color="black", markersize=3.5)

    left, right = ([cones[cone] for cone in answer[side]] for side in ("left", "right"))
    count = len(left) + len(right)
    found.set_title(f"found: a lane through {count} of them")
    others = [at for cone, at in cones.items() if cone not in answer["left"] + answer["right"]]
    found.plot(*zip(*others), "o", color=OTHER, markerfacecolor="none", markersize=3.5)
    found.fill(*zip(*(left + right[::-1])), color=LANE, zorder=0)
    for side, colour in ((left, LEFT), (right, RIGHT)):
        found.plot(*zip(*side), "-o", color=colour, markersize=4.5, linewidth=1.5)
    figure.savefig(out, facecolor="white", metadata={"Date": None} if out.endswith(".svg") else None)


if __name__ == "__main__":
    if len(sys.argv) != 5:
        sys.exit("usage: draw_lane.py SCENES.jsonl LANES.jsonl SCENE_ID OUT.svg|OUT.png")
    scenes_file, lanes_file, scene_id, out_file = sys.argv[1:]
    draw(line_of(scenes_file, "id", scene_id), line_of(lanes_file, "scene", scene_id), out_file)
