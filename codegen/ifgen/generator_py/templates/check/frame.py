"""The knowledge at one place of a template."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import TypeAlias

from jinja2 import nodes

from ifgen.generator_py.templates.check.syntax import Template
from ifgen.generator_py.templates.check.types import Type

Block: TypeAlias = tuple[Template, nodes.Block]


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
