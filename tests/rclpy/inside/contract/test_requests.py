"""Services, actions and parameters."""

from __future__ import annotations

import time
from typing import Any

from rclpy.action import ActionClient, ActionServer, CancelResponse
from rclpy.node import Node
from rclpy.parameter import Parameter
from rclpy.parameter_client import AsyncParameterClient
from std_srvs.srv import SetBool
from test_msgs.action import Fibonacci

from tests.rclpy.inside.contract.processes import LIMIT, Pair


def test_services_answer(two: tuple[Pair, Node, Node]) -> None:
    pair, one, other = two
    client = one.create_client(SetBool, "switch")
    assert not client.service_is_ready()

    def answer(request: Any, response: Any) -> Any:
        response.success, response.message = request.data, "done"
        return response

    service = other.create_service(SetBool, "switch", answer)
    pair.until(client.service_is_ready)
    futures = [client.call_async(SetBool.Request(data=data)) for data in (True, False)]
    pair.until(lambda: all(future.done() for future in futures))
    assert [(future.result().success, future.result().message) for future in futures] == [
        (True, "done"),
        (False, "done"),
    ]
    other.destroy_service(service)
    pair.until(lambda: not client.service_is_ready())


def test_actions_reach_their_results(two: tuple[Pair, Node, Node]) -> None:
    pair, one, other = two

    async def compute(goal: Any) -> Any:
        sequence = [0, 1]
        for _ in range(goal.request.order):
            sequence.append(sequence[-1] + sequence[-2])
            goal.publish_feedback(Fibonacci.Feedback(sequence=sequence))
        goal.succeed()
        return Fibonacci.Result(sequence=sequence)

    server = ActionServer(
        other, Fibonacci, "compute", compute, cancel_callback=lambda _: CancelResponse.ACCEPT
    )
    client = ActionClient(one, Fibonacci, "compute")
    pair.until(client.server_is_ready)
    seen: list[int] = []
    sent = client.send_goal_async(
        Fibonacci.Goal(order=4), feedback_callback=lambda message: seen.append(len(message.feedback.sequence))
    )
    pair.until(sent.done)
    pair.until(lambda: len(seen) == 4)  # feedback that comes after the result is dropped, as upstream does
    result = sent.result().get_result_async()
    pair.until(result.done)
    assert list(result.result().result.sequence) == [0, 1, 1, 2, 3, 5]
    assert seen == sorted(seen)
    client.destroy()
    server.destroy()


def test_parameters_can_be_read_and_set(two: tuple[Pair, Node, Node]) -> None:
    pair, one, other = two
    other.declare_parameter("rate", 0.1)
    client = AsyncParameterClient(one, "two")
    pair.until(client.services_are_ready)
    change = client.set_parameters([Parameter("rate", value=2.5)])
    pair.until(change.done)
    assert change.result().results[0].successful
    question = client.get_parameters(["rate"])
    pair.until(question.done)
    assert question.result().values[0].double_value == 2.5
    assert other.get_parameter("rate").value == 2.5


def test_a_server_holds_no_more_requests_than_it_can_still_answer(across: Pair) -> None:
    one, process = across.process("one"), across.process("two")
    client = one.node.create_client(SetBool, "switch")
    service = process.node.create_service(SetBool, "switch", lambda _, response: response)
    across.until(client.service_is_ready)
    server, asking = service.handle._server, one.link._presences[client.handle._client].asking
    futures = [client.call_async(SetBool.Request()) for _ in range(30)]  # the server keeps ten
    malformed = server.takes.drops.count
    asking.ask(b"garbage", 1000, 0, ())
    end = time.monotonic() + LIMIT
    while server.unread < 10 or server._queue[-1][3] != 1000:
        assert time.monotonic() < end
        time.sleep(0.001)
    serving = process.link._presences[server].serving
    kept = serving._waiting if across.kind == "recorded" else serving._requests
    assert len(kept) == 10
    across.until(lambda: futures[-1].done() and not kept)
    assert server.takes.drops.count == malformed + 1
