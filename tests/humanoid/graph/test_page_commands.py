"""What visitors of the page command happens to the robot, and each command is answered."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
import pytest
from geometry_msgs.msg import Twist, Vector3
from humanoid.data import Mode
from humanoid.show.audience import Audience
from humanoid.show.web.view_node import WebView
from rclpy.executors import SingleThreadedExecutor
from rclpy.parameter import Parameter

from tests.humanoid.graph.robot import WALKING, Robot

MakeRobot = Callable[..., Robot]
EVERYBODY = (*WALKING, "teleop", "high_level_task_manager", "emergency_stop")


class Visitor:
    """Commands a robot as the page's server does, from a page that is open."""

    def __init__(
        self, robot: Robot, executor: SingleThreadedExecutor, monkeypatch: pytest.MonkeyPatch
    ) -> None:
        self.robot = robot
        self.audience = Audience(parameter_overrides=[Parameter("use_sim_time", value=True)])
        self.view = WebView(audience=self.audience)
        monkeypatch.setattr(type(self.view.page), "watchers", property(lambda _: 1))
        for node in (self.audience, self.view):
            executor.add_node(node)

    def ask(self, **command: Any) -> tuple[bool, str]:
        """Send a command; returns its answer."""
        answers: list[tuple[bool, str]] = []
        self.view._commands.do(command, lambda *answer: answers.append(answer))
        self.robot.until(lambda: bool(answers))
        return answers[0]

    def close(self) -> None:
        """End it all."""
        for node in (self.view, self.audience):
            node.destroy_node()


