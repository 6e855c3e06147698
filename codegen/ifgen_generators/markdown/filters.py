"""Filters for the templates of this set: text that is safe in Markdown, links, and who uses what."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from ifgen.model import FieldType, Interface, Model, Qos


def cell(text: str) -> str:
    """Text for a paragraph or the cell of a table, on one line."""
    escaped = "".join(f"\\{c}" if c in "\\`*_[]<>|#" else c for c in text)
    return " ".join(escaped.split())


def code(text: str) -> str:
    """Text as code, in a cell of a table."""
    shown = " ".join(text.split()).replace("|", "\\|")
    fence = "``" if "`" in shown else "`"
    return f"{fence} {shown} {fence}" if "`" in shown else f"{fence}{shown}{fence}"


def anchor(interface: Interface) -> str:
    """The id of the heading of an interface."""
    return f"{interface.folder}-{interface.name}".lower()


def linked(type_: FieldType, model: Model) -> str:
    """The type of a field, with a link to its message if that has a page."""
    message = type_.message
    if message is not None:
        for package in model.packages:
            for interface in package.interfaces:
                if interface.generate and interface.type_name == message.type_name:
                    return f"[{code(type_.text)}]({package.name}.md#{anchor(interface)})"
    return code(type_.text)


def users(interface: Interface, model: Model) -> list[str]:
    """The interfaces and endpoints of nodes that use an interface, as links or names."""
    found = [
        f"[{cell(of.type_name)}]({of.package}.md#{anchor(of)})"
        for package in model.packages
        for of in package.interfaces
        if of.generate and any(used.type_name == interface.type_name for used in of.uses)
    ]
    for package in model.packages:
        for node in package.nodes:
            found += (
                f"[{cell(node.name)}](nodes/{node.package}.{node.name}.md) ({code(end.name)})"
                for end in node.endpoints
                if end.type_name == interface.type_name
            )
    return found


def qos_text(qos: Qos | None) -> str:
    """A QoS profile in a few words: `last 1, best effort`."""
    if qos is None:
        return "default"
    words = [f"last {qos.depth}" if qos.depth else qos.history, qos.reliability, qos.durability or ""]
    words += [f"deadline {qos.deadline:g} s"] if qos.deadline else []
    return ", ".join(word.lower().replace("_", " ") for word in words if word)
