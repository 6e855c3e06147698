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
from ifgen.nodl.model import Category, Interface
from ifgen.nodl.syntax.tree import ListNode, MapNode, ScalarNode, source_text
from ifgen.nodl.yaml_lines import description_lines
from ifgen.reading.packages import NodeFile

_LOCAL = "local://"


def merged(loaded: Loaded, *, as_json: bool = False) -> str:
    """One document without includes and `codegen`, as YAML or JSON."""
    ends = loaded.whole.endpoints
    lists: dict[str, Any] = {
        category.value: tuple(end for end in ends if end.category is category) for category in Category
    }
    whole = replace(
        loaded.description,
        parameters=loaded.whole.parameters,
        reserved=Interface(),
        references=(),
        codegen=(),
        **lists,
    )
    text = "".join(f"{line}\n" for line in ("nodl_version: 2", *description_lines(whole)))
    if not as_json:
        return text
    return json.dumps(yaml.safe_load(text), indent=2, ensure_ascii=False) + "\n"


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
