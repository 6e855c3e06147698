"""The user of trials does not wait for dead nodes: a scenario whose server falls silent ends with a sentence."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import pytest
from humanoid.data import Mode
from humanoid.trials.user import ScenarioError, User

from tests.humanoid.graph.robot import WALKING, Robot

MORE = ("dance_action_server", "emergency_stop")


@pytest.mark.parametrize("server", ["navigation_action_server", "dance_action_server"])
def test_a_server_dies(make_robot: Callable[..., Robot], ros_executor: Any, server: str) -> None:
    robot = make_robot(*WALKING, *MORE)
    user = User(lambda _: None)
    ros_executor.add_node(user)

    async def play() -> None:
        await user.ready()
        with pytest.raises(ScenarioError, match=f"^{server} has been silent for 2 s$"):
            await (user.walk(1.0, 0.0, 0.0) if server.startswith("nav") else user.dance("wave"))

    task = ros_executor.create_task(play)
    busy = Mode.WALKING if server.startswith("nav") else Mode.DANCING
    robot.until(lambda: robot.mode is busy)
    robot.run(1.0)
    robot.kill(server)
    killed = robot.now
    robot.until(task.done)
    assert task.exception() is None
    assert robot.now - killed < 2.6
    ros_executor.remove_node(user)
    user.destroy_node()
