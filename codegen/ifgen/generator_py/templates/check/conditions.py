"""Knowledge from conditions about names: inside `{% if module.action %}` that is not none."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Protocol, TypeAlias

from jinja2 import nodes

from ifgen.generator_py.templates.check.frame import Frame, path_of
from ifgen.generator_py.templates.check.types import ANYTHING, NOTHING, Type, without_none

Facts: TypeAlias = Mapping[str, Type]


class Typer(Protocol):
    """Whoever knows the types of expressions."""

    def type_of(self, node: nodes.Node, frame: Frame, *, lenient: bool = False) -> Type:
        """The type of an expression."""
        ...


def facts_of(condition: nodes.Node, frame: Frame, typer: Typer) -> tuple[Facts, Facts]:
    """The knowledge if the condition is true, and if it is false."""
    match condition:
        case nodes.Name() | nodes.Getattr():
            return _something(condition, frame, typer), {}
        case nodes.Not(node=negated):
            yes, no = facts_of(negated, frame, typer)
            return no, yes
        case nodes.And(left=left, right=right):
            first, _ = facts_of(left, frame, typer)
            second, _ = facts_of(right, frame.inside(first), typer)
            return {**first, **second}, {}
        case nodes.Or(left=left, right=right):
            _, first = facts_of(left, frame, typer)
            _, second = facts_of(right, frame.inside(first), typer)
            return {}, {**first, **second}
        case nodes.Test(node=tested, name=str() as name):
            return _tested(tested, name, frame, typer)
        case nodes.Compare(
            expr=left, ops=[nodes.Operand(op="eq" | "ne" as way, expr=nodes.Const(value=None))]
        ):
            yes, no = _tested(left, "none", frame, typer)
            return (yes, no) if way == "eq" else (no, yes)
        case _:
            return {}, {}


def _tested(tested: nodes.Node, name: str, frame: Frame, typer: Typer) -> tuple[Facts, Facts]:
    path = path_of(tested)
    if path is None:
        return {}, {}
    match name:
        case "none":
            return {path: NOTHING}, _something(tested, frame, typer)
        case "defined":
            return {path: typer.type_of(tested, frame, lenient=True)}, {}
        case "undefined":
            return {}, {path: typer.type_of(tested, frame, lenient=True)}
        case (
            "string"
            | "number"
            | "mapping"
            | "sequence"
            | "iterable"
            | "boolean"
            | "integer"
            | "float"
            | "callable"
        ):
            return {path: ANYTHING}, {path: ANYTHING}
        case _:
            return {}, {}


def _something(node: nodes.Node, frame: Frame, typer: Typer) -> Facts:
    path = path_of(node)
    type_ = typer.type_of(node, frame, lenient=True)
    better = without_none(type_)
    return {} if path is None or better == type_ else {path: better}