def test_the_robot_does_what_visitors_want(
    make_robot: MakeRobot, ros_executor: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    robot = make_robot(*EVERYBODY)
    visitor = Visitor(robot, ros_executor, monkeypatch)
    robot.until(lambda: robot.mode is Mode.STANDING)

    assert visitor.ask(do="walk", x=1.0, y=0.1, yaw=0.0) == (True, "walking to (1.00 m, 0.10 m)")
    robot.until(lambda: robot.mode is Mode.WALKING)
    assert visitor.ask(do="cancel")[0]
    robot.until(lambda: robot.mode is Mode.STANDING)

    assert visitor.ask(do="stop") == (True, "emergency stop")
    why = "emergency stop: the button was pressed"
    assert visitor.ask(do="walk", x=1.0, y=0.0, yaw=0.0) == (False, why)

    # Everything starts again, also for a robot that lies on the floor: the stop is released.
    assert visitor.ask(do="push", x=-60.0, y=0.0)[0]
    robot.until(lambda: robot.mode is Mode.FALLEN)
    robot.run(0.5)
    assert visitor.ask(do="restart", scenario="") == (True, "time starts again")
    robot.until(lambda: robot.mode is Mode.STANDING)
    assert robot.now < 5
    assert np.allclose(robot.physics.data.qpos[:2], 0.0, atol=0.05)
    assert visitor.ask(do="say", words=" walk  0.5 0 0 ") == (True, "said: walk 0.5 0 0")
    robot.until(lambda: robot.mode is Mode.WALKING)
    assert visitor.ask(do="push", x=2.0, y=0.0) == (True, "pushed with 2.0 N s")
    visitor.close()


def test_a_robot_that_dances_is_not_driven(
    make_robot: MakeRobot, ros_executor: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    robot = make_robot(*EVERYBODY, "dance_action_server")
    visitor = Visitor(robot, ros_executor, monkeypatch)
    robot.until(lambda: robot.mode is Mode.STANDING)
    assert visitor.ask(do="dance", name="wave") == (True, "dancing: wave")
    robot.until(lambda: visitor.view._commands.mode == "dancing")
    assert visitor.ask(do="drive", forward=1, left=0, turn=0) == (
        False,
        "it cannot be driven now: it is dancing",
    )
    assert visitor.ask(do="drive", forward=0, left=0, turn=0) == (True, "let go")
    robot.publisher(Twist, "/humanoid/cmd_vel", 1)(Twist(linear=Vector3(x=0.2)))
    robot.expect("gait_planner", "the robot is not steered in mode dancing")
    assert robot.mode is Mode.DANCING
    visitor.close()


def test_who_pressed_the_stop_releases_it(make_robot: MakeRobot, ros_executor: Any) -> None:
    """A scenario may end with a press; a page that stays open is of no use then."""
    robot = make_robot(*EVERYBODY)
    audience = Audience(parameter_overrides=[Parameter("use_sim_time", value=True)])
    ros_executor.add_node(audience)
    robot.until(lambda: robot.mode is Mode.STANDING)
    audience.play(["0.1: press"], 0)
    robot.until(lambda: robot.mode is Mode.EMERGENCY_STOP)
    audience.let_go()
    robot.until(lambda: robot.mode is Mode.STANDING)
    audience.destroy_node()


def test_time_obeys(make_robot: MakeRobot, ros_executor: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    robot = make_robot(*EVERYBODY)
    visitor = Visitor(robot, ros_executor, monkeypatch)
    robot.until(lambda: robot.mode is Mode.STANDING)
    assert visitor.ask(do="step") == (False, "pause first: single steps are for time that stands still")
    assert visitor.ask(do="pause") == (True, "paused")
    stamp = robot.physics.stamp
    assert visitor.ask(do="step")[0]
    robot.until(lambda: robot.physics.stamp == stamp + 100_000_000)
    assert visitor.ask(do="run")[0]
    robot.until(lambda: robot.physics.stamp > stamp + 200_000_000)
    # A new speed counts from now on: time neither waits for what would have been, nor makes up for it.
    assert visitor.ask(do="speed", factor=5.0) == (True, "5 times real time at most")
    assert visitor.ask(do="speed", factor=2.0)[0]
    robot.run(0.5)
    assert robot.nodes["humanoid_simulator"].get_parameter("speed").value == 2.0
    assert not robot.fell
    visitor.close()


def test_visitors_choose_the_scene(
    make_robot: MakeRobot, ros_executor: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    robot = make_robot(*EVERYBODY)
    visitor = Visitor(robot, ros_executor, monkeypatch)
    robot.until(lambda: robot.mode is Mode.STANDING)

    def obstacles() -> list[str]:
        return [solid.name for solid in robot.physics.obstacles.solids]

    assert obstacles() == []
    for _ in range(2):
        assert visitor.ask(do="restart", scenario="obstacles") == (True, "time starts again, with obstacles")
        assert obstacles() == ["red_box", "green_cylinder", "yellow_box"]
        robot.until(lambda: robot.mode is Mode.WALKING)
        assert visitor.ask(do="move", name="red_box", x=-2.0, y=0.0)[0]
    robot.until(lambda: robot.physics.obstacles.solids[0].x == -2.0)
    # Without a scenario time starts again in the same scene, and everything stands in its place.
    assert visitor.ask(do="restart", scenario="")[0]
    assert robot.physics.obstacles.solids[0].x == 1.5
    # The floor of a scenario that puts nothing on it is empty.
    assert visitor.ask(do="restart", scenario="walk")[0]
    assert obstacles() == []
    robot.until(lambda: robot.mode is Mode.WALKING)
    visitor.close()


REFUSED: Mapping[str, tuple[dict[str, Any], str]] = {
    "nobody": ({"do": "walk", "x": 1, "y": 0, "yaw": 0}, "navigation_action_server is not there"),
    "far": ({"do": "walk", "x": 16, "y": 0, "yaw": 0}, "x must be a number from -15 to 15"),
    "text": ({"do": "walk", "x": "1", "y": 0, "yaw": 0}, "x must be a number from -15 to 15"),
    "bool": ({"do": "drive", "forward": True, "left": 0, "turn": 0}, "forward must be a number from -1 to 1"),
    "nan": ({"do": "push", "x": float("nan"), "y": 0}, "x must be a number from -60 to 60"),
    "strong": ({"do": "push", "x": 50, "y": 50}, "a push has at most 60 N s"),
    "dance": (
        {"do": "dance", "name": ["wave"]},
        "there is no dance ['wave']: choose one of wave, disco, waltz",
    ),
    "words": ({"do": "say", "words": "fly"}, "'fly' is not a task: say "),
    "silence": ({"do": "say", "words": " "}, "say something, with at most 200 characters"),
    "scenario": (
        {"do": "restart", "scenario": "../walk"},
        "there is no scenario '../walk': choose one of all, ",
    ),
    "setup": ({"do": "restart", "scenario": "obstacles"}, "humanoid_simulator is not there"),
    "obstacle": ({"do": "move", "name": "tree", "x": 1, "y": 0}, "there is no obstacle 'tree'"),
    "speed": ({"do": "speed", "factor": -1}, "a speed is not negative; 0 is as fast as possible"),
    "unknown": ({"do": "explode"}, "there is no command 'explode'"),
    "odd": ({"do": []}, "there is no command []"),
}


def test_refusals_say_why(make_robot: MakeRobot, ros_executor: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    visitor = Visitor(make_robot(), ros_executor, monkeypatch)
    for command, reason in REFUSED.values():
        accepted, text = visitor.ask(**command)
        assert not accepted
        assert text.startswith(reason), command
    visitor.close()
