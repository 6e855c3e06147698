"""Filters for the templates of the site: links, pictures, samples of messages, and who uses what."""

from __future__ import annotations

import html
import json
from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from ifgen.model import FieldType, Interface, Message, Model, Node, Package, Qos

_MOST_NESTED = 12
_ZERO: dict[str, Any] = {"bool": False, "int": 0, "float": 0.0, "byte": 0, "char": 0, "string": ""}


def escaped(text: object) -> str:
    """Text that is safe in HTML, also within quotes."""
    return html.escape(str(text))


def prose(text: str) -> str:
    """Documentation as paragraphs; an empty line divides them, and line breaks stay."""
    parts = [part.strip("\n") for part in text.split("\n\n") if part.strip()]
    return "".join(f"<p>{escaped(part)}</p>" for part in parts)


class _Index:
    """Questions about a whole model, answered once."""

    def __init__(self, model: Model) -> None:
        self.model = model
        self.messages = {message.type_name: message for message in model.types}
        self.pages: dict[str, str] = {}
        self.users: dict[str, list[Interface]] = {}
        self.nodes: dict[str, list[tuple[Node, str, str]]] = {}
        self.needs = {package.name: needed_packages(package) for package in model.packages}
        self.packages = {package.name for package in model.packages if package.generate}
        for package in model.packages:
            for interface in package.interfaces:
                if interface.generate:
                    self._add(interface)
            for node in package.nodes:
                for end in node.endpoints:
                    known = self.nodes.setdefault(end.type_name, [])
                    known.append((node, end.category.replace("_", " "), end.name))

    def _add(self, interface: Interface) -> None:
        page = f"{interface.package}/{interface.folder}/{interface.name}.html"
        self.pages |= dict.fromkeys((interface.type_name, *(m.type_name for m in interface.messages)), page)
        for used in interface.uses:
            self.users.setdefault(used.type_name, []).append(interface)


_LAST: list[_Index] = []
"""The index of the model of this run, which all pages ask."""


def _index(model: Model) -> _Index:
    if not _LAST or _LAST[0].model is not model:
        _LAST[:] = [_Index(model)]
    return _LAST[0]


def linked(type_name: str, model: Model, root: str, text: str | None = None) -> str:
    """The name of a type, with a link to its page if it has one."""
    shown = f"<code>{escaped(text or type_name)}</code>"
    page = _index(model).pages.get(type_name)
    return f'<a href="{root}{page}">{shown}</a>' if page else shown


def field_type(type_: FieldType, model: Model, root: str) -> str:
    """The type of a field, with a link if it is a message."""
    if type_.message is None:
        return f"<code>{escaped(type_.text)}</code>"
    return linked(type_.message.type_name, model, root, type_.text)


def users(interface: Interface, model: Model) -> list[Interface]:
    """The interfaces whose fields hold this one."""
    return _index(model).users.get(interface.type_name, [])


def nodes_with(interface: Interface, model: Model) -> list[tuple[Node, str, str]]:
    """The nodes that have endpoints of this type: node, list of NoDL, name."""
    return _index(model).nodes.get(interface.type_name, [])


def needed_packages(package: Package) -> list[str]:
    """The other packages whose messages a package holds or whose types its nodes use."""
    held = {used.package for of in package.interfaces for used in of.uses}
    held |= {end.type_name.partition("/")[0] for node in package.nodes for end in node.endpoints}
    return sorted(held - {package.name})


def dependants(package: Package, model: Model) -> list[str]:
    """The packages that need this one."""
    index = _index(model)
    return sorted(
        name for name, needs in index.needs.items() if package.name in needs and name in index.packages
    )


def has_page(package_name: str, model: Model) -> bool:
    """Whether a package has a page."""
    return package_name in _index(model).packages


