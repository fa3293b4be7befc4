"""measures_test.py EXPERIMENTS: the report's statistics, on samples small enough to follow by hand."""

import sys
import unittest

import numpy as np

sys.path.insert(0, sys.argv.pop(1))
from report import measures  # noqa: E402
from report.load import Sample  # noqa: E402
from report.summaries import quantile  # noqa: E402


def sample(method, latency, tracks):
    scenes = np.array([f"s{i}" for i in range(len(latency))], dtype=object)
    return Sample(method, None, {"scene": scenes, "track": np.array(tracks, dtype=object),
                                 "latency": np.array(latency)})


class Measures(unittest.TestCase):
    def test_quantile_is_one_of_the_values(self):
        self.assertEqual(quantile([4.0, 1.0, 3.0, 2.0], 0.5), 2.0)
        self.assertEqual(quantile([4.0, 1.0, 3.0, 2.0], 0.51), 3.0)
        self.assertEqual(quantile([7.0], 0.0), 7.0)
        self.assertEqual(quantile(range(1, 101), 0.07), 7)  # 0.07 * 100 is a little more than 7

    def test_shifted_geometric_mean(self):
        # (0 + 1) (3 + 1) = 4, whose root is 2.
        self.assertAlmostEqual(measures.shifted_geometric_mean([0.0, 3.0]), 1.0)

    def test_one_track_tells_nothing_about_others(self):
        self.assertIsNone(measures.mean_interval(np.array([0.0, 1.0]), np.array(["a", "a"])))
        self.assertIsNone(measures.median_interval(np.array([0.0, 1.0]), np.array(["a", "a"])))

    def test_tracks_are_resampled_whole(self):
        # Of two tracks, of all 0 and all 1, a resample holds one alone in half the cases: the interval is all of
        # [0, 1], however many scenes there are.
        values = np.repeat([0.0, 1.0], 500)
        tracks = np.repeat(["a", "b"], 500)
        self.assertEqual(measures.mean_interval(values, tracks), (0.0, 1.0))
        self.assertEqual(measures.median_interval(values, tracks), (0.0, 1.0))

    def test_median_is_that_of_the_rows_drawn(self):
        # Each resample written out: the rows of a track as often as the track was drawn.
        values = np.array([5.0, 1.0, 4.0, 2.0, 3.0, 9.0, 7.0])
        tracks = np.array(["a", "a", "b", "b", "c", "c", "c"], dtype=object)
        medians = []
        for times in measures._track_weights(3):
            drawn = sorted(value for value, track in zip(values, tracks) for _ in range(int(times["abc".index(track)])))
            medians.append(drawn[(len(drawn) - 1) // 2])
        self.assertEqual(measures.median_interval(values, tracks), measures._interval(medians))

    def test_alike_tracks_leave_no_doubt(self):
        values = np.array([0.0, 1.0] * 3)
        low, high = measures.mean_interval(values, np.repeat(["a", "b", "c"], 2))
        self.assertAlmostEqual(low, 0.5)
        self.assertAlmostEqual(high, 0.5)

    def test_ratio_is_paired_and_geometric(self):
        slow = sample("slow", [2.0, 8.0, 1.0], ["a", "b", "b"])
        fast = sample("fast", [1.0, 1.0], ["a", "b"])  # has not met the third scene
        mean, (low, high), count = measures.latency_ratio(slow, fast)
        self.assertEqual(count, 2)
        self.assertAlmostEqual(mean, 4.0)
        self.assertAlmostEqual(low, 2.0)
        self.assertAlmostEqual(high, 8.0)


if __name__ == "__main__":
    unittest.main()
