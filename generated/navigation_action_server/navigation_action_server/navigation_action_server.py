"""The node navigation_action_server: walks to a goal; a newer goal takes over."""

from __future__ import annotations

import math
from typing import Any

from humanoid import data
from humanoid.control.pace import Pace
from humanoid.planning.following import blocked_step
from humanoid.planning.footsteps import PlanResult, PlanStatus, StepLimits, fitted, shorter
from humanoid.planning.navigation import Navigation
from humanoid.planning.walks import GoalTolerance, Outcome, WalkResult, WalkTick, halted
from humanoid.robot.body import load_body
from humanoid.robot.scene import GROUND
from humanoid.ros import messages
from humanoid.ros.diagnostics import Health
from humanoid.ros.grids import read_occupancy_grid
from humanoid.ros.news import News
from humanoid.ros.running import run
from humanoid_interfaces.action import WalkTo
from humanoid_interfaces.msg import EmergencyStop, FootstepPlan, GaitState
from humanoid_interfaces.srv import FollowPath, PlanPath
from nav_msgs.msg import OccupancyGrid
from rclpy.action import CancelResponse, GoalResponse
from rclpy.action.server import ServerGoalHandle
from rclpy.task import Future

from navigation_action_server._navigation_action_server_base import NavigationActionServerBase
from navigation_action_server._navigation_action_server_parameters import ParametersError

_FRAMES = ("", "odom")
_SILENCE = 500_000_000  # ns of silence of the controller after which a goal is given up
_BUSY = "I am already walking to another goal, and second_goal says reject"
_PLANNED = {PlanStatus.PLANNED, PlanStatus.ALREADY_THERE}
_BLOCKED = {PlanPath.Response.STATUS_BLOCKED, PlanPath.Response.STATUS_GOAL_OCCUPIED}


