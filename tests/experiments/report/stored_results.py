"""write_results(FOLDER, ...): results as `conelane compare` stores them, of made-up scores on straight courses, to see
what the report makes of them."""

import json
import math
import os
import random
from dataclasses import dataclass, field

STEP_M = 4.0  # from cone to cone
WIDTH_M = 3.0
CAUSES = ("wrong_start", "wrong_leg", "false_cone", "cone_skipped", "gap_not_bridged", "stopped_early")


@dataclass
class Setup:
    tracks: tuple = ("one", "two", "three")
    runs: tuple = ()  # tracks with a driven path instead of boundaries
    conditions: tuple = ("paper", "car")  # of no name: ("",)
    rates: tuple = (0.0, 0.3)
    ranges: tuple = (30.0,)
    poses: int = 8  # of a lap
    every_m: float = 10.0
    methods: tuple = ("first", "second")
    points: tuple = ()  # methods that answer with points
    centre_lines: tuple = ()  # methods that answer with a centre line alone
    old: bool = False  # as stored before there was anything but success
    seed: int = 1
    trained_on: dict = field(default_factory=dict)  # method -> tracks
    outside: dict = field(default_factory=dict)  # method -> what its rows say of it


def _cones(setup, pose_x, rate, range_m, rng):
    """Ids of the left boundary are even, of the right one odd, of false positives above 100000."""
    first, last = math.ceil(pose_x / STEP_M), math.floor((pose_x + range_m) / STEP_M)
    cones = [{"id": 2 * i + side, "x": STEP_M * i, "y": WIDTH_M / 2 * (1 - 2 * side)}
             for i in range(first, last) for side in (0, 1)]
    strays = round(rate / (1 - rate) * len(cones)) if rate < 1 else 0
    cones += [{"id": 100000 + i, "x": round(pose_x + range_m * rng.random(), 4),
               "y": round(range_m * (rng.random() - 0.5), 4)} for i in range(strays)]
    return cones, [2 * i for i in range(first, last)], [2 * i + 1 for i in range(first, last)]


def _scenes(setup):
    for condition in setup.conditions:
        for track in setup.tracks + setup.runs:
            for rate in setup.rates:
                for range_m in setup.ranges:
                    rng = random.Random(f"{setup.seed}/{condition}/{track}/{rate}/{range_m}")
                    for pose in range(setup.poses):
                        x = setup.every_m * pose
                        cones, left, right = _cones(setup, x, rate, range_m, rng)
                        tail = f"/{condition}" if condition else ""
                        scene = {"id": f"{track}/pose_{pose:04}/fp_{rate:.2f}/range_{range_m:g}{tail}",
                                 "pose": {"x": x, "y": 0.0, "yaw": 0.0}, "cones": cones}
                        if track not in setup.runs:
                            scene["ground_truth"] = {"left": left, "right": right, "closed": False}
                        scene |= {"track": track, "false_positive_rate": rate, "range": range_m, "seed": 0}
                        if condition:
                            scene["condition"] = condition
                        if condition == "car":
                            scene["missed"] = [{"id": 99, "x": x + 6.0, "y": WIDTH_M / 2}]
                        yield scene, left, right


def _score(setup, method, scene, rng):
    has_iou = scene["track"] not in setup.runs and method not in setup.centre_lines
    usable = rng.random() < 0.8
    score = {"scene": scene["id"], "method": method, "track": scene["track"],
             "false_positive_rate": scene["false_positive_rate"], "range": scene["range"]}
    if "condition" in scene:
        score["condition"] = scene["condition"]
    score |= {"status": "found", "category": "near_ground_truth" if usable else "diverging_below_20"}
    if not setup.old:
        score["usable"] = usable
        if not usable:
            score["cause"] = rng.choice(CAUSES)
    if has_iou:
        score["iou"] = round(0.9 + 0.1 * rng.random() if usable else 0.5 * rng.random(), 6)
    score |= {"lane_length_m": 24.0, "ground_truth_length_m": 28.0}
    if not setup.old and usable:
        score |= {"lateral_median_m": 0.1, "lateral_max_m": 0.3, "heading_error_rad": 0.01, "steady": True}
    if scene["track"] in setup.trained_on.get(method, ()):
        score["trained_on"] = True
    score |= {"cones": len(scene["cones"]), "latency_ms": round(0.1 + rng.random(), 6)}
    return score


def _lane(setup, method, scene, left, right, score):
    lane = {"scene": scene["id"], "method": method, "status": "found"}
    if method in setup.centre_lines:
        lane["centre_line"] = [[scene["pose"]["x"] + step, 0.1] for step in (0.0, 8.0, 16.0)]
    elif method in setup.points:
        lane["left_points"] = [[scene["pose"]["x"] + step, 1.4] for step in (0.0, 8.0, 16.0)]
        lane["right_points"] = [[scene["pose"]["x"] + step, -1.4] for step in (0.0, 8.0, 16.0)]
    else:
        strays = [cone["id"] for cone in scene["cones"] if cone["id"] >= 100000][:1]
        wrong = strays if score["category"] == "diverging_below_20" else []
        lane |= {"left": left[:3] + wrong, "right": right[:4]}
    return lane | {"closed": False, "latency_ms": score["latency_ms"]}


