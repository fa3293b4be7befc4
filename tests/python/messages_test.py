"""Messages of simulators, as objects with attributes and as dicts."""
import unittest
from types import SimpleNamespace

import numpy as np

import conelane
from conelane import Color, messages

PLACES = [[3.0, 1.5], [3.5, -1.25], [7.0, 1.5], [7.0, -1.5]]
KINDS = [Color.blue, Color.yellow, Color.orange, Color.orange, Color.unknown]
COLORS = [Color.blue, Color.yellow, Color.orange, Color.unknown]


def as_objects(value):
    """Dicts become objects with attributes, as a ROS client library gives them."""
    if isinstance(value, dict):
        return SimpleNamespace(**{key: as_objects(one) for key, one in value.items()})
    return [as_objects(one) for one in value] if isinstance(value, list) else value


def point(x, y):
    return {"x": x, "y": y, "z": 0.3}


def cone_set(cones):
    return {((x, y), color) for (x, y), color in zip(cones.cones.tolist(), cones.colors.tolist())}


class Eufs(unittest.TestCase):
    MESSAGE = {
        "header": {"frame_id": "base_footprint"},
        "blue_cones": [{"point": point(1, 2), "covariance": [0.1, 0, 0, 0.1]}],
        "yellow_cones": [{"point": point(1, -2), "covariance": [0.1, 0, 0, 0.1]}],
        "orange_cones": [{"point": point(3, 2), "covariance": [0.1, 0, 0, 0.1]}],
        "big_orange_cones": [{"point": point(4, 2), "covariance": [0.1, 0, 0, 0.1]}],
        "unknown_color_cones": [{"point": point(9, 0), "covariance": [0.1, 0, 0, 0.1]}],
    }

    def test_from(self):
        for message in (self.MESSAGE, as_objects(self.MESSAGE)):
            cones = messages.from_eufs(message)
            self.assertEqual(cones.cones.tolist(), [[1, 2], [1, -2], [3, 2], [4, 2], [9, 0]])
            self.assertEqual(cones.colors.tolist(), KINDS)
            self.assertIsNone(cones.ids)
            self.assertIsNone(cones.confidences)
            np.testing.assert_array_equal(cones.covariances, np.tile(0.1 * np.eye(2), (5, 1, 1)))

    def test_covariances(self):
        given = np.array([[[0.2, 0.1], [0.1, 0.3]], [[0.0, 0.0], [0.0, 0.0]]])
        message = messages.to_eufs([[1, 2], [3, 4]], covariances=given)
        np.testing.assert_array_equal(messages.from_eufs(message).covariances, given)
        self.assertIsNone(messages.from_eufs(messages.to_eufs([[1, 2]])).covariances)
        without = {**self.MESSAGE, "blue_cones": [{"point": point(1, 2)}]}
        self.assertEqual(messages.from_eufs(without).covariances[0].tolist(), [[0, 0], [0, 0]])
        with self.assertRaisesRegex(ValueError, r"blue_cones\[0\].covariance: 3 numbers, not 4"):
            messages.from_eufs({**self.MESSAGE, "blue_cones": [{"point": point(1, 2), "covariance": [1, 0, 1]}]})

    def test_there_and_back(self):
        message = messages.to_eufs(PLACES, COLORS, covariances=np.arange(16.0).reshape(4, 4))
        self.assertEqual(message["yellow_cones"],
                         [{"point": {"x": 3.5, "y": -1.25, "z": 0.0}, "covariance": [4, 5, 6, 7]}])
        again = messages.from_eufs(as_objects(message))
        self.assertEqual(cone_set(again), {(tuple(place), color) for place, color in zip(PLACES, COLORS)})

    def test_a_missing_field_is_named(self):
        with self.assertRaisesRegex(ValueError, "big_orange_cones"):
            messages.from_eufs({key: value for key, value in self.MESSAGE.items() if key != "big_orange_cones"})
        with self.assertRaisesRegex(ValueError, "point"):
            messages.from_eufs({**self.MESSAGE, "blue_cones": [{"location": point(1, 2)}]})


