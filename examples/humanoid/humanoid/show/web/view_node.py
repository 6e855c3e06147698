"""A node that subscribes to everything and shows it on the page."""

from __future__ import annotations

import math
import threading
import time
from collections import deque
from collections.abc import Callable
from functools import partial
from importlib import import_module
from typing import Any

from action_msgs.msg import GoalStatus, GoalStatusArray
from action_msgs.srv import CancelGoal
from humanoid_interfaces.action import PerformDance, WalkTo
from humanoid_interfaces.msg import BatteryStatus, EmergencyStop, FootstepPlan, GaitState
from ifgen.graph.svg import svg
from ifgen.observing.running_graph import FRAMEWORK_TOPICS, hidden, of_running
from nav_msgs.msg import Odometry
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.clock import Clock
from rclpy.clock_type import ClockType
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy, qos_profile_action_status_default
from rosgraph_msgs.msg import Clock as ClockMessage
from sensor_msgs.msg import JointState
from std_msgs.msg import String
from std_srvs.srv import SetBool

from .server import PageServer

_LATEST = QoSProfile(depth=1, reliability=ReliabilityPolicy.BEST_EFFORT)
_LATCHED = QoSProfile(
    depth=1, reliability=ReliabilityPolicy.RELIABLE, durability=DurabilityPolicy.TRANSIENT_LOCAL
)
_PERIOD = 0.04  # s between states on the page
_PICTURE = "sensor_msgs/msg/Image"
_LOOK = 1.0  # s between checks of the graph
_STATES = {
    GoalStatus.STATUS_ACCEPTED: "accepted",
    GoalStatus.STATUS_EXECUTING: "executing",
    GoalStatus.STATUS_CANCELING: "canceling",
    GoalStatus.STATUS_SUCCEEDED: "succeeded",
    GoalStatus.STATUS_CANCELED: "canceled",
    GoalStatus.STATUS_ABORTED: "aborted",
}


