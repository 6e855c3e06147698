"""Filters for the templates in this folder: text that is safe in Markdown, in HTML and in Mermaid."""

from __future__ import annotations

import html
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from ifgen.model import Endpoint, Interface, Node, Package, Qos

_SENDERS = ("publishers", "service_clients", "action_clients")


def cell(text: str) -> str:
    """Text for a cell of a Markdown table, on one line."""
    escaped = "".join(f"\\{c}" if c in "\\`*_[]<>|#" else c for c in text)
    return " ".join(escaped.split())


def escaped(text: str) -> str:
    """Text for HTML, with its line breaks."""
    return html.escape(text)


def anchor(name: str) -> str:
    """The id of a heading: letters, digits and dashes."""
    return "".join(c if c.isalnum() else "-" for c in name)


def qos_text(qos: Qos | None) -> str:
    """A QoS profile in a few words: `last 1, best effort`."""
    if qos is None:
        return "default"
    history = f"last {qos.depth}" if qos.depth else qos.history
    words = [history, qos.reliability, *([qos.durability] if qos.durability else [])]
    words += [f"deadline {qos.deadline:g} s"] if qos.deadline else []
    return ", ".join(word.lower().replace("_", " ") for word in words)


def category(endpoint: Endpoint) -> str:
    """The kind of an endpoint: `service server`."""
    return endpoint.category.removesuffix("s").replace("_", " ")


def is_documented(type_name: str, packages: tuple[Package, ...]) -> bool:
    """Whether an interface is described in the reference."""
    return any(interface.type_name == type_name for interface in interfaces(packages))


def edges(packages: tuple[Package, ...]) -> list[tuple[str, str, str, str]]:
    """The graph: (kind, from, to, type), where a name that starts with `/` is a topic, service or action."""
    found: list[tuple[str, str, str, str]] = []
    for node in nodes(packages):
        for end in node.endpoints:
            kind = end.category.partition("_")[0].rstrip("s")
            pair = (node.name, end.full_name) if end.category in _SENDERS else (end.full_name, node.name)
            found.append((kind, *pair, end.type_name))
    return found


def meeting_points(packages: tuple[Package, ...]) -> dict[str, str]:
    """The topics, services and actions, and their types."""
    return {end.full_name: end.type_name for node in nodes(packages) for end in node.endpoints}


def nodes(packages: tuple[Package, ...]) -> list[Node]:
    """The nodes of all packages."""
    return [node for package in packages for node in package.nodes]


def interfaces(packages: tuple[Package, ...]) -> list[Interface]:
    """The interfaces of all packages."""
    return [interface for package in packages for interface in package.interfaces]


def users(interface: Interface, packages: tuple[Package, ...]) -> list[tuple[Node, Endpoint]]:
    """The nodes that use an interface, and the endpoints through which they do."""
    return [(n, e) for n in nodes(packages) for e in n.endpoints if e.type_name == interface.type_name]


def zipped(names: list[str], prefix: str) -> list[tuple[str, str]]:
    """The names, each with an identifier: `point1`, `point2` and so on."""
    return [(name, f"{prefix}{index}") for index, name in enumerate(names, 1)]
