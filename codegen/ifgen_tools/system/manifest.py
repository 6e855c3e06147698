"""The manifest `ifgen.system.lock`: nodes, their endpoints after renaming, hashes, QoS and versions."""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping
from dataclasses import asdict, dataclass, field, replace
from pathlib import Path
from typing import Any, Final, NoReturn, cast, get_args

from ifgen.diagnostics import Diagnostic, InputError, Label, Source, Span, shorten
from ifgen.nodl.endpoints import DURATIONS, POLICIES
from ifgen.nodl.model import Category, QosProfile, Terms
from ifgen.reading.storage import read_source

from ifgen_tools.system.model import Endpoint, NodeInstance, System

NAME: Final = "ifgen.system.lock"
VERSION: Final = 1
_KEYS: Final = ("category", "name", "type", "hash", "qos", "version")


@dataclass(frozen=True, slots=True)
class Manifest:
    """The offers and needs of a system: its nodes, with their endpoints but those that all nodes have.

    A node without a document is an open end, and has none. `source` is the file, if it was read from one.
    """

    nodes: tuple[NodeInstance, ...]
    open_ends: tuple[str, ...] = ()
    source: Source | None = field(default=None, compare=False, repr=False)

    @property
    def endpoints(self) -> tuple[Endpoint, ...]:
        """The endpoints of all nodes."""
        return tuple(end for node in self.nodes for end in node.endpoints)


def of_system(system: System) -> Manifest:
    """The manifest of a system."""
    nodes = [
        NodeInstance(
            node.name,
            node.package,
            node.executable,
            endpoints=tuple(
                _plain(end) for end in sorted(node.endpoints, key=_order) if not end.is_of_framework
            ),
            span=node.span,
        )
        for node in system.nodes
    ]
    return Manifest(
        tuple(sorted(nodes, key=lambda node: node.name)),
        tuple(sorted(node.name for node in system.open_ends)),
    )


def text(manifest: Manifest) -> str:
    """The text of a manifest: an endpoint a line, sorted."""
    lines = ["{", f'  "version": {VERSION},', f'  "open_ends": {json.dumps(list(manifest.open_ends))},']
    nodes = [_node_text(node) for node in manifest.nodes]
    lines += ['  "nodes": {', ",\n".join(nodes), "  }", "}"] if nodes else ['  "nodes": {}', "}"]
    return "\n".join(lines) + "\n"


def read(path: Path) -> Manifest:
    """Read a manifest. Raises InputError with the first mistake."""
    return parse(read_source(path))


def parse(source: Source) -> Manifest:
    """The manifest in a text. Raises InputError with the first mistake."""
    try:
        content = json.loads(source.text)
    except (ValueError, RecursionError) as error:
        at = getattr(error, "pos", 0)
        _fail(source, f"this is no JSON: {getattr(error, 'msg', 'too deep')}", at)
    version = cast("dict[str, Any]", content).get("version") if isinstance(content, dict) else None
    if isinstance(version, int) and not isinstance(version, bool) and version > VERSION:
        _fail(
            source,
            f"this manifest is of version {version}, and this ifgen reads {VERSION}",
            source.text.find('"version"'),
            "update ifgen",
        )
    top = _map(source, content, "a manifest", ("version", "open_ends", "nodes"))
    if version != VERSION or isinstance(version, bool):
        _fail(source, f"the version must be {VERSION}", source.text.find('"version"'))
    names = top["open_ends"]
    if not isinstance(names, list) or not all(isinstance(each, str) for each in names):
        _fail(source, "`open_ends` must be a list of names", source.text.find('"open_ends"'))
    if not isinstance(top["nodes"], dict):
        _fail(source, "`nodes` must be a map", source.text.find('"nodes"'))
    nodes = cast("dict[str, Any]", top["nodes"])
    found = tuple(_node(source, name, value) for name, value in nodes.items())
    return Manifest(found, tuple(cast("list[str]", names)), source)


def _plain(end: Endpoint) -> Endpoint:
    """An endpoint as the others see it, whatever its node calls it."""
    terms = Terms(version=end.terms.version, span=end.terms.span) if end.terms and end.terms.version else None
    return replace(end, written=end.name, expanded=end.name, remap=None, terms=terms)


def _order(endpoint: Endpoint) -> tuple[str, str, str]:
    return endpoint.category.value, endpoint.name, endpoint.type_name


