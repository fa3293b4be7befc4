#!/usr/bin/env python3
"""ft-fsd-path-planning (FaSTTUBe, MIT) as a method from outside.

    pip install fsd-path-planning          # or: pip install git+https://github.com/papalotis/ft-fsd-path-planning
    python3 ft_fsd_adapter.py --warm-up    # once: compiles it, which takes a minute
    conelane compare --methods clc "exec:ft-fsd=python3 ft_fsd_adapter.py" --out DIR

It answers with the cones that its sorting gives each side; with --path by the path that its whole pipeline plans. With
--colors it gets the colours of the scene, without it no cone has one. `latency_ms` is the time in its own code.
"""
import json
import sys
import time
import warnings

import numpy as np
from fsd_path_planning import ConeTypes, MissionTypes, PathPlanner
from fsd_path_planning.sorting_cones.core_cone_sorting import ConeSortingInput

warnings.simplefilter("ignore", DeprecationWarning)  # versions differ in how the sorting is called
TYPES = {"blue": ConeTypes.LEFT, "yellow": ConeTypes.RIGHT, "orange": ConeTypes.START_FINISH_AREA,
         "big_orange": ConeTypes.START_FINISH_LINE, "unknown": ConeTypes.UNKNOWN}
WARM_UP = {"id": "0", "pose": {"x": -1, "y": 0, "yaw": 0},
           "cones": [{"x": 4 * i, "y": y} for i in range(8) for y in (-1.75, 1.75)]}


def sort(planner, cones, position, direction):
    planner.cone_sorting.set_new_input(ConeSortingInput(cones, position, direction))
    left, right = planner.cone_sorting.run_cone_sorting()
    if not len(left) and not len(right):
        return {"status": "none"}
    return {"status": "found", "left_points": np.asarray(left).tolist(), "right_points": np.asarray(right).tolist()}


def plan(planner, cones, position, direction):
    path = planner.calculate_path_in_global_frame(cones, position, direction)
    return {"status": "found", "centre_line": np.asarray(path)[:, 1:3].tolist()}


def answer(planner, how, scene):
    pose = scene["pose"]
    by_type = [[] for _ in ConeTypes]
    for cone in scene["cones"]:
        by_type[TYPES[cone.get("color", "unknown")] if "--colors" in sys.argv else ConeTypes.UNKNOWN].append([cone["x"], cone["y"]])
    cones = [np.array(places, dtype=float).reshape(-1, 2) for places in by_type]
    start = time.perf_counter()
    try:
        lane = how(planner, cones, np.array([pose["x"], pose["y"]], dtype=float),
                   np.array([np.cos(pose["yaw"]), np.sin(pose["yaw"])]))
    except Exception as failure:  # an error of the planner loses one scene, not the run
        lane = {"status": "error", "message": f"{type(failure).__name__}: {failure}"}
    return {"scene": scene["id"], "latency_ms": 1000 * (time.perf_counter() - start), **lane}


def main():
    how = plan if "--path" in sys.argv else sort
    planner = PathPlanner(MissionTypes.trackdrive)
    if "--warm-up" in sys.argv:
        print(json.dumps([answer(planner, how, WARM_UP) for how in (sort, plan)], indent=1))
        return
    for line in sys.stdin:
        scene = json.loads(line)
        if scene.get("reset"):  # a new lap: the planner keeps its last path
            planner = PathPlanner(MissionTypes.trackdrive)
        else:
            print(json.dumps(answer(planner, how, scene)), flush=True)


main()
