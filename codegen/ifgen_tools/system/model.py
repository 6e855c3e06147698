"""A system of nodes: what each of them offers and needs once it is started, and where that is written.

All values are frozen. Equality ignores places. A node is one of a launch file with its NoDL document, or one
that runs.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Literal, TypeAlias

from ifgen.diagnostics import Diagnostic, Span
from ifgen.nodl.model import Category, NodeDescription, QosProfile, Terms
from ifgen.nodl.syntax.tree import Node as Tree

NodeKind: TypeAlias = Literal["process", "component", "container", "transforms", "running"]
"""A node with a process of its own, one in a container, a container, a publisher of static transforms, or one
that was seen running. Containers and publishers of transforms need no document."""


@dataclass(frozen=True, slots=True)
class Remap:
    """A remapping `old:=new` as a launch file says it; `is_global` for those of `SetRemap`."""

    old: str
    new: str
    is_global: bool = False
    span: Span | None = field(default=None, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class Endpoint:
    """A node's end of a topic, a service or an action.

    `written` is the name in the document, `expanded` that name within the node's namespace, and `name` the
    one after remapping, which the others meet. `type_hash` is empty where the definition cannot be found.
    `is_of_framework` is true for what every node, or every managed one, has. `span` is a place in the
    document, `remap` the remapping that made `name`.
    """

    node: str
    category: Category
    written: str
    expanded: str
    name: str
    type_name: str
    type_hash: str = ""
    qos: QosProfile | None = None
    terms: Terms | None = None
    is_of_framework: bool = False
    remap: Remap | None = field(default=None, compare=False)
    span: Span | None = field(default=None, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class Parameter:
    """A value that a node gets at its start; the last one of a name counts.

    `value` is None where it is known only when the launch runs. `span` is a place in a launch file or in a
    parameter file; `section` is the key of that file which stands for the node.
    """

    name: str
    value: Tree | None
    section: str = ""
    span: Span | None = field(default=None, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class NodeInstance:
    """A node under its full name, such as `/robot/arm`.

    `description` is None for an open end: a node without a document. `span` is the place in the launch file
    that starts it, `problem` says why it cannot start. `is_managed` is true if the launch file configures it,
    by `autostart` or by a transition.
    """

    name: str
    package: str
    executable: str
    kind: NodeKind = "process"
    description: NodeDescription | None = None
    endpoints: tuple[Endpoint, ...] = ()
    parameters: tuple[Parameter, ...] = ()
    remaps: tuple[Remap, ...] = ()
    arguments: tuple[str, ...] = ()
    is_managed: bool = False
    problem: Diagnostic | None = field(default=None, compare=False, repr=False)
    span: Span | None = field(default=None, compare=False, repr=False)

    @property
    def namespace(self) -> str:
        """The namespace: `/robot`, or `/`."""
        return self.name.rpartition("/")[0] or "/"

    @property
    def is_open(self) -> bool:
        """Whether nobody says what it offers and needs."""
        return self.description is None and self.kind in {"process", "component"}

    def value(self, name: str) -> Parameter | None:
        """The parameter that counts, of those of this name; None if nothing sets it."""
        return next((each for each in reversed(self.parameters) if each.name == name), None)


@dataclass(frozen=True, slots=True)
class Command:
    """A program that is no node: its words, and its place in the launch file."""

    words: tuple[str, ...]
    span: Span | None = field(default=None, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class Section:
    """A part of a parameter file that is for the nodes that match `pattern`; `receivers` get the file."""

    pattern: str
    receivers: tuple[str, ...]
    span: Span | None = field(default=None, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class System:
    """Nodes, in the order of their start, and the other programs of the launch files.

    `sections` are those of all parameter files.
    """

    nodes: tuple[NodeInstance, ...] = ()
    commands: tuple[Command, ...] = ()
    sections: tuple[Section, ...] = ()

    @property
    def endpoints(self) -> tuple[Endpoint, ...]:
        """The endpoints of all nodes."""
        return tuple(each for node in self.nodes for each in node.endpoints)

    @property
    def open_ends(self) -> tuple[NodeInstance, ...]:
        """The nodes without a document."""
        return tuple(node for node in self.nodes if node.is_open)

    def ends(self, name: str, *categories: Category) -> Iterator[Endpoint]:
        """The endpoints of these kinds that a topic, a service or an action has."""
        return (each for each in self.endpoints if each.name == name and each.category in categories)

    def node(self, name: str) -> NodeInstance | None:
        """The first node of this full name; None if there is none."""
        return next((node for node in self.nodes if node.name == name), None)
