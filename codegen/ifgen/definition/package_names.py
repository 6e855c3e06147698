"""Names that packages and files cannot have: ROS forbids them, or Python or Windows uses them."""

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
from ifgen.diagnostics import Diagnostic, InputError, Label, Span
from ifgen.reading import storage
from ifgen.reading.packages import NODE_FOLDER, PackageFiles, node_name
from ifgen.reading.storage import read_source

_OF_OTHERS: Final = frozenset(
    (
        *("ifgen", "ifgen_native", "ifgen_pytest", "ifgen_runtime", "rclpy", "rmw_local", "rosidl_parser"),
        *("hypothesis", "launch", "launch_ros", "numpy", "pytest", "setuptools", "typing_extensions"),
        *("xxhash", "yaml", "zenoh"),
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


def check(package: PackageFiles) -> Iterator[Diagnostic]:
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
