"""A site of interfaces and nodes in HTML, which works from a folder and without a network (docs/doc.md)."""

from __future__ import annotations

import json
import zlib
from collections.abc import Iterator
from pathlib import Path
from typing import Final

from ifgen.generators import File, Generator, Option, Output, Request, Response
from ifgen.model import Message, Model

_HERE: Final = Path(__file__).parent


def generate(request: Request) -> Response:
    """The index for the search on the pages, and the inventory that Sphinx of others reads."""
    entries = list(_entries(request.model))
    index = json.dumps(entries, ensure_ascii=False, separators=(",", ":"))
    title, version = request.options["title"], request.options["version"]
    return Response(
        (
            File("search-index.js", f"window.ifgenIndex = {index};\n"),
            File("objects.inv", _inventory(request.model, title, version)),
        )
    )


def _entries(model: Model) -> Iterator[tuple[str, str, str]]:
    """Name, address and kind of everything that has a place on the site."""
    for package in model.packages:
        if not package.generate:
            continue
        yield package.name, f"{package.name}/index.html", "package"
        for interface in package.interfaces:
            if not interface.generate:
                continue
            page = f"{package.name}/{interface.folder}/{interface.name}.html"
            yield interface.type_name, page, interface.kind
            for message in interface.messages:
                for member in _members(message):
                    place = f"{page}#{message.kind}-{member}"
                    yield f"{interface.name}.{member}", place, interface.type_name
        for node in package.nodes:
            page = f"{package.name}/nodes/{node.name}.html"
            yield node.name, page, "node"
            for endpoint in node.endpoints:
                yield endpoint.name, f"{page}#{endpoint.category}", f"of {node.name}"


def _members(message: Message) -> list[str]:
    """The names of the fields and constants of a message."""
    return [field.name for field in message.fields] + [constant.name for constant in message.constants]


def _inventory(model: Model, title: str, version: str) -> bytes:
    """An inventory of Sphinx, version 2: classes, attributes, and labels such as `std_msgs/msg/Header`."""
    lines: list[str] = []
    for package in model.packages:
        for interface in package.interfaces:
            if not interface.generate:
                continue
            page = f"{package.name}/{interface.folder}/{interface.name}.html"
            name = f"{package.name}.{interface.folder}.{interface.name}"
            lines.append(f"{name} py:class 1 {page} -")
            lines.append(f"{interface.type_name} std:label -1 {page} {interface.type_name}")
            for message in interface.messages:
                owner = (
                    name
                    if message.name == interface.name
                    else f"{package.name}.{interface.folder}.{message.name}"
                )
                lines += (
                    f"{owner}.{member} py:attribute 1 {page}#{message.kind}-{member} -"
                    for member in _members(message)
                )
    head = f"# Sphinx inventory version 2\n# Project: {title}\n# Version: {version}\n"
    kind = "# The remainder of this file is compressed using zlib.\n"
    text = "".join(f"{line}\n" for line in sorted(set(lines)))
    return (head + kind).encode() + zlib.compress(text.encode(), 9)


GENERATOR: Final = Generator(
    name="html",
    version="1.0",
    description="a site in HTML: a page for each package, interface and node, with search; see `ifgen doc`",
    options=(
        Option("title", "string", "Interfaces", "the title of the site"),
        Option("version", "string", "", "the version of what it describes"),
    ),
    templates=_HERE / "templates",
    filters=_HERE / "filters.py",
    outputs=(
        Output("style.css.j2", "style.css", "run"),
        Output("site.js.j2", "site.js", "run"),
        Output("index.html.j2", "index.html", "run"),
        Output("package.html.j2", "{package}/index.html", "package"),
        Output("interface.html.j2", "{package}/{folder}/{interface}.html", "interface"),
        Output("node.html.j2", "{package}/nodes/{node}.html", "node"),
    ),
    generate=generate,
)
"""The generator, for the entry point."""
