"""The messages that nodes published in a replay, and differences from a recording or another replay."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from os import PathLike
from pathlib import Path
from typing import Any, NamedTuple

from ifgen_runtime import deserialize
from ifgen_runtime.bag import Bag, Recorder

from ifgen_pytest.comparison import counted, differences

_SHOWN = 10  # fields of a message that differ


class Output(NamedTuple):
    """A message that a node published: the virtual time [ns since 1970], the topic, the serialised form."""

    time: int
    topic: str
    data: bytes


@dataclass(frozen=True)
class Replayed:
    """The messages that nodes published in a replay. Two are equal if every time, topic and byte is."""

    path: Path = field(compare=False)
    """The bag that was replayed."""
    outputs: tuple[Output, ...]
    """Everything, in the order in which it was published."""
    classes: dict[str, type[Any]] = field(compare=False, repr=False)
    """The message class of each topic."""

    def __getitem__(self, topic: str) -> list[Any]:
        """The messages that were published on a topic, none if there is no such topic."""
        return [self._message(output) for output in self.outputs if output.topic == topic]

    def save(self, path: str | PathLike[str]) -> None:
        """Write a bag of what was published, in place of what is there."""
        with Recorder(path, overwrite=True) as recorder:
            for topic, cls in self.classes.items():
                recorder.add_topic(topic, cls)
            for output in self.outputs:
                recorder.write_serialized(output.topic, output.data, output.time)

    def expect_recorded(self, *topics: str) -> None:
        """Fail unless the same messages are in the bag, byte by byte, on each of these topics.

        Without `topics`, on all that the bag and the nodes both have. Times are not compared: the real world
        has other ones.
        """
        __tracebackhide__ = True
        with Bag(self.path) as bag:
            compared = topics or [topic for topic in self.classes if topic in bag]
            if not compared:
                published = ", ".join(self.classes) or "nothing"
                raise AssertionError(f"{self.path} has nothing of what the nodes published: {published}")
            lines: list[str] = []
            for topic in compared:
                mine = [output for output in self.outputs if output.topic == topic]
                recorded = [Output(each.received, topic, each.data) for each in bag.recorded(topic)]
                lines += self._compared(topic, mine, recorded)
        if lines:
            raise AssertionError("\n".join([f"published now != recorded in {self.path}", *lines]))

    def differences(self, other: Replayed) -> Iterator[str]:
        """The differences from another replay: a line for each topic, and lines for its first message."""
        for topic in dict.fromkeys([*self.classes, *other.classes]):
            mine, theirs = ([each for each in one.outputs if each.topic == topic] for one in (self, other))
            found = self._compared(topic, mine, theirs)
            yield from found
            if not found:
                for index, (left, right) in enumerate(zip(mine, theirs, strict=True)):
                    if left.time != right.time:
                        yield f"{topic}: message {index} was published at {left.time} ns != {right.time} ns"
                        break

    def _compared(self, topic: str, mine: Sequence[Output], theirs: Sequence[Output]) -> list[str]:
        lines: list[str] = []
        for index, (left, right) in enumerate(zip(mine, theirs, strict=False)):
            if left.data != right.data:
                lines.append(f"{topic}: message {index} of {len(mine)} is the first that differs")
                lines += [f"  {line}" for line in self._fields(left, right)]
                break
        if len(mine) != len(theirs):
            lines.append(f"{topic}: {counted(len(mine), 'message')} != {counted(len(theirs), 'message')}")
        return lines

    def _fields(self, left: Output, right: Output) -> list[str]:
        found = list(differences("", self._message(left), self._message(right)))
        shown = found[:_SHOWN] or ["no field differs, only bytes between them or inside of NaN"]
        return shown if len(found) <= _SHOWN else [*shown, f"and {len(found) - _SHOWN} more"]

    def _message(self, output: Output) -> Any:
        return deserialize(output.data, self.classes[output.topic])
