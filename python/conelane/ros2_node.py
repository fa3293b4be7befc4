"""A node for ROS 2: cones and poses in, the path to drive out. Its work is that of `NodeCore`, which needs no ROS.

    python -m conelane.ros2_node --ros-args -p cones_type:=eufs_msgs/msg/ConeArrayWithCovariance -r cones:=/perception/cones

in   cones, pose, /tf, /tf_static    cones and pose of the types in the parameters cones_type and pose_type (empty: poses of TF)
out  path, markers, /diagnostics     the same as the node for ROS 1 (experiments/examples/ros1)

More parameters: mission, detector, laps (0: the mission's own), time_limit_ms, mapping (YAML file, `conelane.frames.Mapping`).
"""
from __future__ import annotations

import math
from typing import Any, Dict, List, Optional

from . import Plan, Planner
from .frames import Mapping, MessageFrames, NoPose, _Sighting

__all__ = ["NodeCore", "messages_of"]

_MOST_POSES = 2000  # of each frame of reference
_LEVELS = {"following": b"\x00", "finished": b"\x00", "lost": b"\x02"}
_WARN, _ERROR = b"\x01", b"\x02"


class NodeCore:
    """Messages in, messages out. Those that go out are dicts by their topics."""

    def __init__(self, planner: Planner, mapping: Mapping = Mapping(), time_limit_ms: Optional[float] = 20.0) -> None:
        self._planner, self._time_limit_ms = planner, time_limit_ms
        self._maker = MessageFrames(mapping, _MOST_POSES)
        self._waiting: Optional[_Sighting] = None  # for a pose

    def on_poses(self, type_name: str, message: Any, is_fixed: bool = False) -> Dict[str, Any]:
        """What is to be published: cones may have waited for this pose."""
        try:
            self._maker.add_poses(type_name, message, is_fixed)
        except ValueError as error:  # the run goes on: the next pose may be valid
            return {"/diagnostics": _diagnostics(0, _ERROR, str(error), {})}
        return self._answer(self._waiting, is_last=False)

    def on_cones(self, type_name: str, message: Any, received_ns: int) -> Dict[str, Any]:
        """What is to be published; nothing while these cones wait for a pose. Cones of an earlier message stop waiting."""
        given_up = self._answer(self._waiting, is_last=True)
        self._waiting = None
        try:
            sighting = self._maker.sighting(type_name, message, received_ns)
        except (KeyError, TypeError, ValueError) as error:  # a mapping may name a field that is no number
            return {"/diagnostics": _diagnostics(received_ns, _ERROR, str(error), {})}
        return self._answer(sighting, is_last=False) or given_up

    def _answer(self, sighting: Optional[_Sighting], is_last: bool) -> Dict[str, Any]:
        if sighting is None:
            return {}
        self._waiting = None
        try:
            frame = self._maker.frame(sighting)
            plan = self._planner.update(**frame._asdict(), time_limit_ms=self._time_limit_ms)
        except NoPose as reason:
            if not is_last:
                self._waiting = sighting
                return {}
            return {"/diagnostics": _diagnostics(sighting.stamp_ns, _ERROR, str(reason), {})}
        except ValueError as error:  # of the planner
            return {"/diagnostics": _diagnostics(sighting.stamp_ns, _ERROR, str(error), {})}
        return messages_of(plan, sighting.stamp_ns, self._maker.frame_of_map, len(frame.cones))


