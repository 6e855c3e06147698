"""What the page shows of each topic: from messages to values of JSON."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from action_msgs.msg import GoalStatus, GoalStatusArray
from humanoid_interfaces.action import PerformDance, WalkTo
from humanoid_interfaces.msg import (
    BalanceState,
    BatteryStatus,
    DetectedObjectArray,
    EmergencyStop,
    FootstepPlan,
    GaitState,
    TaskStatus,
)
from nav_msgs.msg import OccupancyGrid, Odometry, Path
from rcl_interfaces.msg import Log
from rosgraph_msgs.msg import Clock
from sensor_msgs.msg import JointState
from std_msgs.msg import String
from visualization_msgs.msg import MarkerArray

_STATES = {
    GoalStatus.STATUS_ACCEPTED: "accepted",
    GoalStatus.STATUS_EXECUTING: "executing",
    GoalStatus.STATUS_CANCELING: "canceling",
    GoalStatus.STATUS_SUCCEEDED: "succeeded",
    GoalStatus.STATUS_CANCELED: "canceled",
    GoalStatus.STATUS_ABORTED: "aborted",
}
_SHAPES = {1: "box", 2: "sphere", 3: "cylinder"}  # visualization_msgs/msg/Marker.type
_DELETE = (2, 3)  # its actions
_MOST_CELLS = 1_000_000
_OCCUPIED = 65  # percent, from which our planner sees an obstacle


@dataclass(frozen=True, slots=True)
class Reading:
    """How a topic is shown: `read` makes the value that its channel on the page gets."""

    kind: type[Any]
    channel: str
    read: Callable[[Any], Any]
    latched: bool = False


def rounded(*values: float) -> list[float]:
    """Round to a tenth of a millimetre."""
    return [_number(value, 4) for value in values]


def _number(value: float, digits: int) -> float:
    """A rounded number; JSON has no value for those that are not finite."""
    return round(value, digits) if math.isfinite(value) else 0.0


def yaw_of(q: Any) -> float:
    """The heading of a quaternion message [rad]."""
    return math.atan2(2 * (q.w * q.z + q.x * q.y), 1 - 2 * (q.y * q.y + q.z * q.z))


def _clock(message: Clock) -> float:
    return round(message.clock.sec + message.clock.nanosec * 1e-9, 3)


def _joints(message: JointState) -> dict[str, float]:
    return dict(zip(message.name, rounded(*message.position), strict=False))


def _odometry(message: Odometry) -> list[float]:
    p, q = message.pose.pose.position, message.pose.pose.orientation
    return rounded(p.x, p.y, p.z, q.x, q.y, q.z, q.w)


def _footsteps(message: FootstepPlan) -> dict[str, Any]:
    steps = [
        [s.leg, *rounded(s.position.x, s.position.y, s.position.z, yaw_of(s.orientation)), s.index]
        for s in message.steps
    ]
    goal = message.goal
    return {
        "steps": steps,
        "goal": rounded(goal.position.x, goal.position.y, yaw_of(goal.orientation)) if steps else None,
    }


def _gait(message: GaitState) -> dict[str, Any]:
    mode = _constant(GaitState, "MODE_", message.mode)
    return {"mode": mode, "reason": message.reason, "next": message.footstep_index}


def _balance(message: BalanceState) -> dict[str, Any]:
    capture, zmp = message.capture_point, message.zero_moment_point
    return {
        "capture": rounded(capture.x, capture.y),
        "zmp": rounded(zmp.x, zmp.y),
        "support": [rounded(point.x, point.y) for point in message.support.points],
    }


def _battery(message: BatteryStatus) -> dict[str, Any]:
    level = _constant(BatteryStatus, "LEVEL_", message.level)
    return {"charge": _number(message.charge, 2), "level": level}


def _stop(message: EmergencyStop) -> dict[str, Any]:
    return {"active": message.active, "reason": message.reason}


def _task(message: TaskStatus) -> dict[str, Any]:
    return {
        "number": message.number,
        "waiting": message.waiting,
        "words": message.words,
        "state": _constant(TaskStatus, "STATE_", message.state),
        "message": message.message,
    }


def _walked(message: Any) -> dict[str, Any]:
    feedback = message.feedback
    return {
        "goal": _id(message.goal_id),
        "left": _number(feedback.distance_left, 2),
        "taken": feedback.steps_taken,
        "steps": feedback.steps_taken + feedback.steps_left,
        "replanning": feedback.replanning,
    }


def _danced(message: Any) -> dict[str, Any]:
    progress = _number(message.feedback.progress, 3)
    return {"goal": _id(message.goal_id), "progress": progress, "beat": message.feedback.beat}


def _id(goal_id: Any) -> str:
    return bytes(goal_id.uuid).hex()


def _status(message: GoalStatusArray) -> dict[str, str]:
    """The newest goal, and its state."""
    goals = sorted(message.status_list, key=lambda s: (s.goal_info.stamp.sec, s.goal_info.stamp.nanosec))
    if not goals:
        return {"goal": "", "state": ""}
    newest = goals[-1]
    return {"goal": _id(newest.goal_info.goal_id), "state": _STATES.get(newest.status, "unknown")}


def _path(message: Path) -> list[list[float]]:
    return [rounded(pose.pose.position.x, pose.pose.position.y) for pose in message.poses]


def _map(message: OccupancyGrid) -> dict[str, Any] | None:
    info = message.info
    if not 0 < info.width * info.height <= _MOST_CELLS:
        return None
    occupied = np.flatnonzero(np.asarray(message.data) >= _OCCUPIED)
    return {
        "width": info.width,
        "height": info.height,
        "cell": _number(info.resolution, 4),
        "origin": rounded(info.origin.position.x, info.origin.position.y),
        "occupied": occupied.tolist(),
    }


def _obstacles(message: MarkerArray) -> list[dict[str, Any]]:
    return [
        {
            "name": marker.ns,
            "shape": _SHAPES[marker.type],
            "at": rounded(marker.pose.position.x, marker.pose.position.y, marker.pose.position.z),
            "yaw": _number(yaw_of(marker.pose.orientation), 4),
            "size": rounded(marker.scale.x, marker.scale.y, marker.scale.z),
            "color": rounded(marker.color.r, marker.color.g, marker.color.b),
        }
        for marker in message.markers
        if marker.type in _SHAPES and marker.action not in _DELETE
    ]


def _found(message: DetectedObjectArray) -> list[list[Any]]:
    return [
        [o.label, o.region.x_offset, o.region.y_offset, o.region.width, o.region.height]
        for o in message.objects
    ]


def line_of(message: Log) -> tuple[str, str, str]:
    """A line of the log: level, name of the node, text."""
    level = "error" if message.level >= 40 else "warning" if message.level >= 30 else "info"
    return level, message.name, message.msg


def _constant(message: Any, prefix: str, value: int) -> str:
    names = (name for name in dir(message) if name.startswith(prefix) and getattr(message, name) == value)
    return next(names, f"{prefix}{value}").removeprefix(prefix).replace("_", " ").lower()


READINGS: Mapping[str, Reading] = {
    "/clock": Reading(Clock, "time", _clock),
    "/joint_states": Reading(JointState, "joints", _joints),
    "/odom": Reading(Odometry, "base", _odometry),
    "/footsteps/upcoming": Reading(FootstepPlan, "footsteps", _footsteps, latched=True),
    "/gait_state": Reading(GaitState, "gait", _gait, latched=True),
    "/whole_body_controller/balance": Reading(BalanceState, "balance", _balance),
    "/battery": Reading(BatteryStatus, "battery", _battery, latched=True),
    "/emergency_stop": Reading(EmergencyStop, "stop", _stop, latched=True),
    "/high_level_task_manager/task": Reading(TaskStatus, "task", _task, latched=True),
    "/robot_description": Reading(String, "robot", lambda message: message.data, latched=True),
    "/walk_to/_action/feedback": Reading(WalkTo.Impl.FeedbackMessage, "walk feedback", _walked),
    "/walk_to/_action/status": Reading(GoalStatusArray, "walk", _status, latched=True),
    "/perform_dance/_action/feedback": Reading(PerformDance.Impl.FeedbackMessage, "dance feedback", _danced),
    "/perform_dance/_action/status": Reading(GoalStatusArray, "dance", _status, latched=True),
    "/plan": Reading(Path, "path", _path, latched=True),
    "/map": Reading(OccupancyGrid, "map", _map, latched=True),
    "/humanoid_simulator/obstacles": Reading(MarkerArray, "obstacles", _obstacles, latched=True),
    "/face_detection/detections": Reading(DetectedObjectArray, "found", _found),
}
"""The topics that the page shows more of than their rates."""