class NavigationActionServer(NavigationActionServerBase):
    """Asks the planners about a goal before it accepts it, and ends the goal by the gait state."""

    def __init__(self, **options: Any) -> None:
        super().__init__(**options)
        body = load_body(self.parameters.model_file, self.parameters.joint_map)
        self._limits = fitted(StepLimits().at_pace(Pace(self.parameters.walking_speed)), body)
        self._gait: data.GaitState | None = None
        self._news = News(self)  # gait states
        self._stop = data.EmergencyStop(active=False)
        self._walk: _Walk | None = None
        self._plan: data.FootstepPlan | None = None
        self._sent = FootstepPlan()  # the same state as the original message
        self._tick: WalkTick | None = None
        self._health = Health("navigation_action_server: inputs", self.get_logger(), "readings", "maps")

    async def on_gait_state(self, message: GaitState) -> None:
        """Check how far the walk has come, and plan again or end it."""
        gait = self._health.read("readings", "/gait_state", messages.read_gait_state, message)
        if gait is None:
            return
        self._gait = gait
        self._news.come()
        walk = self._walk
        if walk is None:
            return
        if walk.handle.is_cancel_requested:
            walk.navigation.cancel()
        self._tick = tick = walk.navigation.update(gait)
        if tick.plan is not None:
            walk.stopping = False  # it has held, or waited for a way, and goes on
            self._send(tick.plan)
        elif tick.stop and not walk.stopping:
            walk.stopping = True
            self._halt()
        if tick.result is not None:
            self._end(walk, tick.result)

    async def on_map(self, message: OccupancyGrid) -> None:
        """Plan anew if something is in the way."""
        grid = self._health.read("maps", "/map", read_occupancy_grid, message)
        if grid is None or self._walk is None or self._gait is None:
            return
        navigation = self._walk.navigation
        if blocked_step(navigation.steps_ahead, grid.occupied(), self._gait.stance.centre, self._limits):
            navigation.replan()

    async def on_emergency_stop(self, message: EmergencyStop) -> None:
        """Remember whether goals can be accepted; the controller stops on its own and reports that."""
        self._stop = messages.read_emergency_stop(message)

    async def accept_walk_to(self, goal: WalkTo.Goal) -> GoalResponse:
        """Accept goals that the robot can reach; the log says why another is rejected."""
        problem = await self._problem(goal)
        if problem:
            self.get_logger().warning(f"goal rejected: {problem}")
            return GoalResponse.REJECT
        return GoalResponse.ACCEPT

    async def cancel_walk_to(self, goal_handle: ServerGoalHandle) -> CancelResponse:
        """Any goal may be cancelled."""
        return CancelResponse.ACCEPT

    async def execute_walk_to(self, goal_handle: ServerGoalHandle) -> WalkTo.Result:
        """Walk until the goal is reached, given up, cancelled or taken over."""
        assert self._gait is not None, "accepted without a gait state"
        goal: WalkTo.Goal = goal_handle.request
        if self._walk is not None:
            if self.parameters.second_goal == "reject":  # both were checked before either began
                return self._refuse(goal_handle, _BUSY)
            before = self._walk
            before.navigation.preempt()
            result = before.navigation.update(self._gait).result
            assert result is not None, "a preempted goal ends at once"
            self._end(before, result)
        x, y, yaw = (float(part) for part in messages.planar(goal.target.pose))
        values = self.parameters
        navigation = Navigation(
            (x, y, yaw),
            self._gait,
            self._plan,
            limits=shorter(self._limits, goal.max_step_length),
            ground=GROUND,
            tolerance=GoalTolerance(
                goal.position_tolerance or values.tolerance.position,
                goal.yaw_tolerance or values.tolerance.yaw,
            ),
            replan_distance=values.replan_distance,
            planner=_Ways(self, (x, y, yaw), goal.max_step_length).plan,
            patience=values.patience,
            recovery_time=values.recovery_time,
        )
        if navigation.rejection:
            return self._refuse(goal_handle, navigation.rejection)
        walk = self._walk = _Walk(navigation, goal_handle)
        result = await walk.ended
        if result.outcome is Outcome.REACHED:
            goal_handle.succeed()
        elif result.outcome is Outcome.CANCELED:
            goal_handle.canceled()
        else:
            goal_handle.abort()
        return self._result(result)

    async def on_feedback_timer(self) -> None:
        """Send feedback to the client, and tell the gait planner that the plan is still valid."""
        if self._walk is None or self._tick is None or self._gait is None:
            return
        silent = int(self.get_clock().now().nanoseconds) - self._gait.stamp
        if silent > _SILENCE:
            text = f"whole_body_controller has been silent for {silent / data.SECOND:.2f} s"
            self.get_logger().warning(f"goal given up: {text}")
            self._halt()
            self._end(self._walk, self._walk.navigation.stopped(self._gait, text))
            return
        if self._sent.steps and not self._walk.stopping:
            self.publish_footsteps_plan(self._sent)
        told = self._tick.feedback
        pose = messages.stamped(self._gait.stamp, messages.planar_pose(*told.pose))
        self._walk.handle.publish_feedback(
            WalkTo.Feedback(
                pose=pose,
                distance_left=told.distance_left,
                replanning=told.replanning,
                steps_taken=max(told.steps_taken, 0),
                steps_left=told.steps_left,
            )
        )

    async def _problem(self, goal: WalkTo.Goal) -> str:
        """The reason why a goal cannot be accepted, or ""."""
        if self._stop.active or (self._gait is not None and halted(self._gait)):
            await self._news.next()
        if self._stop.active:
            return f"emergency stop: {self._stop.reason}"
        if self._gait is None:
            return "the controller has not reported yet where the feet are"
        if problem := halted(self._gait):
            return problem
        if self._walk is not None and self.parameters.second_goal == "reject":
            return _BUSY
        if goal.target.header.frame_id not in _FRAMES:
            return f"the goal is in '{goal.target.header.frame_id}'; I walk in odom"
        x, y, yaw = (float(part) for part in messages.planar(goal.target.pose))
        if not all(map(math.isfinite, (x, y, yaw))):
            return "the goal holds a number that is not finite"
        ways = _Ways(self, (x, y, yaw), goal.max_step_length)
        answer = await ways.ask(self._gait.stance, None, self._gait.footstep_index)
        return "" if answer.status in _PLANNED else answer.message

    def _send(self, plan: data.FootstepPlan) -> None:
        assert self._gait is not None
        self._plan = plan
        self._sent = messages.footstep_plan(plan, self._gait.stamp)
        self.publish_footsteps_plan(self._sent)

    def _halt(self) -> None:
        """Make the robot stop with its feet side by side."""
        assert self._gait is not None
        self.publish_footsteps_plan(FootstepPlan(header=messages.header(self._gait.stamp, "odom")))

    def _end(self, walk: _Walk, result: WalkResult) -> None:
        self._walk, self._sent = None, FootstepPlan()
        walk.ended.set_result(result)

    def _refuse(self, handle: ServerGoalHandle, why: str) -> WalkTo.Result:
        """End a goal that was accepted but can no longer be reached."""
        assert self._gait is not None
        self.get_logger().warning(f"goal aborted: {why}")
        handle.abort()
        outcome = Outcome.STOPPED if halted(self._gait) or why == _BUSY else Outcome.UNREACHABLE
        return self._result(WalkResult(outcome, why, self._gait.stance.centre, 0, 0.0))

    def _result(self, result: WalkResult) -> WalkTo.Result:
        stamp = 0 if self._gait is None else self._gait.stamp
        return WalkTo.Result(
            outcome=int(result.outcome),
            message=result.message[:255],
            pose=messages.stamped(stamp, messages.planar_pose(*result.pose)),
            steps=max(result.steps, 0),
            time=messages.duration_of(result.time),
        )


