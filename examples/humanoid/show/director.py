"""A node that plays a scenario: it requests walks and dances, pushes and stops the robot, and keeps score."""

from __future__ import annotations

import hashlib
import math
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

from action_msgs.msg import GoalStatus
from geometry_msgs.msg import Vector3, Wrench, WrenchStamped
from humanoid_interfaces.action import PerformDance, WalkTo
from humanoid_interfaces.msg import FootstepPlan, GaitState, Stance
from nav_msgs.msg import Odometry
from rclpy.action import ActionClient
from rclpy.action.client import ClientGoalHandle
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.clock import Clock
from rclpy.clock_type import ClockType
from rclpy.node import Node
from rclpy.parameter import Parameter
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy
from rclpy.serialization import serialize_message
from rclpy.task import Future
from std_srvs.srv import SetBool

from ..data import SECOND, Footstep, Mode
from ..data import FootstepPlan as Plan
from ..ros import messages
from ..spatial import Array

_LATEST = QoSProfile(depth=1, reliability=ReliabilityPolicy.BEST_EFFORT)
_LATCHED = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
_POLL = 0.02  # s of real time between checks for a server
_BEGIN = 1.0  # s of simulated time
_SILENCE = 2.0  # s of simulated time without an answer or feedback after which a server counts as gone
_LOOK = 0.2  # s of simulated time between checks for that
_LYING = 0.45  # m of base_link above the floor
_MOVED = 0.02  # m: a larger motion is not swaying
_WALKER, _DANCER = "navigation_action_server", "dance_action_server"
PUSH_TIME = 0.1  # s for which the simulator pushes

Say = Callable[[str], None]


class ScenarioError(RuntimeError):
    """A scenario cannot continue; the text says why."""


@dataclass(slots=True)
class Score:
    """The results as messages report them; lengths in metres, times in simulated seconds."""

    steps: int = 0
    distance: float = 0.0
    falls: int = 0
    foot_errors: list[float] = field(default_factory=list)
    goal_errors: list[float] = field(default_factory=list)
    dances: int = 0
    pushes: int = 0
    stop_times: list[float] = field(default_factory=list)

    @property
    def foot_error(self) -> float:
        """Root mean square of the distances between the feet's landings and their planned places."""
        errors = self.foot_errors
        return math.sqrt(sum(e * e for e in errors) / len(errors)) if errors else 0.0


