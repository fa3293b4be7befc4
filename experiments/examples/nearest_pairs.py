#!/usr/bin/env python3
"""A method from outside in Python, for `conelane compare --methods "exec:pairs-py=python3 nearest_pairs.py"`.

From the car outward it takes, 4 m after 4 m, the nearest cone to the left and to the right of the car's axis. That
finds straight lanes only: what matters here is how scenes come in and answers go out.
"""
import json
import math
import sys
import time

STEP_M = 4.0
for line in sys.stdin:
    scene = json.loads(line)
    if scene.get("reset"):  # another lap begins: forget what was carried along (here: nothing)
        continue
    start = time.perf_counter()
    pose = scene["pose"]
    cosine, sine = math.cos(pose["yaw"]), math.sin(pose["yaw"])
    nearest = {"left": {}, "right": {}}  # per side: step -> (distance from the axis, cone id)
    for cone in scene["cones"]:
        dx, dy = cone["x"] - pose["x"], cone["y"] - pose["y"]
        ahead, left = cosine * dx + sine * dy, cosine * dy - sine * dx
        side = nearest["left" if left > 0 else "right"]
        step = int(ahead // STEP_M)
        if ahead >= 0 and abs(left) < STEP_M:
            side[step] = min(side.get(step, (math.inf, 0)), (abs(left), cone["id"]))
    lane = {side: [steps[k][1] for k in sorted(steps)] for side, steps in nearest.items()}
    found = all(len(ids) >= 2 for ids in lane.values())
    answer = {"scene": scene["id"], "status": "found" if found else "none",
              "latency_ms": 1000 * (time.perf_counter() - start)}
    print(json.dumps(answer | lane if found else answer), flush=True)
