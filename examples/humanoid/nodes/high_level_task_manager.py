"""The node high_level_task_manager: decides what the robot does next."""

from __future__ import annotations

import math
from typing import Any

from action_msgs.msg import GoalStatus
from high_level_task_manager._high_level_task_manager_base import HighLevelTaskManagerBase
from high_level_task_manager._high_level_task_manager_parameters import ParametersError
from high_level_task_manager._waiting import GoalRejected, RunningGoal
from humanoid_interfaces.action import PerformDance, WalkTo
from humanoid_interfaces.msg import BatteryStatus, DetectedObjectArray, EmergencyStop
from std_msgs.msg import String

from ..data import SECOND
from ..planning.task_manager import Task, TaskManager
from ..ros import messages
from ..simulation.battery import Level
from .running import run

_SERVERS = {"walk": "navigation_action_server", "dance": "dance_action_server"}
_GREETING = Task("dance", name="wave", tries=1)
_LOOK = 0.2  # s of real time between checks that a goal still makes progress
_SILENCE = 2 * SECOND  # ns without feedback after which a goal is given up


class HighLevelTaskManager(HighLevelTaskManagerBase):
    """Does one task after another: it awaits the end of each, and handles messages meanwhile."""

    def __init__(self, **options: Any) -> None:
        super().__init__(**options)
        self.manager = TaskManager(())
        self._battery = Level.NORMAL
        self._stopped = False
        self._running: RunningGoal[Any, Any] | None = None
        self._cancelled = False
        self._heard = 0  # when feedback last arrived
        self._words = "waiting"
        self._greeted = False
        for words in self.parameters.tasks:
            self._add(words)

    async def on_speech_text(self, message: String) -> None:
        """Add what was said as the next task; `stop` ends the present one."""
        if message.data == "stop":
            await self._cancel()
            return
        x, y, yaw = self.parameters.home
        self._add(message.data.replace("walk home", f"walk {x} {y} {yaw}"))

    async def on_face_detection_detections(self, message: DetectedObjectArray) -> None:
        """Greet each person who appears, once."""
        if message.objects and self.parameters.greet_faces and not self._greeted:
            self._greeted = True
            self.manager.add(_GREETING)

    async def on_battery(self, message: BatteryStatus) -> None:
        """Remember the level."""
        self._battery = Level(message.level) if message.level in list(Level) else Level.UNKNOWN

    async def on_emergency_stop(self, message: EmergencyStop) -> None:
        """End the present task."""
        self._stopped = message.active
        if message.active:
            await self._cancel()

    async def on_state_timer(self) -> None:
        """Decide what to do, do it, and publish what it is."""
        self.publish_state(String(data=self._words))
        order = self.manager.update(self._battery, self._stopped)
        if order.cancel:
            await self._cancel()
        if order.start is not None and self.executor is not None:
            self._cancelled = False
            self.executor.create_task(self._do(order.start))

    def _add(self, words: str) -> None:
        if self._stopped:
            self.get_logger().warning(f"'{words}' is not done: emergency stop")
            return
        try:
            self.manager.add(task_of(words))
        except ValueError as error:
            self.get_logger().warning(str(error))

    async def _do(self, task: Task) -> None:
        """Do a task to its end."""
        self._words = words_of(task)
        try:
            if task.kind == "wait":
                end = self._now() + round(task.seconds * SECOND)
                while self._now() < end and not self._cancelled:
                    await self.sleep(0.05)
                self.manager.finished(True, "")
                return
            self._running = await self._start(task)
            if self._cancelled:
                await self._running.cancel()
            result = await self._end_of(self._running, _SERVERS[task.kind])
            succeeded = self._running.status == GoalStatus.STATUS_SUCCEEDED
            self.manager.finished(succeeded or self._cancelled, result.message)
        except (GoalRejected, TimeoutError) as error:
            self.get_logger().warning(f"{self._words}: {error}")
            self.manager.finished(False, str(error))
        finally:
            self._running = None
            self._words = "waiting"

    async def _start(self, task: Task) -> RunningGoal[Any, Any]:
        if task.kind == "dance":
            return await self.send_perform_dance(PerformDance.Goal(dance=task.name))
        target = messages.stamped(self._now(), messages.planar_pose(*task.goal))
        return await self.send_walk_to(WalkTo.Goal(target=target))

    async def _end_of(self, goal: RunningGoal[Any, Any], server: str) -> Any:
        """The result. Raises TimeoutError when its server falls silent, because actions have no timeout."""
        assert self.executor is not None
        began = self._heard = self._now()
        self.executor.create_task(self._listen, goal)
        while True:
            try:
                return await goal.result(timeout_sec=_LOOK)
            except TimeoutError:
                now = self._now()
                if now - self._heard > _SILENCE:
                    raise TimeoutError(f"{server} has been silent for {_SILENCE / SECOND:g} s") from None
                if now - began > self.parameters.goal_timeout * SECOND and not self._cancelled:
                    self.get_logger().warning(
                        f"{self._words}: not over after {self.parameters.goal_timeout:g} s"
                    )
                    await self._cancel()

    async def _listen(self, goal: RunningGoal[Any, Any]) -> None:
        async for _ in goal:
            self._heard = self._now()

    def _now(self) -> int:
        return int(self.get_clock().now().nanoseconds)

    async def _cancel(self) -> None:
        self._cancelled = True
        if self._running is not None:
            await self._running.cancel()


def task_of(words: str) -> Task:
    """A task from words such as `walk 1.0 0.5 1.57`. Raises ValueError."""
    verb, *rest = words.split() or [""]
    try:
        if verb == "walk" and len(rest) == 3:
            x, y, yaw = (float(word) for word in rest)
            if all(map(math.isfinite, (x, y, yaw))):
                return Task("walk", goal=(x, y, yaw))
        if verb == "dance" and len(rest) == 1:
            return Task("dance", name=rest[0])
        if verb == "wait" and len(rest) == 1 and 0 <= float(rest[0]) < math.inf:
            return Task("wait", seconds=float(rest[0]))
    except ValueError:
        pass
    raise ValueError(f"'{words}' is not a task: say `walk X Y YAW`, `dance NAME` or `wait SECONDS`")


def words_of(task: Task) -> str:
    """A task in words."""
    match task.kind:
        case "walk":
            return "walk {:g} {:g} {:g}".format(*task.goal)
        case "dance":
            return f"dance {task.name}"
        case _:
            return f"wait {task.seconds:g}"


def main(args: list[str] | None = None) -> None:
    """Run the node."""
    run(HighLevelTaskManager, args, ParametersError)


if __name__ == "__main__":
    main()
