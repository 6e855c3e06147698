"""The figures of a process, for another one that asks: its nodes, the ends of its topics, and its executors.

Nothing is measured before somebody asks, nor any more five seconds after the last question. What is told
without measuring is there anyway: the number of each publisher's last message, and what waits.
"""

from __future__ import annotations

import _thread
import json
import os
import sys
import time
from itertools import islice
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final, Protocol

from rmw_local.reader import Reader
from rmw_local.writer import Writer

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable

    from rmw_local.domain import Domain
    from rmw_local.topic import Topic

VERSION: Final = 1
"""Of the answer. Whoever asks ignores answers of other versions."""

LEASE: Final = 5.0
"""Seconds after the last question for which measuring goes on."""

_MOST: Final = 2000
"""The number of nodes, publishers, subscriptions and executors that an answer has of each."""

_FRESH: Final = 0.05
"""Seconds for which an answer is good, so that many questions cost as little as few."""


class Meter(Protocol):
    """Something that measures while that is wanted, such as an executor's."""

    def measure(self, is_wanted: bool) -> None:
        """Begin, unless it has begun; or end."""

    def figures(self) -> dict[str, Any] | None:
        """The figures since it began, as JSON; None if there is nothing left to measure."""


class Statistics:
    """The figures of a process in one domain."""

    def __init__(self, domain: Domain) -> None:
        self._domain = domain
        self._lock = _thread.allocate_lock()  # not threading's, which virtual time exchanges
        self._answer = b""
        self._answered = 0.0  # monotonic [s]
        self._is_measuring = False
        self._until = 0.0  # monotonic [s]

    def answer(self) -> bytes:
        """The figures as JSON in UTF-8; from now on they are measured for a while."""
        with self._lock:
            now = time.monotonic()
            self._until = now + LEASE
            if not self._is_measuring:
                self._is_measuring = True
                _thread.start_new_thread(self._end_in_time, ())
            if not self._answer or now - self._answered > _FRESH:
                self._answer = json.dumps(self._figures(), separators=(",", ":")).encode()
                self._answered = now
            return self._answer

    def _figures(self) -> dict[str, Any]:
        self._measure(is_wanted=True)
        domain = self._domain
        with domain.lock:
            nodes = [node.full_name for node in domain.nodes if not node.is_remote]
            topics = list(domain.topics.values())
            writers = [each for topic in topics for each in topic.writers if not each.is_remote]
            readers = _readers(topics)
            meters = list(domain.meters)
        executors = [figures for meter in meters if (figures := meter.figures()) is not None]
        parts: tuple[Iterable[object], ...] = (
            nodes,
            map(_of_writer, writers),
            map(_of_reader, readers),
            executors,
        )
        names = ("nodes", "publishers", "subscriptions", "executors")
        return {
            "version": VERSION,
            "pid": os.getpid(),
            "program": _program(),
            "clock": time.monotonic_ns(),
            **{name: list(islice(part, _MOST)) for name, part in zip(names, parts, strict=True)},
            "omitted": sum(max(len(each) - _MOST, 0) for each in (nodes, writers, readers, executors)),
        }

    def _measure(self, *, is_wanted: bool) -> None:
        with self._domain.lock:
            measured: list[Meter | Reader] = [*_readers(self._domain.topics.values()), *self._domain.meters]
        for each in measured:
            each.measure(is_wanted)

    def _end_in_time(self) -> None:
        """Wait for the last question to be long ago. A thread of this kind keeps no program from ending."""
        while True:
            with self._lock:
                left = self._until - time.monotonic()
                if left <= 0:
                    self._measure(is_wanted=False)
                    self._is_measuring = False
                    return
            time.sleep(left)


def survey(domain: Domain, patience: float) -> Callable[[], Iterable[bytes]]:
    """Ask every process in a domain for its statistics, and this one too.

    Returns a function that returns what has been answered since the last call, for `patience` [s]: each a
    JSON text as `Statistics.answer` returns it, unless another process sends something else.
    """
    mine = [of(domain).answer()]
    link = domain.link
    others = link.survey(patience) if link is not None else tuple

    def come() -> list[bytes]:
        answers = [*mine, *others()]
        mine.clear()
        return answers

    return come


def of(domain: Domain) -> Statistics:
    """The statistics of a domain in this process."""
    with domain.lock:
        if domain.statistics is None:
            domain.statistics = Statistics(domain)
        return domain.statistics


def _readers(topics: Iterable[Topic]) -> list[Reader]:
    return [each for topic in topics for each in topic.readers if not each.is_remote]


def _of_writer(writer: Writer) -> dict[str, Any]:
    return {
        "node": writer.node.full_name,
        "topic": writer.topic,
        "gid": writer.gid.hex(),
        "published": writer.last_number,
    }


def _of_reader(reader: Reader) -> dict[str, Any]:
    return {
        "node": reader.node.full_name,
        "topic": reader.topic,
        "gid": reader.gid.hex(),
        "waiting": reader.unread,
        "depth": reader.qos.queue_length or 0,
        "lost": reader.message_lost.total,
        "overwritten": reader.overwritten,
    }


def _program() -> str:
    """The name of the program without its arguments, which may be nobody's business."""
    path = Path(sys.argv[0] if sys.argv else "")
    return (path.parent.name if path.name == "__main__.py" else path.stem) or "python"
