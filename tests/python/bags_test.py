"""Bags of every kind become the frames that they were made of, and bad ones are refused in one line.

CONELANE_ROSBAGS may name the folder that has rosbags (pip install --target FOLDER rosbags); without rosbags the test is skipped (77).
"""
import contextlib
import io
import json
import math
import os
import re
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

import numpy as np

sys.path.append(os.environ.get("CONELANE_ROSBAGS", ""))
try:
    from rosbags.rosbag1 import Writer as Writer1
    from rosbags.rosbag2 import StoragePlugin
    from rosbags.rosbag2 import Writer as Writer2
    from rosbags.typesys import Stores, get_types_from_msg, get_typestore
except ImportError as missing:
    print(f"skipped: {missing}")
    sys.exit(77)

import conelane
from conelane import bags, frames, replay
from conelane.messages import to_eufs, to_fs_track, to_pacsim

PROGRAM = os.environ.get("CONELANE_PROGRAM")
START_NS = 1_700_000_000_000_000_000
STORES = {1: get_typestore(Stores.ROS1_NOETIC), 2: get_typestore(Stores.ROS2_HUMBLE)}
CUSTOM = {"my_msgs/Cone": "float64[2] at\nstring kind\nfloat32 p\nint32 track\nfloat64[9] cov",
          "my_msgs/Cones": "std_msgs/Header header\nmy_msgs/Cone[] seen",
          "my_msgs/Blob": "std_msgs/Header header\nfloat64 x\nfloat64 y"}
for store in STORES.values():
    for name, text in {**bags._DEFINITIONS, **CUSTOM}.items():
        store.register(get_types_from_msg(text, name.replace("/", "/msg/")))


def message(version, type_name, given):
    """A message of a type of nested dicts; what they leave out is 0 or empty."""
    store = STORES[version]
    if type_name == "builtin_interfaces/msg/Time":
        return store.types[type_name](**{"sec": 0, "nanosec": 0, **given})

    def value(spec, of):
        kind, detail = int(spec[0]), spec[1]
        if kind == 1:  # a primitive type
            return of if of is not None else "" if detail[0] == "string" else 0
        if kind == 2:
            return message(version, detail, of or {})
        (inner, length) = detail
        items = of if of is not None else [None] * (length if kind == 3 else 0)
        if int(inner[0]) == 1 and inner[1][0] != "string":
            return np.array(items if of is not None else np.zeros(len(items)), dtype=np.bool_ if inner[1][0] == "bool" else inner[1][0])
        return [value(inner, item) for item in items]

    fields = store.get_msgdef(type_name).fields
    return store.types[type_name](**{name: value(spec, given.get(name)) for name, spec in fields})