def layout(message: Message) -> str:
    """The first bytes of a message on the wire as a picture, as far as they are the same in all messages."""
    steps = message.wire.steps
    if not steps or steps[0].kind != "run":
        return ""
    places: dict[str, list[int]] = {}
    for item in steps[0].items:
        if item.path:
            end = item.offset + item.size * (item.count or 1)
            known = places.setdefault(item.path[0], [item.offset, end])
            known[1] = end
    total = max((end for _, end in places.values()), default=0)
    whole = len(steps) == 1
    if not total or (len(places) == 1 and not whole):
        return ""
    words = f"{total} bytes" if whole else f"{total} bytes, then what has no fixed place"
    bars = "".join(_bar(name, start, end, total) for name, (start, end) in places.items())
    return (
        f'<figure><svg viewBox="0 0 640 46" role="img" aria-label="layout of {escaped(message.name)}">'
        f"{bars}</svg>"
        f"<figcaption>On the wire: {words}</figcaption></figure>"
    )


def _bar(name: str, start: int, end: int, total: int) -> str:
    left, width = 640 * start / total, max(640 * (end - start) / total - 1, 1)
    label = escaped(name) if width > 7 * len(name) else ""
    return (
        f"<g><title>{escaped(name)}: {end - start} bytes at offset {start}</title>"
        f'<rect x="{left:.1f}" y="0" width="{width:.1f}" height="26"/>'
        f'<text x="{left + 4:.1f}" y="17">{label}</text><text x="{left:.1f}" y="40">{start}</text></g>'
    )


def sample(message: Message, model: Model) -> str:
    """A message with default values as YAML in one line, as `ros2 topic pub` takes it."""
    return json.dumps(_sample(message.type_name, model, 0), ensure_ascii=False).replace('"', "'")


def _sample(type_name: str, model: Model, depth: int) -> Any:
    message = _index(model).messages.get(type_name)
    if message is None or depth > _MOST_NESTED:
        return {}
    return {field.name: _value(field, model, depth) for field in message.fields}


def _value(field: Any, model: Model, depth: int) -> Any:
    if field.default_elements is not None:
        return [value.value for value in field.default_elements]
    if field.default_value is not None:
        return field.default_value.value
    type_ = field.type
    one = _sample(type_.message.type_name, model, depth + 1) if type_.message else _ZERO.get(type_.base, 0)
    if type_.array is None:
        return one
    return [one] * type_.size if type_.size is not None and type_.size <= 9 else []


def qos_text(qos: Qos | None) -> str:
    """A QoS profile in a few words: `last 1, best effort`."""
    if qos is None:
        return "default"
    words = [f"last {qos.depth}" if qos.depth else qos.history, qos.reliability, qos.durability or ""]
    return ", ".join(word.lower().replace("_", " ") for word in words if word)


def graph(node: Node) -> str:
    """A node as a picture: what comes in on the left, what goes out on the right."""
    left = [*node.subscriptions, *node.service_servers, *node.action_servers]
    right = [*node.publishers, *node.service_clients, *node.action_clients]
    height = 34 * max(len(left), len(right), 1) + 10
    parts = [
        f'<rect class="node" x="250" y="5" width="140" height="{height - 10}" rx="8"/>',
        f'<text class="name" x="320" y="{height / 2 + 5:.0f}">{escaped(node.name)}</text>',
        *_ends(left, 0, 250),
        *_ends(right, 390, 640),
    ]
    opened = f'<svg class="graph" viewBox="0 0 640 {height}" role="img"'
    return f'{opened} aria-label="endpoints of {escaped(node.name)}">{"".join(parts)}</svg>'


def _ends(ends: list[Any], start: int, stop: int) -> Iterator[str]:
    for number, end in enumerate(ends):
        y = 34 * number + 26
        yield f'<path d="M{start} {y}H{stop - 6}l-5 -4m5 4l-5 4"/>'
        yield f'<text x="{start + 8}" y="{y - 5}">{escaped(end.name)}</text>'
