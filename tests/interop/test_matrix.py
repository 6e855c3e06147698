"""The table: what becomes of implementations that work, differ, crash, or are not there."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import pytest

from tests.interop.bench import definitions, features, samples
from tests.interop.bench.comparison import difference
from tests.interop.bench.exchange import Absent, Actor, Failed, Lacking
from tests.interop.bench.matrix import Matrix
from tests.interop.bench.outcomes import Cell, Feature, Outcome
from tests.interop.bench.peers import PEERS, Known, Peer

pytest.importorskip("zenoh")

PEER = Peer("theirs", "none.py", ("theirs==1.2",), (1, 2), types=(samples.STRING, samples.JOINT_STATE))


class Wire:
    """What two of them share: messages that were sent, by topic."""

    def __init__(self, change: Callable[[int, Any], Any]) -> None:
        self.change = change
        self.queues: dict[str, list[Any]] = {}
        self.sent = 0


class Half:
    """One side, in this process."""

    def __init__(self, wire: Wire, node: str, version: str = "1.2.3") -> None:
        self.wire, self.node, self.versions = wire, node, {"theirs": version}

    def do(self, command: str, **arguments: Any) -> Any:
        match command:
            case "subscribe":
                self.wire.queues[arguments["topic"]] = []
            case "send":
                self.wire.sent += 1
                came = self.wire.change(self.wire.sent, arguments["value"])
                self.wire.queues[arguments["topic"]] += came
            case "received":
                queue = self.wire.queues[arguments["topic"]]
                found, queue[:] = queue[:], []
                return found
            case "act" | "serve_action":
                raise Lacking("it has no actions")
        return None

    def close(self) -> None:
        pass


@pytest.fixture(scope="module", autouse=True)
def installed_once() -> Iterator[None]:
    with pytest.MonkeyPatch.context() as patch, TemporaryDirectory() as folder:
        installed = definitions.install(samples.TYPES, Path(folder))
        patch.setattr(definitions, "install", lambda types, folder: installed)
        yield


def matrix_of(monkeypatch: pytest.MonkeyPatch, theirs: Callable[[], Actor], wire: Wire) -> Matrix:
    monkeypatch.setattr(features, "_LIMIT", 0.05)
    monkeypatch.setattr(Matrix, "_ours", lambda self, peer: Half(wire, "ours"))
    monkeypatch.setattr(Matrix, "_theirs", lambda self, peer: theirs())
    return Matrix({})


def cell(
    monkeypatch: pytest.MonkeyPatch,
    change: Callable[[int, Any], Any] = lambda number, value: [value],
    feature: Feature = Feature.TOPIC,
    peer: Peer = PEER,
    version: str = "1.2.3",
) -> Cell:
    wire = Wire(change)
    with matrix_of(monkeypatch, lambda: Half(wire, "theirs", version), wire) as matrix:
        (row,) = matrix.rows([peer], [feature])
    (found,) = row.cells
    return found


def test_all_that_arrives_once_and_in_order_works(monkeypatch: pytest.MonkeyPatch) -> None:
    found = cell(monkeypatch)
    assert found.word == "ok"
    assert [check.name for check in found.checks] == [
        *("String to us", "String from us", "JointState to us", "JointState from us"),
        *("String, best effort to us", "String, best effort from us"),
    ]


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (lambda number, value: [], "no message within 0.05 s"),
        (lambda number, value: [value] * (2 if number == 4 else 1), "6 came, expected 5"),
        (lambda number, value: [value] if number != 4 else [], "4 came, expected 5"),
        (
            lambda number, value: [{"data": "no"}] if number == 4 else [value],
            "[2].data: got 'no', expected 'Grüße aus 0.1 m Höhe: 3'",
        ),
    ],
)
def test_what_is_lost_repeated_or_changed_fails(
    monkeypatch: pytest.MonkeyPatch, change: Callable[[int, Any], Any], words: str
) -> None:
    found = cell(monkeypatch, change)
    assert found.word == "FAILS"
    assert found.checks[0].outcome is Outcome.FAILS
    assert found.checks[0].reason == words


def known(error: str, *, sometimes: bool = False) -> Peer:
    failure = Known("it talks to nobody", error, sometimes)
    return Peer(
        *("theirs", "none.py", ("theirs",), (1,)),
        types=(samples.STRING,),
        known={(Feature.TOPIC, "String to us"): failure},
    )


@pytest.mark.parametrize(
    ("peer", "works", "outcome", "reason"),
    [
        (known("no message"), False, Outcome.LACKING, "it talks to nobody (no message within 0.05 s)"),
        (known("it crashed"), False, Outcome.FAILS, "no message within 0.05 s"),
        (known("no message"), True, Outcome.FAILS, "it works, and is listed as known: it talks to nobody"),
        (known("no message", sometimes=True), True, Outcome.WORKS, ""),
    ],
    ids=["fails so", "fails otherwise", "works", "works sometimes"],
)
def test_a_known_failure_has_to_be_the_known_one(
    monkeypatch: pytest.MonkeyPatch, peer: Peer, works: bool, outcome: Outcome, reason: str
) -> None:
    found = cell(monkeypatch, lambda number, value: [value] if works else [], peer=peer)
    assert (found.checks[0].outcome, found.checks[0].reason) == (outcome, reason)


def test_what_it_lacks_and_what_is_too_old(monkeypatch: pytest.MonkeyPatch) -> None:
    found = cell(monkeypatch, feature=Feature.ACTION)
    assert (found.word, {check.reason for check in found.checks}) == ("-", {"it has no actions"})
    found = cell(monkeypatch, feature=Feature.BUFFERS)
    assert (found.word, found.checks[0].reason) == ("-", "it has no buffer backends")
    found = cell(monkeypatch, version="1.1.9")
    assert (found.word, found.checks[0].outcome) == ("-", Outcome.ABSENT)
    assert found.checks[0].reason == "theirs 1.1.9 is installed, 1.2 is needed"
    assert cell(monkeypatch, version="").checks[0].reason == "theirs is not installed"
    jazzy, kilted = (peer for peer in PEERS if peer.bridge)
    assert jazzy.refusal("9.1.2") == "ros-rclpy 9.1.2 is installed, 7.x is needed"
    assert kilted.refusal("9.1.2") == jazzy.refusal("7.1.6") == ""


def test_who_crashes_is_started_again_for_the_next_check(monkeypatch: pytest.MonkeyPatch) -> None:
    wire = Wire(lambda number, value: [value])
    starts: list[Half] = []

    class Crashing(Half):
        def do(self, command: str, **arguments: Any) -> Any:
            if len(starts) == 1 and command == "send":
                raise Failed("theirs ended by SIGSEGV")
            return super().do(command, **arguments)

    def theirs() -> Half:
        starts.append(Crashing(wire, "theirs"))
        return starts[-1]

    with matrix_of(monkeypatch, theirs, wire) as matrix:
        (row,) = matrix.rows([PEER], [Feature.TOPIC])
    outcomes = [check.outcome for check in row.cells[0].checks]
    assert outcomes == [Outcome.FAILS, *[Outcome.WORKS] * 5]
    assert len(starts) == 2


def test_what_is_not_there_is_not_tried_again(monkeypatch: pytest.MonkeyPatch) -> None:
    starts = 0

    def theirs() -> Half:
        nonlocal starts
        starts += 1
        raise Absent("there is no module 'theirs'")

    with matrix_of(monkeypatch, theirs, Wire(lambda number, value: [value])) as matrix:
        (row,) = matrix.rows([PEER], [Feature.TOPIC, Feature.SERVICE])
    assert ([cell.word for cell in row.cells], starts) == (["-", "-"], 1)


def test_an_interpreter_that_is_not_there_is_said() -> None:
    with Matrix({"dora-rs": "/no/such/python"}) as matrix:
        (row,) = matrix.rows([PEERS[0]], [Feature.GRAPH])
    assert row.cells[0].checks[0].reason == "/no/such/python: No such file or directory"


def test_differences_name_the_field() -> None:
    one = {"a": [{"b": 0.1}, {"b": 0.2}]}
    assert difference(one, {"a": [{"b": 0.1}, {"b": 0.2}]}) == ""
    assert difference(one, {"a": [{"b": 0.1}, {"b": 0.3}]}) == "a[1].b: got 0.2, expected 0.3"
    assert difference(one, {"a": []}) == "a: 2 came, expected 0"
    assert difference({"a": 1}, {"b": 1}) == "got the fields a, expected b"