def _header(stamp_ns: int, frame: str) -> Dict[str, Any]:
    return {"stamp": {"sec": stamp_ns // 10**9, "nanosec": stamp_ns % 10**9}, "frame_id": frame}


def _diagnostics(stamp_ns: int, level: bytes, message: str, values: Dict[str, Any]) -> Dict[str, Any]:
    entries = [{"key": key, "value": str(value)} for key, value in values.items()]
    return {"header": _header(stamp_ns, ""), "status": [{"level": level, "name": "conelane: planner", "message": message, "values": entries}]}


def messages_of(plan: Plan, stamp_ns: int, map_frame: str, cones: int) -> Dict[str, Any]:
    """nav_msgs/Path, visualization_msgs/MarkerArray and diagnostic_msgs/DiagnosticArray of a plan, as dicts by topic."""
    header, line = _header(stamp_ns, map_frame), plan.centre_line.tolist()
    poses = [{"header": header, "pose": {"position": {"x": x, "y": y}, "orientation": {"z": math.sin(yaw / 2), "w": math.cos(yaw / 2)}}}
             for _, x, y, yaw, *_ in line]
    markers: List[Dict[str, Any]] = []
    for name, side, column, color in (("left", 1.0, 5, {"b": 1.0}), ("right", -1.0, 6, {"r": 1.0, "g": 0.8})):
        for trusted in (True, False):
            points = [{"x": row[1] - side * row[column] * math.sin(row[3]), "y": row[2] + side * row[column] * math.cos(row[3]), "z": 0.0}
                      for row in line if trusted == (row[0] <= plan.safe_m)]
            markers.append({"header": header, "ns": name, "id": 0 if trusted else 1, "type": 4, "action": 0 if len(points) > 1 else 2,
                            "pose": {"orientation": {"w": 1.0}}, "scale": {"x": 0.1}, "color": {**color, "a": 1.0 if trusted else 0.4},
                            "points": points})
    values = {key: getattr(plan, key) for key in ("lap", "phase", "stop", "safe_m", "age_s", "latency_ms")}
    state = _diagnostics(stamp_ns, _LEVELS.get(plan.state, _WARN), plan.state, {**values, "detector": plan.answer.status, "cones": cones})
    return {"path": {"header": header, "poses": poses}, "markers": {"markers": markers}, "/diagnostics": state}


def main() -> None:
    import rclpy
    from rclpy.node import Node
    from rclpy.qos import DurabilityPolicy, QoSProfile
    from rosidl_runtime_py.set_message import set_message_fields
    from rosidl_runtime_py.utilities import get_message

    rclpy.init()
    node = Node("conelane")
    defaults = {"cones_type": "eufs_msgs/msg/ConeArrayWithCovariance", "pose_type": "nav_msgs/msg/Odometry", "mission": "trackdrive",
                "detector": "front-warm", "laps": 0, "time_limit_ms": 20.0, "mapping": ""}
    given = {name: node.declare_parameter(name, value).value for name, value in defaults.items()}
    core = NodeCore(Planner(given["mission"], given["detector"], given["laps"] or None),
                    Mapping.read(given["mapping"]) if given["mapping"] else Mapping(), given["time_limit_ms"])
    types = {"path": "nav_msgs/msg/Path", "markers": "visualization_msgs/msg/MarkerArray", "/diagnostics": "diagnostic_msgs/msg/DiagnosticArray"}
    publishers = {topic: node.create_publisher(get_message(name), topic, 1) for topic, name in types.items()}

    def publish(messages: Dict[str, Any]) -> None:
        for topic, fields in messages.items():
            message = get_message(types[topic])()
            set_message_fields(message, fields)
            publishers[topic].publish(message)

    def subscribe(name: str, topic: str, call: Any, qos: Any = 50) -> None:
        node.create_subscription(get_message(name), topic, lambda message: publish(call(name, message)), qos)

    tf = "tf2_msgs/msg/TFMessage"
    subscribe(given["cones_type"], "cones", lambda name, one: core.on_cones(name, one, node.get_clock().now().nanoseconds), 1)
    subscribe(tf, "/tf", core.on_poses)
    subscribe(tf, "/tf_static", lambda name, one: core.on_poses(name, one, True),
              QoSProfile(depth=50, durability=DurabilityPolicy.TRANSIENT_LOCAL))
    if given["pose_type"]:
        subscribe(given["pose_type"], "pose", core.on_poses)
    rclpy.spin(node)


if __name__ == "__main__":
    main()
