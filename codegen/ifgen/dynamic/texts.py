"""A class from the text of a definition, at run time."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, Final

from ifgen.definition.described.limits import check_limits
from ifgen.definition.described.types import BadDescription
from ifgen.definition.interfaces import Message, Registry
from ifgen.definition.resolve import resolve
from ifgen.definition.type_description import referenced_types
from ifgen.diagnostics import Diagnostic, InputError, Source, shorten
from ifgen.dynamic.making import make
from ifgen.reading.package_files import FOLDERS, InterfaceFile, PackageFiles
from ifgen.reading.search_path import SearchPath

_FOLDER: Final = Path("<text>")
"""The place that diagnostics name: no file is there."""

_SEPARATOR: Final = re.compile(r"^={80}\nMSG: (\S+)\n", re.MULTILINE)
"""The lines between definitions that belong together, in bags and in the schemas of MCAP."""


def class_from_text(
    type_name: str,
    text: str,
    *,
    others: Mapping[str, str] | None = None,
    include: Sequence[Path | str] = (),
    idl: bool = False,
) -> type[Any]:
    """The class of a type that a text defines, as `.msg`, `.srv` and `.action` files do, or `.idl` files.

    `type_name` is `pkg/msg/Name`; its middle says what the text is. `others` are the texts of other types by
    their names. They can follow the text as well, as in bags: each after a line of 80 `=` and a line
    `MSG: pkg/Name`. Types that have no text are looked for where `ifgen generate` does it, first in the
    folders `include`.

    The same definition always returns the same class. Raises InputError with all mistakes.
    """
    main, *more = _SEPARATOR.split(text) if _SEPARATOR.search(text) else [text]
    sources = [(type_name, "idl" if idl else "", main)]
    sources += ((_full(name), "", body) for name, body in zip(more[::2], more[1::2], strict=True))
    sources += ((name, "", body) for name, body in (others or {}).items())
    return _class(type_name, sources, include)


def class_from_sources(type_name: str, sources: Iterable[tuple[str, str, str]]) -> type[Any] | None:
    """The class of a type from (type name, encoding, text) of it and of those that it needs.

    None if its own text is not among them. Raises InputError.
    """
    texts = [source for source in sources if source[1] != "implicit" and source[2]]
    if not any(name == type_name for name, _, _ in texts):
        return None
    return _class(type_name, texts, ())


@dataclass(frozen=True, slots=True)
class _Text(InterfaceFile):
    """A definition that is in no file."""

    text: str = ""

    def read(self) -> Source:
        """The text, with plain line ends."""
        return Source(self.path, self.text.replace("\r\n", "\n"))


def _class(
    type_name: str, sources: Iterable[tuple[str, str, str]], include: Sequence[Path | str]
) -> type[Any]:
    files: dict[str, dict[str, _Text]] = {}
    for name, encoding, text in sources:
        package, file = _file(name, encoding, text)
        files.setdefault(package, {})[name] = file
    elsewhere = SearchPath((), include)
    packages = [_package(package, tuple(of.values()), elsewhere) for package, of in files.items()]
    registry = resolve(packages, SearchPath(packages, include))
    described = registry.interface(type_name)
    _check_sizes(registry, type_name)
    return make(described, registry)


def _check_sizes(registry: Registry, type_name: str) -> None:
    described = registry.interface(type_name)
    needed = (described, *referenced_types(described, registry))
    try:
        check_limits(item for item in needed if isinstance(item, Message))
    except BadDescription as error:
        raise InputError([Diagnostic("invalid-description", str(error))]) from None


def _file(type_name: str, encoding: str, text: str) -> tuple[str, _Text]:
    """The package of a type, and a file that stands for its text."""
    package, folder, name = (*type_name.split("/", 2), "", "")[:3]
    if not name.isidentifier() or folder not in FOLDERS or not package.isidentifier():
        message = f"{shorten(repr(type_name))} is not the name of a type, such as 'std_msgs/msg/String'"
        raise InputError([Diagnostic("unknown-type", message)])
    extension = "idl" if encoding == "idl" else folder
    return package, _Text(_FOLDER / package / folder / f"{name}.{extension}", folder, text)


def _package(name: str, files: tuple[_Text, ...], elsewhere: SearchPath) -> PackageFiles:
    """The package that an installation has, with these texts in place of its files; or one of these alone."""
    installed = elsewhere.package(name)
    if installed is None:
        return PackageFiles(name, _FOLDER / name, files, partial=False)
    return replace(installed, files=files, partial=True, listed=None, nodes=())


def _full(name: str) -> str:
    """`pkg/msg/Name` for `pkg/Name`, as bags write it."""
    package, slash, rest = name.partition("/")
    return f"{package}/msg/{rest}" if slash and "/" not in rest else name
