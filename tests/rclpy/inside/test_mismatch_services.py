"""Services and actions whose two ends have different definitions."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any

import pytest
import rclpy
from ifgen.dynamic import class_from_text
from ifgen_runtime.adapters import Adapter, register
from ifgen_runtime.mismatch import reporting
from ifgen_runtime.mismatch.reporting import Mismatch, in_one_line
from rclpy.action import ActionClient, ActionServer
from rclpy.client import Client
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from rclpy.parameter import Parameter
from rclpy.task import Future

from tests.rclpy.inside.adding import ADD, Message, NewAdd, OldAdd, adapters_for_add, new_add, old_add

WALK = "demo_msgs/action/Walk"
Answer = class_from_text(ADD, "float32 a\n---\nfloat32 sum\nuint8 rest")
OldWalk = class_from_text(WALK, "float32 goal\n---\nfloat32 reached\n---\nfloat32 left")
NewWalk = class_from_text(
    WALK, "float64 goal\nstring gait\n---\nfloat64 reached\n---\nfloat64 left\nuint8 step"
)


@pytest.fixture(autouse=True)
def executor(no_adapters: None, monkeypatch: pytest.MonkeyPatch) -> Iterator[SingleThreadedExecutor]:
    monkeypatch.setattr(reporting, "explanation", in_one_line)  # whether or not the toolkit is installed
    rclpy.init()
    made = SingleThreadedExecutor()
    yield made
    for node in made.get_nodes():
        node.destroy_node()
    made.shutdown()
    rclpy.shutdown()


@pytest.fixture
def node(executor: SingleThreadedExecutor) -> Callable[..., Node]:
    """Makes nodes with policies that spin."""

    def make(name: str, policy: str = "warn") -> Node:
        made = Node(name, parameter_overrides=[Parameter("on_type_mismatch", value=policy)])
        executor.add_node(made)
        return made

    return make


def result(executor: SingleThreadedExecutor, future: Future[Any]) -> Any:
    executor.spin_until_future_complete(future, timeout_sec=10)
    return future.result() if future.done() else None


def nothing_comes_of(executor: SingleThreadedExecutor, future: Future[Any]) -> bool:
    for _ in range(10):
        executor.spin_once(timeout_sec=0)
    return not future.done()


def test_to_warn_is_what_ros_does(
    node: Callable[..., Node],
    executor: SingleThreadedExecutor,
    heard: list[Mismatch],
    log: Callable[[], list[str]],
) -> None:
    node("server").create_service(OldAdd, "add", old_add)
    client = node("client").create_client(Answer, "add")
    assert client.service_is_ready()
    (mismatch,) = heard
    assert (mismatch.kind, mismatch.name, mismatch.type_name) == ("service", "/add", ADD)
    assert {mismatch.mine.role, mismatch.theirs.role} == {"service server", "service client"}
    assert mismatch.mine.type_hash == OldAdd.__type_hash__
    assert mismatch.theirs.definition is not None
    assert len(log()) == 1
    assert nothing_comes_of(executor, client.call_async(Answer.Request(a=0.5)))
    (line,) = log()
    assert "[client]: service '/add': A message of /server does not fit demo_msgs/srv/Add_Response" in line


def test_left_over_bytes_of_a_response(
    node: Callable[..., Node], executor: SingleThreadedExecutor, log: Callable[[], list[str]]
) -> None:
    def answer(request: Message, response: Message) -> Message:
        response.sum = request.a
        return response

    node("server").create_service(Answer, "add", answer)
    client = node("client").create_client(OldAdd, "add")
    log()
    assert [result(executor, client.call_async(OldAdd.Request(a=0.5))).sum for _ in range(3)] == [0.5] * 3
    (line,) = log()
    assert "1 byte of a message of /server were left over after" in line


@pytest.mark.parametrize("policies", [("refuse", "warn"), ("warn", "refuse"), ("adapt", "refuse")])
def test_whoever_refuses_there_is_no_service(
    node: Callable[..., Node],
    executor: SingleThreadedExecutor,
    heard: list[Mismatch],
    policies: tuple[str, str],
) -> None:
    adapters_for_add()
    server = node("server", policies[0])
    server.create_service(NewAdd, "add", new_add)
    client = node("client", policies[1]).create_client(OldAdd, "add")
    assert not client.service_is_ready()
    assert not client.wait_for_service(timeout_sec=0)
    assert nothing_comes_of(executor, client.call_async(OldAdd.Request(a=0.5)))
    assert [mismatch.policy for mismatch in heard] == ["refuse"]
    twin = node("twin").create_client(NewAdd, "add")
    assert twin.service_is_ready()
    assert result(executor, twin.call_async(NewAdd.Request(a=0.5, b=0.25))).sum == 0.75


def test_a_server_adapts_requests_and_responses(
    node: Callable[..., Node], executor: SingleThreadedExecutor
) -> None:
    adapters_for_add()
    node("server", "adapt").create_service(NewAdd, "add", new_add)
    old, new = node("old").create_client(OldAdd, "add"), node("new").create_client(NewAdd, "add")
    for _ in range(2):
        answered = result(executor, old.call_async(OldAdd.Request(a=0.5)))
        assert type(answered) is OldAdd.Response
        assert answered.sum == pytest.approx(0.6)
        assert result(executor, new.call_async(NewAdd.Request(a=0.5, b=0.25))).sum == 0.75


def test_a_client_adapts_to_an_old_server(
    node: Callable[..., Node], executor: SingleThreadedExecutor
) -> None:
    adapters_for_add()
    client = node("client", "adapt").create_client(NewAdd, "add")
    node("server").create_service(OldAdd, "add", old_add)
    answered = result(executor, client.call_async(NewAdd.Request(a=0.5)))
    assert answered == NewAdd.Response(sum=1.0, note="adapted")


def test_an_adapter_that_is_missing_refuses(
    node: Callable[..., Node], heard: list[Mismatch], capfd: pytest.CaptureFixture[str]
) -> None:
    register(Adapter(OldAdd.Request, NewAdd.Request, lambda m: NewAdd.Request(a=m.a)))
    register(Adapter(OldAdd.Response, NewAdd.Response, lambda m: NewAdd.Response(sum=m.sum)))
    node("server", "adapt").create_service(NewAdd, "add", new_add)  # nothing makes old responses
    assert not node("client").create_client(OldAdd, "add").service_is_ready()
    assert [mismatch.policy for mismatch in heard] == ["refuse"]
    assert f"ifgen adapt {ADD} --from {OldAdd.__type_hash__[:23]}" in capfd.readouterr().err


@pytest.mark.parametrize("part", ["request", "response"])
def test_an_adapter_that_fails_loses_one_message(
    node: Callable[..., Node], executor: SingleThreadedExecutor, log: Callable[[], list[str]], part: str
) -> None:
    adapters_for_add()
    broken = iter([True, True, False])

    def convert(message: Message) -> Message:
        if next(broken):
            raise ValueError("broken")
        return NewAdd.Request(a=message.a) if part == "request" else OldAdd.Response(sum=message.sum)

    old, new = (cls.Request if part == "request" else cls.Response for cls in (OldAdd, NewAdd))
    register(Adapter(old, new, convert, convert))
    node("server", "adapt").create_service(NewAdd, "add", new_add)
    client = node("client").create_client(OldAdd, "add")
    log()
    for _ in range(2):
        assert nothing_comes_of(executor, client.call_async(OldAdd.Request(a=0.5)))
    assert result(executor, client.call_async(OldAdd.Request(a=0.5))).sum > 0
    (line,) = log()
    assert "[server]: service '/add': The adapter for /client failed with ValueError: broken" in line


def test_clients_and_servers_that_leave_leave_nothing_behind(node: Callable[..., Node]) -> None:
    adapters_for_add()
    asking, serving = node("client", "adapt"), node("server")
    clients: list[Client] = [asking.create_client(NewAdd, "add") for _ in range(2)]
    service = serving.create_service(OldAdd, "add", old_add)
    asking.destroy_client(clients[0])
    assert list(service.handle._server.clients) == [clients[1].handle._client.gid]
    serving.destroy_service(service)
    assert not clients[1].service_is_ready()


# Actions


def adapters_for_walk() -> None:
    """Of the goal, the result and the feedback: what is sent follows from them."""
    register(
        Adapter(
            OldWalk.Goal,
            NewWalk.Goal,
            lambda m: NewWalk.Goal(goal=m.goal, gait="walk"),
            lambda m: OldWalk.Goal(goal=m.goal),
        )
    )
    register(
        Adapter(
            OldWalk.Result,
            NewWalk.Result,
            lambda m: NewWalk.Result(reached=m.reached),
            lambda m: OldWalk.Result(reached=m.reached),
        )
    )
    register(
        Adapter(
            OldWalk.Feedback,
            NewWalk.Feedback,
            lambda m: NewWalk.Feedback(left=m.left, step=1),
            lambda m: OldWalk.Feedback(left=m.left),
        )
    )


def server(of: Node, cls: Any) -> ActionServer[Any]:
    def execute(handle: Any) -> Any:
        handle.publish_feedback(cls.Feedback(left=handle.request.goal - 0.25))
        handle.succeed()
        return cls.Result(reached=handle.request.goal)

    return ActionServer(of, cls, "walk", execute)


def walk(executor: SingleThreadedExecutor, client: ActionClient[Any], goal: Any) -> tuple[Any, list[Any]]:
    feedback: list[Any] = []
    handle = result(executor, client.send_goal_async(goal, lambda message: feedback.append(message.feedback)))
    return result(executor, handle.get_result_async()).result, feedback


@pytest.mark.parametrize("policies", [("refuse", "warn"), ("warn", "refuse"), ("adapt", "warn")])
def test_an_action_is_refused_by_any_of_its_parts(
    node: Callable[..., Node], heard: list[Mismatch], policies: tuple[str, str], log: Callable[[], list[str]]
) -> None:
    serving, asking = node("server", policies[0]), node("client", policies[1])
    made = server(serving, OldWalk)
    client = ActionClient(asking, NewWalk, "walk")
    assert not client.server_is_ready()
    assert [(each.kind, each.name, each.type_name) for each in heard] == [("action", "/walk", WALK)]
    assert {heard[0].mine.role, heard[0].theirs.role} == {"action server", "action client"}
    assert {heard[0].mine.type_hash, heard[0].theirs.type_hash} == {
        OldWalk.__type_hash__,
        NewWalk.__type_hash__,
    }
    assert len(log()) == 1
    client.destroy()
    made.destroy()


def test_only_the_feedback_differs(node: Callable[..., Node], heard: list[Mismatch]) -> None:
    other = class_from_text(WALK, "float32 goal\n---\nfloat32 reached\n---\nfloat32 left\nuint8 step")
    made = server(node("server"), other)
    client = ActionClient(node("client", "refuse"), OldWalk, "walk")
    assert not client.server_is_ready()
    assert [(each.kind, each.policy, each.mine.role) for each in heard] == [
        ("action", "refuse", "action client")
    ]
    client.destroy()
    made.destroy()


def test_a_client_adapts_an_action(
    node: Callable[..., Node], executor: SingleThreadedExecutor, heard: list[Mismatch]
) -> None:
    adapters_for_walk()
    made = server(node("server"), OldWalk)
    client = ActionClient(node("client", "adapt"), NewWalk, "walk")
    assert client.server_is_ready()
    reached, feedback = walk(executor, client, NewWalk.Goal(goal=0.5, gait="run"))
    assert reached == NewWalk.Result(reached=0.5)
    assert feedback == [NewWalk.Feedback(left=0.25, step=1)]
    assert [each.policy for each in heard] == ["adapt"]
    client.destroy()
    made.destroy()


def test_a_server_adapts_goals_and_results_and_feedback_is_the_clients(
    node: Callable[..., Node], executor: SingleThreadedExecutor
) -> None:
    adapters_for_walk()
    made = server(node("server", "adapt"), NewWalk)
    client = ActionClient(node("client"), OldWalk, "walk")
    reached, feedback = walk(executor, client, OldWalk.Goal(goal=0.5))
    assert reached == OldWalk.Result(reached=0.5)
    assert feedback != [OldWalk.Feedback(left=0.25)]  # read as it comes: a topic is adapted by who receives
    client.destroy()
    made.destroy()
