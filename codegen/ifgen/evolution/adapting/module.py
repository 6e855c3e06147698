"""The text of a module of adapters: functions from steps, and what is registered."""

from __future__ import annotations

import json
from collections.abc import Iterator

from ifgen.definition.interfaces import Message
from ifgen.definition.names import attribute_name
from ifgen.evolution.adapting.class_names import ClassNames
from ifgen.evolution.adapting.steps import PARAMETERS, Function, Functions, Step
from ifgen.evolution.adapting.versions import TwoVersions
from ifgen.evolution.edits import Versions
from ifgen.generator_py.adapters.context import (
    AdapterModule,
    FunctionText,
    LostText,
    RegistrationText,
    ValueText,
)

_WIDTH = 88


def adapter_module(versions: TwoVersions, parts: list[Versions], functions: Functions) -> AdapterModule:
    """The contents of the module."""
    names = ClassNames(versions)
    texts = tuple(_function(function, names) for function in functions)
    registrations = tuple(_registrations(versions, parts, functions, names))
    for name in ("Adapter", "register"):
        names.runtime(name)
    name = versions.new.type_name
    return AdapterModule(
        title=f"Converts `{name}` of another version: written once by `ifgen adapt`, yours now.",
        origin=versions.origin,
        old_hash=versions.old_hashes.of(versions.old),
        new_hash=versions.new_hashes.of(versions.new),
        imports=names.imports,
        functions=texts,
        registrations=registrations,
        is_open=any(function.is_open for function in functions),
    )


def part_name(versions: TwoVersions, part: Message) -> str:
    """`request` for the request of a service; empty for a message."""
    return part.name.removeprefix(versions.new.name).lstrip("_").lower()


def _function(function: Function, names: ClassNames) -> FunctionText:
    is_upgrade = function.direction == "upgrade"
    parameter = PARAMETERS[function.direction]
    source = names.of(function.source, is_old=is_upgrade)
    target = names.of(function.target, is_old=not is_upgrade)
    head = f"def {function.name}({parameter}: {source}) -> {target}:"
    if len(head) > _WIDTH:
        head = f"def {function.name}(\n    {parameter}: {source},\n) -> {target}:"
    lost = tuple(
        LostText(
            f"{parameter}.{attribute_name(field)}",
            _text(f"`{parameter}.{field.name}` has no field here: use it, or delete this call"),
        )
        for field in function.lost
    )
    if lost:
        names.runtime("lost")
    if any(step.question for step in function.steps):
        names.runtime("undecided")
    return FunctionText(
        head=head,
        docstring=f"Make a message of the {'new' if is_upgrade else 'old'} version.",
        result=target,
        lost=lost,
        values=tuple(_value(step, "was" if is_upgrade else "now") for step in function.steps),
    )


def _value(step: Step, when: str) -> ValueText:
    name = attribute_name(step.target)
    if step.question:
        return ValueText(name, "", "", _text(step.question))
    if step.conversion is None:
        return ValueText(name, step.default, "only this version has it", "")
    assert step.source is not None
    note = f"{when} `{step.source.name}`" if step.source.name != step.target.name else ""
    return ValueText(name, step.conversion.text, note, "")


def _registrations(
    versions: TwoVersions, parts: list[Versions], functions: Functions, names: ClassNames
) -> Iterator[RegistrationText]:
    for part in parts:
        upgrade = functions.get("upgrade", part.old, part.new)
        downgrade = functions.get("downgrade", part.old, part.new)
        is_message = part.old is versions.old
        if upgrade is None:  # a part that is the same, of a service or an action that differs
            names.runtime("unchanged")
        arguments = [
            ("old", names.of(part.old, is_old=upgrade is not None)),
            ("new", names.of(part.new, is_old=False)),
            ("upgrade", "unchanged" if upgrade is None else upgrade.name),
        ]
        if downgrade is not None or upgrade is None:
            arguments.append(("downgrade", "unchanged" if downgrade is None else downgrade.name))
        arguments.append(("new_hash", f'"{versions.new_hashes.of(part.new)}"'))
        if not is_message:
            arguments.append(("within", f'"{versions.old_hashes.of(versions.old)}"'))
        yield RegistrationText(tuple(arguments))


def _text(question: str) -> str:
    """A question as a Python string."""
    return json.dumps(question, ensure_ascii=False)
