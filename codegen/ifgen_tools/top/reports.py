"""The reports of processes of the local transport, read from JSON that anybody may have sent."""

from __future__ import annotations

import json
from dataclasses import dataclass, field
from typing import Any, Final

from ifgen_runtime.printable import printable

_VERSION: Final = 1
_LONGEST: Final = 4_000_000  # bytes of an answer
_MOST: Final = 2000  # entries of each kind
_LONGEST_TEXT: Final = 1000  # characters
_LARGEST: Final = 2**63


@dataclass(frozen=True, slots=True)
class Publisher:
    """A publisher, and the number of its last message."""

    node: str
    topic: str
    gid: str
    published: int


@dataclass(frozen=True, slots=True)
class Subscription:
    """A subscription: what waits, its depth (0: no limit), and what it has missed."""

    node: str
    topic: str
    gid: str
    waiting: int
    depth: int
    lost: int
    overwritten: int


@dataclass(frozen=True, slots=True)
class Executor:
    """An executor, since it is measured: for how long, and how long it was busy [ns]."""

    kind: str
    nodes: tuple[str, ...]
    threads: int
    measured: int
    busy: int
    callbacks: int
    longest: int
    longest_is: str


@dataclass(frozen=True, slots=True)
class Report:
    """The answer of one process; `clock` is its steady time [ns]."""

    pid: int
    program: str
    clock: int
    nodes: tuple[str, ...] = ()
    publishers: tuple[Publisher, ...] = ()
    subscriptions: tuple[Subscription, ...] = ()
    executors: tuple[Executor, ...] = field(default=())

    @property
    def process(self) -> str:
        """Its name for people."""
        return f"{self.program} {self.pid}"


def read(data: bytes) -> Report | None:
    """The report in an answer; None if it is none, or one of another version."""
    if len(data) > _LONGEST:
        return None
    try:
        found = json.loads(data)
        if not isinstance(found, dict) or found.get("version") != _VERSION:
            return None
        return Report(
            pid=_number(found["pid"]),
            program=_text(found["program"]),
            clock=_number(found["clock"]),
            nodes=tuple(map(_text, _list(found["nodes"]))),
            publishers=tuple(map(_publisher, _list(found["publishers"]))),
            subscriptions=tuple(map(_subscription, _list(found["subscriptions"]))),
            executors=tuple(map(_executor, _list(found["executors"]))),
        )
    except (ValueError, KeyError, TypeError, RecursionError):
        return None


def _publisher(value: Any) -> Publisher:
    return Publisher(
        _text(value["node"]), _text(value["topic"]), _text(value["gid"]), _number(value["published"])
    )


def _subscription(value: Any) -> Subscription:
    numbers = (_number(value[name]) for name in ("waiting", "depth", "lost", "overwritten"))
    return Subscription(_text(value["node"]), _text(value["topic"]), _text(value["gid"]), *numbers)


def _executor(value: Any) -> Executor:
    return Executor(
        kind=_text(value["kind"]),
        nodes=tuple(map(_text, _list(value["nodes"]))),
        threads=_number(value["threads"]),
        measured=_number(value["measured"]),
        busy=_number(value["busy"]),
        callbacks=_number(value["callbacks"]),
        longest=_number(value["longest"]),
        longest_is=_text(value["longest_is"]),
    )


def _list(value: Any) -> list[Any]:
    if not isinstance(value, list) or len(value) > _MOST:
        raise ValueError
    return value


def _text(value: Any) -> str:
    """A text that can be printed: what came may have sequences that control a terminal."""
    if not isinstance(value, str) or len(value) > _LONGEST_TEXT:
        raise ValueError
    return printable(value)


def _number(value: Any) -> int:
    if type(value) is not int or not 0 <= value < _LARGEST:
        raise ValueError
    return value
