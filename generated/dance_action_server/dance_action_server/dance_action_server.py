"""The node dance_action_server: dances on request."""

from __future__ import annotations

from typing import Any

from humanoid import data
from humanoid.planning.dance import Dance, DanceFeedback, problem
from humanoid.planning.walks import halted
from humanoid.robot.body import load_body
from humanoid.ros import messages
from humanoid.ros.diagnostics import Health
from humanoid.ros.latest import LatestJoints
from humanoid.ros.news import News
from humanoid.ros.running import run
from humanoid_interfaces.action import PerformDance
from humanoid_interfaces.msg import EmergencyStop, GaitState
from rclpy.action import CancelResponse, GoalResponse
from rclpy.action.server import ServerGoalHandle
from rclpy.task import Future
from sensor_msgs.msg import JointState

from dance_action_server._dance_action_server_base import DanceActionServerBase
from dance_action_server._dance_action_server_parameters import ParametersError

_FEEDBACK_EVERY = 10  # beats of the timer
_SILENCE = 500_000_000  # ns of silence of the controller after which a dance is given up


class DanceActionServer(DanceActionServerBase):
    """Performs one dance at a time; the robot stands before and after."""

    def __init__(self, **options: Any) -> None:
        super().__init__(**options)
        self._body = load_body(self.parameters.model_file, self.parameters.joint_map)
        self._joints = LatestJoints(self, self._body)
        self._gait: data.GaitState | None = None
        self._news = News(self)  # gait states
        self._stop = data.EmergencyStop(active=False)
        self._performance: _Performance | None = None
        self._health = Health("dance_action_server: inputs", self.get_logger(), "readings")

    async def on_joint_states(self, message: JointState) -> None:
        """Take the joint positions."""
        self._joints.put(message)

    async def on_gait_state(self, message: GaitState) -> None:
        """Take the state of the controller."""
        gait = self._health.read("readings", "/gait_state", messages.read_gait_state, message)
        if gait is None:
            return
        self._gait = gait
        self._news.come()

    async def on_emergency_stop(self, message: EmergencyStop) -> None:
        """Remember whether goals can be accepted; a dance ends when the controller reports the stop."""
        self._stop = messages.read_emergency_stop(message)

    async def accept_perform_dance(self, goal: PerformDance.Goal) -> GoalResponse:
        """Accept a known dance while the robot stands and does not dance; the log says why others are not."""
        if self._stop.active or (self._gait is not None and self._gait.mode is not data.Mode.STANDING):
            await self._news.next()
        why_not = problem(goal.dance, goal.tempo, self.parameters.dances, self._body)
        preempts = self._performance is not None and self.parameters.second_goal == "preempt"
        if self._performance is not None and not preempts:
            why_not = "I am dancing already, and second_goal says reject"
        elif self._stop.active:
            why_not = f"emergency stop: {self._stop.reason}"
        elif self._gait is None or self._joints.get() is None:
            why_not = "the controller has not reported its state yet"
        elif halt := halted(self._gait):
            why_not = halt
        elif self._gait.mode is not data.Mode.STANDING and not preempts:
            why_not = why_not or f"the robot is {self._gait.mode.name.lower()}; a dance begins from standing"
        if why_not:
            self.get_logger().warning(f"goal rejected: {why_not}")
            return GoalResponse.REJECT
        return GoalResponse.ACCEPT

    async def cancel_perform_dance(self, goal_handle: ServerGoalHandle) -> CancelResponse:
        """Any dance may be cancelled."""
        return CancelResponse.ACCEPT

    async def execute_perform_dance(self, goal_handle: ServerGoalHandle) -> PerformDance.Result:
        """Dance to the end, or until it is cancelled."""
        assert self._gait is not None, "accepted without a gait state"
        goal: PerformDance.Goal = goal_handle.request
        while self._performance is not None:  # the robot returns to standing first
            self._performance.preempted = True
            await self._performance.ended
        if halt := halted(self._gait):
            goal_handle.abort()
            return PerformDance.Result(message=halt[:255])
        tempo = goal.tempo or self.parameters.tempo
        dance = Dance(goal.dance, tempo, goal.beats, self._gait.stamp, self._body)
        performance = self._performance = _Performance(dance, goal_handle)
        result = await performance.ended
        if result.completed:
            goal_handle.succeed()
        elif goal_handle.is_cancel_requested:
            goal_handle.canceled()
        else:
            goal_handle.abort()
        return PerformDance.Result(
            completed=result.completed,
            message="a later goal took over" if performance.preempted else result.message[:255],
            steps=result.steps,
            beats=result.beats,
            time=messages.duration_of(result.time),
            joint_error=result.joint_error,
        )

    async def on_beat_timer(self) -> None:
        """Publish the next posture."""
        performance, gait = self._performance, self._gait
        if performance is None or gait is None or (joints := self._joints.get()) is None:
            return
        if silent := self._silence(gait):
            performance.ended.set_result(performance.dance.stopped(gait, silent))
            self._performance = None
            return
        if performance.handle.is_cancel_requested or performance.preempted:
            performance.dance.cancel()
        tick = performance.dance.update(gait.stamp, joints, gait)
        self.publish_posture(messages.posture(tick.posture, gait.stamp, self._body))
        if tick.plan is not None:
            self.publish_footsteps_plan(messages.footstep_plan(tick.plan, gait.stamp))
        performance.beats += 1
        if performance.beats % _FEEDBACK_EVERY == 0:
            performance.handle.publish_feedback(_feedback(tick.feedback))
        if tick.result is not None:
            self._performance = None
            performance.ended.set_result(tick.result)

    def _silence(self, gait: data.GaitState) -> str:
        """The reason why nobody follows postures any longer, or ""."""
        silent = int(self.get_clock().now().nanoseconds) - gait.stamp
        if silent <= _SILENCE:
            return ""
        text = f"whole_body_controller has been silent for {silent / data.SECOND:.2f} s"
        self.get_logger().warning(f"dance given up: {text}")
        return text


class _Performance:
    """A goal under way."""

    def __init__(self, dance: Dance, handle: ServerGoalHandle) -> None:
        self.dance = dance
        self.handle = handle
        self.ended: Future = Future()
        self.beats = 0
        self.preempted = False


def _feedback(told: DanceFeedback) -> PerformDance.Feedback:
    return PerformDance.Feedback(
        beat=told.beat, phase=int(told.phase), progress=told.progress, joint_error=told.joint_error
    )


def main(args: list[str] | None = None) -> None:
    """Run the node."""
    run(DanceActionServer, args, ParametersError)


if __name__ == "__main__":
    main()
