"""What can be wrong with an interface before its first line: where its file is and what it is called."""

from __future__ import annotations

import re
from typing import Final

from ifgen.definition import names
from ifgen.diagnostics import Diagnostic, Label, Source, Span
from ifgen.read import InterfaceFile

_KINDS: Final = {"msg": "message", "srv": "service", "action": "action"}
_PYTHON_CONSTANTS: Final = frozenset({"None", "True", "False"})


def check_file(file: InterfaceFile, source: Source) -> list[Diagnostic]:
    """What is wrong with a file's name and its folder."""
    start = Label(Span(source, 0, 0))
    found: list[Diagnostic] = []
    if file.folder != file.kind:
        found.append(
            Diagnostic(
                "wrong-folder",
                f"{file.path.name} is in a folder named {file.folder}",
                start,
                help=f"move it to a folder named {file.kind}: a {_KINDS[file.kind]} is looked for there only",
            )
        )
    if not names.is_interface_name(file.name, file.kind):
        camel = "".join(word[:1].upper() + word[1:] for word in re.split(r"[^A-Za-z0-9]+", file.name))
        hint = f"did you mean {camel}.{file.kind}? " if names.is_interface_name(camel, file.kind) else ""
        found.append(
            Diagnostic(
                "invalid-file-name",
                f"'{file.name}' is not a valid name for {_article(_KINDS[file.kind])}",
                start,
                help=f"{hint}The file's name is the type's: a capital letter, then letters and digits",
            )
        )
    elif file.name in _PYTHON_CONSTANTS:
        found.append(
            Diagnostic(
                "keyword-name",
                f"no Python class can be called '{file.name}'",
                start,
                help="rename the file; rosidl's class cannot be imported",
            )
        )
    return found


def same_module(type_name: str, other: str, source: Source, first: Source | None) -> Diagnostic:
    """Say that two interfaces would be written to the same Python module."""
    module = names.module_name(type_name.rpartition("/")[2])
    return Diagnostic(
        "same-module",
        f"{type_name} and {other} would both be the Python module _{module}",
        Label(Span(source, 0, 0)),
        (Label(Span(first, 0, 0), "the other one"),) if first else (),
        "rename one of them",
    )


def duplicate_type(type_name: str, source: Source, first: Source | None) -> Diagnostic:
    """Say that two files define the same type."""
    return Diagnostic(
        "duplicate-type",
        f"{type_name} is defined twice",
        Label(Span(source, 0, 0), "defined again"),
        (Label(Span(first, 0, 0), "first defined here"),) if first else (),
        "rename one of them, or leave one of the two folders out",
    )


def _article(noun: str) -> str:
    return f"an {noun}" if noun[0] in "aeiou" else f"a {noun}"
