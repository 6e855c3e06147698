"""Messages with random values of every type, and a testee asked about them in batches.

The codec of our message classes writes the payloads; tests compare it with real rosidl. A reader of its own
returns the canonical text of a payload. A testee that agrees with both reads and writes what ROS does.
"""

from __future__ import annotations

import random
import struct
from collections.abc import Iterator
from dataclasses import dataclass
from fnmatch import fnmatchcase
from typing import Any, Final

from ifgen.definition.interfaces import Message, Registry
from ifgen.dynamic.making import make
from ifgen_runtime import serialize
from ifgen_runtime.field_types import Basic, Field, Text, fields_of, type_name

from ifgen_tools.conformance.canonical import CanonicalText
from ifgen_tools.conformance.testee import Reply, Request, Testee

_LETTERS: Final = "abcxyz019_/é€𝄞"
_BATCH: Final = 200  # messages: enough that no side waits for the other, and few to ask again after a crash

# -- values


def random_message(source: random.Random, cls: type[Any], depth: int = 0) -> Any:
    """A message with random values; the deeper, the shorter its sequences."""
    message = cls()
    for field in fields_of(cls):
        most = min(3 if depth == 0 else 1 if depth < 3 else 0, 3 if field.maximum is None else field.maximum)
        fill(source, message, field, source.randint(0, most), depth)
    return message


def fill(source: random.Random, message: Any, field: Field, count: int, depth: int = 0) -> None:
    """Give a field of a message a random value, with the given number of elements if it is a sequence."""
    value = (
        [_value(source, field, depth) for _ in range(count if field.is_sequence else field.size or 0)]
        if field.is_collection
        else _value(source, field, depth)
    )
    setattr(message, field.attribute, value)


def _value(source: random.Random, field: Field, depth: int) -> Any:
    """A value or an element of a field."""
    if isinstance(field.type, Basic):
        return _number(source, field.type)
    if isinstance(field.type, Text):
        return _text(source, field.type)
    return random_message(source, field.type, depth + 1)


def _text(source: random.Random, type_: Text) -> str:
    """A text within its bound."""
    most = 5 if type_.maximum is None else min(5, type_.maximum)
    value = "".join(source.choice(_LETTERS) for _ in range(source.randrange(most + 1)))
    encoding = "utf-16-le" if type_.wide else "utf-8"
    while type_.maximum is not None and len(value.encode(encoding)) > type_.maximum:
        value = value[:-1]
    return value


def _number(source: random.Random, basic: Basic) -> Any:
    """A number of any size, sometimes one of the extremes."""
    if basic.name == "boolean":
        return source.random() < 0.5
    if basic.is_float:
        value = source.choice(
            [0.0, -0.0, 1.0, source.uniform(-1e3, 1e3), source.uniform(-1, 1) * 1e30, float("inf")]
        )
        return struct.unpack("<f", struct.pack("<f", value))[0] if basic.size == 4 else value
    if basic.name in ("octet", "char"):
        return bytes([source.randrange(256)]) if basic.name == "octet" else chr(source.randrange(256))
    low, high = basic.range
    return source.choice(
        [low, high, source.randint(low, high), source.randint(max(low, -100), min(high, 100))]
    )


# -- a testee


def message_classes(registry: Registry, only: tuple[str, ...] = ()) -> Iterator[tuple[str, type[Any]]]:
    """The names and classes of messages, also of parts of services, whose `random/NAME` fits `only`."""
    for interface in sorted(registry, key=lambda interface: interface.type_name):
        messages = (interface,) if isinstance(interface, Message) else interface.messages
        names = {message.type_name for message in messages}
        if only:
            names = {name for name in names if any(fnmatchcase(f"random/{name}", each) for each in only)}
        if names:  # making a class takes time
            classes = dict(_classes_in(make(interface, registry)))
            yield from ((name, classes[name]) for name in sorted(names))


def _classes_in(cls: type[Any]) -> Iterator[tuple[str, type[Any]]]:
    if hasattr(cls, "_fields_and_field_types"):
        yield type_name(cls), cls
        return
    for name, value in vars(cls).items():
        if isinstance(value, type) and not name.startswith("__"):
            yield from _classes_in(value)


@dataclass(slots=True)
class Comparison:
    """The counts of a run over random messages. A testee may skip types and operations."""

    messages: int = 0
    types: int = 0
    skipped: int = 0
    bytes_differ: int = 0
    values_differ: int = 0

    @property
    def is_right(self) -> bool:
        """Whether something was compared, and nothing differed."""
        return self.messages > 0 and not self.bytes_differ and not self.values_differ

    @property
    def line(self) -> str:
        """The counts in one line."""
        counts = f"{self.messages:,} messages of {self.types:,} types"
        skipped = f", {self.skipped:,} types skipped" if self.skipped else ""
        return f"{counts}: {self.bytes_differ:,} differ in bytes, {self.values_differ:,} in values{skipped}"

    def check(self, request: Request, expected: str, reply: Reply) -> Iterator[str]:
        """Count a reply; yield a sentence if it is wrong."""
        if reply.text == f"ok {expected}".rstrip() or reply.verdict == "skip":
            return
        self.bytes_differ += request.op == "load"
        self.values_differ += request.op != "load"
        asked = " ".join((request.op, request.type_name, *request.arguments))
        yield f"{asked}: expected {expected}, got {reply.text}"


def compare(
    testee: Testee, registry: Registry, count: int, only: tuple[str, ...], result: Comparison
) -> Iterator[str]:
    """Ask a testee for `count` random messages of each type; yield a sentence for each difference."""
    lacks = testee.hello().get("skip", "").split(",")
    for name, cls in message_classes(registry, only):
        source, left = random.Random(f"{name} {count}"), count
        while left > 0:
            asked = list(_questions(source, registry, name, cls, min(_BATCH, left)))
            asked = [(request, expected) for request, expected in asked if request.op not in lacks]
            replies = testee.ask_all([request for request, _ in asked])
            if not replies or replies[0] == Reply("skip", "unknown-type"):
                break
            for (request, expected), reply in zip(asked, replies, strict=True):
                yield from result.check(request, expected, reply)
            left -= _BATCH
        result.messages += count if left <= 0 else 0
        result.types += left <= 0
        result.skipped += left > 0


def _questions(
    source: random.Random, registry: Registry, name: str, cls: type[Any], count: int
) -> Iterator[tuple[Request, str]]:
    """Requests and right replies: each message is written, read, and compared with itself or another."""
    before: tuple[Any, str] | None = None
    for _ in range(count):
        message = random_message(source, cls)
        data = bytes(serialize(message))
        payload, text = data.hex(), CanonicalText(registry, name, data).text
        yield Request("load", name, (text,)), payload
        yield Request("dump", name, (payload,)), text
        other = before or (message, payload)
        yield Request("equal", name, (payload, other[1])), str(int(message == other[0]))
        before = None if before else (message, payload)
