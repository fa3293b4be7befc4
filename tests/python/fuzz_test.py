"""Random arrays and options thrown at the package: an answer that holds, ValueError or TypeError, no crash and no hang. Files are those of
the fuzz programs (tests/fuzz). The same seed and number is the same case:

    PYTHONPATH=build/release/python python3 tests/python/fuzz_test.py [--seconds S] [--seed N] [--first CASE] [--verbose]

CONELANE_FUZZ_SECONDS says how long where no option does; without both it is 5 s.
"""
import argparse
import faulthandler
import os
import sys
import time

import numpy as np

import conelane

LONGEST_CASE_S = 60  # a machine may be busy; the limits of the calls are 20 ms at most
STRANGE = (0.0, -0.0, 1e-320, 1e-9, 1.0, 1e3, 1e6, 1e7, 1e15, 1e154, 1e308, -1e308, np.nan, np.inf, -np.inf)
TYPES = ("f8", "f8", "f8", "f8", ">f8", "f4", "f2", "i8", "i4", "u8", "u1", "?", "c16", "O", "U4", "S4", "M8[s]", "V8")


def one_of(random, choices):
    return choices[random.integers(len(choices))]


def places(random, count):
    """Cones on a lane, on a grid, on a line, at one place, anywhere; some of their numbers strange."""
    kind = random.integers(5)
    xy = random.normal(0.0, 10.0, (count, 2))
    if kind == 0:
        along = np.arange(count)
        xy = np.stack([3.0 * (along // 2) + 1.0, np.where(along % 2, -1.8, 1.8)], axis=1) + 0.1 * xy
    elif kind == 1:
        xy = np.round(xy / 3.0) * 3.0
    elif kind == 2:
        xy[:, 1] = 2.0 * xy[:, 0]
    elif kind == 3:
        xy[:] = xy[:1]
    if random.random() < 0.3:
        xy = xy * 10.0 ** random.integers(-12, 12) + 10.0 ** random.integers(0, 12)
    if count and random.random() < 0.3:
        xy[random.integers(count), random.integers(2)] = one_of(random, STRANGE)
    return xy


def disguised(random, array):
    """The array in another type, shape or layout, or no array at all; most often as it is."""
    if random.random() < 0.9:
        return array
    kind = random.integers(8)
    if kind == 0:
        with np.errstate(all="ignore"):
            try:
                return array.astype(one_of(random, TYPES))
            except (TypeError, ValueError):
                return None
    if kind == 1:
        return np.asfortranarray(array)
    if kind == 2:
        return array[::-1]
    if kind == 3:
        return array.tolist()
    if kind == 4:
        return array.reshape(-1)
    if kind == 5:
        return array[..., None]
    if kind == 6:
        return np.lib.stride_tricks.as_strided(array, array.shape, (0,) * array.ndim)
    return one_of(random, (None, "cones", 7, {}, [], [[]], [[1, 2], [3]], np.zeros((0, 2)), np.zeros((2, 0)), object()))


def scene_arguments(random):
    count = int(one_of(random, (0, 1, 2, 3, 6, 12, 25, 60)))
    arguments = {"cones": disguised(random, places(random, count))}
    pose = np.array([0.0, 0.0, random.normal()])
    if random.random() < 0.1:
        pose[random.integers(3)] = one_of(random, STRANGE)
    arguments["pose"] = disguised(random, pose) if random.random() < 0.3 else pose
    if random.random() < 0.3:
        arguments["ids"] = disguised(random, random.integers(-2**63, 2**63 - 1, count))
    if random.random() < 0.3:
        arguments["colors"] = disguised(random, random.integers(0, 6 if random.random() < 0.1 else 5, count))
    if random.random() < 0.3:
        arguments["confidences"] = disguised(random, random.random(count))
    return arguments


def check_lane(lane):
    sides = np.concatenate([lane.left, lane.right])
    assert len(set(sides.tolist())) == len(sides), "a cone is in a lane once"
    assert ((0 <= sides) & (sides < len(lane.cones))).all(), "a lane is made of the scene's cones"
    assert lane.found == (len(sides) > 0) and lane.found == (lane.status == "found"), "found means a lane"
    assert lane.status != "error", lane.message


def strange_number(random, usual):
    return usual if random.random() < 0.6 else one_of(random, STRANGE + (-1, None, "x", 10**30))


def detect(random):
    options = {}
    if random.random() < 0.2:
        options["nearest"] = one_of(random, (0, 1, 4, 12, -1, 2.5, 10**30))
    if random.random() < 0.2:
        parameters = conelane.rld_parameters()
        parameters[one_of(random, list(parameters))] = strange_number(random, 1.0)
        options["parameters"] = parameters
    detector = conelane.Detector(one_of(random, list(conelane.methods())), **options)
    lane = detector.detect(**scene_arguments(random), time_limit_ms=strange_number(random, 5.0)
                           if random.random() < 0.1 else float(one_of(random, (0.0, 0.5, 5.0, 20.0))))
    check_lane(lane)
    line = lane.centre_line(strange_number(random, 0.5), smoothing_m=strange_number(random, 1.75),
                            usual_width_m=strange_number(random, 3.5))
    assert np.isfinite(line).all(), "a centre line is finite"


def solve(random):
    solution = conelane.solve_rld(**scene_arguments(random), time_limit_ms=5.0, pairing=one_of(
        random, (None, "near_far", "paper", "neither")), absolute_gap=one_of(random, (1e-9, 0.0, -1.0, np.nan, 1e308)))
    assert solution.status != "error", solution.message
    if solution.bound is not None and solution.objective is not None:
        assert solution.bound <= solution.objective, "a bound is below the objective"


def score(random):
    arguments = scene_arguments(random)
    count = np.shape(arguments["cones"])[0] if np.ndim(arguments["cones"]) else 0
    truth = [disguised(random, random.integers(-1 if random.random() < 0.1 else 0, count + 1, random.integers(1, 6)))
             for _ in range(2)] if count else None
    scene = conelane.Scene(**arguments, id="a", ground_truth=truth, closed=bool(random.random() < 0.2))
    lane = conelane.Detector("front").detect_scene(scene, 5.0)
    check_lane(lane)
    boundaries = None
    if random.random() < 0.5:
        boundaries = conelane.Boundaries(*(disguised(random, places(random, random.integers(0, 6))) for _ in range(2)),
                                         closed=bool(random.random() < 0.5))
    repr(conelane.score(scene, lane, boundaries))


def generate(random):
    track, = conelane.load_tracks(one_of(random, ("generated:straight", "generated:circle@3", "generated:nowhere")))
    conelane.generate_scenes(track, false_positive_rate=strange_number(random, 0.3),
                             range_m=strange_number(random, 15.0), every_m=strange_number(random, 60.0),
                             condition=one_of(random, (None, "paper", "car", "harsh", "?")), seed=int(random.integers(9)))


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--seconds", type=float, default=os.environ.get("CONELANE_FUZZ_SECONDS", "5"))
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--first", type=int, default=0, metavar="CASE")
    parser.add_argument("--verbose", action="store_true", help="says each case before it runs")
    options = parser.parse_args()
    faulthandler.enable()
    answered = refused = 0
    case = options.first
    end = time.monotonic() + options.seconds
    while time.monotonic() < end or case == options.first:
        random = np.random.default_rng([options.seed, case])
        what = one_of(random, (detect, detect, solve, score, generate))
        if options.verbose:
            print(f"case {case}: {what.__name__}", flush=True)
        faulthandler.dump_traceback_later(LONGEST_CASE_S, exit=True)
        try:
            try:
                what(random)
                answered += 1
            except (ValueError, TypeError) as error:
                assert str(error), "who refuses says why"
                refused += 1
        except BaseException:
            print(f"case {case} of seed {options.seed}: {what.__name__}", file=sys.stderr)
            raise
        case += 1
    faulthandler.cancel_dump_traceback_later()
    print(f"{case - options.first} cases: {answered} answered, {refused} refused")
    assert answered and refused, "cases of both kinds"


main()
