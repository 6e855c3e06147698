"""The XML of NoDL 0.3 (`<interface version="1">`) as documents of NoDL 2."""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

from ifgen.definition.explain import did_you_mean
from ifgen.diagnostics import Diagnostic, InputError, Label, Source, Span
from ifgen.nodl import names, values
from ifgen.nodl.model import Category
from ifgen.reading.storage import read_source

from ifgen_tools.nodl.document import Inline, as_yaml

if TYPE_CHECKING:
    from xml.etree.ElementTree import Element

_LISTS: Final = {
    "topic": {"publisher": Category.PUBLISHER, "subscription": Category.SUBSCRIPTION},
    "service": {"server": Category.SERVICE_SERVER, "client": Category.SERVICE_CLIENT},
    "action": {"server": Category.ACTION_SERVER, "client": Category.ACTION_CLIENT},
}
_TYPES: Final = {
    **{name: name for name in (*values.SCALARS, *values.ARRAYS)},
    "integer": "int",
    "float": "double",
    "boolean": "bool",
    "str": "string",
    **{f"{name}[]": f"{name}_array" for name in ("bool", "int", "double", "string", "byte")},
}
_DURATIONS: Final = {
    "deadline": "deadline_ns",
    "lifespan": "lifespan_ns",
    "liveliness_lease_duration": "liveliness_lease_duration_ns",
}
_DEFAULT: Final = {"history": "KEEP_LAST", "depth": 10, "reliability": "RELIABLE"}
_NO_ENTITIES: Final = re.compile(r"<!(DOCTYPE|ENTITY)", re.IGNORECASE)


def migrated(path: Path) -> dict[str, str]:
    """The YAML of each node of a file, by the names of the nodes. Raises InputError."""
    source = read_source(path)
    root = _parsed(source)
    if root.tag != "interface" or root.get("version") != "1":
        raise _error(source, 'this is not `<interface version="1">`, the XML of NoDL 0.3')
    found: dict[str, str] = {}
    for node in root:
        name = node.get("name", "")
        if node.tag != "node" or not name:
            raise _error(source, f"`<{node.tag}>` is no node with a name", f"<{node.tag}")
        if problem := names.node_name_problem(name):
            raise _error(source, f"'{name}' {problem.message}", f'"{name}"')
        if name in found:
            raise _error(source, f"there are two nodes named '{name}'", f'"{name}"')
        found[name] = _document(node, source)
    return found


def _parsed(source: Source) -> Element:
    from xml.etree import ElementTree  # slow to import, and seldom needed

    if entity := _NO_ENTITIES.search(source.text):
        raise _error(source, "a NoDL document has no DOCTYPE and no entities", entity[0])
    try:
        return ElementTree.fromstring(source.text)
    except ElementTree.ParseError as error:
        line, column = error.position
        start = sum(len(text) + 1 for text in source.text.split("\n")[: line - 1]) + column
        start = min(start, len(source.text))
        raise InputError(
            [Diagnostic("xml-syntax", f"this is not XML: {error}", Label(Span(source, start, start)))]
        ) from None


def _document(node: Element, source: Source) -> str:
    document: dict[str, Any] = {"nodl_version": 2}
    notes: list[str] = []
    if executable := node.get("executable"):
        document["description"] = f"The node of the executable {executable}."
    for element in node:
        name, type_ = element.get("name", ""), element.get("type", "")
        if element.tag == "parameter":
            _check_parameter(name, type_, source)
            document.setdefault("parameters", {})[name] = {"type": _TYPES[type_]}
        elif element.tag in _LISTS:
            for category in _roles(element, source):
                end = _endpoint(element, category, source, notes)
                document.setdefault(category.value, []).append(end)
        else:
            raise _error(source, f"`<{element.tag}>` does not belong into a node", f"<{element.tag}")
    order = ["nodl_version", "description", "parameters", *(category.value for category in Category)]
    ordered = {key: document[key] for key in order if key in document}
    return as_yaml(ordered, dict.fromkeys(notes), "to check")


def _check_parameter(name: str, type_: str, source: Source) -> None:
    if problem := names.parameter_name_problem(name):
        raise _error(source, f"`{name}` is not a valid name: {problem.message}", f'"{name}"')
    if type_ not in _TYPES:
        raise _error(
            source, f"`{type_}` is not a type of parameters", f'"{type_}"', did_you_mean(type_, _TYPES)
        )


def _roles(element: Element, source: Source) -> Iterator[Category]:
    """The lists that an element belongs to, by its role, or by the flags that came before roles."""
    lists = _LISTS[element.tag]
    role = element.get("role")
    chosen = [name for name in lists if role in {name, "both"} or element.get(name) == "true"]
    if not chosen:
        where = f'"{role}"' if role else f"<{element.tag}"
        message = f"the role of a {element.tag} is {', '.join(lists)} or both"
        raise _error(source, message, where)
    return (lists[name] for name in chosen)


def _endpoint(element: Element, category: Category, source: Source, notes: list[str]) -> dict[str, Any]:
    name, type_ = element.get("name", ""), element.get("type", "")
    if problem := names.endpoint_name_problem(name):
        raise _error(source, f"`{name}` is not a valid name: {problem.message}", f'"{name}"')
    parts = names.split_type(type_)
    if parts is None or parts[1] not in {None, category.folder}:
        advice = names.type_advice(type_, category.folder)
        raise _error(source, f"`{type_}` is no type of a {category.singular}", f'"{type_}"', advice)
    end: dict[str, Any] = {"name": name, "type": f"{parts[0]}/{category.folder}/{parts[2]}"}
    profile = element.find("qos_profile")
    if profile is not None and category.folder != "action":
        end["qos"] = _qos(profile, source)
    elif category.folder == "msg":
        end["qos"] = Inline(_DEFAULT)
        notes.append(f"the QoS of {category.singular} {name}, which NoDL 0.3 does not say")
    return end


def _qos(profile: Element, source: Source) -> Inline:
    found: dict[str, Any] = dict(_DEFAULT)
    for key, value in profile.items():
        if not value or key == "avoid_ros_namespace_conventions":
            continue
        try:
            if key in _DURATIONS:
                found[_DURATIONS[key]] = int(float(value) * 1e9)
            elif key == "depth":
                found[key] = max(1, int(value))
            else:
                found[key] = value.upper()
        except (ValueError, OverflowError):
            raise _error(source, f"`{value}` is no number for `{key}`", f'"{value}"') from None
    if found["history"] != "KEEP_LAST":
        del found["depth"]
    return Inline(found)


def _error(source: Source, message: str, text: str = "", help: str | None = None) -> InputError:
    """An error at the first place of a text in the file."""
    start = max(source.text.find(text), 0)
    return InputError(
        [Diagnostic("old-nodl", message, Label(Span(source, start, start + len(text))), help=help)]
    )
