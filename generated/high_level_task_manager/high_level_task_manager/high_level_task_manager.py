"""The node high_level_task_manager: decides what the robot does next."""

from __future__ import annotations

from typing import Any

from action_msgs.msg import GoalStatus
from geometry_msgs.msg import PoseStamped
from humanoid import data
from humanoid.data import SECOND
from humanoid.planning.pointing import hand_towards, in_footprint
from humanoid.planning.task_manager import TaskManager
from humanoid.planning.tasks import Task, task_of, words_of
from humanoid.robot.body import load_body
from humanoid.ros import messages
from humanoid.ros.diagnostics import Health
from humanoid.ros.running import run
from humanoid.simulation.battery import Level
from humanoid_interfaces.action import PerformDance, WalkTo
from humanoid_interfaces.msg import BatteryStatus, DetectedObjectArray, EmergencyStop, GaitState, TaskStatus
from humanoid_interfaces.srv import CheckHeadPose, SolveIK
from rclpy.task import Future
from sensor_msgs.msg import JointState
from std_msgs.msg import String

from high_level_task_manager._high_level_task_manager_base import HighLevelTaskManagerBase
from high_level_task_manager._high_level_task_manager_parameters import ParametersError
from high_level_task_manager._waiting import GoalRejected, RunningGoal

_SERVERS = {"walk": "navigation_action_server", "dance": "dance_action_server"}
_GREETING = Task("dance", name="wave", tries=1)
_LOOK = 0.2  # s of real time between checks that a goal still makes progress
_SILENCE = 2 * SECOND  # ns without feedback after which a goal is given up
_ANSWER = 5.0  # s of real time that a kinematics service has
_BEGIN = SECOND  # ns: at a fixed moment of simulated time, so that a run does not depend on the wall clock