class FsTrack(unittest.TestCase):
    # fs_msgs/Cone: BLUE=0, YELLOW=1, ORANGE_BIG=2, ORANGE_SMALL=3, UNKNOWN=4
    MESSAGE = {"track": [{"location": point(i, 2 * i), "color": i} for i in range(5)]}

    def test_from(self):
        for message in (self.MESSAGE, as_objects(self.MESSAGE)):
            cones = messages.from_fs_track(message)
            self.assertEqual(cones.cones.tolist(), [[0, 0], [1, 2], [2, 4], [3, 6], [4, 8]])
            self.assertEqual(cones.colors.tolist(), KINDS)

    def test_there_and_back(self):
        message = messages.to_fs_track(PLACES, ["blue", "yellow", "orange", "unknown"])
        self.assertEqual([cone["color"] for cone in message["track"]], [0, 1, 3, 4])
        again = messages.from_fs_track(as_objects(message))
        self.assertEqual((again.cones.tolist(), again.colors.tolist()), (PLACES, COLORS))

    def test_a_colour_that_is_none(self):
        with self.assertRaisesRegex(ValueError, r"track\[0\].color: 9"):
            messages.from_fs_track({"track": [{"location": point(0, 0), "color": 9}]})


def landmark(x, y, of_class, sure=1.0, **more):
    probabilities = [0.02] * 7
    probabilities[of_class] = 0.88
    return {"pose": {"pose": {"position": point(x, y)}}, "class_probabilities": probabilities,
            "detection_probability": sure, **more}


class PacSim(unittest.TestCase):
    # CLASS_UNKNOWN=0, INVISIBLE=1, BLUE=2, YELLOW=3, ORANGE=4, BIGORANGE=5, TIMEKEEPING=6
    LANDMARKS = [landmark(i, -i, i, sure=0.1 * i) for i in range(7)]

    def test_detections(self):
        message = {"header": {}, "detections": self.LANDMARKS}
        for one in (message, as_objects(message), self.LANDMARKS):
            cones = messages.from_pacsim(one)
            self.assertEqual(cones.cones.tolist(), [[0, 0], [2, -2], [3, -3], [4, -4], [5, -5]])
            self.assertEqual(cones.labels.tolist(), [Color.unknown, Color.blue, Color.yellow, Color.orange, Color.big_orange])
            np.testing.assert_allclose(cones.confidences, [0.0, 0.2, 0.3, 0.4, 0.5])
            self.assertIsNone(cones.ids)

    def test_covariances(self):
        uncertain = landmark(1, 2, 2)
        uncertain["pose"]["covariance"] = np.arange(36.0).tolist()
        cones = messages.from_pacsim(as_objects([uncertain, landmark(1, -2, 3)]))
        self.assertEqual(cones.covariances.tolist(), [[[0, 1], [6, 7]], [[0, 0], [0, 0]]])
        self.assertIsNone(messages.from_pacsim(self.LANDMARKS).covariances)
        uncertain["pose"]["covariance"] = [1.0] * 4
        with self.assertRaisesRegex(ValueError, "landmark 0: pose.covariance: 4 numbers, not 36"):
            messages.from_pacsim([uncertain])

    def test_a_track_has_ids(self):
        track = {"left_lane": [landmark(0, 2, 2, id=5)], "right_lane": [landmark(0, -2, 3, id=8)],
                 "unknown": [landmark(4, 0, 0, id=9)], "time_keeping_gates": [landmark(1, 1, 6, id=1)]}
        cones = messages.from_pacsim(as_objects(track))
        self.assertEqual(cones.ids.tolist(), [5, 8, 9])
        self.assertEqual(cones.labels.tolist(), [Color.blue, Color.yellow, Color.unknown])

    def test_probabilities_are_kept(self):
        # Classes in the order of PacSim; its invisible and time-keeping ones count as unknown.
        soft = {**landmark(3, 1, 2), "class_probabilities": [0.1, 0.05, 0.6, 0.1, 0.05, 0.02, 0.08]}
        twice = {**landmark(3, -1, 3), "class_probabilities": [0.0, 0.0, 0.0, 2.0, 0.0, 0.0, 0.0]}
        unseen = {**landmark(5, 1, 0), "class_probabilities": [0.0] * 7}
        cones = messages.from_pacsim([soft, twice, unseen])
        np.testing.assert_allclose(cones.colors, [[0.23, 0.6, 0.1, 0.05, 0.02], [0, 0, 1, 0, 0], [1, 0, 0, 0, 0]])
        self.assertEqual(cones.labels.tolist(), [Color.blue, Color.yellow, Color.unknown])
        conelane.Detector("front").detect(**cones._asdict(), pose=(0, 0, 0))
        self.assertEqual(messages.from_pacsim([twice, unseen]).colors.tolist(), [Color.yellow, Color.unknown])

    def test_the_label_of_a_tie_is_unknown(self):
        cones = messages.Cones(np.zeros((2, 2)), np.array([[0, 0.5, 0.5, 0, 0], [0, 0.3, 0.2, 0.2, 0.3]]))
        self.assertEqual(cones.labels.tolist(), [Color.unknown, Color.big_orange])

    def test_probabilities_that_are_invalid(self):
        for wrong in (-0.1, float("nan")):
            with self.assertRaisesRegex(ValueError, "landmark 0: class_probabilities: must be finite"):
                messages.from_pacsim([{**landmark(0, 0, 0), "class_probabilities": [wrong, 0, 1, 0, 0, 0, 0]}])

    def test_there_and_back(self):
        message = messages.to_pacsim(PLACES, COLORS, confidences=[1, 0.5, 0.25, 0], ids=[4, 3, 2, 1])
        self.assertEqual(message["detections"][1]["class_probabilities"], [0, 0, 0, 1, 0, 0, 0])
        again = messages.from_pacsim(as_objects(message))
        self.assertEqual((again.cones.tolist(), again.colors.tolist()), (PLACES, COLORS))
        self.assertEqual((again.confidences.tolist(), again.ids.tolist()), ([1, 0.5, 0.25, 0], [4, 3, 2, 1]))

    def test_other_than_seven_classes(self):
        with self.assertRaisesRegex(ValueError, "landmark 0: class_probabilities: 3 of them, not 7"):
            messages.from_pacsim({"detections": [{**landmark(0, 0, 0), "class_probabilities": [1, 0, 0]}]})


