"""Requests that go as messages between programs of one machine, and those that do not."""

from __future__ import annotations

import time
from collections.abc import Iterator
from typing import Any

import pytest
from std_srvs.srv import SetBool

pytest.importorskip("zenoh")

import zenoh
from rmw_local.transports.zenoh import attachments
from rmw_local.transports.zenoh.calls import Caller
from rmw_local.transports.zenoh.services import Questions

from tests.rclpy.inside.contract.processes import Pair, connected

KIND_AND_SERVER = 17  # bytes, at the end of an attachment


@pytest.fixture
def pair() -> Iterator[Pair]:
    with connected("zenoh") as made:
        yield made


@pytest.fixture
def queries(monkeypatch: pytest.MonkeyPatch) -> list[int]:
    """The numbers of the requests that go as queries."""
    asked: list[int] = []
    ask = Questions.ask

    def note(self: Questions, data: bytes, number: int, stamp: int) -> None:
        asked.append(number)
        ask(self, data, number, stamp)

    monkeypatch.setattr(Questions, "ask", note)
    return asked


def served(pair: Pair, *kinds: str) -> tuple[Any, list[str]]:
    """A client that sees servers in processes of these kinds, and what is added by those that are asked."""
    asked: list[str] = []
    client = pair.process("client").node.create_client(SetBool, "switch")
    for number, kind in enumerate(kinds):
        pair.kind = kind
        name = f"server_{number}"

        def answer(_: Any, response: Any, name: str = name) -> Any:
            asked.append(name)
            response.message = name
            return response

        pair.process(name).node.create_service(SetBool, "switch", answer)
    pair.until(lambda: len(client.handle._client.servers) == len(kinds))
    calls = pair.processes[0].link._transport._calls
    pair.until(lambda: len(calls._processes) == kinds.count("zenoh"))  # each says it beside its servers
    return client, asked


def answered(pair: Pair, client: Any) -> Any:
    future = client.call_async(SetBool.Request())
    pair.until(future.done)
    return future.result()


def test_programs_of_one_machine_are_asked_by_messages(pair: Pair, queries: list[int]) -> None:
    client, asked = served(pair, "zenoh")
    for _ in range(3):
        assert answered(pair, client).message == "server_0"
    assert (asked, queries) == (["server_0"] * 3, [])


def test_each_of_several_servers_is_asked_once(pair: Pair, queries: list[int]) -> None:
    client, asked = served(pair, "zenoh", "zenoh")
    answered(pair, client)
    pair.until(lambda: sorted(asked) == ["server_0", "server_1"])
    pair.settle()
    assert (len(asked), queries) == (2, [])


def test_all_are_asked_by_a_query_if_one_may_be_elsewhere(pair: Pair, queries: list[int]) -> None:
    client, asked = served(pair, "zenoh", "queries")
    answered(pair, client)
    pair.until(lambda: sorted(asked) == ["server_0", "server_1"])
    pair.settle()
    assert (len(asked), queries) == (2, [1])


def test_a_client_that_goes_is_forgotten(pair: Pair) -> None:
    client, _ = served(pair, "zenoh")
    answered(pair, client)
    calls = pair.processes[0].link._transport._calls
    assert calls._callers
    client.destroy()
    assert not calls._callers


def attachment(kind: int, client: bytes, server: bytes, number: int = 1) -> bytes:
    return attachments.pack(number, 0, client) + bytes([kind]) + server


def test_what_nobody_was_asked_for_is_refused(pair: Pair) -> None:
    """A session that is not ours sends answers and requests."""
    client, asked = served(pair, "zenoh")
    process = pair.processes[0]
    transport = process.link._transport
    caller = process.link._presences[client.handle._client].gid
    (server,) = client.handle._client.servers
    config = zenoh.Config()
    for path, value in (
        ("scouting/multicast/enabled", "false"),
        ("scouting/delay", "0"),
        ("connect/endpoints", f'["unixsock-stream/{pair.folder}/0"]'),
    ):
        config.insert_json5(path, value)
    waiting = client.handle._client._unanswered
    waiting[1] = {server: server}, 1  # as if it had asked
    with zenoh.open(config) as session:
        publisher = session.declare_publisher(f"@ifgen_calls/7/{transport._id}/{session.zid()}")
        pair.until(lambda: publisher.matching_status.matching)
        answer = b"\0\1\0\0\1\0\0\0" + bytes(8)
        for kind, about in ((1, caller), (2, caller), (1, bytes(16)), (0, caller)):
            publisher.put(answer, attachment=attachment(kind, about, server.gid))
        for wrong in (None, b"", bytes(KIND_AND_SERVER), bytes(50), attachment(3, caller, server.gid)):
            publisher.put(answer, attachment=wrong)
        pair.until(lambda: transport.malformed.count == 5)
    assert client.handle._client.unread == 0
    assert list(waiting) == [1]
    assert not asked


class Going:
    """Calls to a process that goes while it is asked."""

    def __init__(self) -> None:
        self.lost: list[str] = []
        self.sent: list[str] = []

    def reaches(self, servers: Any) -> bool:
        return not self.sent

    def put(self, process: str, data: bytes, attachment: bytes) -> None:
        self.sent.append(process)

    def lose(self, process: str) -> None:
        self.lost.append(process)


def test_a_request_to_a_process_that_is_going_ends() -> None:
    """Nobody else would end it: it was noted after all that the process owed were ended."""
    going, over = Going(), []
    caller = Caller(going, b"c" * 16, print, lambda *end: over.append(end))
    assert caller.ask(b"", 1, 0, [("abc", b"s" * 16)])
    assert (going.sent, going.lost) == (["abc"], ["abc"])
    ((number, server),) = caller.expected_of("abc")
    caller.end(number, server)
    caller.end(number, server)
    assert over == [(1, "")]
    assert not caller.ask(b"", 2, 0, [("abc", b"s" * 16)])
    assert not caller.ask(b"", 2, 0, [])


def test_a_server_that_was_withdrawn_says_so_at_once(pair: Pair) -> None:
    """Without the time that an answer may take which is on its way."""
    one, two = pair.process("one"), pair.process("two")
    client = one.node.create_client(SetBool, "switch")
    service = two.node.create_service(SetBool, "switch", lambda _, response: response)
    pair.until(client.service_is_ready)
    futures = [client.call_async(SetBool.Request()) for _ in range(3)]
    server = service.handle._server
    end = time.monotonic() + 10.0
    while server.unread < len(futures):
        assert time.monotonic() < end
        time.sleep(0.001)
    two.node.destroy_service(service)
    pair.until(lambda: all(future.done() for future in futures))
    caller = one.link._presences[client.handle._client].asking._caller
    assert not caller._expected
