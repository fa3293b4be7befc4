"""The scenes that viewer and gallery show: cones in the car's frame, the ground truth, each method's lane. They are
reduced to whole centimetres and to as many poses as the page has room for."""

import glob
import json
import math
import os
from dataclasses import dataclass, field

import numpy as np

from .load import CATEGORIES, InputError, label_of, read_lines, require

MOST_BYTES = 9_000_000  # of all frames as JSON
_BYTES_PER_CONE = 11
_BYTES_PER_ANSWER = 90
_BYTES_PER_SCENE = 150
_SAME_PLACE_M = 0.01
_NOISE_FACTOR = 4.0  # a seen position is this many standard deviations off at most, nearly always

GALLERY_RATE = 0.3


@dataclass
class SceneData:
    frames: dict = field(default_factory=dict)  # scene id -> frame
    laps: list = field(default_factory=list)  # {"track", "rate", "range", "scenes": [ids in order of travel]}
    start: str = ""  # the scene to begin with
    stride: int = 1
    scene_count: int = 0  # scored ones, of which `frames` has a part
    picks: dict = field(default_factory=dict)  # label -> [(word, scene id)]
    missing: str = ""  # why there are none


def gallery_rate(results):
    """The stored rate nearest to the CLC paper's moderate one."""
    return min(results.rates, key=lambda rate: (abs(rate - GALLERY_RATE), rate))


