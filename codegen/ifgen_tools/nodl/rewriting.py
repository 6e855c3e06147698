"""Copies of documents: with other references, or with everything that they include."""

from __future__ import annotations

import json
from collections.abc import Iterable, Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import yaml
from ifgen.definition.problems import FileProblems
from ifgen.diagnostics import Diagnostic, InputError, Label
from ifgen.nodl import document
from ifgen.nodl.load import Loaded
from ifgen.nodl.model import Category, Interface, Parameter
from ifgen.nodl.syntax.tree import Foreign, ListNode, MapNode, Node, ScalarNode, source_text
from ifgen.nodl.yaml_lines import description_lines
from ifgen.reading.packages import NodeFile

from ifgen_tools.nodl import document as output

_LOCAL = "local://"


def merged(loaded: Loaded, *, as_json: bool = False) -> str:
    """One document without includes and `codegen`, as YAML or JSON.

    It says what its documents say, as they say it: a default that has not its parameter's type stays.
    """
    found: dict[str, Any] = {"nodl_version": document.VERSION}
    if loaded.description.description:
        found["description"] = loaded.description.description
    parameters: dict[str, Any] = {}
    lists: dict[str, list[Any]] = {category.value: [] for category in Category}
    for root in (each.root for each in loaded.documents):
        written = root.get("parameters") if root else None
        parameters.update(_plain(written) if written else {})
        for name, endpoints in lists.items():
            endpoints.extend(_plain(node) if root and (node := root.get(name)) else ())
    for parameter in loaded.whole.parameters:
        if parameter.name not in parameters:
            parameters.update(_expanded(parameter, loaded))
        default = parameter.default
        if default is not None:
            value = list(default) if isinstance(default, tuple | bytes) else default
            parameters[parameter.name]["default_value"] = value
    found.update({name: value for name, value in {"parameters": parameters, **lists}.items() if value})
    return output.as_json(found, []) if as_json else output.as_yaml(found, [])


def _plain(node: Node) -> Any:
    """A node as Python's own values; what JSON lacks, such as a date, as it is written."""
    match node:
        case ScalarNode(Foreign()):
            return source_text(node)
        case ScalarNode(value):
            return value
        case ListNode(items):
            return [_plain(item) for item in items]
        case MapNode(entries):
            return {key.name: _plain(value) for key, value in entries}


def _expanded(parameter: Parameter, loaded: Loaded) -> dict[str, Any]:
    """A parameter that `codegen.ifgen` expands, which no document writes out."""
    lists: dict[str, Any] = {category.value: () for category in Category}
    alone = replace(
        loaded.description,
        description="",
        parameters=(parameter,),
        reserved=Interface(),
        references=(),
        codegen=(),
        **lists,
    )
    return dict(yaml.safe_load("\n".join(description_lines(alone)))["parameters"])


def rewritten(path: Path, replaced: Iterable[tuple[str, str]]) -> str:
    """The text of a document with other references: all else stays as it is.

    Raises InputError if a `local://` is left, or if the file is no document.
    """
    source = NodeFile(path.absolute()).read()
    problems = FileProblems(source)
    root = document.parse(source, problems)
    if problems or root is None:
        raise InputError(problems.errors())
    known = {_key(old, path): new for old, new in replaced}
    text, left = source.text, []
    for node in reversed(list(_references(root))):
        reference = str(node.value)
        new = known.get(_key(reference, path), reference)
        if new.startswith(_LOCAL):
            left.append(
                Diagnostic("local-reference", f"`{reference}` is not replaced", Label(node.span), help=_HELP)
            )
        written = source_text(node)
        is_quoted = written[:1] in "\"'" or not set(new).isdisjoint("[]{},#&*!|>%@`")
        quoted = new if not is_quoted else json.dumps(new)
        text = text[: node.span.start] + quoted + text[node.span.end :]
    if left:
        raise InputError(reversed(left))
    return text


_HELP = "an installed document cannot name files: write `-r local://FILE:=nodl://PACKAGE/NAME`"


def _references(root: object) -> Iterator[ScalarNode]:
    includes = root.get("include") if isinstance(root, MapNode) else None
    for item in includes.items if isinstance(includes, ListNode) else ():
        reference = item.get("ref") if isinstance(item, MapNode) else None
        if isinstance(reference, ScalarNode):
            yield reference


def _key(reference: str, path: Path) -> str:
    """A reference that is the same for all spellings of a file."""
    if not reference.startswith(_LOCAL):
        return reference
    return f"{_LOCAL}{(path.absolute().parent / reference.removeprefix(_LOCAL)).resolve()}"