def _node_text(node: NodeInstance) -> str:
    head = f'    {json.dumps(node.name)}: {{"package": {json.dumps(node.package)}, '
    head += f'"executable": {json.dumps(node.executable)}, "endpoints": ['
    ends = [f"      {json.dumps(_endpoint_json(end))}" for end in node.endpoints]
    return "\n".join([head, ",\n".join(ends), "    ]}"]) if ends else f"{head}]}}"


def _endpoint_json(end: Endpoint) -> dict[str, Any]:
    qos = None
    if end.qos is not None:
        qos = {key: value for key, value in asdict(end.qos).items() if key != "span" and value}
    return {
        "category": end.category.value,
        "name": end.name,
        "type": end.type_name,
        **({"hash": end.type_hash} if end.type_hash else {}),
        **({"qos": qos} if qos else {}),
        **({"version": end.terms.version} if end.terms and end.terms.version else {}),
    }


def _node(source: Source, name: str, value: Any) -> NodeInstance:
    start = max(source.text.find(json.dumps(name)), 0)
    fields = _map(source, value, f"the node `{shorten(name)}`", ("package", "executable", "endpoints"), start)
    package, executable = (_text(source, fields, key, start) for key in ("package", "executable"))
    if not isinstance(fields["endpoints"], list):
        _fail(source, f"the endpoints of `{shorten(name)}` must be a list", start)
    ends = tuple(_endpoint(source, name, each, start) for each in fields["endpoints"])
    return NodeInstance(name, package, executable, endpoints=ends, span=_line(source, start))


def _endpoint(source: Source, node: str, value: Any, start: int) -> Endpoint:
    what = f"an endpoint of `{shorten(node)}`"
    fields = _map(source, value, what, _KEYS, start, required=_KEYS[:3])
    texts = {key: _text(source, fields, key, start) for key in _KEYS if key != "qos" and key in fields}
    at = source.text.find(json.dumps(texts["name"]), start)
    at = max(at, start)
    if texts["category"] not in {each.value for each in Category}:
        _fail(source, f"`{shorten(texts['category'])}` is no kind of endpoint", at)
    version = texts.get("version", "")
    return Endpoint(
        node=node,
        category=Category(texts["category"]),
        written=texts["name"],
        expanded=texts["name"],
        name=texts["name"],
        type_name=texts["type"],
        type_hash=texts.get("hash", ""),
        qos=_qos(source, fields["qos"], at) if "qos" in fields else None,
        terms=Terms(version=version, span=_line(source, at)) if version else None,
        span=_line(source, at),
    )


def _qos(source: Source, value: Any, start: int) -> QosProfile:
    known = (*POLICIES, "depth", *DURATIONS)
    fields = _map(source, value, "a QoS profile", known, start, required=("history", "reliability"))
    for key, given in fields.items():
        allowed = get_args(POLICIES[key]) if key in POLICIES else ()
        is_number = isinstance(given, int) and not isinstance(given, bool) and given >= 0
        if given not in allowed if key in POLICIES else not is_number:
            _fail(source, f"`{key}` of a QoS profile cannot be {shorten(repr(given))}", start)
    return QosProfile(**fields)


def _map(
    source: Source,
    value: Any,
    what: str,
    known: Iterable[str],
    start: int = 0,
    required: Iterable[str] | None = None,
) -> dict[str, Any]:
    """A map with these keys. Raises InputError."""
    keys = tuple(known)
    if not isinstance(value, Mapping):
        _fail(source, f"{what} must be a map", start)
    fields = dict(cast("Mapping[str, Any]", value))
    for key in fields:
        if key not in keys:
            _fail(source, f"{what} has no key `{shorten(key)}`", start, f"it has {', '.join(keys)}")
    for key in keys if required is None else required:
        if key not in fields:
            _fail(source, f"{what} needs the key `{key}`", start)
    return fields


def _text(source: Source, fields: Mapping[str, Any], key: str, start: int) -> str:
    value = fields[key]
    if not isinstance(value, str):
        _fail(source, f"`{key}` must be a text", start)
    return value


def _line(source: Source, at: int) -> Span:
    end = source.text.find("\n", at)
    return Span(source, at, end if end >= 0 else len(source.text))


def _fail(source: Source, message: str, at: int, help: str | None = None) -> NoReturn:
    at = min(max(at, 0), len(source.text))
    advice = help or "`ifgen check --system FILE --lock` writes it again"
    raise InputError([Diagnostic("system-manifest", message, Label(_line(source, at)), help=advice)])
