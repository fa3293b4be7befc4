"""ros1_node_test.py NODE: starts roscore and the node for ROS 1, plays a circle to it and checks what it publishes. Skipped (77)
where ROS or the node is missing."""
import math
import os
import shutil
import socket
import subprocess
import sys
import tempfile
import time
import unittest

NODE = sys.argv.pop(1) if len(sys.argv) > 1 else ""
try:
    import rospy
    import tf2_ros
    from diagnostic_msgs.msg import DiagnosticArray
    from genpy.dynamic import generate_dynamic
    from geometry_msgs.msg import TransformStamped
    from nav_msgs.msg import Path
    from visualization_msgs.msg import Marker, MarkerArray
except ImportError as missing:
    print(f"skipped: {missing}")
    sys.exit(77)
if not os.path.exists(NODE) or not shutil.which("roscore"):
    print(f"skipped: {'no roscore' if os.path.exists(NODE) else 'the node is not built, ROS is missing'}")
    sys.exit(77)

_EUFS = """std_msgs/Header header
ConeWithCovariance[] blue_cones
ConeWithCovariance[] yellow_cones
ConeWithCovariance[] orange_cones
ConeWithCovariance[] big_orange_cones
ConeWithCovariance[] unknown_color_cones
================================================================================
MSG: std_msgs/Header
uint32 seq
time stamp
string frame_id
================================================================================
MSG: eufs_msgs/ConeWithCovariance
geometry_msgs/Point point
float64[4] covariance
================================================================================
MSG: geometry_msgs/Point
float64 x
float64 y
float64 z
"""
RADIUS_M = 20.0


def pose_at(metres):
    angle = metres / RADIUS_M
    return 5.0 + RADIUS_M * math.sin(angle), 7.0 + RADIUS_M * (1.0 - math.cos(angle)), angle


def placed(frame, child, stamp, x, y, yaw):
    transform = TransformStamped()
    transform.header.frame_id, transform.child_frame_id, transform.header.stamp = frame, child, stamp
    transform.transform.translation.x, transform.transform.translation.y = x, y
    transform.transform.rotation.z, transform.transform.rotation.w = math.sin(yaw / 2), math.cos(yaw / 2)
    return transform