def stamp(seconds):
    nanoseconds = START_NS + round(seconds * 1e9)
    return {"sec": nanoseconds // 10**9, "nanosec": nanoseconds % 10**9}


def header(seconds, frame):
    return {"stamp": stamp(seconds), "frame_id": frame}


def quaternion(yaw):
    return {"z": math.sin(yaw / 2), "w": math.cos(yaw / 2)}


def pose_at(seconds):
    """A left circle of 20 m at 5 m/s, begun at (3, 4)."""
    angle = 5.0 * seconds / 20.0
    return 3.0 + 20.0 * math.sin(angle), 4.0 + 20.0 * (1.0 - math.cos(angle)), angle


def transform(seconds, parent, child, x=0.0, y=0.0, yaw=0.0):
    return {"header": header(seconds, parent), "child_frame_id": child,
            "transform": {"translation": {"x": x, "y": y}, "rotation": quaternion(yaw)}}


def odometry(seconds):
    x, y, yaw = pose_at(seconds)
    return {"header": header(seconds, "map"), "child_frame_id": "base_link",
            "pose": {"pose": {"position": {"x": x, "y": y}, "orientation": quaternion(yaw)}}}


def in_car(seconds, at=(0.0, 0.0, 0.0)):
    """Cones of the course as the car sees them, and as a sensor does that stands there in it."""
    angles = np.arange(0.0, 2.0 * math.pi, 0.2)
    course = np.concatenate([[3.0, 24.0] + radius * np.column_stack([np.sin(angles), -np.cos(angles)]) for radius in (18.5, 21.5)])
    for x, y, yaw in (pose_at(seconds), at):
        course = (course - [x, y]) @ [[math.cos(yaw), -math.sin(yaw)], [math.sin(yaw), math.cos(yaw)]]
    seen = (course[:, 0] > 0.0) & (np.hypot(*course.T) < 20.0)
    return course[seen], np.repeat([1, 2], len(angles))[seen]


def write_bag(path, kind, rows):
    """rows: (received [s], topic, type, message as dicts). kind: 1, "db3" or "mcap"."""
    version = 1 if kind == 1 else 2
    writer = Writer1(path) if kind == 1 else Writer2(path, version=8, storage_plugin=StoragePlugin[{"db3": "SQLITE3", "mcap": "MCAP"}[kind]])
    store, connections = STORES[version], {}
    with writer:
        for received, topic, type_name, given in rows:
            full = type_name.replace("/", "/msg/")
            if topic not in connections:
                connections[topic] = writer.add_connection(topic, full, typestore=store)
            serialize = store.serialize_ros1 if version == 1 else store.serialize_cdr
            if version == 1 and "header" in given:
                given = {**given, "header": {**given["header"], "seq": 0}}
            writer.write(connections[topic], START_NS + round(received * 1e9), serialize(message(version, full, given), full))


def eufs(seconds, covariance=None):
    places, colors = in_car(seconds)
    return {"header": header(seconds, "base_link"), **to_eufs(places, colors, covariance if covariance is None else [covariance] * len(places))}


def poses(until=3.0, rate=20.0):
    return [(i / rate, "/odom", "nav_msgs/Odometry", odometry(i / rate)) for i in range(round(until * rate) + 1)]


def run(seconds=3.0, make=eufs, topic="/cones", type_name="eufs_msgs/ConeArrayWithCovariance"):
    return [(t + 0.02, topic, type_name, make(t)) for t in np.arange(0.0, seconds, 0.1).round(3).tolist()]


def fs_track(seconds):
    places, colors = in_car(seconds)
    return to_fs_track(places, colors)


def pacsim(seconds):
    places, colors = in_car(seconds, (1.5, 0.0, 0.1))
    made = to_pacsim(places, colors)
    for one in made["detections"]:
        one["pose"]["covariance"] = [0.04 if i == 0 else 0.01 if i == 7 else 0.0 for i in range(36)]
    return {"header": header(seconds, "lidar"), **made}


def amz(seconds):
    places, colors = in_car(seconds)
    return {"header": header(seconds, "base_link"), "cone_detections": [
        {"position": {"x": x, "y": y}, "color": {"data": "?by"[color]}} for (x, y), color in zip(places.tolist(), colors)]}


def markers(seconds):
    places, colors = in_car(seconds)
    return {"markers": [{"header": header(seconds, "base_link"), "pose": {"position": {"x": x, "y": y}},
                         "color": {"r": float(color == 2), "g": 0.9 * (color == 2), "b": float(color == 1), "a": 1.0}}
                        for (x, y), color in zip(places.tolist(), colors)]}


def cloud(seconds):
    places, _ = in_car(seconds)
    data = np.zeros(len(places), dtype=[("x", "<f4"), ("y", "<f4"), ("z", "<f4"), ("p", "<f4")])
    data["x"], data["y"], data["p"] = *places.T, 0.8
    fields = [{"name": name, "offset": 4 * i, "datatype": 7, "count": 1} for i, name in enumerate(data.dtype.names)]
    return {"header": header(seconds, "base_link"), "height": 1, "width": len(places), "fields": fields, "point_step": 16,
            "row_step": 16 * len(places), "data": np.frombuffer(data.tobytes(), np.uint8)}


def custom(seconds):
    places, colors = in_car(seconds)
    return {"header": header(seconds, "base_link"), "seen": [
        {"at": list(place), "kind": "?LR"[color], "p": 0.5, "track": i, "cov": [0.04, 0, 0, 0, 0.01, 0, 0, 0, 1]}
        for i, (place, color) in enumerate(zip(places.tolist(), colors))]}


class Bags(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)

    def check(self, path, colors=True, **mapping):
        """Poses and places are those of the course, for 30 frames, less at most one at each end, where poses may lack."""
        got = bags.read_bag(path, frames.Mapping(**mapping))
        self.assertGreaterEqual(len(got.frames), 28)
        for frame in got.frames:
            since = frame.time_s + (3.0 - 0.1 - got.frames[-1].time_s)
            np.testing.assert_allclose(frame.pose, pose_at(since), atol=2e-3)
            radius = np.hypot(*(frame.cones - [3.0, 24.0]).T)
            self.assertGreater(len(radius), 8)
            np.testing.assert_allclose(np.minimum(abs(radius - 18.5), abs(radius - 21.5)), 0.0, atol=5e-3)
            if colors:
                np.testing.assert_array_equal(frame.colors, np.where(radius < 20.0, 1, 2))
        return got

    def test_a_ros_1_bag_of_eufs_with_odometry_and_covariances(self):
        rows = poses() + run(make=lambda t: eufs(t, [0.04, 0.0, 0.0, 0.01]))
        write_bag(self.folder / "run.bag", 1, rows)
        got = self.check(self.folder / "run.bag")
        self.assertEqual(got.cones, "/cones (eufs_msgs/ConeArrayWithCovariance)")
        frame = got.frames[20]
        yaw = frame.pose[2]
        along = frame.covariances[0] @ [math.cos(yaw), math.sin(yaw)]
        np.testing.assert_allclose(along, 0.04 * np.array([math.cos(yaw), math.sin(yaw)]), atol=1e-9)

    def test_sqlite_without_definitions_of_fs_msgs_in_the_map_by_tf(self):
        def in_map(seconds):
            x, y, yaw = pose_at(seconds)
            places, colors = in_car(seconds)
            return {"track": to_fs_track(places @ [[math.cos(yaw), math.sin(yaw)], [-math.sin(yaw), math.cos(yaw)]] + [x, y], colors)["track"]}

        rows = [(t, "/tf", "tf2_msgs/TFMessage", {"transforms": [transform(t, "odom", "base_link", *pose_at(t))]})
                for t in np.arange(0.0, 3.0, 0.05).tolist()]
        rows += [(0.0, "/tf_static", "tf2_msgs/TFMessage", {"transforms": [transform(0.0, "map", "odom")]})]
        rows += [(t, "/cones", "fs_msgs/Track", in_map(t)) for t in np.arange(0.0, 3.0, 0.1).tolist()]
        write_bag(self.folder / "run", "db3", rows)
        with contextlib.closing(__import__("sqlite3").connect(next((self.folder / "run").glob("*.db3")))) as base:
            base.execute("DELETE FROM message_definitions")
            base.commit()
        got = bags.read_bag(self.folder / "run")  # fs_msgs/Track has no header: it is in the map
        self.assertEqual(len(got.frames), 30)
        np.testing.assert_allclose(np.hypot(*(got.frames[9].cones - [3.0, 24.0]).T).min(), 18.5, atol=1e-3)
        self.assertEqual(got.poses, "/tf (tf2_msgs/TFMessage)")

    def test_mcap_of_pacsim_with_a_sensor_and_posestamped(self):
        rows = [(t, "/pose", "geometry_msgs/PoseStamped", {"header": header(t, "map"), "pose": odometry(t)["pose"]["pose"]})
                for t in np.arange(0.0, 3.0, 0.05).tolist()]
        rows += [(0.0, "/tf_static", "tf2_msgs/TFMessage", {"transforms": [transform(0.0, "base_link", "lidar", 1.5, 0.0, 0.1)]})]
        write_bag(self.folder / "run", "mcap", rows + run(make=pacsim, type_name="pacsim/PerceptionDetections"))
        got = self.check(next((self.folder / "run").glob("*.mcap")))
        frame = got.frames[10]
        heading = frame.pose[2] + 0.1
        self.assertAlmostEqual(frame.covariances[0, 0, 1], 0.03 * math.cos(heading) * math.sin(heading), places=9)
        self.assertTrue((frame.confidences == 1.0).all())

    def test_amz_markers_clouds_and_a_type_that_a_mapping_tells(self):
        for name, make, type_name, told in (
                ("amz", amz, "fsd_common_msgs/ConeDetections", {}), ("markers", markers, "visualization_msgs/MarkerArray", {"cones": "/cones"}),
                ("cloud", cloud, "sensor_msgs/PointCloud2", {"cones": "/cones", "types": {
                    "sensor_msgs/PointCloud2": conelane.messages.Fields(confidence="p")}})):
            with self.subTest(name):
                write_bag(self.folder / f"{name}.bag", 1, poses() + run(make=make, type_name=type_name))
                got = self.check(self.folder / f"{name}.bag", colors=name != "cloud", **told)
                if name == "cloud":
                    np.testing.assert_allclose(got.frames[0].confidences, 0.8, atol=1e-6)
        write_bag(self.folder / "own", "mcap", poses() + run(make=custom, type_name="my_msgs/Cones"))
        (self.folder / "own.yaml").write_text(
            "types:\n  my_msgs/msg/Cones:\n    {lists: {seen: null}, x: at.0, y: at.1, color: kind, colors: {L: blue, R: yellow},\n"
            "     confidence: p, id: track, covariance: cov}\n", encoding="utf-8")
        got = self.check(self.folder / "own", **frames.Mapping.read(self.folder / "own.yaml")._asdict())
        self.assertEqual(got.frames[0].ids.tolist(), list(range(len(got.frames[0].ids))))

    def test_late_doubled_and_unordered_frames(self):
        rows = run(1.0)
        rows[3] = (0.97, *rows[3][1:])  # late
        rows += [(0.52, *run(1.0, lambda t: {"header": header(0.5, "base_link"), **to_eufs([[7.0, 0.0]])})[0][1:])]  # 0.5 s again
        rows += [(0.2, *run(1.0, lambda t: {"header": header(7.7, "base_link"), **to_eufs([[7.0, 0.0]])})[0][1:])]  # has no pose
        nan = to_eufs([[float("nan"), 1.0], [5.0, 1.0]])
        rows += [(0.96, *run(1.0, lambda t: {"header": {"stamp": {"sec": 0, "nanosec": 0}, "frame_id": "base_link"}, **nan})[0][1:])]
        write_bag(self.folder / "run.bag", 1, sorted(poses(1.0) + rows, key=lambda row: row[0]))
        got = bags.read_bag(self.folder / "run.bag")
        times = [round(frame.time_s, 3) for frame in got.frames]
        self.assertEqual(times, [0.0, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 0.96])
        self.assertEqual((len(got.frames[5].cones), len(got.frames[10].cones)), (1, 1))
        self.assertEqual(sorted(got.left_out.values()), [1, 1])

    def test_frames_of_a_file_are_the_frames_of_the_bag(self):
        write_bag(self.folder / "run.bag", 1, poses() + run(make=lambda t: eufs(t, [0.04, 0.0, 0.0, 0.01])))
        file = self.folder / "run.frames.jsonl"
        self.assertEqual(bags.main([str(self.folder / "run.bag"), "--out", str(file)]), 0)
        for first, again in zip(bags.read_bag(self.folder / "run.bag").frames, frames.read_frames(file)):
            self.assertEqual((first.time_s, first.pose), (again.time_s, again.pose))
            for key in ("cones", "colors", "covariances"):
                np.testing.assert_allclose(getattr(first, key), getattr(again, key), atol=1e-6)

    def test_a_page_of_a_bag_and_the_same_by_the_program(self):
        gone = [row for row in run(6.0) if not 3.0 < row[0] < 5.0]
        write_bag(self.folder / "run.bag", 1, poses(6.0) + gone)
        page, file = self.folder / "run.html", self.folder / "run.frames.jsonl"
        made = subprocess.run([sys.executable, "-m", "conelane.replay", self.folder / "run.bag", "--out", page], capture_output=True, text=True,
                              env={**os.environ, "PYTHONPATH": os.pathsep.join([os.environ["PYTHONPATH"], os.environ.get("CONELANE_ROSBAGS", "")])})
        self.assertEqual((made.returncode, made.stdout), (0, ""), made.stderr)
        text = page.read_text(encoding="utf-8")
        for pattern in (r"40 frames, 5\.9 s", r"2\.\d s without a frame"):
            self.assertTrue(re.search(pattern, text), pattern)
        self.assertFalse(re.search(r'(src|href)="(?!data:)', text))
        if PROGRAM:
            self.assertEqual(bags.main([str(self.folder / "run.bag"), "--out", str(file)]), 0)
            subprocess.run([PROGRAM, "drive", "--follow", file, "--out", self.folder / "p.jsonl", "--page", self.folder / "p.html", "--time-limit", "inf"],
                           check=True)
            text = replay.replay(bags.read_bag(self.folder / "run.bag").frames, conelane.Planner(), time_limit_ms=None)
            states = [[one["state"] for one in json.loads(of.split('id="race-data">')[1].split("</script>")[0])["frames"]]
                      for of in (text, (self.folder / "p.html").read_text(encoding="utf-8"))]
            self.assertEqual(states[0], states[1])

    def refused(self, pattern, path, *more):
        out, errors = self.folder / "out.frames.jsonl", io.StringIO()
        before = sorted(os.listdir(self.folder))
        with contextlib.redirect_stderr(errors):
            self.assertEqual(bags.main([str(path), "--out", str(out), *more]), 2)
        self.assertRegex(errors.getvalue(), pattern)
        self.assertEqual(errors.getvalue().count("\n"), 1, errors.getvalue())
        self.assertIn(str(path), errors.getvalue())
        self.assertEqual(sorted(os.listdir(self.folder)), before)

    def test_bad_bags(self):
        write_bag(self.folder / "run.bag", 1, poses() + run())
        whole = (self.folder / "run.bag").read_bytes()
        for share in (0.0, 0.1, 0.6, 0.99):
            (self.folder / "cut.bag").write_bytes(whole[:int(share * len(whole))])
            self.refused("cut.bag: cannot be read: ", self.folder / "cut.bag")
        for kind in ("db3", "mcap"):
            write_bag(self.folder / kind, kind, poses() + run())
            file = next((self.folder / kind).glob(f"*.{kind}"))
            file.write_bytes(file.read_bytes()[:9000])
            self.refused("cannot be read: ", self.folder / kind)
        self.refused("none.bag: .*No such file", self.folder / "none.bag")
        write_bag(self.folder / "no_pose.bag", 1, run())
        self.refused("holds no topic of pose, only /cones", self.folder / "no_pose.bag")
        write_bag(self.folder / "no_cones.bag", 1, poses())
        self.refused("holds no topic of cones, only /odom", self.folder / "no_cones.bag")
        write_bag(self.folder / "unknown", "mcap", poses() + run(make=custom, type_name="my_msgs/Cones"))
        self.refused(r"holds no topic of cones, only /cones \(my_msgs/Cones\)", self.folder / "unknown")
        self.refused("my_msgs/msg/Cones is unknown", self.folder / "unknown", "--cones", "/cones")
        self.refused("/cones: type eufs_msgs/ConeArrayWithCovariance has no poses; these have: nav_msgs/Odometry", self.folder / "run.bag", "--pose", "/cones")
        write_bag(self.folder / "late.bag", 1, poses(0.2) + run(2.0)[5:])
        self.refused("no frame has a pose: no pose of 'base_link' in 'map' within", self.folder / "late.bag")
        write_bag(self.folder / "two.bag", 1, poses() + run() + run(topic="/other"))
        self.refused("--cones has to say which topic is meant: /cones, /other", self.folder / "two.bag")
        for text, pattern in (("cone: /x", "cone: is not one of"), ("types: {a/B: {list: 1}}", "types: a/B: list: is not one of"),
                              ("types: {a/B: {lists: {seen: red}}}", "'red' is not one of"), ("types: {a/B: {lists: [seen]}}", "lists: must be a mapping"),
                              ("car_frame: 5", "car_frame: must be text"), ("types: 5", "types: must be a mapping"), ("{", "cannot be read")):
            (self.folder / "m.yaml").write_text(text, encoding="utf-8")
            errors = io.StringIO()
            with contextlib.redirect_stderr(errors):
                self.assertEqual(bags.main([str(self.folder / "run.bag"), "-o", str(self.folder / "o"), "--mapping", str(self.folder / "m.yaml")]), 2)
            self.assertRegex(errors.getvalue(), "m.yaml: .*" + pattern)


if __name__ == "__main__":
    unittest.main()
