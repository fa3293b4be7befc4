"""What the node for ROS 2 makes of messages, without ROS: dicts in place of messages, in and out. The node itself is not run."""
import math
import unittest

import conelane
from conelane import ros2_node
from conelane.messages import to_eufs

ODOMETRY, EUFS, TF = "nav_msgs/msg/Odometry", "eufs_msgs/msg/ConeArrayWithCovariance", "tf2_msgs/msg/TFMessage"


def header(time_ms, frame):
    return {"stamp": {"sec": 50 + time_ms // 1000, "nanosec": time_ms % 1000 * 10**6}, "frame_id": frame}


def odometry(time_ms, x):
    """A car that drives along y at x = 3."""
    return {"header": header(time_ms, "odom"), "child_frame_id": "base_link", "pose": {"pose": {
        "position": {"x": 3.0, "y": x, "z": 0.0}, "orientation": {"x": 0.0, "y": 0.0, "z": math.sqrt(0.5), "w": math.sqrt(0.5)}}}}


def cones(time_ms, frame="base_link", ahead=0.0):
    places = [[x - ahead, y] for x in range(2, 22, 4) for y in (1.5, -1.5)]
    return {"header": header(time_ms, frame), **to_eufs(places, ["blue", "yellow"] * 5)}


class Core(unittest.TestCase):
    def setUp(self):
        self.core = ros2_node.NodeCore(conelane.Planner(), time_limit_ms=None)

    def level(self, messages):
        status, = messages["/diagnostics"]["status"]
        return status["level"], status["message"]

    def test_cones_wait_for_their_pose_and_become_a_path_in_the_map(self):
        self.assertEqual(self.core.on_poses(ODOMETRY, odometry(0, 0.0)), {})
        self.assertEqual(self.core.on_cones(EUFS, cones(100), 0), {})  # the pose at 100 ms is not there yet
        messages = self.core.on_poses(ODOMETRY, odometry(200, 2.0))
        self.assertEqual(self.level(messages), (b"\x00", "following"))
        path = messages["path"]
        self.assertEqual(path["header"], header(100, "odom"))
        first, last = path["poses"][0]["pose"], path["poses"][-1]["pose"]
        self.assertAlmostEqual(first["position"]["x"], 3.0, delta=0.1)
        self.assertAlmostEqual(first["position"]["y"], 1.0, delta=1.1)  # half way between the poses
        self.assertGreater(last["position"]["y"], 10.0)
        self.assertAlmostEqual(first["orientation"]["z"], math.sqrt(0.5), delta=0.05)
        message = cones(200)
        message["blue_cones"][1]["covariance"] = [math.nan, 0.0, 0.0, 1.0]  # costs this cone alone
        self.assertEqual(self.level(self.core.on_cones(EUFS, message, 0)), (b"\x00", "following"))
        lines = {(one["ns"], one["id"]): one for one in messages["markers"]["markers"]}
        for (side, is_rest), line in lines.items():
            self.assertEqual(line["action"], 0 if len(line["points"]) > 1 else 2)
            for point in line["points"]:
                self.assertAlmostEqual(point["x"], 3.0 + (-1.5 if side == "left" else 1.5), delta=0.2)
        self.assertGreater(len(lines["left", 0]["points"]), 3)

    def test_a_sensor_beside_the_car(self):
        transform = {"header": header(0, "base_link"), "child_frame_id": "lidar", "transform": {
            "translation": {"x": 1.0, "y": 0.0, "z": 0.5}, "rotation": {"x": 0.0, "y": 0.0, "z": 0.0, "w": 1.0}}}
        self.core.on_poses(TF, {"transforms": [transform]}, is_fixed=True)
        self.core.on_poses(ODOMETRY, odometry(100, 5.0))
        of_sensor = self.core.on_cones(EUFS, cones(100, "lidar", ahead=1.0), 0)
        other = ros2_node.NodeCore(conelane.Planner(), time_limit_ms=None)
        other.on_poses(ODOMETRY, odometry(100, 5.0))
        for one, same in zip(of_sensor["path"]["poses"], other.on_cones(EUFS, cones(100), 0)["path"]["poses"]):
            for axis in "xy":
                self.assertAlmostEqual(one["pose"]["position"][axis], same["pose"]["position"][axis], places=9)

    def test_a_pose_in_another_frame_replaces_those_before(self):
        self.core.on_poses(ODOMETRY, odometry(0, 50.0))
        self.core.on_poses(ODOMETRY, {**odometry(100, 5.0), "header": header(100, "map")})
        path = self.core.on_cones(EUFS, cones(60), 0)["path"]
        self.assertEqual(path["header"]["frame_id"], "map")
        self.assertLess(path["poses"][0]["pose"]["position"]["y"], 8.0)

    def test_what_is_wrong_is_a_diagnostic(self):
        self.assertEqual(self.level(self.core.on_cones("my_msgs/msg/Blob", {}, 7))[0], b"\x02")
        self.assertIn("pose of 'base_link'", self.level(self.core.on_poses(ODOMETRY, odometry(0, math.nan)))[1])
        self.core.on_poses(ODOMETRY, odometry(0, 0.0))
        self.assertEqual(self.core.on_cones(EUFS, cones(700), 0), {})
        messages = self.core.on_cones(EUFS, cones(800), 0)  # the first ones never got a pose
        level, words = self.level(messages)
        self.assertEqual(level, b"\x02")
        self.assertIn("no pose of 'base_link' in 'odom'", words)
        self.assertEqual(messages["/diagnostics"]["header"]["stamp"], header(700, "")["stamp"])

    def test_memory_is_bounded(self):
        for i in range(10_000):
            self.core.on_poses(ODOMETRY, odometry(10 * i, 0.0))
        edge, = self.core._maker._edges.values()
        self.assertLessEqual(len(edge.samples), 2 * ros2_node._MOST_POSES)
        self.assertEqual(self.level(self.core.on_cones(EUFS, cones(99_985), 0))[1], "following")


if __name__ == "__main__":
    unittest.main()
