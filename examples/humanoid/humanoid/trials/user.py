"""A user of the robot, who asks for walks and dances, pushes and stops it: for trials and tests."""

from __future__ import annotations

import math
from typing import Any

from action_msgs.msg import GoalStatus
from geometry_msgs.msg import WrenchStamped
from humanoid_interfaces.action import PerformDance, WalkTo
from humanoid_interfaces.msg import FootstepPlan, GaitState
from rclpy.action import ActionClient
from rclpy.action.client import ClientGoalHandle
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.clock import Clock
from rclpy.clock_type import ClockType
from rclpy.task import Future
from std_srvs.srv import SetBool

from ..data import FootstepPlan as Plan
from ..data import Mode
from ..ros import messages
from ..show.audience import push_of
from ..show.director import Director, Say
from ..spatial import Array

_POLL = 0.02  # s of real time between checks for a server
_BEGIN = 1.0  # s of simulated time
_SILENCE = 2.0  # s of simulated time without an answer or feedback after which a server counts as gone
_LOOK = 0.2  # s of simulated time between checks for that
_WALKER, _DANCER = "navigation_action_server", "dance_action_server"


class ScenarioError(RuntimeError):
    """A trial cannot continue; the text says why."""


class User(Director):
    """Asks for one thing after the other, and keeps score; `say` is called with what happens."""

    def __init__(self, say: Say) -> None:
        super().__init__(say)
        self.walk_feedback = WalkTo.Feedback()
        self._heard = 0.0  # when a server last sent feedback or received a request
        self._group = ReentrantCallbackGroup()
        self._walk = ActionClient(self, WalkTo, "/walk_to", callback_group=self._group)
        self._dance = ActionClient(self, PerformDance, "/perform_dance", callback_group=self._group)
        self._stop = self.create_client(SetBool, "/emergency_stop/set", callback_group=self._group)
        self._steps = self.create_publisher(FootstepPlan, "/footsteps/plan", 1)
        self._changed = Future()  # for the next change of what the controller does
        self._seen: tuple[object, ...] = ()
        self._push = self.create_publisher(WrenchStamped, "/humanoid_simulator/push", 10)

    @property
    def place(self) -> Array:
        """The true position (3,) of base_link [m]. Raises ScenarioError if it is not published."""
        if self.base is None:
            raise ScenarioError("the simulator does not publish where the robot is: set its ground_truth")
        return self.base

    async def ready(self) -> None:
        """Wait until the robot stands and all servers are there."""
        for client in (self._walk, self._dance):
            while not client.server_is_ready():
                await self._sleep(_POLL, ClockType.STEADY_TIME)
        while not self._stop.service_is_ready() or self.mode is not Mode.STANDING:
            await self._sleep(_POLL, ClockType.STEADY_TIME)
        # Start at a fixed moment of simulated time, so that a trial does not depend on the wall clock.
        if self.now < _BEGIN:
            await self.wait(_BEGIN - self.now)

    async def wait(self, seconds: float) -> None:
        """Wait for simulated seconds to pass."""
        await self._sleep(seconds, ClockType.ROS_TIME)

    async def begin_walk(self, x: float, y: float, yaw: float) -> ClientGoalHandle:
        """Request a walk to a pose. Raises ScenarioError if it is rejected."""
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

    async def dance(self, name: str, beats: int = 0) -> None:
        """Dance. Raises ScenarioError if the dance does not reach its end."""
        await self.until(Mode.STANDING)
        goal = PerformDance.Goal(dance=name, beats=beats)
        sending = self._dance.send_goal_async(goal, feedback_callback=self._on_dance_feedback)
        handle: ClientGoalHandle = await self._answer(sending, _DANCER)
        if not handle.accepted:
            raise ScenarioError(f"the dance '{name}' was rejected")
        answer: Any = await self._answer(handle.get_result_async(), _DANCER)
        if not answer.result.completed:
            raise ScenarioError(f"the dance ended early: {answer.result.message}")
        self.score.dances += 1

    def push(self, momentum: float, direction: float) -> None:
        """Push the torso: momentum [N s] and direction, seen from above [rad]."""
        self._push.publish(push_of(momentum, math.degrees(direction)))

    async def emergency_stop(self, active: bool) -> None:
        """Press the button, or release it."""
        await self._answer(self._stop.call_async(SetBool.Request(data=active)), "emergency_stop")

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
        super()._on_gait(message)
        seen = (self.mode, self.fallen, self._index)
        if seen != self._seen and not self._changed.done():
            self._changed.set_result(None)
        self._seen = seen

    def _on_feedback(self, message: Any) -> None:
        self._heard = self.now
        self.walk_feedback = message.feedback

    def _on_dance_feedback(self, _: Any) -> None:
        self._heard = self.now
