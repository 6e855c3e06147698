"""The meaning of interfaces: every case of meanings/*.txt, printed line by line.

A case is a title (`====`), a file (`----` and its path), and its parts (`>>>>`): documentation in quotes, then each
constant and field with type, value, unit and documentation.
"""

from __future__ import annotations

from pathlib import Path

import pytest
from ifgen.definition import build
from ifgen.definition.interfaces import Action, Annotation, Interface, Message, Service
from ifgen.definition.problems import FileProblems
from ifgen.diagnostics import Source

from .conftest import Case, cases

MEANINGS = Path(__file__).parent / "meanings"


def show(path: str, text: str) -> str:
    """The parts of an interface, with a line for each element."""
    package, kind, name = Path(path).with_suffix("").parts
    problems = FileProblems(Source(Path(path), text))
    interface = build.interface(Source(Path(path), text), package, kind, name, problems)  # type: ignore[arg-type]
    assert not problems, problems.errors()
    return "".join(_part(part) for part in _parts(interface))


def _parts(interface: Interface) -> tuple[Message, ...]:
    match interface:
        case Message():
            return (interface,)
        case Service():
            return (interface.request, interface.response)
        case Action():
            return (interface.goal, interface.result, interface.feedback)


def _part(message: Message) -> str:
    lines = [f"{message.type_name} {message.documentation!r}{''.join(map(_annotation, message.annotations))}"]
    for constant in message.constants:
        lines.append(f"  {constant.name}: {constant.type} = {constant.value!r}{_extras(constant)}")
    for field in message.fields:
        value = "" if field.default_value is None else f" = {field.default_value!r}"
        lines.append(f"  {field.name}: {field.type}{value}{_extras(field)}")
    return "".join(f"{line}\n" for line in lines)


def _extras(definition: object) -> str:
    unit, documentation = getattr(definition, "unit"), getattr(definition, "documentation")  # noqa: B009
    annotations = "".join(map(_annotation, getattr(definition, "annotations")))  # noqa: B009
    said = (f" [{unit}]" if unit is not None else "") + (f" {documentation!r}" if documentation else "")
    return said + annotations


def _annotation(annotation: Annotation) -> str:
    parameters = "".join(f" {name}={value!r}" for name, value in annotation.parameters)
    value = "" if annotation.value is None else f" {annotation.value!r}"
    return f" @{annotation.name}{value}{parameters}"


@pytest.mark.parametrize(
    "case",
    [pytest.param(case, id=case.title) for path in sorted(MEANINGS.glob("*.txt")) for case in cases(path)],
)
def test_means(case: Case) -> None:
    """The file means what the case says."""
    ((path, text),) = case.files.items()
    assert show(path, text) == case.said