class HighLevelTaskManager(HighLevelTaskManagerBase):
    """Does one task after another: it awaits the end of each, and handles messages meanwhile."""

    def __init__(self, **options: Any) -> None:
        super().__init__(**options)
        self._body = load_body(self.parameters.model_file, self.parameters.joint_map)
        self.manager = TaskManager(())
        self._battery = Level.NORMAL
        self._stopped = False
        self._gait: data.GaitState | None = None
        self._running: RunningGoal[Any, Any] | None = None
        self._task: Task | None = None
        self._began = 0  # when the task did
        self._is_cancelled = False
        self._heard = 0  # when feedback last arrived
        self._posture: JointState | None = None  # while the robot looks or points
        self._over: Future | None = None  # set when the time of a task is over
        self._greeted = False
        self._health = Health("high_level_task_manager: inputs", self.get_logger(), "readings", "words")
        for words in self.parameters.tasks:
            self._add(words)
        self._tell(TaskStatus.STATE_IDLE)

    async def on_speech_text(self, message: String) -> None:
        """Add what was said as the next task; `stop` ends the present one, `stop all` those that wait, too."""
        if message.data in {"stop", "stop all"}:
            if message.data == "stop all":
                self.manager.forget()
            await self._cancel()
            return
        x, y, yaw = self.parameters.home
        self._add(message.data.replace("walk home", f"walk {x} {y} {yaw}"))

    async def on_gait_state(self, message: GaitState) -> None:
        """Remember whether the robot stands, and where."""
        self._gait = (
            self._health.read("readings", "/gait_state", messages.read_gait_state, message) or self._gait
        )

    async def on_face_detection_detections(self, message: DetectedObjectArray) -> None:
        """Greet each person who appears, once."""
        if message.objects and self.parameters.greet_faces and not self._greeted:
            self._greeted = True
            self.manager.add(_GREETING)

    async def on_battery(self, message: BatteryStatus) -> None:
        """Remember the level."""
        self._battery = Level(message.level) if message.level in list(Level) else Level.UNKNOWN

    async def on_emergency_stop(self, message: EmergencyStop) -> None:
        """End the present task, and drop those that wait."""
        self._stopped = message.active
        if message.active:
            self.manager.forget()  # before the present task ends: nothing is left to do then
            await self._cancel()

    async def on_decide_timer(self) -> None:
        """Begin the next task, or break off the present one."""
        now = self._now()
        task = self._task
        if task is not None and task.seconds and now - self._began >= task.seconds * SECOND:
            await self._end_in_time(task)
        if not self._is_ready(now):
            return
        order = self.manager.update(self._battery, self._stopped)
        if order.cancel:
            await self._cancel()
        if order.start is not None and self.executor is not None:
            self._is_cancelled = False
            self.executor.create_task(self._do(order.start))

    async def on_posture_timer(self) -> None:
        """Repeat the posture: whoever follows it must know that it is still wanted."""
        if self._posture is not None:
            self._posture.header = messages.header(self._now(), "")
            self.publish_posture(self._posture)

    def _is_ready(self, now: int) -> bool:
        """Whether tasks may begin: the robot has stood up, and whoever the first one needs is there."""
        first = self.manager.next
        if self.manager.number or first is None:
            return True
        stands = self._gait is not None and self._gait.mode is data.Mode.STANDING
        clients = {"walk": self.walk_to_action_client, "dance": self.perform_dance_action_client}
        client = clients.get(first.kind)
        return stands and now >= _BEGIN and (client is None or client.server_is_ready())

    def _add(self, words: str) -> None:
        if self._stopped:
            self.get_logger().warning(f"'{messages.printable(words)}' is not done: emergency stop")
            return
        try:
            self.manager.add(task_of(words))
        except ValueError as error:
            self._health.takes("words", messages.printable(str(error)))

    async def _do(self, task: Task) -> None:
        """Do a task to its end."""
        self._task, self._began = task, self._now()
        self._tell(TaskStatus.STATE_RUNNING)
        try:
            succeeded, message = await self._done(task)
        except (GoalRejected, TimeoutError) as error:
            self.get_logger().warning(f"{words_of(task)}: {error}")
            succeeded, message = False, str(error)
        finally:
            self._running = self._over = None
        again = self.manager.finished(succeeded or self._is_cancelled, message)
        state = TaskStatus.STATE_SUCCEEDED if succeeded else TaskStatus.STATE_FAILED
        self._tell(TaskStatus.STATE_CANCELED if self._is_cancelled and not succeeded else state, message)
        self._task = None if not again else self._task
        if not again and not self.manager.waiting:
            self._tell(TaskStatus.STATE_IDLE, task=task)

    async def _done(self, task: Task) -> tuple[bool, str]:
        """Do a task; returns whether that succeeded, and what came of it."""
        if task.kind in {"look", "point"}:
            return await self._look(task)
        if task.kind == "wait":
            await self._until_over()
            return not self._is_cancelled, ""
        self._running = await self._start(task)
        if self._is_cancelled:
            await self._running.cancel()
        result = await self._end_of(self._running, _SERVERS[task.kind])
        succeeded = self._running.status == GoalStatus.STATUS_SUCCEEDED
        done = f"{result.steps} steps" if task.kind == "walk" else f"{result.beats} beats"
        return succeeded, done if succeeded else result.message

    async def _start(self, task: Task) -> RunningGoal[Any, Any]:
        if task.kind == "dance":
            return await self.send_perform_dance(PerformDance.Goal(dance=task.name, beats=task.beats))
        target = messages.stamped(self._now(), messages.planar_pose(*task.place))
        return await self.send_walk_to(WalkTo.Goal(target=target))

    async def _look(self, task: Task) -> tuple[bool, str]:
        """Look at a point, and point at it, for a while."""
        if self._gait is None or self._gait.mode is not data.Mode.STANDING:
            return False, "the robot does not stand"
        target = in_footprint(self._gait.stance.centre, task.place)
        gaze = CheckHeadPose.Request(mode=CheckHeadPose.Request.MODE_LOOK_AT, target=_at(target))
        answer = await self.call_check_head_pose(gaze, timeout_sec=_ANSWER)
        if not answer.reachable:
            return False, str(answer.message)
        names, positions = list(answer.joints.name), list(answer.joints.position)
        if task.kind == "point":
            chain, hand = hand_towards(target, self._body)
            reach = await self.call_solve_ik(
                SolveIK.Request(chain=chain, target=_at(hand), position_only=True, seed=answer.joints),
                timeout_sec=_ANSWER,
            )
            if reach.status != SolveIK.Response.STATUS_SOLVED:
                return False, str(reach.message)
            names += reach.solution.name
            positions += reach.solution.position
        self._posture = JointState(name=names, position=positions)
        await self._until_over()
        self._posture = None
        self.publish_posture(JointState(header=messages.header(self._now(), "")))
        return not self._is_cancelled, ""

    async def _until_over(self) -> None:
        """Wait until the time of the task is over, or somebody cancels it."""
        self._over = Future()
        await self._over

    async def _end_in_time(self, task: Task) -> None:
        if self._over is not None and not self._over.done():
            self._over.set_result(None)
        elif task.kind == "walk":
            await self._cancel()

    async def _end_of(self, goal: RunningGoal[Any, Any], server: str) -> Any:
        """The result. Raises TimeoutError when its server falls silent, because actions have no timeout."""
        assert self.executor is not None
        self._heard = self._now()
        self.executor.create_task(self._listen, goal)
        while True:
            try:
                return await goal.result(timeout_sec=_LOOK)
            except TimeoutError:
                now = self._now()
                if now - self._heard > _SILENCE:
                    raise TimeoutError(f"{server} has been silent for {_SILENCE / SECOND:g} s") from None
                if now - self._began > self.parameters.goal_timeout * SECOND and not self._is_cancelled:
                    self.get_logger().warning(f"not over after {self.parameters.goal_timeout:g} s")
                    await self._cancel()

    async def _listen(self, goal: RunningGoal[Any, Any]) -> None:
        async for _ in goal:
            self._heard = self._now()

    async def _cancel(self) -> None:
        if self._is_cancelled:
            return
        self._is_cancelled = True
        if self._running is not None:
            await self._running.cancel()
        if self._over is not None and not self._over.done():
            self._over.set_result(None)

    def _tell(self, state: int, message: str = "", task: Task | None = None) -> None:
        """Publish what the robot does."""
        task = task or self._task
        status = TaskStatus(
            header=messages.header(self._now(), "odom"),
            number=self.manager.number,
            waiting=self.manager.waiting,
            state=state,
            message=message[:255],
        )
        if task is not None:
            status.words = words_of(task)[:128]
            if task.kind == "walk":
                status.goal = messages.planar_pose(*task.place)
        self.publish_task(status)

    def _now(self) -> int:
        return int(self.get_clock().now().nanoseconds)


def _at(point: tuple[float, float, float]) -> PoseStamped:
    """A point in base_footprint."""
    target = PoseStamped()
    target.header.frame_id = "base_footprint"
    target.pose.position = messages.point(*point)
    return target


def main(args: list[str] | None = None) -> None:
    """Run the node."""
    run(HighLevelTaskManager, args, ParametersError)


if __name__ == "__main__":
    main()
