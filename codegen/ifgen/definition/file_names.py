"""Mistakes in the names and the places of packages and files, whatever the files say.

ROS forbids some names, and Python or Windows uses others.
"""

from __future__ import annotations

import keyword
import re
import sys
from collections.abc import Iterator
from contextlib import suppress
from dataclasses import replace
from pathlib import Path
from typing import Final

from ifgen.definition import names
from ifgen.diagnostics import Diagnostic, InputError, Label, Source, Span
from ifgen.reading import storage
from ifgen.reading.packages import IDL, NODE_FOLDER, InterfaceFile, PackageFiles, is_adapted, node_name
from ifgen.reading.storage import read_source

_OF_OTHERS: Final = frozenset(
    (
        *("ifgen", "ifgen_native", "ifgen_pytest", "ifgen_runtime", "rclpy", "rmw_local", "rosidl_parser"),
        *("hypothesis", "launch", "launch_ros", "numpy", "pytest", "rclpy_asyncio", "setuptools"),
        *("typing_extensions", "xxhash", "yaml", "zenoh"),
    )
)
_OF_PYTHON: Final = """
__future__ abc annotationlib argparse array ast asyncio atexit base64 bdb binascii bisect builtins
bz2 calendar codecs collections compression concurrent contextlib contextvars copy copyreg csv
ctypes dataclasses datetime decimal difflib dis email encodings enum errno fcntl fnmatch fractions
functools gc genericpath getpass gettext glob grp gzip hashlib heapq hmac html http importlib
inspect io ipaddress itertools json keyword linecache locale logging lzma math mimetypes mmap
multiprocessing ntpath numbers opcode operator os pathlib pickle pkgutil platform posixpath pprint
pwd queue quopri random re reprlib secrets select selectors shlex shutil signal site socket sqlite3 ssl stat
string stringprep struct subprocess sys sysconfig tempfile textwrap threading time token tokenize
tomllib traceback types typing unicodedata unittest urllib uuid warnings weakref xml zipfile zlib
zoneinfo
"""

NEEDED: Final = _OF_OTHERS | frozenset(_OF_PYTHON.split())
"""The modules that generated packages, their tests and rclpy import, and the modules that those import."""

_UNREAD: Final = (".json", ".yaml", ".yml")

_DEVICES: Final = frozenset(
    ("aux", "con", "nul", "prn", *(f"{port}{number}" for port in ("com", "lpt") for number in range(1, 10)))
)
"""Names that no file can have on Windows, in upper or lower case and with any extension."""


def check_package(package: PackageFiles) -> Iterator[Diagnostic]:
    """The mistakes in the names of a package and of its files."""
    where = "" if package.declared else f" ({package.root})"
    label = Label(package.declared) if package.declared else None
    interfaces, nodes = (file.name for file in package.files), (node.name for node in package.nodes)
    for found in (problem(package.name), *map(_device, (package.name, *interfaces, *nodes))):
        if found is not None:
            yield replace(found, message=found.message + where, primary=label)
    yield from _unread(package.root / NODE_FOLDER)


def _unread(folder: Path) -> Iterator[Diagnostic]:
    """Descriptions of nodes whose names do not say so."""
    for path in _files(folder):
        if path.suffix in _UNREAD and node_name(path.name) is None and not path.name.startswith("."):
            with suppress(InputError):
                source = read_source(path)
                if (start := source.text.find("nodl_version")) >= 0:
                    message = f"{path.name} is not read: a node description is called NAME.nodl.yaml"
                    label = Label(Span(source, start, start + len("nodl_version")), "this looks like one")
                    advice = f"rename it to {path.stem}.nodl{path.suffix}"
                    yield Diagnostic("unread-description", message, label, help=advice, severity="warning")


def _files(folder: Path) -> list[Path]:
    return (
        sorted(folder / entry.name for entry in storage.entries(folder)) if storage.is_folder(folder) else []
    )


def _device(name: str) -> Diagnostic | None:
    if name.lower() not in _DEVICES:
        return None
    message = f"'{name}' is the name of a device on Windows, and cannot be a file there"
    advice = "with another name the package can be checked out and generated there too"
    return Diagnostic("device-name", message, help=advice, severity="warning")


def problem(name: str) -> Diagnostic | None:
    """The mistake in a name for a package, wherever the package is."""
    if not names.is_package_name(name):
        snake = re.sub(r"[^a-z0-9]+", "_", names.snake_case(name)).strip("_")
        advice = "Package names are lower-case letters, digits and single underscores, a letter first"
        hint = f"did you mean '{snake}'? " if names.is_package_name(snake) and snake != name else ""
        message = f"'{name}' is not a valid package name"
        return Diagnostic("invalid-package-name", message, help=hint + advice)
    advice = f"rename it, for example to '{name}_msgs'"
    if keyword.iskeyword(name):
        message = f"no Python package can be called '{name}': `import {name}` is a syntax error"
        return Diagnostic("keyword-name", message, help=advice)
    if name in NEEDED:
        message = (
            f"a package called '{name}' hides the Python package of that name, which generated code needs"
        )
        return Diagnostic("hiding-name", message, help=advice)
    if name in sys.stdlib_module_names:
        message = f"a package called '{name}' hides a module of Python's own"
        advice = f"programs that import `{name}` may fail: {advice}"
        return Diagnostic("hiding-name", message, help=advice, severity="warning")
    return None


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
