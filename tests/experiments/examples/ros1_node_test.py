"""ros1_node_test.py NODE: starts roscore and the node for ROS 1, drives a simulated lap by what it publishes, records the lap as a bag,
plays the bag to the node and compares its answers with those of `conelane.bags` and a planner. Skipped (77) where ROS, rosbags
(CONELANE_ROSBAGS, as in bags_test.py) or the node is missing.
"""
import math
import os
import random
import shutil
import signal
import socket
import statistics
import subprocess
import sys
import tempfile
import time
import unittest
from pathlib import Path as File

NODE = sys.argv.pop(1) if len(sys.argv) > 1 else ""
sys.path.append(os.environ.get("CONELANE_ROSBAGS", ""))
try:
    import conelane.bags
    import rosbag
    import rosbags.highlevel  # noqa: F401
    import rospy
    from diagnostic_msgs.msg import DiagnosticArray
    from genpy.dynamic import generate_dynamic
    from geometry_msgs.msg import TransformStamped
    from nav_msgs.msg import Path
    from tf2_msgs.msg import TFMessage
    from visualization_msgs.msg import Marker, MarkerArray
except ImportError as missing:
    print(f"skipped: {missing}")
    sys.exit(77)
if not os.path.exists(NODE) or not shutil.which("roscore"):
    print(f"skipped: {'no roscore' if os.path.exists(NODE) else 'the node is not built, ROS is missing'}")
    sys.exit(77)

_RULE = "\n" + 80 * "=" + "\nMSG: "
_EUFS = (conelane.bags._DEFINITIONS["eufs_msgs/ConeArrayWithCovariance"] +
         _RULE + "std_msgs/Header\nuint32 seq\ntime stamp\nstring frame_id" +
         _RULE + "eufs_msgs/ConeWithCovariance\n" + conelane.bags._DEFINITIONS["eufs_msgs/ConeWithCovariance"] +
         _RULE + "geometry_msgs/Point\nfloat64 x\nfloat64 y\nfloat64 z\n")
START_S = 1_700_000_000.0
STRAIGHT_M, RADIUS_M, HALF_WIDTH_M = 30.0, 15.0, 1.5
LAP_M = 2.0 * (STRAIGHT_M + math.pi * RADIUS_M)
SENSOR = (1.0, 0.0, 0.2)  # in the car: x, y, yaw
SIGMAS_M = (0.1, 0.05)  # of a cone in the sensor's frame


def course(s_m, left_m=0.0):
    """Two straights and two half circles, driven to the left: x, y, yaw at a length, and so far left of it."""
    half, (sign, s_m) = LAP_M / 2.0, (1.0, s_m % LAP_M)
    if s_m >= half:
        sign, s_m = -1.0, s_m - half
    angle = max(0.0, s_m - STRAIGHT_M) / RADIUS_M
    x = min(s_m, STRAIGHT_M) - STRAIGHT_M / 2.0 + (RADIUS_M - left_m) * math.sin(angle)
    y = (RADIUS_M - left_m) * -math.cos(angle)
    return sign * x, sign * y, angle + (0.0 if sign > 0.0 else math.pi)


def seen_from(x, y, pose):
    dx, dy, yaw = x - pose[0], y - pose[1], pose[2]
    return dx * math.cos(yaw) + dy * math.sin(yaw), dy * math.cos(yaw) - dx * math.sin(yaw)


def off_course_m(x, y):
    return min(math.dist((x, y), course(0.1 * i)[:2]) for i in range(int(10.0 * LAP_M)))


def placed(frame, child, stamp, x, y, yaw):
    transform = TransformStamped()
    transform.header.frame_id, transform.child_frame_id, transform.header.stamp = frame, child, stamp
    transform.transform.translation.x, transform.transform.translation.y = x, y
    transform.transform.rotation.z, transform.transform.rotation.w = math.sin(yaw / 2), math.cos(yaw / 2)
    return transform


def wait_for(condition, seconds=30.0):
    end = time.monotonic() + seconds
    while not condition() and time.monotonic() < end:
        time.sleep(0.01)
    return condition()