class All(unittest.TestCase):
    def test_a_message_is_what_a_detector_takes(self):
        track, = conelane.load_tracks("generated:circle")
        scene = conelane.generate_scenes(track, every_m=20.0, with_color=True)[0]
        expected = {tuple(place) for place in conelane.Detector("front").detect_scene(scene, time_limit_ms=None).left_points}
        for to, back in ((messages.to_eufs, messages.from_eufs), (messages.to_fs_track, messages.from_fs_track),
                         (messages.to_pacsim, messages.from_pacsim)):
            cones = back(to(scene.cones, scene.colors))
            lane = conelane.Detector("front").detect(**cones._asdict(), pose=scene.pose, time_limit_ms=None)
            self.assertEqual({tuple(place) for place in lane.left_points}, expected)

    def test_empty_messages(self):
        for to, back in ((messages.to_eufs, messages.from_eufs), (messages.to_fs_track, messages.from_fs_track),
                         (messages.to_pacsim, messages.from_pacsim)):
            cones = back(to([]))
            self.assertEqual((cones.cones.shape, cones.colors.shape), ((0, 2), (0,)))
            self.assertEqual(conelane.Detector("clc").detect(**cones._asdict(), pose=(0, 0, 0), time_limit_ms=None).status, "none")

    def test_big_orange_cones_can_be_said(self):
        place, color = [[1, 2]], ["big_orange"]
        self.assertEqual(len(messages.to_eufs(place, color)["big_orange_cones"]), 1)
        self.assertEqual(messages.to_fs_track(place, [Color.big_orange])["track"][0]["color"], 2)
        self.assertEqual(messages.to_pacsim(place, color)["detections"][0]["class_probabilities"], [0, 0, 0, 0, 0, 1, 0])

    def test_what_becomes_no_message(self):
        for to in (messages.to_eufs, messages.to_fs_track, messages.to_pacsim):
            with self.assertRaisesRegex(ValueError, r"not \(N, 2\)"):
                to([[1, 2, 3]])
            with self.assertRaisesRegex(ValueError, "colors: 1 of them, not 2"):
                to([[1, 2], [3, 4]], colors=["blue"])
            with self.assertRaisesRegex(ValueError, "colors: only unknown, blue, yellow, orange"):
                to([[1, 2]], colors=["red"])


if __name__ == "__main__":
    unittest.main()
