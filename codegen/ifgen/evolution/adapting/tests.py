"""The tests of a module of adapters."""

from __future__ import annotations

from collections.abc import Iterator

from ifgen.definition.names import attribute_name
from ifgen.evolution.adapting.checks import check_name, checked, kept, kept_name
from ifgen.evolution.adapting.module import part_name
from ifgen.evolution.adapting.sample import Sample, is_too_large
from ifgen.evolution.adapting.steps import Function, Functions
from ifgen.evolution.adapting.versions import TwoVersions
from ifgen.evolution.edits import Versions
from ifgen.generator_py.adapters.context import AdapterCase, AdapterTests, CheckText
from ifgen.generator_py.adapters.frozen import OldStrategies
from ifgen.generator_py.imports import import_statement
from ifgen.generator_py.tests.strategies import Strategies, enclosed

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
