"""The tests of a module of adapters, with a message in which no field has its default.

Its bytes are made here, not by a generated codec, so that a test of these classes has something to compare.
"""

from __future__ import annotations

import struct
from collections.abc import Callable, Iterator
from math import prod
from typing import Final

from ifgen.definition.interfaces import Field, Message, Registry
from ifgen.definition.names import attribute_name
from ifgen.definition.types import (
    Array,
    BasicType,
    BoundedSequence,
    BoundedString,
    BoundedWString,
    CollectionType,
    FieldType,
    NamespacedType,
    UnboundedSequence,
    UnboundedString,
    UnboundedWString,
)
from ifgen.evolution.adapting.module import part_name
from ifgen.evolution.adapting.steps import PARAMETERS, Function, Functions, Step, TwoVersions
from ifgen.evolution.edits import Versions
from ifgen.generator_py.adapters import AdapterCase, AdapterTests, CheckText, OldStrategies
from ifgen.generator_py.imports import import_statement
from ifgen.generator_py.messages.fields import is_float32
from ifgen.generator_py.tests.strategies import Strategies, enclosed
from ifgen.wire.program import NUMBERS

_DIGITS = 80
"""Hexadecimal digits in a line."""


def adapter_tests(
    versions: TwoVersions, parts: list[Versions], functions: Functions, module: str
) -> AdapterTests | None:
    """The contents of the tests of `module`; None if the messages are too large to be tried."""
    differing = [part for part in parts if functions.get("upgrade", part.old, part.new)]
    for part in differing:
        large = is_too_large(part.old, versions.old_registry), is_too_large(part.new, versions.new_registry)
        if any(large):
            return None
    old, new = OldStrategies(versions.old_registry, versions.facts), Strategies(versions.new_registry)
    cases = tuple(_case(versions, part, functions, old, new) for part in differing)
    return AdapterTests(
        title=f"Tests of {module}: written once by `ifgen adapt`, yours now.",
        module=module,
        imports=tuple(sorted({*old.imports, *new.imports})),
        own_import=import_statement(".", sorted(old.frozen)),
        values=tuple({**dict(old.values), **dict(new.values)}.items()),
        strategies=tuple({**dict(old.messages), **dict(new.messages)}.items()),
        checks=tuple(_checks(functions)),
        cases=cases,
    )


def _checks(functions: Functions) -> Iterator[CheckText]:
    for function in functions:
        yield checked(function)
        if function.direction == "downgrade" and (check := kept(function, functions)) is not None:
            yield check


def _case(
    versions: TwoVersions, part: Versions, functions: Functions, old: OldStrategies, new: Strategies
) -> AdapterCase:
    upgrade = functions.get("upgrade", part.old, part.new)
    downgrade = functions.get("downgrade", part.old, part.new)
    assert upgrade is not None
    sample = Sample(part.old, versions.old_registry, old.message_class)
    digits = sample.data.hex()
    return AdapterCase(
        name=(part_name(versions, part.new) or "message").upper(),
        title="An old message in which no field has its default, and the bytes that it becomes.",
        old=old.message_class(part.old),
        new=new.message_class(part.new),
        old_hash=versions.old_hashes.of(part.old),
        upgrade=upgrade.name,
        check=check_name(upgrade),
        downgrade=downgrade.name if downgrade else "",
        check_downgrade=check_name(downgrade) if downgrade else "",
        kept=kept_name(downgrade) if downgrade else "",
        populated=sample.text,
        recorded=tuple(f'"{digits[at : at + _DIGITS]}"' for at in range(0, len(digits), _DIGITS)),
        fields=enclosed("[", _set_fields(upgrade, sample), "]", len("FIELDS_MESSAGE: list[str] = ")),
        old_messages=old.message(part.old),
        new_messages=new.message(part.new),
    )


def _set_fields(upgrade: Function, sample: Sample) -> Iterator[str]:
    """The fields that do not have their defaults after a populated message was converted."""
    for step in upgrade.steps:
        if step.question or step.conversion is None or step.source is None:
            continue
        if sample.values[step.source.name] != repr(step.target.default_value):
            yield f'"{attribute_name(step.target)}"'


