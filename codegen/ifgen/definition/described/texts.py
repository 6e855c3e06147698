"""From the texts of definitions to definitions, wherever the texts come from: no file has to be there."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Final

from ifgen.definition.described.types import BadDescription, check_limits
from ifgen.definition.interfaces import Interface, Message, Registry
from ifgen.definition.resolve import resolve
from ifgen.definition.type_description import referenced_types
from ifgen.diagnostics import Diagnostic, InputError, Source, shorten
from ifgen.reading.package_files import FOLDERS, InterfaceFile, PackageFiles
from ifgen.reading.search_path import SearchPath

_FOLDER: Final = Path("<text>")
"""The place that diagnostics name: no file is there."""


def read_texts(
    type_name: str,
    texts: Iterable[tuple[str, str, str]],
    include: Sequence[Path | str] = (),
    folder: Path = _FOLDER,
    revision: str | None = None,
) -> tuple[Interface, Registry]:
    """The interface that one of the texts defines, and a registry with all that it needs.

    `texts` are (type name, encoding, text): the encoding is `idl`, or anything else for what the middle of
    the name says. Types without a text are looked for where `ifgen generate` does it, first in the folders
    `include`. Places are in files below `folder`, in a `revision`.

    Raises InputError with all mistakes, and for sizes beyond all limits.
    """
    files: dict[str, dict[str, TextFile]] = {}
    for name, encoding, text in texts:
        package, file = _file(name, encoding, text, folder, revision)
        files.setdefault(package, {})[name] = file
    elsewhere = SearchPath((), include)
    packages = [_package(package, tuple(of.values()), elsewhere, folder) for package, of in files.items()]
    registry = resolve(packages, SearchPath(packages, include))
    described = registry.interface(type_name)
    _check_sizes(described, registry)
    return described, registry


def read_sources(
    type_name: str,
    sources: Iterable[tuple[str, str, str]],
    folder: Path = _FOLDER,
    revision: str | None = None,
) -> tuple[Interface, Registry] | None:
    """The same from the sources of a class or of `~/get_type_description`, which may lack some texts.

    None if the text of the type itself is not among them. Raises InputError.
    """
    texts = [source for source in sources if source[1] != "implicit" and source[2]]
    if not any(name == type_name for name, _, _ in texts):
        return None
    return read_texts(type_name, texts, (), folder, revision)


@dataclass(frozen=True, slots=True)
class TextFile(InterfaceFile):
    """A definition that is in no file."""

    text: str = ""
    revision: str | None = None

    def read(self) -> Source:
        """The text, with plain line ends."""
        return Source(self.path, self.text.replace("\r\n", "\n"), self.revision)


def _check_sizes(described: Interface, registry: Registry) -> None:
    needed = (described, *referenced_types(described, registry))
    try:
        check_limits(item for item in needed if isinstance(item, Message))
    except BadDescription as error:
        raise InputError([Diagnostic("invalid-description", str(error))]) from None


def _file(
    type_name: str, encoding: str, text: str, place: Path, revision: str | None
) -> tuple[str, TextFile]:
    """The package of a type, and a file that stands for its text."""
    package, folder, name = (*type_name.split("/", 2), "", "")[:3]
    if not name.isidentifier() or folder not in FOLDERS or not package.isidentifier():
        message = f"{shorten(repr(type_name))} is not the name of a type, such as 'std_msgs/msg/String'"
        raise InputError([Diagnostic("unknown-type", message)])
    extension = "idl" if encoding == "idl" else folder
    return package, TextFile(place / package / folder / f"{name}.{extension}", folder, text, revision)


def _package(name: str, files: tuple[TextFile, ...], elsewhere: SearchPath, place: Path) -> PackageFiles:
    """The package that an installation has, with these texts in place of its files; or one of these alone."""
    installed = elsewhere.package(name)
    if installed is None:
        return PackageFiles(name, place / name, files, partial=False)
    return replace(installed, files=files, partial=True, listed=None, nodes=())
