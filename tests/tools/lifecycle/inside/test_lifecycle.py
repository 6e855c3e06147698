"""`ifgen lifecycle`, against nodes in this process."""

from __future__ import annotations

import json
import threading
from collections.abc import Iterator
from typing import Any

import pytest
import rclpy
from rclpy.client import Client
from rclpy.executors import SingleThreadedExecutor
from rclpy.lifecycle import LifecycleNode, State, TransitionCallbackReturn
from rclpy.node import Node

from tests.cli.conftest import Run


class Camera(LifecycleNode):
    def on_activate(self, state: State) -> TransitionCallbackReturn:
        return TransitionCallbackReturn.FAILURE


@pytest.fixture
def lifecycle(ifgen: Run) -> Iterator[Run]:
    rclpy.init(args=[])
    nodes = [Camera("camera"), LifecycleNode("_secret"), Node("talker")]
    executor = SingleThreadedExecutor()
    for node in nodes:
        executor.add_node(node)
    thread = threading.Thread(target=executor.spin)
    thread.start()
    yield lambda *words: ifgen("lifecycle", *words)
    executor.shutdown()
    thread.join()
    for node in nodes:
        node.destroy_node()
    rclpy.shutdown()


def test_nodes(lifecycle: Run) -> None:
    assert lifecycle("nodes").out == "/camera\n"
    assert lifecycle("nodes", "-a").out == "/_secret\n/camera\n"
    assert lifecycle("nodes", "-a", "-c").out == "2\n"
    assert json.loads(lifecycle("nodes", "--json").out) == ["/camera"]


def test_states(lifecycle: Run) -> None:
    assert lifecycle("get", "camera").out == "unconfigured [1]\n"
    assert lifecycle("set", "/camera", "configure").out == "Transitioning successful\n"
    assert lifecycle("get").out == "/camera: inactive [2]\n"
    assert lifecycle("get", "--include-hidden-nodes").out.startswith("/_secret: unconfigured [1]\n/camera")
    failed = lifecycle("set", "/camera", "3")
    assert (failed.code, failed.out, failed.err) == (1, "", "Transitioning failed\n")
    done = json.loads(lifecycle("set", "/camera", "cleanup", "--json").out)
    assert done == {"successful": True, "state": {"label": "unconfigured", "id": 1}}
    assert json.loads(lifecycle("get", "--json").out) == {"/camera": {"label": "unconfigured", "id": 1}}


def test_transitions(lifecycle: Run) -> None:
    assert lifecycle("list", "camera").out == (
        "- configure [1]\n\tStart: unconfigured\n\tGoal: configuring\n"
        "- shutdown [5]\n\tStart: unconfigured\n\tGoal: shuttingdown\n"
    )
    every = lifecycle("list", "camera", "--all").out
    assert "- activate [3]\n\tStart: inactive\n\tGoal: activating\n" in every
    assert json.loads(lifecycle("list", "camera", "--json").out)[0] == {
        "label": "configure",
        "id": 1,
        "start": {"label": "unconfigured", "id": 1},
        "goal": {"label": "configuring", "id": 10},
    }


@pytest.mark.parametrize(
    ("words", "told"),
    [
        (["get", "/camra"], "there is no node '/camra' = help: did you mean '/camera'?"),
        (["get", "/talker"], "the node '/talker' is no lifecycle node = help: lifecycle nodes are: /camera"),
        (
            ["set", "/camera", "activate"],
            "'/camera' has no transition 'activate' now = help: "
            "available ones are: configure [1], shutdown [5]",
        ),
    ],
)
def test_mistakes(lifecycle: Run, words: list[str], told: str) -> None:
    failed = lifecycle(*words)
    assert failed.code == 1
    assert told in " ".join(failed.err.split())


def test_a_node_that_answers_with_a_failure(lifecycle: Run, monkeypatch: pytest.MonkeyPatch) -> None:
    """As one that ends meanwhile."""

    def fail(self: Any, request: object) -> Any:
        future: Any = rclpy.Future()
        future.set_exception(ConnectionError("the server has gone"))
        return future

    monkeypatch.setattr(Client, "call_async", fail)
    done = lifecycle("get", "/camera")
    assert (done.code, done.err) == (
        1,
        "error: the node '/camera' has not answered on 'get_state': the server has gone\n",
    )
