"""Services of which one side adapts what processes with another version of the type ask or answer."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import pytest
from ifgen_runtime import ServerGoneError
from ifgen_runtime.adapters import Adapter, register
from ifgen_runtime.codec import deserialize, serialize
from ifgen_runtime.mismatch import reporting
from ifgen_runtime.mismatch.reporting import Mismatch, in_one_line
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.node import Node
from rclpy.task import Future
from rmw_local.transports import services

from tests.rclpy.inside.adding import Message, NewAdd, OldAdd, adapters_for_add, new_add, old_add
from tests.rclpy.inside.contract.processes import ACROSS, IN_ROUNDS, Pair, connected


@pytest.fixture(autouse=True)
def clean(no_adapters: None, heard: list[Mismatch], monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(reporting, "explanation", in_one_line)  # whether or not the toolkit is installed


@pytest.fixture(params=[*ACROSS, *IN_ROUNDS])
def pair(request: pytest.FixtureRequest) -> Iterator[Pair]:
    with connected(request.param) as made:
        yield made


def node(pair: Pair, name: str, policy: str = "warn") -> Node:
    made = pair.process(name).node
    made.handle.graph_node.on_type_mismatch = policy
    return made


async def never(*_: Any) -> None:
    """Answer nothing."""
    await Future()


def result(pair: Pair, future: Future[Any]) -> Any:
    pair.until(future.done)
    return future.result()


@pytest.mark.parametrize("server_first", [True, False])
def test_a_server_adapts(pair: Pair, heard: list[Mismatch], server_first: bool) -> None:
    adapters_for_add(OldAdd.__type_hash__)
    serving, asking, third = node(pair, "server", "adapt"), node(pair, "old"), node(pair, "new")
    if server_first:
        serving.create_service(NewAdd, "add", new_add)
    old, new = asking.create_client(OldAdd, "add"), third.create_client(NewAdd, "add")
    if not server_first:
        serving.create_service(NewAdd, "add", new_add)
    pair.until(lambda: old.service_is_ready() and new.service_is_ready())
    for _ in range(2):
        answered = result(pair, old.call_async(OldAdd.Request(a=0.5)))
        assert type(answered) is OldAdd.Response
        assert answered.sum == pytest.approx(0.6)
        assert result(pair, new.call_async(NewAdd.Request(a=0.5, b=0.25))).sum == 0.75
    assert asking.count_services("add") == third.count_services("add") == 1
    if pair.kind != "lockstep":  # where no definition is asked for, nobody waits for one
        pair.until(lambda: len(heard) == 2)
        assert {(each.mine.role, each.policy) for each in heard} == {
            ("service server", "adapt"),
            ("service client", "refuse"),  # it does not know that the server adapts
        }


@pytest.mark.parametrize("server_first", [True, False])
def test_a_client_adapts(pair: Pair, server_first: bool) -> None:
    adapters_for_add(OldAdd.__type_hash__)
    serving, asking = node(pair, "server"), node(pair, "client", "adapt")
    if server_first:
        serving.create_service(OldAdd, "add", old_add)
    client = asking.create_client(NewAdd, "add")
    if not server_first:
        serving.create_service(OldAdd, "add", old_add)
    pair.until(client.service_is_ready)
    for _ in range(2):
        answered = result(pair, client.call_async(NewAdd.Request(a=0.5)))
        assert answered == NewAdd.Response(sum=1.0, note="adapted")
    assert serving.count_clients("add") == asking.count_services("add") == 1


def test_where_both_adapt_a_request_is_answered_once(pair: Pair) -> None:
    adapters_for_add(OldAdd.__type_hash__)
    register(
        Adapter(
            NewAdd.Request,
            OldAdd.Request,
            lambda m: OldAdd.Request(a=m.a),
            lambda m: NewAdd.Request(a=m.a),
            within=NewAdd.__type_hash__,
        )
    )
    register(
        Adapter(
            NewAdd.Response,
            OldAdd.Response,
            lambda m: OldAdd.Response(sum=m.sum),
            lambda m: NewAdd.Response(sum=m.sum),
            within=NewAdd.__type_hash__,
        )
    )
    asked: list[Message] = []

    def add(request: Message, response: Message) -> Message:
        asked.append(request)
        return new_add(request, response)

    node(pair, "server", "adapt").create_service(NewAdd, "add", add)
    client = node(pair, "client", "adapt").create_client(OldAdd, "add")
    pair.until(lambda: len(client.handle._client.servers) == 2)  # as it is, and as it stands in
    for number in range(1, 4):
        assert result(pair, client.call_async(OldAdd.Request(a=0.5))).sum == pytest.approx(0.6)
        pair.settle()
        assert len(asked) == number
    assert all(request.b == 0.1 for request in asked)  # the server's adapter


def test_a_client_asks_servers_of_two_definitions(pair: Pair) -> None:
    adapters_for_add(OldAdd.__type_hash__)
    asked: list[type[Any]] = []

    async def note(request: Message, _: Message) -> None:
        asked.append(type(request))
        await Future()

    old, new, asking = node(pair, "old"), node(pair, "new"), node(pair, "client", "adapt")
    servers = [old.create_service(OldAdd, "add", note), new.create_service(NewAdd, "add", note)]
    client = asking.create_client(NewAdd, "add")
    pair.until(lambda: len(client.handle._client.servers) == 2)
    future = client.call_async(NewAdd.Request(a=0.5))
    pair.until(lambda: len(asked) == 2)
    assert set(asked) == {OldAdd.Request, NewAdd.Request}
    old.destroy_service(servers[0])
    pair.until(lambda: len(client.handle._client.servers) == 1)
    pair.settle()
    assert not future.done()  # the other one may yet answer
    new.destroy_service(servers[1])
    pair.until(future.done)
    assert isinstance(future.exception(), ServerGoneError)


@pytest.mark.parametrize("policies", [("adapt", "warn"), ("warn", "adapt"), ("adapt", "adapt")])
def test_futures_fail_when_an_adapted_server_is_gone(pair: Pair, policies: tuple[str, str]) -> None:
    adapters_for_add(OldAdd.__type_hash__)
    serving, asking = node(pair, "server", policies[0]), node(pair, "client", policies[1])
    server_type, client_type = (NewAdd, OldAdd) if policies[0] == "adapt" else (OldAdd, NewAdd)
    service = serving.create_service(server_type, "add", never)
    client = asking.create_client(client_type, "add")
    pair.until(client.service_is_ready)
    future = client.call_async(client_type.Request(a=0.5))
    pair.settle()
    assert not future.done()
    serving.destroy_service(service)
    pair.until(future.done)
    assert isinstance(future.exception(), ServerGoneError)
    pair.until(lambda: not client.service_is_ready())


@pytest.mark.parametrize("policies", [("refuse", "adapt"), ("adapt", "refuse"), ("warn", "warn")])
def test_whoever_refuses_there_is_no_service(
    across: Pair, heard: list[Mismatch], policies: tuple[str, str], capfd: pytest.CaptureFixture[str]
) -> None:
    adapters_for_add(OldAdd.__type_hash__)
    register(Adapter(NewAdd.Request, OldAdd.Request, old := lambda m: m, old, within=NewAdd.__type_hash__))
    register(Adapter(NewAdd.Response, OldAdd.Response, old, old, within=NewAdd.__type_hash__))
    asked: list[Any] = []
    serving, asking = node(across, "server", policies[0]), node(across, "client", policies[1])
    serving.create_service(NewAdd, "add", lambda *args: asked.append(args))
    client = asking.create_client(OldAdd, "add")
    across.until(lambda: len(heard) == 2)
    across.settle()
    assert not client.service_is_ready()
    client.call_async(OldAdd.Request(a=0.5))
    across.settle()
    assert not asked
    assert {each.policy for each in heard} == {"refuse"}
    log = capfd.readouterr().err
    assert log.count("refuses other definitions") == ("warn" not in policies)
    assert "no adapter" not in log
    if policies == ("warn", "warn"):
        assert "unless the server adapts" in log
        assert "unless the client adapts" in log


@pytest.mark.parametrize("adapting", ["server", "client"])
def test_adapters_that_are_missing_are_asked_for(
    across: Pair, heard: list[Mismatch], adapting: str, capfd: pytest.CaptureFixture[str]
) -> None:
    serving = node(across, "server", "adapt" if adapting == "server" else "warn")
    asking = node(across, "client", "adapt" if adapting == "client" else "warn")
    serving.create_service(NewAdd, "add", new_add)
    client = asking.create_client(OldAdd, "add")
    across.until(lambda: len(heard) == 2)
    log: list[str] = []
    across.until(lambda: log.append(capfd.readouterr().err) or "no adapter with `downgrade`" in "".join(log))
    assert not client.service_is_ready()


def test_a_server_answers_clients_that_nobody_announced_and_those_of_long_ago(
    recorded: Pair, monkeypatch: pytest.MonkeyPatch
) -> None:
    adapters_for_add(OldAdd.__type_hash__)
    monkeypatch.setattr(services, "_MOST_REQUESTS", 2)
    waiting: list[Future[Any]] = []

    async def add(request: Message, response: Message) -> Message:
        waiting.append(Future())
        await waiting[-1]
        return new_add(request, response)

    asking = node(recorded, "client")
    together = ReentrantCallbackGroup()
    node(recorded, "server", "adapt").create_service(NewAdd, "add", add, callback_group=together)
    client = asking.create_client(OldAdd, "add")
    recorded.until(client.service_is_ready)
    answers: list[bytes] = []
    shown = recorded.processes[0].link._presences[client.handle._client].asking.entity
    ask = recorded.network.members["client"].ask_also(
        shown, b"nobody".ljust(16), lambda data, *_: answers.append(data), lambda *_: None
    )
    futures = [client.call_async(OldAdd.Request(a=0.5)) for _ in range(4)]
    ask(serialize(OldAdd.Request(a=1.5)), 1, 0)
    recorded.until(lambda: len(waiting) == 5)
    for each in waiting:
        each.set_result(None)
    assert [round(result(recorded, future).sum, 6) for future in futures] == [0.6] * 4
    recorded.until(lambda: answers)
    assert deserialize(answers[0], OldAdd.Response).sum == pytest.approx(1.6)


@pytest.mark.parametrize("part", ["request", "response"])
@pytest.mark.parametrize("adapting", ["server", "client"])
def test_an_adapter_that_fails_loses_one_message(
    recorded: Pair, part: str, adapting: str, capfd: pytest.CaptureFixture[str]
) -> None:
    adapters_for_add(OldAdd.__type_hash__)
    broken = iter([True, True, False])
    is_server = adapting == "server"
    made: Any = getattr(NewAdd if (part == "request") == is_server else OldAdd, part.title())

    def convert(_: Message) -> Message:
        if next(broken):
            raise ValueError("broken")
        return made()

    old, new = getattr(OldAdd, part.title()), getattr(NewAdd, part.title())
    register(Adapter(old, new, convert, convert, within=OldAdd.__type_hash__))
    serving = node(recorded, "server", "adapt" if is_server else "warn")
    asking = node(recorded, "client", "warn" if is_server else "adapt")
    service = serving.create_service(*(NewAdd, "add", new_add) if is_server else (OldAdd, "add", old_add))
    client = asking.create_client(OldAdd if is_server else NewAdd, "add")
    recorded.until(client.service_is_ready)
    request = (OldAdd if is_server else NewAdd).Request(a=0.5)
    lost = [client.call_async(request) for _ in range(2)]
    recorded.settle()
    assert not any(future.done() for future in lost)
    result(recorded, client.call_async(request))
    assert capfd.readouterr().err.count("failed with ValueError: broken") == 1
    serving.destroy_service(service)
    recorded.settle()
    if (adapting, part) == ("client", "response"):  # they were answered
        assert not any(future.done() for future in lost)
    else:
        recorded.until(lambda: all(future.done() for future in lost))
        assert all(isinstance(future.exception(), ServerGoneError) for future in lost)
