"""The steps of `ifgen.model` say exactly what goes over the wire: an interpreter of them writes the same bytes."""

from __future__ import annotations

import ctypes
import struct
from collections.abc import Iterator, Mapping, Sequence
from functools import cache
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from ifgen.model import Message, Model, Step
from ifgen.model.names import safe_name
from ifgen.pipeline.model import load_model
from ifgen_runtime import serialize

from .strategies import messages
from .support import OWN_INTERFACES, ROOT, Classes
from .test_round_trip import CORNERS

FORMATS = {
    **{"bool": "?", "int8": "b", "uint8": "B", "int16": "h", "uint16": "H", "int32": "i", "uint32": "I"},
    **{"int64": "q", "uint64": "Q", "float32": "f", "float64": "d"},
}


class Writer:
    """Runs the steps of messages. The rules are those of docs/model.md, and nothing else."""

    def __init__(self, types: Mapping[str, Message]) -> None:
        self.types = types
        self.data = bytearray()

    def run(self, steps: Sequence[Step], message: Any) -> None:
        for step in steps:
            self.pad(step.align, step.pad)
            value = at(message, step.path)
            match step.kind:
                case "run":
                    self.items(step, message)
                case "text":
                    self.text(value, step.wide)
                case "values":
                    self.count(value)
                    if len(value):
                        self.pad(step.element_align, step.element_pad)
                    for element in value:
                        self.data += packed(step.primitive, element)
                case "texts":
                    if step.count is None:
                        self.count(value)
                    for element in value:
                        self.pad(4, None)
                        self.text(element, step.wide)
                case "repeat":
                    if step.count is None:
                        self.count(value)
                    if len(value):
                        self.pad(step.element_align, step.element_pad)
                    for element in value:
                        start = len(self.data)
                        self.run(step.steps, element)
                        assert step.stride in {None, len(self.data) - start}
                case "call":
                    self.run(self.types[step.type_name or ""].wire.own, value)

    def pad(self, align: int, pad: int | None) -> None:
        needed = -len(self.data) % align
        assert pad in {None, needed}
        self.data += bytes(needed)

    def items(self, step: Step, message: Any) -> None:
        start = len(self.data)
        for item in step.items:
            self.data += bytes(start + item.offset - len(self.data))
            if item.placeholder:
                self.data.append(0)
                continue
            value = at(message, item.path)
            values = [value] if item.count is None else value
            assert len(values) == (item.count or 1)
            for each in values:
                written = packed(item.primitive, each)
                assert len(written) == item.size
                self.data += written
        assert len(self.data) == start + step.size

    def count(self, values: Sequence[object]) -> None:
        self.data += struct.pack("<I", len(values))

    def text(self, text: str, wide: bool) -> None:
        if wide:
            units = text.encode("utf-16-le")
            self.data += struct.pack("<I", len(units) // 2)
            self.data += b"".join(units[i : i + 2] + b"\0\0" for i in range(0, len(units), 2))
        else:
            data = text.encode() + b"\0"
            self.data += struct.pack("<I", len(data)) + data


def packed(primitive: str | None, value: Any) -> bytes:
    if primitive == "byte":
        return bytes(value)
    if primitive == "char":
        return bytes([ord(value)])
    return struct.pack(f"<{FORMATS[primitive or '']}", value)


def at(message: Any, path: Sequence[str]) -> Any:
    for name in path:
        message = getattr(message, safe_name(name, "python"))
    return message


@cache
def model() -> Model:
    return load_model(ROOT / "interfaces", OWN_INTERFACES)


@cache
def types() -> dict[str, Message]:
    return {message.type_name: message for message in model().types}


def check(message: Any, type_name: str) -> None:
    payload = serialize(message)[4:]
    wire = types()[type_name].wire
    for steps in (wire.steps, wire.own):
        writer = Writer(types())
        writer.run(steps, message)
        assert bytes(writer.data) == bytes(payload)
    assert wire.min_size <= len(payload) <= (wire.max_size or len(payload))
    if wire.fixed:
        assert wire.min_size == len(payload) == wire.max_size


@settings(max_examples=40)
@given(data=st.data())
@pytest.mark.parametrize("name", CORNERS)
def test_corners(classes: Classes, name: str, data: st.DataObject) -> None:
    check(data.draw(messages(classes[f"codec_msgs/msg/{name}"])), f"codec_msgs/msg/{name}")


def test_default_values_of_all_types(classes: Classes) -> None:
    for type_name, cls in classes.items():
        check(cls(), type_name)


def test_a_type_stands_after_those_that_it_needs() -> None:
    known: set[str] = set()
    for message in model().types:
        assert known.issuperset(message.dependencies)
        known.add(message.type_name)


C_TYPES = {
    **{"bool": ctypes.c_bool, "byte": ctypes.c_uint8, "char": ctypes.c_uint8, "int8": ctypes.c_int8},
    **{"uint8": ctypes.c_uint8, "int16": ctypes.c_int16, "uint16": ctypes.c_uint16, "int32": ctypes.c_int32},
    **{"uint32": ctypes.c_uint32, "int64": ctypes.c_int64, "uint64": ctypes.c_uint64},
    **{"float32": ctypes.c_float, "float64": ctypes.c_double},
}


@cache
def c_type(type_name: str) -> Any:
    """The C structure of a message, None if it has fields that C has no values for."""
    fields: list[tuple[str, Any]] = []
    for field in types()[type_name].fields:
        kind = field.type
        one = c_type(kind.message.type_name) if kind.message else C_TYPES.get(kind.primitive)
        if one is None or (kind.array is not None and kind.size is None):
            return None
        fields.append((field.name, one * kind.size if kind.size else one))
    return type("Structure", (ctypes.Structure,), {"_fields_": fields or [("placeholder", ctypes.c_uint8)]})


def leaves(structure: Any, at: int = 0) -> Iterator[tuple[int, int]]:
    """The offsets and sizes of the values of a C type, in order."""
    if hasattr(structure, "_fields_"):
        for name, of in structure._fields_:
            yield from leaves(of, at + getattr(structure, name).offset)
    elif hasattr(structure, "_length_"):
        for i in range(structure._length_):
            yield from leaves(structure._type_, at + i * ctypes.sizeof(structure._type_))
    else:
        yield at, ctypes.sizeof(structure)


class Layout(Writer):
    """Notes where values stand, and in how many bytes."""

    def __init__(self, types: Mapping[str, Message], start: int) -> None:
        super().__init__(types)
        self.data += bytes(start)
        self.found: list[tuple[int, int]] = []

    def items(self, step: Step, message: Any) -> None:
        start = len(self.data)
        super().items(step, message)
        for item in step.items:
            places = range(start + item.offset, len(self.data) + 1, item.size)
            self.found += [(place, item.size) for place in places[: item.count or 1]]


def test_plain_and_least_sizes_hold_wherever_a_message_starts(classes: Classes) -> None:
    plain = 0
    for type_name, cls in classes.items():
        wire, structure = types()[type_name].wire, c_type(type_name)
        for start in range(8):
            layout = Layout(types(), start)
            layout.run(wire.own, cls())
            assert len(layout.data) - start >= wire.min_element_size
            if structure is None:
                assert not wire.plain
                continue
            begin = start + -start % wire.start_align
            assert layout.found[0][0] == begin, "nothing but the first value decides where it starts"
            same = [(place - begin, size) for place, size in layout.found] == list(leaves(structure))
            same = same and len(layout.data) - begin == ctypes.sizeof(structure)
            if begin % wire.align == 0:
                assert wire.plain == same, (type_name, start)
            if wire.plain and wire.start_align == wire.align:
                assert same
            plain += wire.plain
    assert plain > 8 * 40


def test_plain_messages_are_those_that_c_lays_out_alike() -> None:
    plain = {name for name, message in types().items() if message.wire.plain}
    assert {"geometry_msgs/msg/Pose", "std_msgs/msg/Empty", "builtin_interfaces/msg/Time"} <= plain
    # A byte in the middle is fine, one at the end leaves C a gap that the wire does not have.
    assert "sensor_msgs/msg/Imu" not in plain
    assert "codec_msgs/msg/Tail" not in plain
