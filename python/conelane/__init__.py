"""Lane detection between cones.

>>> import conelane
>>> cones = [[2, -1.5], [2, 1.5], [6, -1.5], [6, 1.5], [10, -1.5], [10, 1.5]]
>>> lane = conelane.Detector("front").detect(cones, pose=(0, 0, 0))
>>> lane.centre_line(step_m=1.0).shape
(9, 7)

Lengths are in metres, angles in radians (counter-clockwise, 0 along +x), times in milliseconds. Invalid
input raises a `ValueError`.
"""
from enum import IntEnum

from . import _core
from ._core import (Answer, Boundaries, Detector, DrivableLane, Lane, Plan, Planner, RldSolution, Scene, Score, Track, generate_scenes,
                    load_tracks, methods, read_boundaries, read_lanes, read_scenes, rld_parameters, score, solve_rld, write_boundaries,
                    write_lanes, write_scenes)
from ._core import version as __version__

__all__ = ["Answer", "Boundaries", "Color", "Detector", "DrivableLane", "Lane", "NO_ID", "Plan", "Planner", "RldSolution", "Scene", "Score",
           "Track", "generate_scenes", "load_tracks", "methods", "read_boundaries", "read_lanes", "read_scenes", "rld_parameters", "score",
           "solve_rld", "speed_profile", "write_boundaries", "write_lanes", "write_scenes"]

NO_ID = -(2**63)  # of a cone that has none, among ids of `Planner.update`


class Color(IntEnum):
    """Codes of cone colours; blue cones stand left of a lane, yellow ones right."""

    unknown = 0
    blue = 1
    yellow = 2
    orange = 3  # says nothing of the size
    big_orange = 4


for _name in set(__all__) & set(vars(_core)):
    globals()[_name].__module__ = "conelane"