class WebView(Node):
    """Shows robot, footsteps, goals, topics and nodes on a page on 127.0.0.1, with two buttons.

    With `port` 0 the system chooses one; `page.url` is the address. It changes nothing unless a button is
    pressed.
    """

    def __init__(self, port: int = 0) -> None:
        super().__init__("web_view")
        self._state: dict[str, Any] = {"joints": {}, "steps": [], "goals": {}, "topics": []}
        self._urdf = ""
        self._drawing = svg(of_running(self))
        self._counts: dict[str, _Rate] = {}
        self._types: dict[str, str] = {}
        self._pressed: deque[Callable[[], Any]] = deque()
        self._guard = threading.Lock()
        self._real_time = _Speed()
        self._group = ReentrantCallbackGroup()
        self._cancel = {
            name: self.create_client(CancelGoal, f"{name}/_action/cancel_goal")
            for name in ("/walk_to", "/perform_dance")
        }
        self._stop = self.create_client(SetBool, "/emergency_stop/set")
        topics: tuple[tuple[type[Any], str, QoSProfile, Callable[[Any], None]], ...] = (
            (ClockMessage, "/clock", _LATEST, self._on_clock),
            (JointState, "/joint_states", _LATEST, self._on_joints),
            (Odometry, "/odom", _LATEST, self._on_odometry),
            (FootstepPlan, "/footsteps/upcoming", _LATCHED, self._on_footsteps),
            (GaitState, "/gait_state", _LATCHED, self._on_gait),
            (BatteryStatus, "/battery", _LATCHED, self._on_battery),
            (EmergencyStop, "/emergency_stop", _LATCHED, self._on_stop),
            (String, "/robot_description", _LATCHED, self._on_description),
        )
        for kind, topic, qos, heard in topics:
            self.create_subscription(kind, topic, heard, qos)
        for name, action in (("/walk_to", WalkTo), ("/perform_dance", PerformDance)):
            feedback = action.Impl.FeedbackMessage
            self.create_subscription(
                feedback, f"{name}/_action/feedback", partial(self._on_feedback, name), 10
            )
            self.create_subscription(
                GoalStatusArray,
                f"{name}/_action/status",
                partial(self._on_status, name),
                qos_profile_action_status_default,
            )
        wall = Clock(clock_type=ClockType.STEADY_TIME)
        self.create_timer(_PERIOD, self._show, clock=wall)
        self.create_timer(_LOOK, self._look, clock=wall)
        self.page = PageServer(
            port,
            {"/robot.urdf": lambda: ("", self._urdf), "/graph.svg": lambda: (".svg", self._drawing)},
            {
                "/cancel": partial(self._press, self._cancel_goals),
                "/stop": partial(self._press, partial(self._set_stop, True)),
                "/release": partial(self._press, partial(self._set_stop, False)),
            },
        )

    def destroy_node(self) -> None:
        """Close the page too."""
        self.page.close()
        super().destroy_node()

    def _on_clock(self, message: ClockMessage) -> None:
        self._state["time"] = message.clock.sec + message.clock.nanosec * 1e-9

    def _on_joints(self, message: JointState) -> None:
        self._state["joints"] = dict(zip(message.name, _rounded(*message.position), strict=False))

    def _on_odometry(self, message: Odometry) -> None:
        p, q = message.pose.pose.position, message.pose.pose.orientation
        self._state["base"] = _rounded(p.x, p.y, p.z, q.x, q.y, q.z, q.w)

    def _on_footsteps(self, message: FootstepPlan) -> None:
        steps = message.steps
        self._state["steps"] = [
            [s.leg, *_rounded(s.position.x, s.position.y, s.position.z, _yaw(s.orientation))] for s in steps
        ]
        goal = message.goal
        at = _rounded(goal.position.x, goal.position.y, _yaw(goal.orientation))
        self._state["goal"] = at if steps else None

    def _on_gait(self, message: GaitState) -> None:
        self._state["mode"] = _constant(GaitState, "MODE_", message.mode)
        self._state["reason"] = message.reason

    def _on_battery(self, message: BatteryStatus) -> None:
        level = _constant(BatteryStatus, "LEVEL_", message.level)
        self._state["battery"] = {"charge": _rounded(message.charge)[0], "level": level}

    def _on_stop(self, message: EmergencyStop) -> None:
        self._state["stop"] = {"active": message.active, "reason": message.reason}

    def _on_description(self, message: String) -> None:
        self._urdf = message.data
        self._state["robot"] = True

    def _on_feedback(self, action: str, message: Any) -> None:
        feedback = message.feedback
        goal = self._state["goals"].setdefault(action, {})
        if isinstance(feedback, WalkTo.Feedback):
            goal.update(
                left=_rounded(feedback.distance_left)[0],
                taken=feedback.steps_taken,
                steps=feedback.steps_taken + feedback.steps_left,
                replanning=feedback.replanning,
            )
        else:
            goal.update(progress=_rounded(feedback.progress)[0], beat=feedback.beat)

    def _on_status(self, action: str, message: GoalStatusArray) -> None:
        if message.status_list:
            newest = max(
                message.status_list, key=lambda s: (s.goal_info.stamp.sec, s.goal_info.stamp.nanosec)
            )
            goal = self._state["goals"].setdefault(action, {})
            goal["state"] = _STATES.get(newest.status, "unknown")

    def _press(self, action: Callable[[], Any]) -> None:
        """Queue a button's function: the server's threads call this, and the node runs it next."""
        with self._guard:
            self._pressed.append(action)

    def _cancel_goals(self) -> None:
        for client in self._cancel.values():
            if client.service_is_ready():
                client.call_async(CancelGoal.Request())  # neither an id nor a time: every goal

    def _set_stop(self, active: bool) -> None:
        if self._stop.service_is_ready():
            self._stop.call_async(SetBool.Request(data=active))

    def _show(self) -> None:
        with self._guard:
            pressed, self._pressed = self._pressed, deque()
        for action in pressed:
            action()
        self._state["speed"] = self._real_time.update(self._state.get("time", 0.0))
        self.page.show(self._state)

    def _look(self) -> None:
        """Check what is new in the graph, and measure the rates of all topics."""
        for topic, types in self.get_topic_names_and_types():
            # Images are drawn only for subscribers, and would cost more than everything else.
            if topic in FRAMEWORK_TOPICS or hidden(topic) or len(types) != 1 or types[0] == _PICTURE:
                continue
            if topic not in self._counts:
                self._types[topic] = types[0]
                rate = self._counts[topic] = _Rate()
                self.create_subscription(_message_class(types[0]), topic, rate.count, _LATEST, raw=True)
        self._state["topics"] = [
            [topic, self._types[topic], round(rate.per_second(), 1)]
            for topic, rate in sorted(self._counts.items())
        ]
        self._drawing = svg(of_running(self))


class _Rate:
    """Counts messages."""

    def __init__(self) -> None:
        self._messages = 0
        self._since = time.monotonic()

    def count(self, _: bytes) -> None:
        self._messages += 1

    def per_second(self) -> float:
        """The rate since the last call, in messages per second of real time."""
        now = time.monotonic()
        rate = self._messages / max(now - self._since, 1e-6)
        self._messages, self._since = 0, now
        return rate


class _Speed:
    """The speed of simulated time over the last two seconds."""

    def __init__(self) -> None:
        self._seen: deque[tuple[float, float]] = deque(maxlen=int(2 / _PERIOD))

    def update(self, simulated: float) -> float:
        """The real-time factor."""
        self._seen.append((time.monotonic(), simulated))
        (wall, then), (now, last) = self._seen[0], self._seen[-1]
        return round((last - then) / (now - wall), 2) if now > wall else 0.0


def _message_class(type_name: str) -> Any:
    package, folder, name = type_name.split("/")
    return getattr(import_module(f"{package}.{folder}"), name)


def _constant(message: Any, prefix: str, value: int) -> str:
    names = (name for name in dir(message) if name.startswith(prefix) and getattr(message, name) == value)
    return next(names, f"{prefix}{value}").removeprefix(prefix).replace("_", " ").lower()


def _yaw(q: Any) -> float:
    return math.atan2(2 * (q.w * q.z + q.x * q.y), 1 - 2 * (q.y * q.y + q.z * q.z))


def _rounded(*values: float) -> list[float]:
    """Round to a tenth of a millimetre; JSON has no value for numbers that are not finite."""
    return [round(value, 4) if math.isfinite(value) else 0.0 for value in values]