class Node(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        with socket.socket() as free:
            free.bind(("localhost", 0))
            port = free.getsockname()[1]
        cls.logs = tempfile.TemporaryDirectory()
        os.environ.update(ROS_MASTER_URI=f"http://localhost:{port}", ROS_HOSTNAME="localhost", ROS_LOG_DIR=cls.logs.name)
        cls.started = [subprocess.Popen(["roscore", "-p", str(port)], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)]
        for _ in range(300):
            with socket.socket() as probe:
                if probe.connect_ex(("localhost", port)) == 0:
                    break
            time.sleep(0.1)
        rospy.init_node("player", anonymous=True, disable_signals=True)
        cls.heard = {"path": [], "markers": [], "/diagnostics": []}
        for topic, kind in (("path", Path), ("markers", MarkerArray), ("/diagnostics", DiagnosticArray)):
            rospy.Subscriber(topic, kind, cls.heard[topic].append)
        types = generate_dynamic("eufs_msgs/ConeArrayWithCovariance", _EUFS)
        cls.cone_array, cls.cone = types["eufs_msgs/ConeArrayWithCovariance"], types["eufs_msgs/ConeWithCovariance"]
        cls.cones = rospy.Publisher("cones", cls.cone_array, queue_size=5)
        cls.transforms, cls.fixed = tf2_ros.TransformBroadcaster(), tf2_ros.StaticTransformBroadcaster()
        cls.fixed.sendTransform(placed("base_link", "lidar", rospy.Time.now(), 1.0, 0.0, 0.2))
        cls.started.append(subprocess.Popen([NODE, "_mission:=trackdrive", "_time_limit_ms:=1000", "_transform_wait_s:=5.0"]))
        for _ in range(300):
            if cls.cones.get_num_connections() and cls.transforms.pub_tf.get_num_connections():
                break
            time.sleep(0.1)

    @classmethod
    def tearDownClass(cls):
        for process in reversed(cls.started):
            process.terminate()
            process.wait(20)
        cls.logs.cleanup()

    def play(self, metres, frame="lidar", with_cones=True):
        """One frame; gives what the node answers to it: of each topic the message with its stamp."""
        x, y, yaw = pose_at(metres)
        message, stamp = self.cone_array(), rospy.Time.now()
        message.header.stamp, message.header.frame_id = stamp, frame
        for radius, cones in ((RADIUS_M - 1.5, message.blue_cones), (RADIUS_M + 1.5, message.yellow_cones)):
            for i in range(40 if with_cones else 0):
                angle = 2.0 * math.pi * i / 40
                dx, dy = 5.0 + radius * math.sin(angle) - x, 7.0 + RADIUS_M - radius * math.cos(angle) - y
                ahead, left = dx * math.cos(yaw) + dy * math.sin(yaw) - 1.0, dy * math.cos(yaw) - dx * math.sin(yaw)
                cone = self.cone(covariance=[0.04, 0.0, 0.0, 0.01])
                cone.point.x = ahead * math.cos(0.2) + left * math.sin(0.2)
                cone.point.y = left * math.cos(0.2) - ahead * math.sin(0.2)
                if cone.point.x > -1.0 and math.hypot(ahead, left) < 20.0:
                    cones.append(cone)
        self.transforms.sendTransform(placed("map", "base_link", stamp, x, y, yaw))
        self.cones.publish(message)
        for _ in range(600):
            last = [one for one in self.heard["/diagnostics"] if one.header.stamp == stamp]
            if last:
                break
            time.sleep(0.05)
        self.assertTrue(last, "no answer within 30 s")
        time.sleep(0.2)
        paths = [one for one in self.heard["path"] if one.header.stamp == stamp]
        markers = [one for one in self.heard["markers"] if one.markers[0].header.stamp == stamp]
        return last[0].status[0], paths[0] if paths else None, markers[0] if markers else None

    def test_a_run(self):
        for step in range(4):
            status, path, markers = self.play(0.5 * step)
            time.sleep(0.1)
        self.assertEqual((status.level, status.message, status.name), (0, "following", "/conelane: planner"))
        values = {entry.key: entry.value for entry in status.values}
        self.assertGreater(float(values["safe_m"]), 3.0)
        self.assertGreater(int(values["cones"]), 8)
        self.assertEqual(path.header.frame_id, "map")
        places = [(one.pose.position.x, one.pose.position.y) for one in path.poses]
        self.assertGreater(len(places), 10)
        for x, y in places:
            self.assertAlmostEqual(math.hypot(x - 5.0, y - 27.0), RADIUS_M, delta=0.3)
        self.assertLess(math.dist(places[0], pose_at(1.5)[:2]), 1.0)
        lines = {(one.ns, one.id): one for one in markers.markers if one.action == Marker.ADD}
        for x, y in ((one.x, one.y) for one in lines["left", 0].points):
            self.assertAlmostEqual(math.hypot(x - 5.0, y - 27.0), RADIUS_M - 1.5, delta=0.4)

        status, path, _ = self.play(2.5, with_cones=False)
        self.assertEqual((status.level, status.message), (1, "bridging"))
        time.sleep(1.2)
        status, path, markers = self.play(4.0, with_cones=False)
        self.assertEqual((status.level, status.message, len(path.poses)), (2, "lost", 0))
        self.assertEqual({one.action for one in markers.markers}, {Marker.DELETE})

        status, path, _ = self.play(4.5, frame="no_such_frame")
        self.assertEqual((status.level, path), (2, None))
        self.assertIn("no_such_frame", status.message)


if __name__ == "__main__":
    unittest.main(warnings="ignore")  # of rospy
