"""The scenes that viewer and gallery show: cones in the car's frame, the truth, each method's lane. They are reduced to
whole centimetres and to as many laps as the page has room for."""

import glob
import json
import math
import os
from dataclasses import dataclass, field

import numpy as np

from .load import CATEGORIES, CAUSES
from .measures import headline_measure
from .records import NUMBER, TEXT, InputError, label_of, read_lines, require, require_all

MOST_BYTES = 9_000_000  # of all frames as JSON
_BYTES_PER_CONE = 10
_BYTES_PER_ANSWER = 88
_BYTES_PER_SCENE = 150
_SAME_PLACE_M = 0.01
_NOISE_FACTOR = 4.0  # a seen position is this many standard deviations off at most, nearly always

GALLERY_RATE = 0.3
WORST = 10  # scenes of each method and condition
WORST_OF_A_TRACK = 2
WORST_APART_M = 15.0


@dataclass
class SceneData:
    frames: dict = field(default_factory=dict)  # scene id -> frame
    laps: list = field(default_factory=list)  # {"track", "condition", "rate", "range", "scenes": [ids as travelled]}
    start: str = ""  # the scene to begin with
    scene_count: int = 0  # scored ones, of which `frames` has a part
    whole_laps: int = 0  # laps that are there with one pose in `stride`, of `lap_count`
    lap_count: int = 0
    stride: int = 1
    worst: dict = field(default_factory=dict)  # (label, condition) -> [scene ids]
    wrong: dict = field(default_factory=dict)  # (label, condition) -> number of scenes of which `worst` has some
    missing: str = ""  # why there are none
    longest_gap_m: float = math.inf  # from boundary cone to boundary cone; what is longer is drawn as bridged
    usual_width_m: float = 3.5  # of a lane whose other boundary is inferred


def gallery_rate(results):
    """The stored rate nearest to the CLC paper's moderate one."""
    return min(results.rates, key=lambda rate: (abs(rate - GALLERY_RATE), rate))


def _places(scenes_file, wrong):
    """Where the car stands in each scene of these."""
    ids, places = {scene for of_key in wrong.values() for scene, _ in of_key}, {}
    for number, line in read_lines(scenes_file, ids):
        require_all(scenes_file, number, line, {"pose": {"x": NUMBER, "y": NUMBER}})
        places[line.get("id", str(number))] = (line["pose"]["x"], line["pose"]["y"])
    return places


def _wrong(results):
    """The scenes on which a method's lane is not usable (no success in results of earlier versions), as (scene, track), for each
    method and condition: by IoU, an unknown one last; ties in order of scene ids."""
    found = {}
    for sample in results.samples:
        for condition in results.conditions:
            part = sample.at(condition=condition)
            bad = getattr(part, headline_measure([part])) == 0.0
            found[sample.label, condition] = [(scene, track) for _, scene, track in sorted(zip(
                np.where(np.isnan(part.iou), 2.0, part.iou)[bad], part.scene[bad], part.track[bad]))]
    return found


def _worst(wrong, places):
    """The first WORST of these: at most WORST_OF_A_TRACK of one track, and these WORST_APART_M apart."""
    chosen, of_track = [], {}
    for scene, track in wrong:
        place, others = places.get(scene), of_track.setdefault(track, [])
        if place and len(others) < WORST_OF_A_TRACK and all(math.dist(place, other) >= WORST_APART_M for other in others):
            others.append(place)
            chosen.append(scene)
    return chosen[:WORST]


