"""Diagrams in Mermaid, which GitHub draws: the classes of a package, and the graph of nodes."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Final

from ifgen.generators import File, Generator, Option, Request, Response
from ifgen.model import Field, Message, Model, Package

_SENDERS: Final = ("publishers", "service_clients", "action_clients")
_ENTITIES: Final = {ord(c): f"#{ord(c)};" for c in "#;\"'<>{}[]()~`|&\\%"}


def generate(request: Request) -> Response:
    """A class diagram for each package with interfaces, and a flowchart of all nodes."""
    model, fenced = request.model, request.options["markdown"]
    files = [
        _file(package.name, f"classes of {package.name}", _classes(package, model), fenced)
        for package in model.packages
        if package.generate and any(interface.generate for interface in package.interfaces)
    ]
    if any(package.nodes for package in model.packages if package.generate):
        files.append(_file("nodes", "nodes", _nodes(model), fenced))
    return Response(tuple(files))


def _file(name: str, title: str, lines: Iterator[str], fenced: bool) -> File:
    text = "\n".join(lines) + "\n"
    if fenced:
        return File(f"{name}.md", f"# {title[:1].upper()}{title[1:]}\n\n```mermaid\n{text}```\n")
    return File(f"{name}.mmd", text)


def _classes(package: Package, model: Model) -> Iterator[str]:
    yield "classDiagram"
    own = [m for i in package.interfaces if i.generate for m in i.messages]
    names = {message.type_name for message in own}
    for message in own:
        yield f'    class {_id(message.type_name)}["{_text(message.type_name)}"] {{'
        yield from (
            f"        {_text(constant.name)} = {_text(constant.value)}" for constant in message.constants
        )
        yield from (f"        {_text(field.type.text)} {field.name}" for field in message.fields)
        yield "    }"
    others = {name for message in own for name in message.dependencies} - names
    for name in sorted(others):
        yield f'    class {_id(name)}["{_text(name)}"]'
    for message in own:
        for field in message.fields:
            yield from _relation(message, field)


def _relation(message: Message, field: Field) -> Iterator[str]:
    type_ = field.type
    if type_.message is not None:
        size = "1" if type_.array is None else "*"
        if type_.array is not None and type_.array.size is not None:
            size = f"{'0..' if type_.array.kind == 'bounded' else ''}{type_.array.size}"
        target = _id(type_.message.type_name)
        yield f'    {_id(message.type_name)} --> "{size}" {target} : {field.name}'


def _nodes(model: Model) -> Iterator[str]:
    yield "flowchart LR"
    nodes = [node for package in model.packages if package.generate for node in package.nodes]
    points = sorted({(end.full_name, end.type_name) for node in nodes for end in node.endpoints})
    numbers = {point: number for number, point in enumerate(points)}
    for node in nodes:
        yield f'    {node.package}__{node.name}["{_text(node.name)}"]'
    for (name, type_name), number in numbers.items():
        yield f'    point{number}(["{_text(name)}<br>{_text(type_name)}"])'
    for node in nodes:
        for end in node.endpoints:
            place, point = f"{node.package}__{node.name}", f"point{numbers[end.full_name, end.type_name]}"
            yield f"    {place} --> {point}" if end.category in _SENDERS else f"    {point} --> {place}"


def _id(type_name: str) -> str:
    return type_name.replace("/", "__")


def _text(text: str) -> str:
    """A text in a label: what Mermaid would read as syntax is written as entities."""
    return " ".join(text.split()).translate(_ENTITIES)


GENERATOR: Final = Generator(
    name="mermaid",
    version="1.0",
    description="diagrams in Mermaid: the messages of each package, and the graph of nodes",
    options=(Option("markdown", "boolean", True, "pages of Markdown, which GitHub draws; else .mmd files"),),
    generate=generate,
)
"""The generator, for the entry point."""
