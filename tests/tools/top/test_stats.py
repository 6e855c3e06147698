"""What processes say is read with care, and compared."""

from __future__ import annotations

import json
import random
from typing import Any

import pytest
from ifgen_tools.top.stats import Report, compare, read_report

ANSWER: dict[str, Any] = {
    "version": 1,
    "pid": 41,
    "program": "walker",
    "clock": 10_000_000_000,
    "nodes": ["/walker"],
    "publishers": [{"node": "/walker", "topic": "/word", "gid": "01", "published": 100}],
    "subscriptions": [
        {"node": "/walker", "topic": "/w", "gid": "02", "waiting": 1, "depth": 5, "lost": 2, "overwritten": 3}
    ],
    "executors": [
        {
            "kind": "SingleThreadedExecutor",
            "nodes": ["/walker"],
            "threads": 1,
            "measured": 1_000_000_000,
            "busy": 250_000_000,
            "callbacks": 10,
            "longest": 100_000_000,
            "longest_is": "timer",
        }
    ],
    "omitted": 0,
}


def report(**changed: Any) -> Report:
    found = read_report(json.dumps({**ANSWER, **changed}).encode())
    assert found is not None
    return found


def test_figures_are_those_between_two_answers() -> None:
    later = {
        "clock": 12_000_000_000,
        "publishers": [{**ANSWER["publishers"][0], "published": 130}],
        "executors": [
            {**ANSWER["executors"][0], "measured": 3_000_000_000, "busy": 750_000_000, "callbacks": 50}
        ],
    }
    found = compare({"walker 41": report()}, {"walker 41": report(**later)}, "/tool")
    assert found.rates == {"/word": 15.0}
    assert (found.processes, found.loads) == ({"/walker": "walker 41"}, {"/walker": 0.25})
    (executor,) = found.executors
    assert (executor.load, executor.rate, executor.longest) == (0.25, 20.0, 0.1)
    (subscription,) = found.subscriptions
    assert (subscription.lost, subscription.dropped) == (2, 3)


def test_what_began_anew_is_not_compared_with_what_was() -> None:
    anew = {
        "clock": 12_000_000_000,
        "publishers": [{**ANSWER["publishers"][0], "published": 7}],
        "executors": [{**ANSWER["executors"][0], "measured": 500_000_000, "busy": 0, "callbacks": 0}],
    }
    found = compare({"walker 41": report()}, {"walker 41": report(**anew)}, "/tool")
    assert found.rates == {"/word": 0.0}
    assert found.executors[0].load == 0.0


def test_the_tool_itself_is_left_out() -> None:
    found = compare({}, {"walker 41": report()}, "/walker")
    assert (found.rates, found.counted, found.processes, found.executors) == ({}, {}, {}, ())


@pytest.mark.parametrize(
    "data",
    [
        b"",
        b"{}",
        b"[1]",
        b"null",
        b"\xff",
        b"[" * 100_000,
        json.dumps({**ANSWER, "version": 2}).encode(),
        json.dumps({**ANSWER, "pid": "41"}).encode(),
        json.dumps({**ANSWER, "pid": True}).encode(),
        json.dumps({**ANSWER, "pid": -1}).encode(),
        json.dumps({**ANSWER, "nodes": "/walker"}).encode(),
        json.dumps({**ANSWER, "nodes": ["/walker"] * 2001}).encode(),
        json.dumps({**ANSWER, "program": "x" * 1001}).encode(),
        json.dumps({**ANSWER, "executors": [[]]}).encode(),
        b"1" * 5000,
        b" " * 4_000_001,
    ],
    ids=range(16),
)
def test_what_is_no_report_is_ignored(data: bytes) -> None:
    assert read_report(data) is None


def test_nothing_that_comes_controls_the_terminal() -> None:
    assert report(program="\x1b[2Jwalk\ner").program == "?[2Jwalk?er"


def test_any_bytes_are_read_or_refused() -> None:
    chance = random.Random(7)
    good = json.dumps(ANSWER).encode()
    outcomes = set()
    for _ in range(3000):
        data = bytearray(good)
        for _ in range(chance.randint(1, 4)):
            data[chance.randrange(len(data))] = chance.randrange(256)
        outcomes.add(read_report(bytes(data)) is None)
    assert outcomes == {True, False}
