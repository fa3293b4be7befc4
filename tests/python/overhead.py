"""What a call from Python costs beside the search itself: the difference of both clocks, and the same without cones.

python3 overhead.py [--limit US]: fails where the median of any size is above the limit.
"""
import argparse
import statistics
import sys
import time

import numpy as np

import conelane

CALLS = 400


def overhead_us(detector, cones, pose):
    """Median of the time of a call, less what the detector itself took [us]."""
    beside = []
    for _ in range(CALLS):
        start = time.perf_counter()
        lane = detector.detect(cones, pose)
        beside.append((time.perf_counter() - start) * 1e6 - lane.latency_ms * 1e3)
    return statistics.median(beside)


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--limit", type=float, default=float("inf"))
    limit = parser.parse_args().limit
    track = conelane.load_tracks("generated:curvy")[0]
    scenes = conelane.generate_scenes(track, false_positive_rate=0.5, range_m=50.0, every_m=30.0)
    places = max((scene.cones for scene in scenes), key=len)
    pose = np.zeros(3)
    failed = False
    for count in (0, 12, 24, 50, 100, 200):
        cones = np.ascontiguousarray(np.resize(places, (count, 2)) + np.arange(count)[:, None] * 1e-3)
        for name in ("front", "rld-context"):
            took = overhead_us(conelane.Detector(name), cones, pose)
            failed |= took > limit
            print(f"{name:12} {count:4} cones  {took:6.2f} us beside the search")
    sys.exit(1 if failed else 0)


main()