class Node(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)
        with socket.socket() as free:
            free.bind(("localhost", 0))
            self.port = free.getsockname()[1]
        os.environ.update(ROS_MASTER_URI=f"http://localhost:{self.port}", ROS_HOSTNAME="localhost", ROS_LOG_DIR=self.folder.name)
        self.start("roscore", "-p", str(self.port))
        wait_for(self.has_master)
        rospy.init_node("car", anonymous=True, disable_signals=True)
        self.heard = {"path": {}, "markers": {}, "/diagnostics": {}}
        self.subscribers = [rospy.Subscriber(topic, kind, self.hear, topic) for topic, kind in (
            ("path", Path), ("markers", MarkerArray), ("/diagnostics", DiagnosticArray))]
        types = generate_dynamic("eufs_msgs/ConeArrayWithCovariance", _EUFS)
        self.cone_array, self.cone = types["eufs_msgs/ConeArrayWithCovariance"], types["eufs_msgs/ConeWithCovariance"]

    def has_master(self):
        with socket.socket() as probe:
            return probe.connect_ex(("localhost", self.port)) == 0

    def start(self, *command):
        process = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        self.addCleanup(process.wait, 20)
        self.addCleanup(process.terminate)
        return process

    def start_node(self):
        node = self.start(NODE, "_mission:=trackdrive", "_time_limit_ms:=1000", "_transform_wait_s:=5.0")
        self.assertTrue(wait_for(lambda: all(one.get_num_connections() for one in self.subscribers)))
        return node

    def hear(self, message, topic):
        header = message.markers[0].header if topic == "markers" else message.header
        self.heard[topic][header.stamp] = message

    def send(self, topic, message, stamp):
        self.publishers[topic].publish(message)
        self.bag.write(topic, message, stamp)

    def frame(self, pose, time_s, frame="lidar", with_cones=True):
        """Sends what the car sees; gives the node's answer: its status, path and markers."""
        message, stamp = self.cone_array(), rospy.Time.from_sec(START_S + time_s)
        message.header.stamp, message.header.frame_id = stamp, frame
        for side, cones in ((1.0, message.blue_cones), (-1.0, message.yellow_cones)):
            for i in range(round(LAP_M / 4.0) if with_cones else 0):
                x, y, _ = course(4.0 * i, side * HALF_WIDTH_M)
                ahead, left = seen_from(*seen_from(x, y, pose), SENSOR)
                cone = self.cone(covariance=[SIGMAS_M[0] ** 2, 0.0, 0.0, SIGMAS_M[1] ** 2])
                cone.point.x, cone.point.y = self.noise.gauss(ahead, SIGMAS_M[0]), self.noise.gauss(left, SIGMAS_M[1])
                if cone.point.x > -1.0 and math.hypot(ahead, left) < 20.0:
                    cones.append(cone)
        self.send("/tf", TFMessage([placed("map", "base_link", stamp, *pose)]), stamp)
        self.send("/cones", message, stamp)
        self.assertTrue(wait_for(lambda: stamp in self.heard["/diagnostics"]), "no answer within 30 s")
        status = self.heard["/diagnostics"][stamp].status[0]
        wait_for(lambda: stamp in self.heard["path"] and stamp in self.heard["markers"], 30.0 if frame == "lidar" else 0.5)
        return status, self.heard["path"].get(stamp), self.heard["markers"].get(stamp)

    def test_a_lap_and_its_bag(self):
        node, self.noise = self.start_node(), random.Random(1)
        self.bag = rosbag.Bag(os.path.join(self.folder.name, "lap.bag"), "w")
        self.publishers = {topic: rospy.Publisher(topic, kind, queue_size=5, latch=topic == "/tf_static") for topic, kind in (
            ("/tf_static", TFMessage), ("/tf", TFMessage), ("/cones", self.cone_array))}
        self.send("/tf_static", TFMessage([placed("base_link", "lidar", rospy.Time.from_sec(START_S), *SENSOR)]), rospy.Time.from_sec(START_S))
        self.assertTrue(wait_for(lambda: all(one.get_num_connections() for one in self.publishers.values())))
        (x, y, yaw), step_m, driven_m, time_s = course(0.0), 0.8, 0.0, 0.0
        while driven_m < 1.1 * LAP_M:
            time_s += 0.1
            status, path, markers = self.frame((x, y, yaw), time_s)
            self.assertEqual((status.level, status.message, status.name), (0, "following", "/conelane: planner"))
            self.assertEqual(path.header.frame_id, "map")
            places = [(one.pose.position.x, one.pose.position.y) for one in path.poses]
            self.assertLess(math.dist(places[0], (x, y)), 1.0)
            self.assertLess(off_course_m(x, y), 0.4)
            ahead, left = seen_from(*next(place for place in places if math.dist(place, (x, y)) > 3.0), (x, y, yaw))
            turn = step_m * 2.0 * left / (ahead * ahead + left * left)  # pure pursuit
            x, y, yaw = x + step_m * math.cos(yaw + turn / 2), y + step_m * math.sin(yaw + turn / 2), yaw + turn
            driven_m += step_m
        values = {entry.key: entry.value for entry in status.values}
        self.assertEqual(values["lap"], "1")  # one lap is complete
        self.assertGreater(float(values["safe_m"]), 3.0)
        self.assertGreater(int(values["cones"]), 8)
        lines = {(one.ns, one.id): one for one in markers.markers if one.action == Marker.ADD}
        for side, name in ((HALF_WIDTH_M, "left"), (-HALF_WIDTH_M, "right")):
            for point in lines[name, 0].points:
                away_m = min(math.dist((point.x, point.y), course(0.1 * i, side)[:2]) for i in range(int(10.0 * LAP_M)))
                self.assertLess(away_m, 0.4)

        status, path, _ = self.frame((x, y, yaw), time_s + 0.1, frame="no_such_frame")
        self.assertEqual((status.level, path), (2, None))
        self.assertIn("no_such_frame", status.message)
        self.bag.close()
        node.send_signal(signal.SIGINT)  # it leaves roscore
        node.wait(20)
        self.assertTrue(wait_for(lambda: not any(one.get_num_connections() for one in self.subscribers)))
        for publisher in self.publishers.values():
            publisher.unregister()
        self.check_bag(driven={stamp: one.status[0].message for stamp, one in self.heard["/diagnostics"].items()})

    def check_bag(self, driven):
        for messages in self.heard.values():
            messages.clear()
        self.start_node()
        subprocess.run(["rosbag", "play", "--quiet", "--wait-for-subscribers", self.bag.filename], check=True, stdout=subprocess.DEVNULL)
        last = max(driven)
        self.assertTrue(wait_for(lambda: last in self.heard["/diagnostics"]), "no answer to the last frame of the bag")
        run, planner, off_m = conelane.bags.read_bag(File(self.bag.filename)), conelane.Planner("trackdrive", "front-warm"), []
        self.assertEqual(list(run.left_out.values()), [1])
        first_s = min(driven).to_sec()
        for frame in run.frames:  # those that the node answered: it takes the newest one, so it may have skipped some
            stamp = min(driven, key=lambda one: abs(one.to_sec() - first_s - frame.time_s))
            if stamp not in self.heard["/diagnostics"]:
                continue
            plan = planner.update(**frame._replace(time_s=stamp.to_sec())._asdict(), time_limit_ms=1000)
            self.assertEqual(self.heard["/diagnostics"][stamp].status[0].message, plan.state)
            off_m.append(max(math.dist((one.pose.position.x, one.pose.position.y), (x, y))
                             for one, (_, x, y, *_) in zip(self.heard["path"][stamp].poses, plan.centre_line)))
        print(f"{len(off_m)} of {len(run.frames)} frames of the bag were answered as by conelane.bags and a planner")
        self.assertGreater(len(off_m), 20)  # how many depends on the load of the machine
        self.assertLess(statistics.median(off_m), 1e-5)
        self.assertLess(max(off_m), 0.05)  # the two round transforms differently, so a choice by a threshold may differ


if __name__ == "__main__":
    unittest.main(warnings="ignore")  # of rospy
