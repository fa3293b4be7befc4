"""Lane detection between cones.

>>> import conelane
>>> cones = [[2, -1.5], [2, 1.5], [6, -1.5], [6, 1.5], [10, -1.5], [10, 1.5]]
>>> lane = conelane.Detector("front").detect(cones, pose=(0, 0, 0))
>>> lane.centre_line(step_m=1.0).shape
(9, 7)

Lengths are in metres, angles in radians (counter-clockwise, 0 along +x), times in milliseconds (`..._ms`) or
seconds (`..._s`). Invalid input raises a `ValueError`.
"""
from enum import IntEnum

from . import _core
from ._core import Answer, Detector, DrivableLane, Lane, Plan, Planner, RldSolution, Scene, methods, rld_parameters, solve_rld, speed_profile
from ._core import version as __version__

try:
    from ._core import (Boundaries, Score, Track, generate_scenes, load_tracks, read_boundaries, read_lanes, read_scenes, score,
                        write_boundaries, write_lanes, write_scenes)
except ImportError:  # a build of the core alone
    pass

_ALL = ["Answer", "Boundaries", "Color", "Detector", "DrivableLane", "Lane", "NO_ID", "Plan", "Planner", "RldSolution", "Scene", "Score",
        "Track", "generate_scenes", "load_tracks", "methods", "read_boundaries", "read_lanes", "read_scenes", "rld_parameters", "score",
        "solve_rld", "speed_profile", "write_boundaries", "write_lanes", "write_scenes"]
__all__ = [name for name in _ALL if name in ("Color", "NO_ID") or hasattr(_core, name)]

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


def __getattr__(name: str) -> None:
    of_files = ": this build is the core alone; docs/python.md says how to build files, courses and scores" if name in _ALL else ""
    raise AttributeError(f"module 'conelane' has no attribute '{name}'{of_files}")