class _Laps:
    """Scored scenes by (track, condition, rate, range), in order of travel: that of the scores, which is that of the
    file."""

    def __init__(self, results):
        lap_of, cones = {}, {}
        for sample in results.samples:
            for scene, *lap, count in zip(sample.scene, sample.track, sample.condition, sample.rate, sample.range,
                                          sample.cones):
                if count > cones.get(scene, -1.0):  # a method on few cones does not tell how many there are
                    cones[scene] = count
                lap_of.setdefault(scene, tuple(lap))
        self.scenes = {}
        for scene, lap in lap_of.items():
            self.scenes.setdefault(lap, []).append(scene)
        answers = _BYTES_PER_ANSWER * len(results.samples)
        self.bytes_of = {lap: sum(_BYTES_PER_SCENE + _BYTES_PER_CONE * cones[scene] + answers for scene in scenes)
                         for lap, scenes in self.scenes.items()}
        self.scene_count = len(lap_of)

    def by_interest(self, results):
        """First the laps at the gallery's rate and the shortest range, then all others; of each the tracks with the
        largest share of answers that are not usable (no success in results of earlier versions) first."""
        failed, answered = {}, {}
        for sample in results.samples:
            bad = np.where(np.isnan(sample.usable), 1.0 - sample.success, 1.0 - sample.usable)
            for track, value in zip(sample.track, bad):
                failed[track] = failed.get(track, 0.0) + value
                answered[track] = answered.get(track, 0) + 1
        rate, range_m = gallery_rate(results), results.ranges[0]
        return sorted(self.scenes, key=lambda lap: ((lap[2], lap[3]) != (rate, range_m),
                                                    -failed[lap[0]] / answered[lap[0]], lap[0]))


def _chosen_laps(results, laps, tracks):
    """The laps to show, most interesting first, and the stride: all of the named tracks, however thin; else whole ones
    while there is room."""
    order = laps.by_interest(results)
    if tracks:
        for track in tracks:
            if track not in {lap[0] for lap in order}:
                raise InputError(f"--viewer: there is no track '{track}' in {results.path('scores.jsonl')}")
        chosen = [lap for lap in order if lap[0] in tracks]
        return chosen, max(1, math.ceil(sum(laps.bytes_of[lap] for lap in chosen) / MOST_BYTES))
    chosen, size = [], 0
    for lap in order:
        if size + laps.bytes_of[lap] <= MOST_BYTES:
            size += laps.bytes_of[lap]
            chosen.append(lap)
    return chosen, 1


def in_car_frame(pose, positions):
    """Positions [m] as seen from a pose: ahead and to the left."""
    x, y, yaw = pose
    return (np.array(positions, dtype=float).reshape(-1, 2) - (x, y)) @ np.array([[np.cos(yaw), -np.sin(yaw)], [np.sin(yaw), np.cos(yaw)]])


def _centimetres(value):
    return round(100.0 * value)


def boundary_points(boundaries):
    """None where the track has no annotated boundaries."""
    points = boundaries.get("left", []) + boundaries.get("right", [])
    return np.array(points, dtype=float) if points else None


def _false_positives(positions, boundary, noise_m):
    """Which cones lie on no annotated boundary; none where the boundaries are unknown."""
    if boundary is None or not len(positions):
        return np.zeros(len(positions), bool)
    distances = np.hypot(positions[:, None, 0] - boundary[None, :, 0], positions[:, None, 1] - boundary[None, :, 1])
    return distances.min(axis=1) > max(_SAME_PLACE_M, _NOISE_FACTOR * noise_m)


def _positions(points):
    return np.array([(point["x"], point["y"]) for point in points], dtype=float).reshape(-1, 2)


def _flat(positions):
    return [_centimetres(value) for position in positions for value in position]


def frame_of(path, number, scene, boundary, noise_m):
    """The frame of a scene without its answers, its pose, and the index of each cone id in it. Cones come first, false
    positives last."""
    try:
        pose = tuple(float(scene["pose"][key]) for key in ("x", "y", "yaw"))
        ids = [cone["id"] for cone in scene["cones"]]
        positions = _positions(scene["cones"])
        truth = scene.get("ground_truth") or {"left": [], "right": []}  # a run has a driven path instead
        false_positive = _false_positives(positions, boundary, noise_m)
        order = sorted(range(len(ids)), key=lambda i: (bool(false_positive[i]), ids[i]))
        index_of = {ids[i]: place for place, i in enumerate(order)}
        frame = {"p": [_centimetres(pose[0]), _centimetres(pose[1]), round(1000 * pose[2])],
                 "c": _flat(in_car_frame(pose, positions[order])), "f": int(false_positive.sum()),
                 "g": [[index_of[i] for i in truth["left"]], [index_of[i] for i in truth["right"]],
                       int(truth.get("closed", False))]}
        if scene.get("missed"):
            frame["m"] = _flat(in_car_frame(pose, _positions(scene["missed"])))
        return frame, pose, index_of
    except (KeyError, TypeError, ValueError) as error:
        raise InputError(f"{path}:{number}: no scene with pose, cones and ground truth ({error})") from None


