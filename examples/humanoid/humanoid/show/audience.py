"""A node that plays the people around the robot: they push it, speak, hold a joystick, move things."""

from __future__ import annotations

import math
from array import array
from collections.abc import Callable
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np
import rclpy
from geometry_msgs.msg import Point, Vector3, Wrench, WrenchStamped
from humanoid_interfaces.msg import ObstacleMotion, TaskStatus
from numpy.typing import NDArray
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy
from sensor_msgs.msg import Joy
from std_msgs.msg import Int16MultiArray, String
from std_srvs.srv import SetBool

from ..planning.events import Event, event_of
from ..ros.running import run
from ..sensing import voice

PUSH_TIME = 0.1  # s for which the simulator pushes
_TASKS = QoSProfile(depth=10, durability=DurabilityPolicy.TRANSIENT_LOCAL)
_NEWEST = QoSProfile(depth=1, reliability=ReliabilityPolicy.BEST_EFFORT)
_BEGUN = {TaskStatus.STATE_RUNNING}
_ENDED = {TaskStatus.STATE_SUCCEEDED, TaskStatus.STATE_FAILED, TaskStatus.STATE_CANCELED}
_SOUND = QoSProfile(depth=25, reliability=ReliabilityPolicy.BEST_EFFORT)
_BLOCK = 0.02  # s of sound in a message
_STICKS = 0.1  # s between messages of the joystick
_HELD = [0, 0, 0, 0, 1]  # buttons: the dead man's is held
_RELEASED = [0, 0, 0, 0, 0]


def push_of(momentum: float, degrees: float) -> WrenchStamped:
    """A push of the torso: momentum [N s] and direction, seen from above."""
    force, angle = momentum / PUSH_TIME, math.radians(degrees)
    across = Vector3(x=force * math.cos(angle), y=force * math.sin(angle))
    return WrenchStamped(wrench=Wrench(force=across))


class AudienceError(ValueError):
    """An event cannot be read; the text says which."""


class Audience(Node):
    """Plays the events of its parameter `events`, each once, at their simulated times."""

    def __init__(self, **options: Any) -> None:
        super().__init__("audience", **options)
        self.declare_parameter("events", rclpy.Parameter.Type.STRING_ARRAY)
        texts = self.get_parameter_or("events", rclpy.Parameter("events", value=[""])).value
        try:
            self._waiting = [event_of(text) for text in texts if text]
        except ValueError as error:
            raise AudienceError(str(error)) from None
        self._pressed = False  # the emergency stop
        self._due = 0  # events whose time is set, but has not come
        self._push = self.create_publisher(WrenchStamped, "/humanoid_simulator/push", 10)
        self._move = self.create_publisher(ObstacleMotion, "/humanoid_simulator/move_obstacle", 10)
        self._typed = self.create_publisher(String, "/speech/typed", 10)
        self._microphone = self.create_publisher(Int16MultiArray, "/microphone/audio", _SOUND)
        self._joy = self.create_publisher(Joy, "/joy", _NEWEST)
        self._button = self.create_client(SetBool, "/emergency_stop/set")
        self.create_subscription(TaskStatus, "/high_level_task_manager/task", self._on_task, _TASKS)
        self._plan(lambda event: not event.task)

    @property
    def is_over(self) -> bool:
        """Whether everything has happened."""
        return not self._waiting and not self._due

    def let_go(self) -> None:
        """Release the emergency stop if the last event about it was a press: nobody else would."""
        if self._pressed:
            self._pressed = False
            self._button.call_async(SetBool.Request(data=False))

    def play(self, texts: list[str], after: int) -> None:
        """Play other events instead: times count from now, tasks from the one after number `after`."""
        events = [event_of(text) for text in texts]
        self._waiting = [replace(e, task=e.task + after) if e.task else e for e in events]
        self._plan(lambda event: not event.task)

    def _on_task(self, message: TaskStatus) -> None:
        number, state = message.number, message.state
        self._plan(
            lambda event: event.task == number and state in (_ENDED if event.after else _BEGUN),
        )

    def _plan(self, is_due: Callable[[Event], bool]) -> None:
        """Set the time of events that waited for this moment."""
        due = [event for event in self._waiting if is_due(event)]
        self._waiting = [event for event in self._waiting if event not in due]
        for event in due:
            self._due += 1
            self._after(event.delay, partial(self._happen, event))

    def _after(self, seconds: float, act: Callable[[], None]) -> None:
        """Call a function once, after some simulated time."""

        def once() -> None:
            self.destroy_timer(timer)
            act()

        timer = self.create_timer(max(seconds, 1e-3), once)

    def _happen(self, event: Event) -> None:
        self._due -= 1
        match event.act:
            case "push":
                self._push.publish(push_of(*event.numbers))
            case "press" | "release":
                self._pressed = event.act == "press"
                self._button.call_async(SetBool.Request(data=self._pressed))
            case "say":
                self._typed.publish(String(data=event.words))
            case "speak":
                self._speak(voice.say(event.words))
            case "joystick":
                self._steer(*event.numbers)
            case "move":
                x, y = event.numbers
                self._move.publish(ObstacleMotion(name=event.words, position=Point(x=x, y=y)))

    def _speak(self, sound: NDArray[np.int16]) -> None:
        """Send sound to the microphone, block by block as time passes, and silence after it."""
        self._due += 1
        block, silence = round(_BLOCK * voice.RATE), np.zeros(voice.RATE, dtype=np.int16)
        left = np.concatenate([sound, silence])

        def send(start: int) -> None:
            part = left[start : start + block]
            self._microphone.publish(Int16MultiArray(data=array("h", part.tobytes())))
            if start + block < len(left):
                self._after(_BLOCK, lambda: send(start + block))
            else:
                self._due -= 1

        send(0)

    def _steer(self, forward: float, left: float, turn: float, seconds: float) -> None:
        """Hold the sticks for a time, and let go."""
        self._due += 1
        count = max(1, round(seconds / _STICKS))

        def hold(left_over: int) -> None:
            held = left_over > 0
            axes = [left, forward, turn] if held else [0.0] * 3
            self._joy.publish(Joy(axes=axes, buttons=_HELD if held else _RELEASED))
            if held:
                self._after(_STICKS, lambda: hold(left_over - 1))
            else:
                self._due -= 1

        hold(count)


def main(args: list[str] | None = None) -> None:
    """Run the node."""
    run(Audience, args, AudienceError)


if __name__ == "__main__":
    main()