def _picks(results):
    """Best, median and worst scene of each method by IoU, at one rate; ties in order of scene ids."""
    picks = {}
    for sample in results.samples:
        part = sample.at(gallery_rate(results))
        order = sorted(range(len(part)), key=lambda i: (-part.iou[i], part.scene[i]))
        if order:
            chosen = (("best", order[0]), ("median", order[(len(order) - 1) // 2]), ("worst", order[-1]))
            picks[sample.label] = [(word, part.scene[i]) for word, i in chosen]
    return picks


def _laps(results):
    """Scored scenes by (track, rate, range), in order of travel: that of the scores, which is that of the file."""
    place = {}
    for sample in results.samples:
        for row in zip(sample.scene, sample.track, sample.rate, sample.range, sample.cones):
            if row[0] not in place or row[4] > place[row[0]][3]:
                place[row[0]] = row[1:]
    laps = {}
    for scene, (track, rate, range_m, _) in place.items():
        laps.setdefault((track, rate, range_m), []).append(scene)
    size = sum(_BYTES_PER_SCENE + _BYTES_PER_CONE * cones + _BYTES_PER_ANSWER * len(results.samples)
               for *_, cones in place.values())
    return laps, math.ceil(size / MOST_BYTES), len(place)


def _centimetres(value):
    return round(100.0 * value)


def _boundary_points(results, track):
    boundaries = results.tracks.get(track)
    if not boundaries:
        return None
    return np.array(boundaries["left"] + boundaries["right"], dtype=float)


def _false_positives(positions, boundary, noise_m):
    """Which cones lie on no annotated boundary; none where the boundaries are unknown."""
    if boundary is None or not len(positions):
        return np.zeros(len(positions), bool)
    distances = np.hypot(positions[:, None, 0] - boundary[None, :, 0], positions[:, None, 1] - boundary[None, :, 1])
    return distances.min(axis=1) > max(_SAME_PLACE_M, _NOISE_FACTOR * noise_m)


def _frame(path, number, scene, boundary, noise_m):
    """The frame of a scene without its answers, and the index of each cone id in it. Cones come first, false
    positives last."""
    try:
        pose = scene["pose"]
        ids = [cone["id"] for cone in scene["cones"]]
        positions = np.array([(cone["x"], cone["y"]) for cone in scene["cones"]], dtype=float).reshape(-1, 2)
        truth = scene["ground_truth"]
        x, y, yaw = float(pose["x"]), float(pose["y"]), float(pose["yaw"])
        false_positive = _false_positives(positions, boundary, noise_m)
        order = sorted(range(len(ids)), key=lambda i: (bool(false_positive[i]), ids[i]))
        index_of = {ids[i]: place for place, i in enumerate(order)}
        ahead = (positions - (x, y)) @ np.array([[math.cos(yaw), -math.sin(yaw)], [math.sin(yaw), math.cos(yaw)]])
        return {"p": [_centimetres(x), _centimetres(y), round(1000 * yaw)],
                "c": [_centimetres(value) for i in order for value in ahead[i]],
                "f": int(false_positive.sum()),
                "g": [[index_of[i] for i in truth["left"]], [index_of[i] for i in truth["right"]],
                      int(truth.get("closed", False))]}, index_of
    except (KeyError, TypeError, ValueError) as error:
        raise InputError(f"{path}:{number}: no scene with pose, cones and ground truth ({error})") from None


def _add_answers(results, lanes_files, frames, indices):
    slots = {sample.label: slot for slot, sample in enumerate(results.samples)}
    scores = {sample.label: {scene: row for row, scene in enumerate(sample.scene) if scene in frames}
              for sample in results.samples}
    for path in lanes_files:
        for number, line in read_lines(path, frames):
            scene = require(path, number, line, "scene", (str,))
            label = label_of(require(path, number, line, "method", (str,)), line.get("nearest"))
            row = scores.get(label, {}).get(scene)
            if row is None:
                continue
            sample = results.samples[slots[label]]
            index_of = indices[scene]
            try:
                sides = [[index_of[i] for i in line.get(side, ())] for side in ("left", "right")]
            except KeyError as error:
                raise InputError(f"{path}:{number}: cone {error} is not in the scene") from None
            accurate = sample.accurate[row]
            frames[scene]["a"][slots[label]] = sides + [
                int(bool(line.get("closed", False))), float(f"{sample.latency[row]:.4g}"),
                round(float(sample.iou[row]), 3), CATEGORIES.index(sample.category[row]),
                None if math.isnan(accurate) else int(accurate)]


def _thin(laps, picks, frames, stride):
    """Drops frames until the rest has room, and returns one pose in how many is left. The estimate beforehand
    keeps most of them from being read; cone sets cut to a size hide how many cones a scene has."""
    picked = {scene for chosen in picks.values() for _, scene in chosen}
    sizes = {scene: len(json.dumps(frame, separators=(",", ":"))) + len(scene) for scene, frame in frames.items()}
    while sum(sizes[scene] for scene in frames) > MOST_BYTES:
        stride *= 2  # of the poses that were read
        kept = {scene for scenes in laps.values() for scene in scenes[::stride]} | picked
        if all(scene in kept for scene in frames) and stride > max(map(len, laps.values())):
            break  # the gallery's alone
        for scene in [scene for scene in frames if scene not in kept]:
            del frames[scene]
    return stride


def read_scenes(results):
    """What fits on the page, or why there is nothing."""
    scenes_file = results.path("scenes.scenes.jsonl")
    if not os.path.exists(scenes_file):
        return SceneData(missing=f"the results hold no {os.path.basename(scenes_file)}.")
    lanes_files = sorted(glob.glob(results.path("*.lanes.jsonl")))
    if not lanes_files:
        return SceneData(missing="the results hold no lanes files.")
    laps, stride, count = _laps(results)
    picks = _picks(results)
    wanted = {scene for scenes in laps.values() for scene in scenes[::stride]}
    wanted |= {scene for chosen in picks.values() for _, scene in chosen}
    try:
        noise_m = float(results.run.get("noise", 0.0))
        boundaries = {track: _boundary_points(results, track) for track, _, _ in laps}
    except (KeyError, TypeError, ValueError):
        raise InputError(f"{results.path('scenes.tracks.json')}: boundaries are no lists of points") from None
    frames, indices = {}, {}
    for number, line in read_lines(scenes_file, wanted):
        scene = line.get("id")
        if scene in wanted:
            frame, index_of = _frame(scenes_file, number, line, boundaries.get(line.get("track")), noise_m)
            frame["a"] = [None] * len(results.samples)
            frames[scene], indices[scene] = frame, index_of
    if len(frames) < len(wanted):
        raise InputError(f"{scenes_file}: has no scene {min(wanted - set(frames))}")
    _add_answers(results, lanes_files, frames, indices)
    stride = _thin(laps, picks, frames, stride)
    lap_list = [{"track": track, "rate": rate, "range": range_m, "scenes": [s for s in scenes if s in frames]}
                for (track, rate, range_m), scenes in laps.items()]
    start = next(scene for chosen in picks.values() for word, scene in chosen if word == "median")
    return SceneData(frames, [lap for lap in lap_list if lap["scenes"]], start, stride, count, picks)
