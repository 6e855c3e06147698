"""Completion: types in definitions, keys and values in node descriptions."""

from __future__ import annotations

import re
from collections.abc import Iterator
from functools import lru_cache
from typing import Any, Final, cast

from lsprotocol.types import (
    Command,
    CompletionItem,
    CompletionItemKind,
    InsertTextFormat,
)

from ifgen.definition.spelling import PRIMITIVES
from ifgen.diagnostics import Source
from ifgen.language_server.workspace import Workspace
from ifgen.reading.package_files import node_name
from ifgen.reading.packages import PackageFiles

DECLARE: Final = "ifgen.declareDependency"
"""The command that adds a package to package.xml and CMakeLists.txt, after a type of it was completed."""

_WORD: Final = re.compile(r"[A-Za-z0-9_/:]*$")
_KEY: Final = re.compile(r"^(?P<indent>[ ]*)(?P<dash>- )?(?:(?P<key>[\w/~.-]+):)?")
_PRIMITIVES: Final = tuple(name for name in PRIMITIVES if name not in {"byte", "char"})


def completions(workspace: Workspace, source: Source, line: str, above: list[str]) -> list[CompletionItem]:
    """The items that fit at the end of `line`, a line up to the cursor, below the lines above it."""
    if node_name(source.path.name) is not None:
        return list(_in_document(workspace, line, above))
    if source.path.suffix == ".idl" or "#" in line or not re.fullmatch(r"(@optional +)?[\w/:]*", line):
        return []
    package = workspace.package_of(source.path)
    return list(_types(workspace, package, source))


def _types(workspace: Workspace, package: PackageFiles | None, source: Source) -> Iterator[CompletionItem]:
    """The types that a field can have: those of the own package first."""
    for name in _PRIMITIVES:
        yield CompletionItem(name, kind=CompletionItemKind.Keyword, sort_text=f"1{name}")
    if package is not None:
        for name in package.names("msg"):
            if name != source.path.stem:
                yield CompletionItem(name, kind=CompletionItemKind.Class, sort_text=f"0{name}")
    declared = _declared(package)
    for other, name in _messages(workspace):
        if package is not None and other == package.name:
            continue
        item = CompletionItem(
            f"{other}/{name}",
            kind=CompletionItemKind.Class,
            filter_text=f"{other}/{name} {name}",
            sort_text=f"2{other}/{name}",
        )
        if name == "Header":
            item.insert_text, item.insert_text_format = f"{other}/{name} header$0", InsertTextFormat.Snippet
        if declared is not None and other not in declared:
            item.detail = "adds the dependency"
            item.command = Command(f"depend on {other}", DECLARE, arguments=[source.path.as_uri(), other])
        yield item


def _messages(workspace: Workspace) -> Iterator[tuple[str, str]]:
    search = workspace.search()
    for name in search.package_names():
        package = search.package(name)
        if package is not None:
            yield from ((name, each) for each in package.names("msg"))


def _declared(package: PackageFiles | None) -> frozenset[str] | None:
    """The packages that a package depends on; None if it has no package.xml."""
    if package is None or package.xml is None:
        return None
    return package.xml.dependencies


def _in_document(workspace: Workspace, line: str, above: list[str]) -> Iterator[CompletionItem]:
    """Keys, values and types in a node description in YAML."""
    path = _path(line, above)
    key = re.match(r"^ *(?:- )?(?P<key>[\w-]+): *(?P<value>[\w/]*)$", line)
    if key is not None:
        if key["key"] == "type" and path and path[0] != "parameters":
            yield from _endpoint_types(workspace, path[0])
            return
        found = _schema_at([*path, key["key"]])
        for value in _values(found):
            yield CompletionItem(value, kind=CompletionItemKind.EnumMember)
        return
    if not re.match(r"^ *(?:- )?\w*$", line):
        return
    found = _schema_at(path)
    properties: dict[str, dict[str, Any]] = found.get("properties", {})
    for name, schema in properties.items():
        yield CompletionItem(
            name,
            kind=CompletionItemKind.Property,
            insert_text=f"{name}: ",
            documentation=schema.get("description"),
        )


def _endpoint_types(workspace: Workspace, category: str) -> Iterator[CompletionItem]:
    folder = {"service": "srv", "action": "action"}.get(category.partition("_")[0], "msg")
    search = workspace.search()
    for name in search.package_names():
        package = search.package(name)
        for each in package.names(folder) if package is not None else ():
            yield CompletionItem(f"{name}/{folder}/{each}", kind=CompletionItemKind.Class)


def _path(line: str, above: list[str]) -> list[str]:
    """The keys around a line, outermost first."""
    match = _KEY.match(line)
    assert match is not None
    indent = len(match["indent"]) + (2 if match["dash"] else 0)
    path: list[str] = []
    for earlier in reversed(above):
        found = _KEY.match(earlier)
        if found is None or not earlier.strip() or earlier.lstrip().startswith("#"):
            continue
        own = len(found["indent"]) + (2 if found["dash"] else 0)
        # A list may stand in the column of its key.
        is_around = own < indent or (own == indent - 2 and not found["dash"] and bool(match["dash"]))
        if found["key"] and is_around:
            path.insert(0, found["key"])
            indent = len(found["indent"])
    return path


@lru_cache(maxsize=1)
def _schema() -> dict[str, Any]:
    from ifgen.nodl.schema import schema  # with pydantic, for who writes node descriptions

    return schema()


def _schema_at(path: list[str]) -> dict[str, Any]:
    """The schema of a value below these keys; empty if there is none."""
    found: dict[str, Any] = _schema()
    for key in path:
        found = _resolved(found)
        properties: dict[str, Any] = found.get("properties", {})
        below: object = properties.get(key, found.get("additionalProperties", {}))
        found = cast("dict[str, Any]", below) if isinstance(below, dict) else {}
    return _resolved(found)


def _resolved(schema: dict[str, Any]) -> dict[str, Any]:
    """A schema with its reference followed, or that of the elements of a list."""
    while True:
        if "$ref" in schema:
            schema = _schema()["definitions"][schema["$ref"].rpartition("/")[2]]
        elif "items" in schema:
            schema = schema["items"]
        else:
            listed: list[dict[str, Any]] = schema.get("anyOf", [])
            options = [each for each in listed if each.get("type") != "null"]
            if len(options) != 1:
                return schema
            schema = options[0]


def _values(schema: dict[str, Any]) -> Iterator[str]:
    if schema.get("type") == "boolean":
        yield from ("true", "false")
    for value in schema.get("enum", []):
        yield str(value)
    if "const" in schema:
        yield str(schema["const"])
    for option in schema.get("anyOf", []):
        yield from _values(_resolved(option))