def sides_of(path, number, line, pose, index_of):
    """Left and right as indices of cones; as flat positions under "p" where the answer is positions. An answer that is
    a centre line alone is drawn as a left side."""
    def flat(key):
        try:
            return {"p": _flat(in_car_frame(pose, line[key]))}
        except (TypeError, ValueError) as error:
            raise InputError(f"{path}:{number}: {key}: no list of points ({error})") from None

    if "left_points" in line:
        return [flat("left_points"), flat("right_points")]
    if "centre_line" in line and not line.get("left"):
        return [flat("centre_line"), []]
    try:
        return [[index_of[i] for i in line.get(side, ())] for side in ("left", "right")]
    except KeyError as error:
        raise InputError(f"{path}:{number}: cone {error} is not in the scene") from None


def _add_answers(results, lanes_files, frames, poses, indices):
    slots = {sample.label: slot for slot, sample in enumerate(results.samples)}
    scores = {sample.label: {scene: row for row, scene in enumerate(sample.scene) if scene in frames}
              for sample in results.samples}
    def known_int(value):
        return None if math.isnan(value) else int(value)

    causes = list(CAUSES)
    for path in lanes_files:
        for number, line in read_lines(path, frames):
            scene = require(path, number, line, "scene", TEXT)
            label = label_of(require(path, number, line, "method", TEXT), line.get("nearest"))
            row = scores.get(label, {}).get(scene)
            if row is None:
                continue
            sample = results.samples[slots[label]]
            iou, cause = sample.iou[row], sample.cause[row]
            frames[scene]["a"][slots[label]] = sides_of(path, number, line, poses[scene], indices[scene]) + [
                int(bool(line.get("closed", False))), float(f"{sample.latency[row]:.4g}"),
                None if math.isnan(iou) else round(float(iou), 3), CATEGORIES.index(sample.category[row]),
                known_int(sample.accurate[row]), known_int(sample.usable[row]),
                causes.index(cause) if cause else None] + [
                    float(f"{require(path, number, line, key, NUMBER):.4g}") if key in line else None
                    for key in ("confidence", "trusted_m")]


def _make_room(laps, chosen, picked, frames, stride, named):
    """Drops frames until the rest fits, the least interesting laps first; of named tracks poses. The estimate
    beforehand keeps most of them from being read, but it may be wrong. Returns the stride."""
    sizes = {scene: len(json.dumps(frame, separators=(",", ":"))) + len(scene) for scene, frame in frames.items()}
    while sum(sizes.values()) > MOST_BYTES and (chosen if not named else stride < max(map(len, laps.scenes.values()))):
        if named:
            stride *= 2
        else:
            chosen.pop()
        kept = {scene for lap in chosen for scene in laps.scenes[lap][::stride]} | picked
        for scene in [scene for scene in frames if scene not in kept]:
            del frames[scene], sizes[scene]
    return stride


