"""ROS 1 bags and ROS 2 bags (sqlite3 and MCAP) as frames. Needs rosbags: `pip install conelane[bags]`.

    python -m conelane.bags RUN.bag --out run.frames.jsonl [--mapping MAPPING.yaml] [--cones TOPIC] [--pose TOPIC]

docs/messages.md says which messages are known, what a mapping holds and the rules for late and doubled frames.
"""
from __future__ import annotations

import argparse
import os
import sys
from pathlib import Path
from typing import Any, Dict, List, NamedTuple, Optional, Sequence, Union

from .frames import POSE_TYPES, Frame, Mapping, MessageFrames, NoPose, _plain, _Sighting, write_frames
from .messages import READERS

__all__ = ["BagRun", "read_bag"]

_BY_NAME_ALONE = ("visualization_msgs/MarkerArray", "sensor_msgs/PointCloud2")  # most are no cones
# For ROS 2 bags without definitions.
_CONE_WITH_POSE = "std_msgs/Header header\ngeometry_msgs/PoseWithCovariance pose\nfloat64[7] class_probabilities\nfloat64 detection_probability\n"
_DEFINITIONS = {
    "eufs_msgs/ConeWithCovariance": "geometry_msgs/Point point\nfloat64[4] covariance",
    "eufs_msgs/ConeArrayWithCovariance": "std_msgs/Header header\n" + "\n".join(
        f"eufs_msgs/ConeWithCovariance[] {name}" for name in (
            "blue_cones", "yellow_cones", "orange_cones", "big_orange_cones", "unknown_color_cones")),
    "fs_msgs/Cone": "geometry_msgs/Point location\nuint8 color",
    "fs_msgs/Track": "fs_msgs/Cone[] track",
    "pacsim/PerceptionDetection": _CONE_WITH_POSE,
    "pacsim/PerceptionDetections": "std_msgs/Header header\npacsim/PerceptionDetection[] detections",
    "pacsim/Landmark": _CONE_WITH_POSE + "int32 id",
    "pacsim/Track": "pacsim/Landmark[] left_lane\npacsim/Landmark[] right_lane\npacsim/Landmark[] unknown",
    "fsd_common_msgs/Cone": "geometry_msgs/Point position\nstd_msgs/String color",
    "fsd_common_msgs/ConeDetections": "std_msgs/Header header\nfsd_common_msgs/Cone[] cone_detections",
    "fsd_common_msgs/Map": "std_msgs/Header header\n" + "\n".join(
        f"fsd_common_msgs/Cone[] cone_{name}" for name in ("yellow", "blue", "orange")),
}


class BagRun(NamedTuple):
    """The frames of a bag, ordered by their stamps, and where they are from.

    cones, poses: Topic and type.
    left_out: For each reason, how many messages of cones made no frame.
    """

    frames: List[Frame]
    cones: str
    poses: str
    left_out: Dict[str, int]


def read_bag(path: Union[str, "os.PathLike[str]"], mapping: Mapping = Mapping()) -> BagRun:
    """The frames of a bag: of ROS 1 a file, of ROS 2 a folder or its .db3 or .mcap file.

    Raises ValueError naming the bag: if it cannot be read to its end, holds no cones or no poses, or does not say which of
    several topics is meant. ModuleNotFoundError without rosbags.
    """
    from rosbags.highlevel import AnyReader

    if not Path(path).exists():
        raise ValueError(f"{path}: No such file or folder")
    maker = MessageFrames(mapping)
    sightings: List[_Sighting] = []
    try:
        with AnyReader([Path(path)], default_typestore=_types(mapping)) as reader:
            cones = _topic(reader, "cones", mapping.cones, [name for name in {**READERS, **mapping.types} if name not in _BY_NAME_ALONE])
            if maker.reader(cones[0].msgtype) is None:
                raise _Refused(f"{cones[0].topic}: type {cones[0].msgtype} is unknown: --mapping FILE has to say where its cones are")
            poses = _topic(reader, "pose", mapping.pose, POSE_TYPES)
            # A topic of poses comes first, so that TF does not give the same frame of reference again.
            for wanted in (poses, [one for one in reader.connections if _plain(one.msgtype) in POSE_TYPES[3:] and one not in poses]):
                for connection, _, raw in reader.messages(wanted) if wanted else ():
                    message = reader.deserialize(raw, connection.msgtype)
                    maker.add_poses(connection.msgtype, message, "static" in connection.topic)
            for connection, received_ns, raw in reader.messages(cones):
                message = reader.deserialize(raw, connection.msgtype)
                sightings.append(maker.sighting(connection.msgtype, message, received_ns))
    except _Refused as refusal:
        raise ValueError(f"{path}: {refusal}") from None
    except ImportError:
        raise
    except Exception as error:  # of rosbags, its decompressors, sqlite, or a message that is not as it has to be
        raise ValueError(f"{path}: cannot be read: {' '.join(str(error).split()) or type(error).__name__}") from None
    frames, left_out = _in_order(sightings, maker)
    if not frames:
        raise ValueError(f"{path}: no frame has a pose: " + (next(iter(left_out), "there are no cones")))
    return BagRun(frames, *(f"{of[0].topic} ({_plain(of[0].msgtype)})" for of in (cones, poses)), left_out)


