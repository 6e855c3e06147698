"""The statements of a test that compares messages of two versions, from the steps between them."""

from __future__ import annotations

from collections.abc import Iterator

from ifgen.definition.names import attribute_name
from ifgen.definition.types import CollectionType
from ifgen.evolution.adapting.steps import PARAMETERS, Function, Functions, Step
from ifgen.generator_py.adapters.context import CheckText
from ifgen.generator_py.messages.fields import is_float32


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
