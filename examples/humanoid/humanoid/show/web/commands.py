"""The commands of the page's visitors: each becomes what any ROS program could send, and gets an answer."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Mapping
from functools import partial
from typing import Any

from action_msgs.srv import CancelGoal
from geometry_msgs.msg import Point, Vector3, Wrench, WrenchStamped
from humanoid_interfaces.action import PerformDance, WalkTo
from humanoid_interfaces.msg import ObstacleMotion
from rclpy.action import ActionClient
from rclpy.node import Node
from rclpy.qos import QoSProfile, ReliabilityPolicy
from sensor_msgs.msg import Joy
from std_msgs.msg import String
from std_srvs.srv import SetBool, Trigger

from ...planning.choreography import DANCES
from ...planning.tasks import task_of
from ...ros import messages
from ..audience import PUSH_TIME, Audience
from ..crew import SIMULATOR
from .scenes import Answer, Refusal, Scene, Scenes, require

_STRONGEST = 60.0  # N s
_FARTHEST = 15.0  # m from the origin
_FASTEST = 10.0  # times real time
_LONGEST = 200  # characters of a text line
_ROUNDS = 25  # control periods of a single step: 0.1 s
_NOTICED = 0.3  # s after which all nodes know that time starts again
_LOGGED = 3.0  # s that a node's log has to explain a refusal
_DEAF = {"dancing", "holding", "fallen", "emergency stop"}  # modes in which nobody obeys a velocity
_SAID_TO_ROBOT = ("stop", "stop all", "walk home")  # besides tasks
_NEWEST = QoSProfile(depth=1, reliability=ReliabilityPolicy.BEST_EFFORT)


class Commands:
    """Does commands with a node's clients and publishers, always in the node's thread.

    `why` returns what a node has last warned of. `audience` plays the events of scenarios; `scenario` is the
    name or the file of the one that the robot was started with. Calls that take a while are answered later.
    """

    def __init__(
        self, node: Node, why: Callable[[str], str], audience: Audience | None = None, scenario: str = ""
    ) -> None:
        self._why = why
        self._audience = audience
        self._scenes = Scenes(node, scenario)
        self._walk_to = ActionClient(node, WalkTo, "/walk_to")
        self._perform_dance = ActionClient(node, PerformDance, "/perform_dance")
        self._cancels = {
            name: node.create_client(CancelGoal, f"{name}/_action/cancel_goal")
            for name in ("/walk_to", "/perform_dance")
        }
        self._stop = node.create_client(SetBool, "/emergency_stop/set")
        self._pause = node.create_client(SetBool, "/humanoid_simulator/pause")
        self._step = node.create_client(Trigger, "/humanoid_simulator/step")
        self._reset = node.create_client(Trigger, "/humanoid_simulator/reset")
        self._push = node.create_publisher(WrenchStamped, "/humanoid_simulator/push", 10)
        self._move = node.create_publisher(ObstacleMotion, "/humanoid_simulator/move_obstacle", 10)
        self._speech = node.create_publisher(String, "/speech/text", 10)
        self._joy = node.create_publisher(Joy, "/joy", _NEWEST)
        self._later: list[tuple[float, Callable[[], None]]] = []
        self._rounds = 0  # control periods that are still to be stepped
        self._unexplained: list[
            tuple[float, Answer]
        ] = []  # rejected goals, and until when their reason is awaited
        self.mode = ""  # of the robot, as in GaitState, and its reason
        self.reason = ""
        self.paused = False
        self.speed = 1.0
        self.obstacles: list[str] = []  # their names
        self.task = 0  # the number of the robot's last task
        self._acts: Mapping[Any, Callable[[Mapping[str, Any], Answer], None]] = {
            "walk": self._on_walk,
            "dance": self._on_dance,
            "push": self._on_push,
            "move": self._on_move,
            "say": self._on_say,
            "drive": self._on_drive,
            "cancel": self._on_cancel,
            "stop": partial(self._on_stop, active=True),
            "release": partial(self._on_stop, active=False),
            "pause": partial(self._on_pause, paused=True),
            "run": partial(self._on_pause, paused=False),
            "step": self._on_step,
            "speed": self._on_speed,
            "restart": self._on_restart,
        }

    def do(self, asked: Mapping[str, Any], answer: Answer) -> None:
        """Do a command, and answer it once."""
        act = self._acts.get(asked.get("do")) if isinstance(asked.get("do"), str) else None
        try:
            if act is None:
                raise Refusal(f"there is no command {asked.get('do')!r}")
            act(asked, answer)
        except Refusal as refusal:
            answer(False, str(refusal))

    def tick(self) -> None:
        """Go on with what takes time; call it often."""
        now = time.monotonic()
        due = [act for when, act in self._later if when <= now]
        self._later = [(when, act) for when, act in self._later if when > now]
        for act in due:
            act()
        self._explain(now)
        if self._rounds and self._step.service_is_ready():
            self._rounds -= 1
            self._step.call_async(Trigger.Request())

    def _explain(self, now: float) -> None:
        """Answer rejected goals with what the log says about them."""
        while self._unexplained:
            until, answer = self._unexplained[0]
            why = self._why("goal rejected: ")
            if not why and now < until:
                return
            del self._unexplained[0]
            answer(False, _with_help(why or self.reason or "the log of its server says why"))

    def _on_walk(self, asked: Mapping[str, Any], answer: Answer) -> None:
        x, y = _number(asked, "x", _FARTHEST), _number(asked, "y", _FARTHEST)
        yaw = _number(asked, "yaw", 2 * math.pi)
        require(self._walk_to.server_is_ready(), "navigation_action_server")
        self._forget_tasks()
        goal = WalkTo.Goal(target=messages.stamped(0, messages.planar_pose(x, y, yaw)))
        self._send(self._walk_to, goal, f"walking to ({x:.2f} m, {y:.2f} m)", answer)

    def _on_dance(self, asked: Mapping[str, Any], answer: Answer) -> None:
        name = asked.get("name")
        if not isinstance(name, str) or name not in DANCES:
            raise Refusal(f"there is no dance {name!r}: choose one of {', '.join(DANCES)}")
        require(self._perform_dance.server_is_ready(), "dance_action_server")
        self._forget_tasks()
        self._send(self._perform_dance, PerformDance.Goal(dance=name), f"dancing: {name}", answer)

    def _on_push(self, asked: Mapping[str, Any], answer: Answer) -> None:
        x, y = _number(asked, "x", _STRONGEST), _number(asked, "y", _STRONGEST)
        if math.hypot(x, y) > _STRONGEST:
            raise Refusal(f"a push has at most {_STRONGEST:g} N s")
        force = Vector3(x=x / PUSH_TIME, y=y / PUSH_TIME)
        self._push.publish(WrenchStamped(wrench=Wrench(force=force)))
        answer(True, f"pushed with {math.hypot(x, y):.1f} N s")

    def _on_move(self, asked: Mapping[str, Any], answer: Answer) -> None:
        name = asked.get("name")
        if name not in self.obstacles:
            raise Refusal(f"there is no obstacle {name!r}")
        x, y = _number(asked, "x", _FARTHEST), _number(asked, "y", _FARTHEST)
        self._move.publish(ObstacleMotion(name=name, position=Point(x=x, y=y)))
        answer(True, f"{name} is moved to ({x:.2f} m, {y:.2f} m)")

    def _on_say(self, asked: Mapping[str, Any], answer: Answer) -> None:
        words = asked.get("words")
        if not isinstance(words, str) or not 0 < len(words.strip()) <= _LONGEST:
            raise Refusal(f"say something, with at most {_LONGEST} characters")
        words = " ".join(words.split())
        if not words.isprintable():
            raise Refusal("say letters, not control characters")
        if words not in _SAID_TO_ROBOT:
            try:
                task_of(words)
            except ValueError as error:
                raise Refusal(str(error)) from None
        self._say(words)
        answer(True, f"said: {words}")

    def _on_drive(self, asked: Mapping[str, Any], answer: Answer) -> None:
        forward, left, turn = (_number(asked, name, 1.0) for name in ("forward", "left", "turn"))
        held = any((forward, left, turn))
        if held and self.mode in _DEAF:
            raise Refusal(_with_help(f"it cannot be driven now: {self.reason or f'it is {self.mode}'}"))
        self._joy.publish(Joy(axes=[left, forward, turn], buttons=[0, 0, 0, 0, int(held)]))
        answer(True, "driving" if held else "let go")

    def _on_cancel(self, asked: Mapping[str, Any], answer: Answer) -> None:
        self._forget_tasks()
        for client in self._cancels.values():
            if client.service_is_ready():
                client.call_async(CancelGoal.Request())  # neither an id nor a time: every goal
        answer(True, "cancelled")

    def _on_stop(self, asked: Mapping[str, Any], answer: Answer, *, active: bool) -> None:
        require(self._stop.service_is_ready(), "emergency_stop")
        done = "emergency stop" if active else "released"
        future = self._stop.call_async(SetBool.Request(data=active))
        future.add_done_callback(partial(_answered, answer=answer, done=done))

    def _on_pause(self, asked: Mapping[str, Any], answer: Answer, *, paused: bool) -> None:
        require(self._pause.service_is_ready(), SIMULATOR)
        self._rounds = 0
        future = self._pause.call_async(SetBool.Request(data=paused))
        future.add_done_callback(partial(_answered, answer=answer, done="paused" if paused else "time runs"))
        self.paused = paused

    def _on_step(self, asked: Mapping[str, Any], answer: Answer) -> None:
        if not self.paused:
            raise Refusal("pause first: single steps are for time that stands still")
        self._rounds = _ROUNDS
        answer(True, "a tenth of a second")

    def _on_speed(self, asked: Mapping[str, Any], answer: Answer) -> None:
        factor = _number(asked, "factor", _FASTEST)
        if factor < 0:
            raise Refusal("a speed is not negative; 0 is as fast as possible")
        said = f"{factor:g} times real time at most" if factor else "as fast as possible"

        def end() -> None:
            self.speed = factor
            answer(True, said)

        self._scenes.tune({SIMULATOR: {"speed": factor}}, end, answer)

    def _on_restart(self, asked: Mapping[str, Any], answer: Answer) -> None:
        """Put the robot where it started, at time 0, and play a scenario if one is named."""
        name = asked.get("scenario", "")
        scene = self._scenes.find(name) if name else Scene()
        require(self._reset.service_is_ready() and self._stop.service_is_ready(), SIMULATOR)
        said = f"time starts again, with {name}" if name else "time starts again"

        def begin(_: Any) -> None:
            self._play(scene)
            answer(True, said)

        def release() -> None:
            # Only now: while a robot lies on the floor, nobody can release the stop.
            self._stop.call_async(SetBool.Request(data=False)).add_done_callback(begin)

        def wait(_: Any) -> None:
            # Everybody has to notice first that time has gone back.
            self._later.append((time.monotonic() + _NOTICED, release))

        def reset() -> None:
            self._forget_tasks()
            for client in self._cancels.values():
                if client.service_is_ready():
                    client.call_async(CancelGoal.Request())
            if self.paused:
                self.paused = False
                self._pause.call_async(SetBool.Request(data=False))
            self._reset.call_async(Trigger.Request()).add_done_callback(wait)

        self._scenes.tune(scene.others, reset, answer)

    def _play(self, scene: Scene) -> None:
        """Give the robot tasks, and the audience its events; the robot stands up first, for a second."""
        if self._audience is not None:
            self._audience.play(scene.events, self.task + 1)
        for words in ("wait 1", *scene.tasks) if scene.tasks else ():
            self._say(words)

    def _forget_tasks(self) -> None:
        """Visitors take over: what the robot had to do is over."""
        self._say("stop all")

    def _say(self, words: str) -> None:
        self._speech.publish(String(data=words))

    def _send(self, client: ActionClient, goal: Any, done: str, answer: Answer) -> None:
        """Send a goal, and answer when its server has accepted it."""

        def end(future: Any) -> None:
            if future.result().accepted:
                answer(True, done)
            else:  # an action has no words for a refusal, but the log of its server has
                self._unexplained.append((time.monotonic() + _LOGGED, answer))

        client.send_goal_async(goal).add_done_callback(end)


def _answered(future: Any, answer: Answer, done: str) -> None:
    response = future.result()
    answer(response.success, done if response.success else _with_help(response.message or "refused"))


def _with_help(why: str) -> str:
    """A reason, and what to do where only one thing helps."""
    return f"{why}: Restart stands it up" if "has fallen" in why else why


def _number(asked: Mapping[str, Any], name: str, most: float) -> float:
    value = asked.get(name)
    if isinstance(value, bool) or not isinstance(value, int | float) or not abs(value) <= most:
        raise Refusal(f"{name} must be a number from {-most:g} to {most:g}")
    return float(value)