def checked(function: Function) -> CheckText:
    """The check that a message has the values of the other that it was made of."""
    made, given = _other(function), PARAMETERS[function.direction]
    statements = [line for step in function.steps for line in _statements(step, made, given)]
    head = f"def {check_name(function)}({given}: Any, {made}: Any) -> None:"
    return CheckText(head, f"`{made}` has the values of `{given}`.", tuple(statements))


def check_name(function: Function) -> str:
    """The function of the test for a function of the module."""
    return f"check_{function.name.lstrip('_')}"


def kept_name(function: Function) -> str:
    """The function of the test for what is left of a message after `downgrade` and `upgrade`."""
    return f"check_kept_by_{function.name.lstrip('_')}"


def kept(downgrade: Function, functions: Functions) -> CheckText | None:
    """The check that `upgrade` after `downgrade` keeps what both versions have; None without `upgrade`."""
    upgrade = functions.get("upgrade", downgrade.target, downgrade.source)
    if upgrade is None:
        return None
    sources = {step.target.name: step for step in downgrade.steps}
    statements: list[str] = []
    for step in upgrade.steps:
        back = sources.get(step.source.name) if step.source else None
        if step.conversion is None or step.question or back is None or back.question:
            continue
        if back.conversion is None or back.source is None or back.source.name != step.target.name:
            continue
        statements += _kept(step, back, functions)
    head = f"def {kept_name(downgrade)}(kept: Any, new: Any) -> None:"
    return CheckText(head, "`kept` has what both versions can say of `new`.", tuple(statements))


def _other(function: Function) -> str:
    return "new" if function.direction == "upgrade" else "old"


def _statements(step: Step, made: str, given: str) -> Iterator[str]:
    value = f"{made}.{attribute_name(step.target)}"
    is_list = isinstance(step.target.type, CollectionType)
    if step.question:
        yield f"# {value} is yours to decide: say here what it should be."
    elif step.conversion is None:
        if is_list and (step.default == "[]" or is_float32(step.target.type)):
            yield f"assert len({value}) == len({step.default})"
        else:
            yield f"assert {f'list({value})' if is_list else value} == {step.default}"
    elif not step.conversion.function:
        text = step.conversion.text
        text = f"list({text})" if is_list and not text.startswith("[") else text
        yield f"assert list({value}) == {text}" if is_list else f"assert {value} == {text}"
    else:
        assert step.source is not None
        source = f"{given}.{attribute_name(step.source)}"
        check = f"check_{step.conversion.function.lstrip('_')}"
        if step.conversion.is_each:
            yield f"for one, other in zip({source}, {value}, strict=True):"
            yield f"    {check}(one, other)"
        else:
            yield f"{check}({source}, {value}{'[0]' if step.conversion.is_wrapped else ''})"


def _kept(step: Step, back: Step, functions: Functions) -> Iterator[str]:
    name = attribute_name(step.target)
    assert step.conversion is not None and back.conversion is not None
    if not step.conversion.function and not back.conversion.function:
        is_list = isinstance(step.target.type, CollectionType)
        yield (
            f"assert list(kept.{name}) == list(new.{name})"
            if is_list
            else f"assert kept.{name} == new.{name}"
        )
    elif step.conversion.function and back.conversion.function:
        check = kept_name(functions.named(back.conversion.function))
        if isinstance(step.target.type, CollectionType):
            yield f"for one, other in zip(kept.{name}, new.{name}, strict=True):"
            yield f"    {check}(one, other)"
        else:
            yield f"{check}(kept.{name}, new.{name})"


_HEADER: Final = b"\0\1\0\0"  # CDR, little endian
_MOST: Final = 2_000
"""Values in a sample: nobody reads a longer one."""


