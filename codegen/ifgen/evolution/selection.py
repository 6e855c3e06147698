"""One side of `ifgen diff`: the types that a text names, in the version that it names."""

from __future__ import annotations

import os
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Final

from ifgen.definition.interfaces import Interface, Registry
from ifgen.diagnostics import Diagnostic, InputError, UsageError, shorten
from ifgen.evolution import version
from ifgen.evolution.lock import file as lock_file
from ifgen.pipeline import lookup
from ifgen.reading import revisions, storage
from ifgen.reading.packages import find_packages
from ifgen.reading.search_path import SearchPath

_WITH_REFERENCE: Final = re.compile(
    r"(.*[^:]):([^:].*|)", re.DOTALL
)  # a type may be written as pkg::msg::Name


@dataclass(frozen=True, slots=True)
class Selection:
    """Interfaces by type name, and the registry that has what they need.

    `label` is the text that chose them. `is_one` is true if it names a single type.
    """

    label: str
    interfaces: Mapping[str, Interface]
    registry: Registry
    is_one: bool


def select(text: str, paths: Sequence[Path], include: Sequence[Path]) -> Selection:
    """The types that `text` names: `TYPE`, `REF:TYPE`, a file, a folder, or a lock file.

    A TYPE alone is looked for at the `paths` and where dependencies are. REF is a git revision of the
    repository of these, a folder, or a lock file. Raises UsageError and InputError.
    """
    if os.path.exists(text):  # noqa: PTH110 - any text will do, also one that no file can be called
        return _of_lock(text, None) if _is_lock(text) else _at(text, Path(text), include)
    reference, type_name = split(text)
    if reference is None:
        try:
            return _of_search(text, type_name, _search(paths, include))
        except InputError:
            if revisions.is_revision(paths[0] if paths else Path(), text):
                message = f"'{shorten(text)}' is a revision, which is no type by itself"
                help = f"write the type after it: `{shorten(text)}:demo_msgs/msg/Name`"
                raise UsageError([Diagnostic("unknown-type", message, help=help)]) from None
            raise
    if _is_lock(reference):
        return _of_lock(reference, type_name)
    if os.path.isdir(reference):  # noqa: PTH112
        return _of_search(text, type_name, _search([Path(reference)], include))
    return _of_revision(text, reference, type_name, paths, include)


def split(text: str) -> tuple[str | None, str]:
    """The REF, if there is one, and the TYPE of `REF:TYPE`."""
    found = _WITH_REFERENCE.fullmatch(text)
    return (None, text) if found is None else (found[1], found[2])


def _is_lock(text: str) -> bool:
    return text.endswith(".lock") and os.path.isfile(text)  # noqa: PTH113


def _search(paths: Sequence[Path], include: Sequence[Path]) -> SearchPath:
    return SearchPath(find_packages(paths), include)


def _at(label: str, path: Path, include: Sequence[Path]) -> Selection:
    """All interfaces of a file or a folder."""
    packages = find_packages([path])
    loaded = version.load(packages, SearchPath(packages, include))
    if loaded.mistakes:
        raise InputError(loaded.mistakes)
    return Selection(label, loaded.interfaces, loaded.registry, path.is_file())


def _of_search(label: str, type_name: str, search: SearchPath) -> Selection:
    """A type, or all types of a package."""
    if names := lookup.types_in(type_name, search):
        _, registry = lookup.find_types(names, search)
        return Selection(label, {name: registry.interface(name) for name in names}, registry, False)
    described, registry = lookup.find_type(type_name, search)
    return Selection(label, {described.type_name: described}, registry, True)


def _of_revision(
    label: str, reference: str, type_name: str, paths: Sequence[Path], include: Sequence[Path]
) -> Selection:
    revision = revisions.revision_of(paths[0] if paths else Path(), reference)
    with storage.as_of(revision):
        places = [path for path in paths if storage.exists(path)] or [Path(revision.roots[0])]
        return _of_search(
            label, type_name, _search(places, [path for path in include if storage.exists(path)])
        )


def _of_lock(path: str, type_name: str | None) -> Selection:
    registry = lock_file.read(Path(path)).registry
    interfaces = {interface.type_name: interface for interface in registry}
    if type_name is None:
        return Selection(path, interfaces, registry, False)
    name = type_name.replace("::", "/").replace(".", "/")
    found = [i for i in registry if name in {i.type_name, f"{i.package}/{i.name}", i.name}]
    if len(found) != 1:
        what = "has no type" if not found else f"has {len(found)} types"
        message = f"{path} {what} '{shorten(type_name)}'"
        raise UsageError([Diagnostic("unknown-type", message, help="write it as `package/msg/Name`")])
    return Selection(f"{path}:{type_name}", {found[0].type_name: found[0]}, registry, True)


def pairs(a: Selection, b: Selection) -> list[tuple[Interface | None, Interface | None]]:
    """The interfaces of both sides beside each other: two single ones, else those of the same name."""
    if a.is_one and b.is_one:
        return [(next(iter(a.interfaces.values())), next(iter(b.interfaces.values())))]
    if a.is_one or b.is_one:
        names = list((a if a.is_one else b).interfaces)
    else:
        names = list(dict.fromkeys((*a.interfaces, *b.interfaces)))
    return [(a.interfaces.get(name), b.interfaces.get(name)) for name in sorted(names)]