class _Ways:
    """Plans to one goal: a path from motion_planner, and the steps along it from footstep_planner."""

    def __init__(
        self, node: NavigationActionServer, goal: tuple[float, float, float], max_step_length: float
    ) -> None:
        self._node, self._goal, self._longest = node, goal, max_step_length
        self._answer: tuple[tuple[data.Leg | None, int], PlanResult] | None = None
        self._asks = False

    def plan(self, start: data.Stance, first_leg: data.Leg | None, first_index: int) -> PlanResult | None:
        """The plan from a step on, or None: then it is asked for, and will be there at a later call."""
        answer, self._answer = self._answer, None
        if answer is not None and answer[0] == (first_leg, first_index):
            return answer[1]
        if not self._asks and self._node.executor is not None:
            self._asks = True
            self._node.executor.create_task(self._keep(start, first_leg, first_index))
        return None

    async def _keep(self, start: data.Stance, first_leg: data.Leg | None, first_index: int) -> None:
        answer = await self.ask(start, first_leg, first_index)
        self._answer, self._asks = ((first_leg, first_index), answer), False

    async def ask(self, start: data.Stance, first_leg: data.Leg | None, first_index: int) -> PlanResult:
        """Ask both; a server that does not answer is a status UNKNOWN."""
        result = await self._ask_once(start, first_leg, first_index)
        if result.status is PlanStatus.BLOCKED:  # perhaps the map has changed between the two
            result = await self._ask_once(start, first_leg, first_index)
        return result

    async def _ask_once(self, start: data.Stance, first_leg: data.Leg | None, first_index: int) -> PlanResult:
        nothing = data.FootstepPlan(0, (), self._goal)
        now = int(self._node.get_clock().now().nanoseconds)
        timeout = self._node.parameters.service_timeout
        request = PlanPath.Request(
            start=messages.stamped(now, messages.planar_pose(*start.centre.tolist())),
            goal=messages.stamped(now, messages.planar_pose(*self._goal)),
        )
        try:
            way = await self._node.call_plan_path(request, timeout_sec=timeout)
            if way.status != PlanPath.Response.STATUS_PLANNED:
                blocked = way.status in _BLOCKED
                status = PlanStatus.BLOCKED if blocked else PlanStatus.INVALID_REQUEST
                return PlanResult(status, str(way.message), nothing)
            follow = FollowPath.Request(
                start=messages.stance(start, now),
                path=way.path,
                first_leg=int(first_leg or 0),
                first_index=first_index,
                max_step_length=self._longest,
            )
            steps = await self._node.call_follow_path(follow, timeout_sec=timeout)
        except TimeoutError as error:
            return PlanResult(PlanStatus.UNKNOWN, str(error), nothing)
        known = steps.status in list(PlanStatus)
        status = PlanStatus(steps.status) if known else PlanStatus.UNKNOWN
        try:
            return PlanResult(status, str(steps.message), messages.read_footstep_plan(steps.plan))
        except ValueError as error:
            return PlanResult(PlanStatus.UNKNOWN, f"/follow_path: {error}", nothing)


class _Walk:
    """A goal under way."""

    def __init__(self, navigation: Navigation, handle: ServerGoalHandle) -> None:
        self.navigation = navigation
        self.handle = handle
        self.ended = Future()
        self.stopping = False


def main(args: list[str] | None = None) -> None:
    """Run the node."""
    run(NavigationActionServer, args, ParametersError)


if __name__ == "__main__":
    main()
