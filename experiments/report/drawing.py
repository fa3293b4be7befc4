"""What a drawing of a scene is made of, the same in the viewer, the gallery and `conelane plot`. marks.json says how
each part is marked: sizes, widths and dashes in pixels of the viewer, colours as names of style.css."""

import json
import pkgutil

import numpy as np

MARKS = json.loads(pkgutil.get_data(__package__, "marks.json"))


def driven_ahead(boundaries, pose):
    """The path that was driven as (ahead, left) of the car [m]; empty where boundaries are the truth."""
    driven = boundaries.get("driven", [])
    return in_car_frame(pose, np.array(driven, dtype=float).reshape(-1, 2)) if driven else np.empty((0, 2))


def in_car_frame(pose, positions):
    """Positions [m] as seen from a pose: ahead and to the left."""
    x, y, yaw = pose
    return (positions - (x, y)) @ np.array([[np.cos(yaw), -np.sin(yaw)], [np.sin(yaw), np.cos(yaw)]])


def solid_and_bridged(points, is_closed, longest_gap):
    """A boundary as its solid stretches and its bridged steps, those longer than `longest_gap`."""
    line = list(points) + (list(points[:1]) if is_closed and len(points) > 2 else [])
    solid, bridged = [line[:1]], []
    for start, end in zip(line, line[1:]):
        if np.hypot(end[0] - start[0], end[1] - start[1]) > longest_gap:
            bridged.append([start, end])
            solid.append([end])
        else:
            solid[-1].append(end)
    return [piece for piece in solid if len(piece) > 1], bridged