class Sample:
    """A populated message. `text` makes it, `data` are its bytes, and `values` those of its own fields."""

    def __init__(self, message: Message, registry: Registry, class_name: Callable[[Message], str]) -> None:
        self._registry = registry
        self._class_name = class_name
        self._body = bytearray()
        self._count = 0
        self.values: dict[str, str] = {}
        self._message(message, self.values)
        arguments = [f"{attribute_name(field)}={self.values[field.name]}" for field in message.fields]
        self.text = enclosed(f"{class_name(message)}(", arguments, ")", len("POPULATED_MESSAGE = "))
        self.data = _HEADER + bytes(self._body)

    def _message(self, message: Message, values: dict[str, str] | None = None) -> str:
        found = {} if values is None else values
        for field in message.fields:
            found[field.name] = self._field(field)
        if not message.fields:
            self._body.append(0)
        arguments = (f"{attribute_name(field)}={found[field.name]}" for field in message.fields)
        return f"{self._class_name(message)}({', '.join(arguments)})"

    def _field(self, field: Field) -> str:
        match field.type:
            case Array(element, size):
                return self._elements(element, size, field)
            case BoundedSequence(element, bound):
                self._number("I", min(bound, 2))
                return self._elements(element, min(bound, 2), field)
            case UnboundedSequence(element):
                self._number("I", 2)
                return self._elements(element, 2, field)
            case type_:
                self._count += 1
                return self._value(type_, self._count, field.default_value)

    def _elements(self, type_: FieldType, size: int, field: Field) -> str:
        """A list: of different elements if it is short, else of the same ones."""
        if size <= 3:
            first = self._count
            self._count += size
            return f"[{', '.join(self._value(type_, first + 1 + index, None) for index in range(size))}]"
        self._count += 1
        texts = [self._value(type_, self._count, None) for _ in range(size)]
        if isinstance(type_, NamespacedType):
            return f"[{', '.join(texts)}]"
        return f"[{texts[0]}] * {size}"

    def _value(self, type_: FieldType, count: int, default: object) -> str:
        match type_:
            case NamespacedType():
                return self._message(self._registry.message(type_.type_name))
            case BasicType("boolean"):
                self._body.append(default is not True)
                return repr(default is not True)
            case BasicType("octet"):
                self._body.append(count % 100 + 1)
                return repr(bytes([count % 100 + 1]))
            case BasicType("char"):
                self._body.append(97 + count % 26)
                return f'"{chr(97 + count % 26)}"'
            case BasicType(name):
                return self._numeric(name, count, default)
            case UnboundedString() | BoundedString():
                text = f"text {count}"[: type_.maximum_size if isinstance(type_, BoundedString) else None]
                self._number("I", len(text) + 1)
                self._body += text.encode() + b"\0"
                return f'"{text}"'
            case UnboundedWString() | BoundedWString():
                text = f"text {count}"[: type_.maximum_size if isinstance(type_, BoundedWString) else None]
                self._number("I", len(text))
                for character in text:
                    self._number("I", ord(character))
                return f'"{text}"'
            case _:
                raise AssertionError(type_)

    def _numeric(self, name: str, count: int, default: object) -> str:
        number = count % 100 + 1
        offset = {"float": 0.5, "double": 0.1}.get(name, 0)
        value = number + offset if number + offset != default else number + 1 + offset
        self._number(NUMBERS[name].format, value)  # type: ignore[index]  # what is left is a number
        return repr(value)

    def _number(self, format: str, value: float) -> None:
        size = struct.calcsize(format)
        self._body += bytes(-len(self._body) % size) + struct.pack(f"<{format}", value)


def is_too_large(message: Message, registry: Registry) -> bool:
    """Whether a message, by its arrays, has more values than a sample should."""
    return _size(message, registry, {}) > _MOST


def _size(message: Message, registry: Registry, known: dict[str, int]) -> int:
    name = message.type_name
    if name not in known:
        known[name] = 1 + sum(_values(field.type, registry, known) for field in message.fields)
    return known[name]


def _values(type_: FieldType, registry: Registry, known: dict[str, int]) -> int:
    element = type_.value_type if isinstance(type_, CollectionType) else type_
    size = type_.size if isinstance(type_, Array) else 2 if isinstance(type_, CollectionType) else 1
    inner = (
        _size(registry.message(element.type_name), registry, known)
        if isinstance(element, NamespacedType)
        else 1
    )
    return prod((size, inner))
