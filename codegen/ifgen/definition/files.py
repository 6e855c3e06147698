"""Mistakes in an interface before its first line: the place and the name of its file."""

from __future__ import annotations

import re
from typing import Final

from ifgen.definition import names
from ifgen.diagnostics import Diagnostic, Label, Source, Span
from ifgen.reading import storage
from ifgen.reading.packages import IDL, InterfaceFile, is_adapted

_KINDS: Final = {"msg": "message", "srv": "service", "action": "action"}
_PYTHON_CONSTANTS: Final = frozenset({"None", "True", "False"})


def check_file(file: InterfaceFile, source: Source) -> list[Diagnostic]:
    """The mistakes in a file's name and its folder."""
    start = Label(Span(source, 0, 0))
    found: list[Diagnostic] = []
    if file.folder != file.kind:
        found.append(
            Diagnostic(
                "wrong-folder",
                f"{file.path.name} is in a folder named {file.folder}",
                start,
                help=f"move it to a folder named {file.kind}, the only place for a {_KINDS[file.kind]}",
            )
        )
    if file.is_idl:
        return [*found, *_check_idl_name(file, start)]
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


def _check_idl_name(file: InterfaceFile, start: Label) -> list[Diagnostic]:
    """The mistake in the name of an .idl file, which is the name of a struct."""
    if names.is_idl_type_name(file.name):
        return []
    return [
        Diagnostic(
            "invalid-file-name",
            f"'{file.name}' is not a valid name for {_article(_KINDS[file.kind])}",
            start,
            help="The file's name is the type's: a capital letter, then letters, digits, underscores",
        )
    ]


def two_forms(file: InterfaceFile, source: Source) -> Diagnostic | None:
    """The mistake of two files for one interface: one is .idl, and was not made from the other."""
    twin = file.path.with_suffix(f".{file.kind}" if file.is_idl else IDL)
    idl = file.path if file.is_idl else twin
    if not storage.is_file(twin) or is_adapted(idl):
        return None
    other = f"{file.name}.{file.kind}"
    return Diagnostic(
        "two-files",
        f"{other} and {idl.name} define the same interface",
        Label(Span(source, 0, 0)),
        help=f"remove one of them: rosidl_adapter makes {idl.name} from {other}, and one of the two is lost",
    )


def same_module(type_name: str, other: str, source: Source, first: Source | None) -> Diagnostic:
    """Say that two interfaces would be written to the same Python module."""
    module = names.snake_case(type_name.rpartition("/")[2])
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