class _Row:
    """A line of results.jsonl while its scores come in."""

    def __init__(self):
        self.scenes, self.latencies, self.sums, self.known, self.categories = 0, [], {}, {}, {}

    def add(self, score):
        self.scenes += 1
        self.latencies.append(score["latency_ms"])
        self.categories[score["category"]] = self.categories.get(score["category"], 0) + 1
        for key in ("iou", "usable"):
            if key in score:
                self.sums[key] = self.sums.get(key, 0.0) + score[key]
                self.known[key] = self.known.get(key, 0) + 1

    def line(self, setup, key):
        method, condition, rate, range_m = key
        row = {"method": method, "false_positive_rate": rate, "range": range_m, "scenes": self.scenes}
        if condition:
            row["condition"] = condition
        row["share"] = {name: count / self.scenes for name, count in self.categories.items()}
        row["success_share"] = 1.0 - row["share"].get("diverging_below_20", 0.0)
        for name, of in (("mean_iou", "iou"), ("usable_share", "usable")):
            if of in self.known:
                row[name] = self.sums[of] / self.known[of]
        if not setup.old:
            row |= {"lateral_median_m": 0.1, "lateral_p95_m": 0.3, "heading_median_rad": 0.01,
                    "heading_p95_rad": 0.02, "unsteady_share": 0.125,
                    "calibration": {"error": 0.0125, "sure_share": 0.5, "usable_where_sure_share": 0.99,
                                    "right_where_trusted_share": 0.995, "trusted_share": 0.875,
                                    "bins": [[1, 0.35, 0.0], [self.scenes, 0.95, 0.9]]}}
        ordered = sorted(self.latencies)
        row["latency_ms"] = {"median": ordered[len(ordered) // 2], "mean": sum(ordered) / len(ordered),
                             "p95": ordered[int(0.95 * (len(ordered) - 1))],
                             "p99": ordered[int(0.99 * (len(ordered) - 1))], "max": ordered[-1],
                             "shifted_geometric_mean": sum(ordered) / len(ordered)}
        return row | setup.outside.get(method, {})


def write_results(folder, setup):
    os.makedirs(folder, exist_ok=True)

    def path(name):
        return os.path.join(folder, name)

    tracks = {track: {"left": [[-20.0, 1.5], [400.0, 1.5]], "right": [[-20.0, -1.5], [400.0, -1.5]], "closed": False}
              for track in setup.tracks}
    for track in setup.tracks:  # cones of the course are those on it
        for side, y in (("left", 1.5), ("right", -1.5)):
            tracks[track][side] = [[STEP_M * i, y] for i in range(-5, int(setup.every_m * setup.poses / STEP_M) + 20)]
    for track in setup.runs:
        tracks[track] = {"left": [], "right": [], "closed": False,
                         "driven": [[float(x), 0.2] for x in range(-5, int(setup.every_m * setup.poses) + 60)]}
    rows, rng = {}, random.Random(setup.seed)
    with open(path("scenes.scenes.jsonl"), "w", encoding="utf-8") as scenes:
        lanes = {method: open(path(f"{method}.lanes.jsonl"), "w", encoding="utf-8") for method in setup.methods}
        parts = {method: open(path(f"{method}.scores"), "w+", encoding="utf-8") for method in setup.methods}
        for scene, left, right in _scenes(setup):
            scenes.write(json.dumps(scene, separators=(",", ":")) + "\n")
            for method in setup.methods:
                score = _score(setup, method, scene, rng)
                lane = _lane(setup, method, scene, left, right, score)
                lanes[method].write(json.dumps(lane, separators=(",", ":")) + "\n")
                parts[method].write(json.dumps(score, separators=(",", ":")) + "\n")
                key = (method, scene.get("condition", ""), scene["false_positive_rate"], scene["range"])
                rows.setdefault(key, _Row()).add(score)
    with open(path("scores.jsonl"), "w", encoding="utf-8") as scores:  # a method after the other
        for method in setup.methods:
            lanes[method].close()
            parts[method].seek(0)
            for line in parts[method]:
                scores.write(line)
            parts[method].close()
            os.unlink(path(f"{method}.scores"))
    with open(path("results.jsonl"), "w", encoding="utf-8") as results:
        for method in setup.methods:
            for key, row in rows.items():
                if key[0] == method:
                    results.write(json.dumps(row.line(setup, key)) + "\n")
    for name, value in (("scenes.tracks.json", tracks),
                        ("run.json", {"commit": "made-up", "methods": [{"name": name} for name in setup.methods]})):
        with open(path(name), "w", encoding="utf-8") as stream:
            json.dump(value, stream)