class _Refused(Exception):
    """A bag that can be read, and does not say what is meant."""


def _types(mapping: Mapping) -> Any:
    from rosbags.typesys import Stores, get_types_from_msg, get_typestore

    store = get_typestore(Stores.ROS2_HUMBLE)
    for name, text in {**_DEFINITIONS, **mapping.definitions}.items():
        store.register(get_types_from_msg(text, name.replace("/", "/msg/")))
    return store


def _topic(reader: Any, key: str, wanted: Optional[str], types: Sequence[str]) -> List[Any]:
    """The connections of a topic: the wanted one, or the only one of the first of these types that are there; of poses TF last."""
    all_topics = ", ".join(sorted({f"{one.topic} ({_plain(one.msgtype)})" for one in reader.connections})) or "nothing"
    fitting = [one for one in reader.connections if one.msgcount and
               (one.topic == wanted if wanted else _plain(one.msgtype) in types)]
    if key == "pose" and wanted is None:
        firsts = [[one for one in fitting if _plain(one.msgtype) in of] for of in ((types[0],), types[1:3], types[3:])]
        fitting = next((of for of in firsts if of), [])
    topics = sorted({one.topic for one in fitting})
    if not topics:
        raise _Refused(f"holds no {'topic ' + wanted if wanted else 'topic of ' + key}, only {all_topics}")
    if key == "pose" and _plain(fitting[0].msgtype) not in types:
        raise _Refused(f"{topics[0]}: type {_plain(fitting[0].msgtype)} has no poses; these have: {', '.join(types)}")
    if len(topics) > 1 and _plain(fitting[0].msgtype) not in POSE_TYPES[3:]:
        raise _Refused(f"--{key} has to say which topic is meant: {', '.join(topics)}")
    return fitting


def _in_order(sightings: List[_Sighting], maker: MessageFrames) -> Any:
    """Frames by stamp. Of sightings with one stamp the last one received counts."""
    left_out: Dict[str, int] = {}
    last = {sighting.stamp_ns: sighting for sighting in sightings}
    if len(last) < len(sightings):
        left_out["the stamp of a later message"] = len(sightings) - len(last)
    frames: List[Frame] = []
    start_ns: Optional[int] = None
    for stamp_ns in sorted(last):
        try:
            frame = maker.frame(last[stamp_ns], stamp_ns if start_ns is None else start_ns)
        except NoPose as reason:
            left_out[str(reason)] = left_out.get(str(reason), 0) + 1
            continue
        start_ns = stamp_ns if start_ns is None else start_ns
        frames.append(frame)
    return frames, left_out


def add_bag_options(parser: argparse.ArgumentParser, other_runs: str = "") -> None:
    parser.add_argument("run", help="a ROS 1 bag (*.bag); a ROS 2 bag: its folder, .db3 or .mcap file" + other_runs)
    parser.add_argument("--mapping", help="YAML file: topics, frames of reference, types of messages (docs/messages.md)")
    parser.add_argument("--cones", help="topic of the cones")
    parser.add_argument("--pose", help="topic of the poses")


def run_of(options: argparse.Namespace) -> BagRun:
    """The run of a command line; says on standard error what it is made of."""
    mapping = Mapping.read(options.mapping) if options.mapping else Mapping()
    mapping = mapping._replace(**{key: getattr(options, key) for key in ("cones", "pose") if getattr(options, key)})
    run = read_bag(options.run, mapping)
    print(f"{options.run}: {len(run.frames)} frames, cones of {run.cones}, poses of {run.poses}", file=sys.stderr)
    for reason, count in run.left_out.items():
        print(f"{options.run}: {count} left out: {reason}", file=sys.stderr)
    return run


def reporting(work: Any) -> int:
    """The exit code of a command; what is wrong is one line."""
    try:
        work()
        return 0
    except ModuleNotFoundError as error:
        print(f"conelane: {error.name} is missing: pip install 'conelane[bags]'", file=sys.stderr)
    except OSError as error:
        print(f"conelane: {str(error.filename).partition('.part-')[0]}: {error.strerror}", file=sys.stderr)
    except ValueError as error:
        print(f"conelane: {error}", file=sys.stderr)
    return 2


def main(arguments: Optional[Sequence[str]] = None) -> int:
    parser = argparse.ArgumentParser("python -m conelane.bags", description="Writes the frames of a bag, for conelane drive --follow.")
    add_bag_options(parser)
    parser.add_argument("--out", "-o", required=True, help="the *.frames.jsonl file to write")
    options = parser.parse_args(arguments)
    return reporting(lambda: write_frames(options.out, run_of(options).frames))


if __name__ == "__main__":
    sys.exit(main())
