"""Requests whose servers go before they have answered: their futures fail, and say why."""

from __future__ import annotations

import threading
import time
from typing import Any

import pytest
from ifgen_runtime import ServerGoneError
from rclpy.action import ActionClient, ActionServer
from rclpy.node import Node
from rclpy.task import Future
from std_srvs.srv import SetBool
from test_msgs.action import Fibonacci

from tests.rclpy.inside.contract.processes import LIMIT, Pair

GONE = (
    "service '/switch': no response will come from {}: the server was destroyed, has ended, or is not reached "
    "any more. Wait with `client.wait_for_service()`, then ask again."
)


async def never(*_: Any) -> None:
    """Answer nothing."""
    await Future()


def answer(_: Any, response: SetBool.Response) -> SetBool.Response:
    """Answer."""
    response.message = "x" * 100_000
    return response


def test_futures_fail_when_their_server_is_destroyed(
    two: tuple[Pair, Node, Node], capfd: pytest.CaptureFixture[str]
) -> None:
    pair, one, other = two
    client = one.create_client(SetBool, "switch")
    service = other.create_service(SetBool, "switch", never)
    pair.until(client.service_is_ready)
    futures = [client.call_async(SetBool.Request()) for _ in range(30)]  # more than a queue holds
    told: list[str] = []
    for future in futures:
        future.add_done_callback(lambda future: told.append(str(future.exception())))
    pair.settle()
    assert not any(future.done() for future in futures)
    unheeded = [client.call_async(SetBool.Request())]
    other.destroy_service(service)
    pair.until(lambda: len(told) == 30 and unheeded[0].done())
    assert set(told) == {GONE.format("/two")}
    with pytest.raises(ServerGoneError):
        futures[0].result()
    with pytest.raises(ConnectionError):  # which programs that also run on real rclpy can name
        futures[0].result()
    pair.until(lambda: not client._pending_requests)
    unheeded.clear()
    assert capfd.readouterr().err == ""  # who does not care is not told


def test_a_waiting_call_raises_when_the_process_of_its_server_goes(two: tuple[Pair, Node, Node]) -> None:
    pair, one, other = two
    client = one.create_client(SetBool, "switch")
    other.create_service(SetBool, "switch", never)
    pair.until(client.service_is_ready)
    raised: list[BaseException] = []

    def call() -> None:
        try:
            client.call(SetBool.Request(), timeout_sec=30.0)
        except ServerGoneError as error:
            raised.append(error)

    thread = threading.Thread(target=call)
    thread.start()
    pair.until(lambda: client._pending_requests)
    pair.processes[1].leave()
    pair.until(lambda: raised)
    thread.join()
    assert str(raised[0]) == GONE.format("/two")


def test_what_was_answered_before_the_server_went_is_received(two: tuple[Pair, Node, Node]) -> None:
    pair, one, other = two
    client = one.create_client(SetBool, "switch")
    answers: list[Any] = []
    other.create_service(SetBool, "switch", lambda *request: answers.append(answer(*request)) or answers[0])
    pair.until(client.service_is_ready)
    future = client.call_async(SetBool.Request())
    while not answers:
        pair.processes[1].executor.spin_once(timeout_sec=LIMIT)
    pair.processes[1].leave()
    pair.until(future.done)
    assert len(future.result().message) == 100_000


def test_another_server_may_yet_answer(pair: Pair) -> None:
    one, other, third = (pair.process(name).node for name in ("one", "two", "three"))
    client = one.create_client(SetBool, "switch")
    for node in (other, third):
        node.create_service(SetBool, "switch", never)
    pair.until(lambda: len(client.handle._client.servers) == 2)
    future = client.call_async(SetBool.Request())
    pair.settle()
    pair.processes[1].leave()
    pair.settle()
    assert not future.done()
    pair.processes[2].leave()
    pair.until(future.done)
    assert str(future.exception()) == GONE.format("/three and /two")


def test_goals_end_when_their_server_goes(two: tuple[Pair, Node, Node]) -> None:
    pair, one, other = two
    server = ActionServer(other, Fibonacci, "compute", never, cancel_callback=never)
    client = ActionClient(one, Fibonacci, "compute")
    pair.until(client.server_is_ready)
    sent = client.send_goal_async(Fibonacci.Goal(order=4))
    pair.until(sent.done)
    result, cancel = sent.result().get_result_async(), sent.result().cancel_goal_async()
    pair.settle()
    server.destroy()
    pair.until(lambda: result.done() and cancel.done())
    for future, part in ((result, "get_result"), (cancel, "cancel_goal")):
        with pytest.raises(
            ServerGoneError, match=rf"^{part} of action '/compute': .* `client.wait_for_server"
        ):
            future.result()
    assert not client._pending_result_requests
    assert not client._feedback_callbacks


def test_an_unanswered_goal_fails(two: tuple[Pair, Node, Node]) -> None:
    pair, one, other = two
    server = ActionServer(other, Fibonacci, "compute", never)
    client = ActionClient(one, Fibonacci, "compute")
    pair.until(client.server_is_ready)
    sent = client.send_goal_async(Fibonacci.Goal(order=4), feedback_callback=print)
    server.destroy()
    pair.until(sent.done)
    with pytest.raises(ServerGoneError, match=r"^send_goal of action '/compute'"):
        sent.result()
    assert not client._feedback_callbacks


def test_a_query_that_is_never_ended_is_over_when_its_server_goes() -> None:
    """Zenoh ends none that meets the going of its server."""
    services = pytest.importorskip("rmw_local.transports.zenoh.services")
    over: list[tuple[int, str]] = []
    found: list[Any] = []
    asking = services.Questions(
        found,
        "/switch",
        services.Gate(),
        services.Background(),
        b"",
        lambda *_, **__: None,
        print,
        lambda *end: over.append(end),
    )
    asking.ask(b"", 1, 0)
    asking.ask(b"", 2, 0)
    asking.end(2, "Zenoh says: timeout")
    assert found == [asking]
    found[0].lose_server()
    asking.ask(b"", 3, 0)  # to the next one
    end = time.monotonic() + LIMIT
    while len(over) < 2:
        assert time.monotonic() < end
        time.sleep(0.01)
    assert over == [(2, "Zenoh says: timeout"), (1, "")]