class Director(Node):
    """Plays the part of a user of the robot; `say` is called with what happens."""

    def __init__(self, say: Say) -> None:
        super().__init__("director", parameter_overrides=[Parameter("use_sim_time", value=True)])
        self.score = Score()
        self.mode = Mode.UNKNOWN
        self.fallen = False  # according to the controller, or to where it really is
        self.walk_feedback = WalkTo.Feedback()
        self._heard = 0.0  # when a server last sent feedback or received a request
        self._say = say
        self._group = ReentrantCallbackGroup()
        self._walk = ActionClient(self, WalkTo, "/walk_to", callback_group=self._group)
        self._dance = ActionClient(self, PerformDance, "/perform_dance", callback_group=self._group)
        self._stop = self.create_client(SetBool, "/emergency_stop/set", callback_group=self._group)
        self._push = self.create_publisher(WrenchStamped, "/humanoid_simulator/push", 10)
        self._steps = self.create_publisher(FootstepPlan, "/footsteps/plan", 1)
        self._planned: dict[int, Footstep] = {}
        self._truth: tuple[Array, Array] | None = None
        self._at: Array | None = None
        self._base: Array | None = None
        self._index: int | None = None
        self._changed = Future()  # for the next change of what the controller does
        self._digest = hashlib.sha256()
        topics: tuple[tuple[type[Any], str, QoSProfile, Callable[[Any], None]], ...] = (
            (GaitState, "/gait_state", _LATCHED, self._on_gait),
            (FootstepPlan, "/footsteps/upcoming", _LATCHED, self._on_plan),
            (Stance, "/humanoid_simulator/ground_truth/stance", _LATEST, self._on_truth),
            (Odometry, "/humanoid_simulator/ground_truth/odom", _LATEST, self._on_odometry),
        )
        for kind, topic, qos, heard in topics:
            self.create_subscription(kind, topic, heard, qos, callback_group=self._group)

    @property
    def state_hash(self) -> str:
        """SHA-256 over the true poses of the robot at every moment: equal runs have equal hashes."""
        return self._digest.hexdigest()

    @property
    def now(self) -> float:
        """Simulated seconds."""
        return float(self.get_clock().now().nanoseconds) / SECOND

    @property
    def base(self) -> Array:
        """The true position (3,) of base_link [m]. Raises ScenarioError if it is not published."""
        if self._base is None:
            raise ScenarioError("the simulator does not publish where the robot is: set its ground_truth")
        return self._base

    def distance_to(self, x: float, y: float) -> float:
        """True distance of the middle between the soles from a point [m]; infinite if not published."""
        if self._truth is None:
            return math.inf
        left, right = self._truth
        return math.hypot((left[0] + right[0]) / 2 - x, (left[1] + right[1]) / 2 - y)

    async def ready(self) -> None:
        """Wait until the robot stands and all servers are there."""
        for client in (self._walk, self._dance):
            while not client.server_is_ready():
                await self._sleep(_POLL, ClockType.STEADY_TIME)
        while not self._stop.service_is_ready() or self.mode is not Mode.STANDING:
            await self._sleep(_POLL, ClockType.STEADY_TIME)
        # Start at a fixed moment of simulated time, so that a scenario does not depend on the wall clock.
        if self.now < _BEGIN:
            await self.wait(_BEGIN - self.now)

    async def wait(self, seconds: float) -> None:
        """Wait for simulated seconds to pass."""
        await self._sleep(seconds, ClockType.ROS_TIME)

    async def begin_walk(self, x: float, y: float, yaw: float) -> ClientGoalHandle:
        """Request a walk to a pose. Raises ScenarioError if it is rejected."""
        self._say(f"walk to ({x:g} m, {y:g} m, {math.degrees(yaw):.0f} deg)")
        target = messages.stamped(self.get_clock().now().nanoseconds, messages.planar_pose(x, y, yaw))
        sending = self._walk.send_goal_async(WalkTo.Goal(target=target), feedback_callback=self._on_feedback)
        handle: ClientGoalHandle = await self._answer(sending, _WALKER)
        if not handle.accepted:
            raise ScenarioError(f"the walk to ({x:g}, {y:g}) was rejected")
        return handle

    async def walk(self, x: float, y: float, yaw: float) -> None:
        """Walk to a pose. Raises ScenarioError if it is not reached."""
        handle = await self.begin_walk(x, y, yaw)
        answer = await self.end_of(handle)
        if answer.status != GoalStatus.STATUS_SUCCEEDED:
            raise ScenarioError(f"the walk ended before its goal: {answer.result.message}")
        error = self.distance_to(x, y)
        if math.isfinite(error):
            self.score.goal_errors.append(error)
        self._say(f"arrived with {answer.result.steps} steps, {error * 1e3:.0f} mm off")

    async def end_of(self, walk: ClientGoalHandle) -> Any:
        """Wait for a walk to end: status and result. Raises ScenarioError when its server falls silent."""
        return await self._answer(walk.get_result_async(), _WALKER)

    def send(self, plan: Plan) -> None:
        """Send footsteps to the gait planner."""
        self._steps.publish(messages.footstep_plan(plan, self.get_clock().now().nanoseconds))

    async def taken(self, plan: Plan) -> None:
        """Wait until footsteps that were sent are taken. Raises ScenarioError if the robot falls instead."""
        while self._index is None or self._index <= plan.steps[-1].index:
            await self._change()
        await self.until(Mode.STANDING)

    async def cancel(self, handle: ClientGoalHandle) -> None:
        """Cancel a walk and wait until the robot stands."""
        begun = self.now
        await self._answer(handle.cancel_goal_async(), _WALKER)
        await self.end_of(handle)
        self.score.stop_times.append(self.now - begun)
        self._say(f"cancelled: stands after {self.now - begun:.2f} s")

    async def dance(self, name: str, beats: int = 0) -> None:
        """Dance. Raises ScenarioError if the dance does not reach its end."""
        await self.until(Mode.STANDING)
        self._say(f"dance {name}")
        goal = PerformDance.Goal(dance=name, beats=beats)
        sending = self._dance.send_goal_async(goal, feedback_callback=self._on_dance_feedback)
        handle: ClientGoalHandle = await self._answer(sending, _DANCER)
        if not handle.accepted:
            raise ScenarioError(f"the dance '{name}' was rejected")
        answer: Any = await self._answer(handle.get_result_async(), _DANCER)
        if not answer.result.completed:
            raise ScenarioError(f"the dance ended early: {answer.result.message}")
        self.score.dances += 1
        self._say(f"danced {answer.result.beats} beats")

    def push(self, impulse: float, direction: float) -> None:
        """Push the torso: impulse [N s] and direction, seen from above [rad]."""
        force = impulse / PUSH_TIME
        x, y = force * math.cos(direction), force * math.sin(direction)
        self._push.publish(WrenchStamped(wrench=Wrench(force=Vector3(x=x, y=y))))
        self.score.pushes += 1
        self._say(f"pushed with {impulse:g} N s towards {math.degrees(direction):.0f} deg")

    async def emergency_stop(self, active: bool) -> None:
        """Press the button, or release it."""
        answer: Any = await self._answer(
            self._stop.call_async(SetBool.Request(data=active)), "emergency_stop"
        )
        self._say(
            "emergency stop" if active else f"released: {answer.message or 'the robot accepts goals again'}"
        )

    async def until(self, mode: Mode) -> None:
        """Wait for a mode of the controller. Raises ScenarioError if the robot falls instead."""
        while self.mode is not mode:
            await self._change()

    async def _answer(self, future: Future, server: str) -> Any:
        """Wait for a server's answer. Raises ScenarioError when it falls silent: actions have no timeout."""
        self._heard = self.now

        def look() -> None:
            if not future.done() and self.now - self._heard > _SILENCE:
                future.set_exception(ScenarioError(f"{server} has been silent for {_SILENCE:g} s"))

        timer = self.create_timer(_LOOK, look, callback_group=self._group)
        try:
            return await future
        finally:
            self.destroy_timer(timer)

    async def _change(self) -> None:
        """Wait until the controller does something else, or is at another step."""
        if self.fallen:
            raise ScenarioError("the robot has fallen")
        if self._changed.done():
            self._changed = Future()
        await self._changed

    async def _sleep(self, seconds: float, clock: ClockType) -> None:
        over = Future()
        on = Clock(clock_type=clock) if clock is not ClockType.ROS_TIME else self.get_clock()

        def end() -> None:
            if not over.done():
                over.set_result(None)

        timer = self.create_timer(seconds, end, clock=on, callback_group=self._group)
        await over
        self.destroy_timer(timer)

    def _on_gait(self, message: GaitState) -> None:
        mode = Mode(message.mode)
        fallen = mode is Mode.FALLEN or self._lies()
        if fallen and not self.fallen:
            self.score.falls += 1
            self._say("fallen")
        before, index = self._index, message.footstep_index
        same = (self.mode, self.fallen, before) == (mode, fallen, index)
        self.mode, self.fallen, self._index = mode, fallen, index
        if not same and not self._changed.done():
            self._changed.set_result(None)
        if before is not None and index == before + 1:
            self.score.steps += 1
            landed = self._planned.get(before)
            if landed is not None and self._truth is not None:
                self.score.foot_errors.append(math.dist(landed.pose[:2], self._truth[landed.leg.side][:2]))

    def _lies(self) -> bool:
        return self._base is not None and bool(self._base[2] < _LYING)

    def _on_plan(self, message: FootstepPlan) -> None:
        self._planned.update((step.index, step) for step in messages.read_footstep_plan(message).steps)

    def _on_truth(self, message: Stance) -> None:
        self._truth = messages.read_stance(message).feet

    def _on_odometry(self, message: Odometry) -> None:
        self._digest.update(serialize_message(message))
        self._base = messages.numbers(message.pose.pose.position)
        at = self._base[:2]
        moved = 0.0 if self._at is None else math.dist(at, self._at)
        if self._at is None or moved > _MOVED:
            self._at = at
            self.score.distance += moved if self.mode in (Mode.WALKING, Mode.STOPPING) else 0.0

    def _on_feedback(self, message: Any) -> None:
        self._heard = self.now
        self.walk_feedback = message.feedback

    def _on_dance_feedback(self, _: Any) -> None:
        self._heard = self.now
