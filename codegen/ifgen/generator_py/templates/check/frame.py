"""The knowledge at one place of a template: names, and conditions about them.

Inside `{% if module.action %}` that is not none.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Final, Protocol, TypeAlias

from jinja2 import nodes

from ifgen.generator_py.templates.check.syntax import Block, Template
from ifgen.generator_py.templates.check.types import ANYTHING, NOTHING, Type, without_none


@dataclass
class Frame:
    """The names in sight and what conditions say about them.

    `names` are all names, `context` those that blocks see. `facts` are the types of names and attributes,
    such as `module.action`, that are known better inside an `{% if %}`. `blocks` are the definitions of each
    block, the one that counts first, and `block` is the one that this place is in, as its name and number.
    `sure` is false where what stands here may not be reached.
    """

    template: Template
    names: dict[str, Type]
    context: dict[str, Type]
    blocks: Mapping[str, list[Block]] = field(default_factory=dict[str, list[Block]])
    block: tuple[str, int] | None = None
    facts: Mapping[str, Type] = field(default_factory=dict[str, Type])
    toplevel: bool = True
    sure: bool = True

    def inside(self, facts: Mapping[str, Type] | None = None) -> Frame:
        """A place that may not be reached, whose assignments stay in it."""
        known = {**self.facts, **(facts or {})}
        return replace(self, names=dict(self.names), facts=known, toplevel=False, sure=False)

    def assign(self, name: str, type_: Type) -> None:
        """Note that a name has a new value."""
        self.names[name] = type_
        if self.toplevel:
            self.context[name] = type_
        self.facts = {
            path: fact
            for path, fact in self.facts.items()
            if path != name and not path.startswith(f"{name}.")
        }


@dataclass(frozen=True, eq=False)
class Macro:
    """A macro, and the place where it is defined."""

    node: nodes.Macro
    frame: Frame


def path_of(node: nodes.Node) -> str | None:
    """`a.b.c` for a name or its attributes, None for other expressions."""
    match node:
        case nodes.Name(name=name):
            return str(name)
        case nodes.Getattr(node=of, attr=name):
            start = path_of(of)
            return None if start is None else f"{start}.{name}"
        case _:
            return None


Facts: TypeAlias = Mapping[str, Type]

_OF_CLASSES: Final = frozenset(
    ("string", "number", "mapping", "sequence", "iterable", "boolean", "integer", "float", "callable")
)
"""Tests after which a value may be of any type."""


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
        case _ if name in _OF_CLASSES:
            return {path: ANYTHING}, {path: ANYTHING}
        case _:
            return {}, {}


def _something(node: nodes.Node, frame: Frame, typer: Typer) -> Facts:
    path = path_of(node)
    type_ = typer.type_of(node, frame, lenient=True)
    better = without_none(type_)
    return {} if path is None or better == type_ else {path: better}