def _read_frames(results, scenes_file, wanted, noise_of):
    """Frames, poses and cone indices of the wanted scenes."""
    try:
        boundaries = {track: boundary_points(of_track) for track, of_track in results.tracks.items()}
    except (KeyError, TypeError, ValueError, AttributeError):
        raise InputError(f"{results.path('scenes.tracks.json')}: boundaries are not lists of points") from None
    frames, poses, indices = {}, {}, {}
    for number, line in read_lines(scenes_file, wanted):
        scene = line.get("id", str(number))
        if scene in wanted:
            frame, poses[scene], indices[scene] = frame_of(scenes_file, number, line, boundaries.get(line.get("track")),
                                                         noise_of(line.get("condition", "")))
            frame["a"] = [None] * len(results.samples)
            frames[scene] = frame
    if len(frames) < len(wanted):
        raise InputError(f"{scenes_file}: has no scene {min(wanted - set(frames))}")
    return frames, poses, indices


def _turning_rad(frame):
    """How far the ground truth turns, the sum of its turns left and right; 0 where it has no boundaries."""
    points = np.array(frame["c"], dtype=float).reshape(-1, 2) @ (1, 1j)
    steps = [np.diff(points[side]) for side in frame["g"][:2]]
    return max(float(np.abs(np.angle(one[1:] * one[:-1].conj())).sum()) for one in steps)


def _start(results, frames, lap_list):
    """The scene to begin with, which the pictures of the methods take too: in the main condition and at the gallery's
    rate where the page has that, one that the best method and at least half of all get right but not all, and of these
    the one with the most turns ahead; the first of equal ones."""
    rate = gallery_rate(results)

    def rank(lap, scene):
        answers = [bool(answer and answer[7] == 1) for answer in frames[scene]["a"]]
        share = sum(answers) / len(answers)
        return ((lap["condition"], lap["rate"]) == (results.main_condition, rate), answers[0], share >= 0.5, share < 1.0,
                round(_turning_rad(frames[scene]), 1))
    scenes = [(lap, scene) for lap in lap_list for scene in lap["scenes"]]
    return max(scenes, key=lambda one: rank(*one), default=(None, ""))[1]


def read_scenes(results, conditions=(), tracks=(), longest_gap_m=math.inf, usual_width_m=3.5):
    """What fits on the page, or why there is nothing. `conditions`: what the program knows by name, each with its
    noise. `tracks`: those whose laps the viewer shall have; else the most interesting."""
    scenes_file = results.path("scenes.scenes.jsonl")
    if not os.path.exists(scenes_file):
        return SceneData(missing=f"the results hold no {os.path.basename(scenes_file)}.")
    lanes_files = sorted(glob.glob(results.path("*.lanes.jsonl")))
    if not lanes_files:
        return SceneData(missing="the results hold no lanes files.")
    try:
        run_noise_m = float(results.run.get("noise", 0.0))
    except (TypeError, ValueError):
        raise InputError(f"{results.path('run.json')}: noise: has a value of the wrong kind") from None
    noise_m = {condition["name"]: condition["noise_sigma_m"] for condition in conditions}
    laps = _Laps(results)
    wrong = _wrong(results)
    places = _places(scenes_file, wrong)
    worst = {key: chosen for key, of_key in wrong.items() if (chosen := _worst(of_key, places))}
    picked = {scene for scenes in worst.values() for scene in scenes}
    chosen, stride = _chosen_laps(results, laps, tracks)
    wanted = {scene for lap in chosen for scene in laps.scenes[lap][::stride]} | picked
    frames, poses, indices = _read_frames(results, scenes_file, wanted,
                                          lambda name: max(run_noise_m, noise_m.get(name, 0.0)))
    _add_answers(results, lanes_files, frames, poses, indices)
    stride = _make_room(laps, chosen, picked, frames, stride, bool(tracks))
    lap_list = [{"track": track, "condition": condition, "rate": rate, "range": range_m,
                 "scenes": [scene for scene in scenes if scene in frames]}
                for (track, condition, rate, range_m), scenes in laps.scenes.items()]
    lap_list = [lap for lap in lap_list if lap["scenes"]]
    return SceneData(frames, lap_list, _start(results, frames, lap_list), laps.scene_count, len(chosen), len(laps.scenes), stride, worst,
                     {key: len(of_key) for key, of_key in wrong.items()}, longest_gap_m=longest_gap_m, usual_width_m=usual_width_m)
