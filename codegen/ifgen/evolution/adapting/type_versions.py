"""The version of a type that `ifgen adapt --from` names."""

from __future__ import annotations

import json
import os
import re
from collections.abc import Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final, cast

from ifgen.definition.described.reading import read as read_description
from ifgen.definition.interfaces import Interface, Message, Registry
from ifgen.definition.type_description import TypeHashes, type_hash
from ifgen.diagnostics import Diagnostic, InputError, Source, UsageError, shorten
from ifgen.evolution.lock import file as lock_file
from ifgen.evolution.lock.text import NAME, written_parts
from ifgen.evolution.selection import Selection, select, split
from ifgen.generator_py.names import interface_name
from ifgen.reading import revisions
from ifgen.reading.storage import read_source

_HASH: Final = re.compile(r"(?:RIHS01_[0-9a-f]{1,64}|[0-9a-f]{4,64})(?:\.\.\.)?")
"""A hash or its first digits, also as warnings print it: with dots after them."""

_MOST_REVISIONS: Final = 50


@dataclass(frozen=True, slots=True)
class TypeVersion:
    """A version of an interface, and the registry with what it needs. `origin` says where it is from."""

    interface: Interface
    registry: Registry
    origin: str

    @property
    def type_hash(self) -> str:
        """The hash of the interface."""
        return type_hash(self.interface, self.registry)

    def has_hash(self, prefix: str) -> bool:
        """Whether the hash of the interface, or of a part that somebody wrote, begins so."""
        hashes = TypeHashes(self.registry)
        return any(
            hashes.of(item).startswith(prefix) for item in (self.interface, *written_parts(self.interface))
        )


class VersionFinder:
    """Finds versions of a type. `paths` and `include` are where it is now, `base` is the project's folder."""

    def __init__(self, paths: Sequence[Path], include: Sequence[Path], base: Path) -> None:
        self._paths, self._include, self._base = paths, include, base

    def today(self, name: str) -> TypeVersion:
        """An interface as it is now. Raises UsageError if there is none, and InputError if it is wrong."""
        return _single(select(name, self._paths, self._include), name)

    def earlier(self, reference: str, now: TypeVersion) -> TypeVersion:
        """The version that a reference names. Raises UsageError and InputError."""
        type_name = now.interface.type_name
        found = self._earlier(reference, now)
        if found.interface.folder != now.interface.folder:
            message = f"{shorten(reference)} is the {found.interface.type_name}, which is of another kind"
            raise UsageError([Diagnostic("unknown-type", message, help=f"{type_name} was asked for")])
        if found.type_hash == now.type_hash:
            message = f"there is nothing to adapt: {type_name} has the same type hash in {shorten(reference)}"
            advice = "what has the same hash is the same to ROS: `ifgen diff` shows what differs otherwise"
            raise UsageError([Diagnostic("nothing-to-adapt", message, help=advice)])
        return found

    def _earlier(self, reference: str, now: TypeVersion) -> TypeVersion:
        type_name = now.interface.type_name
        if reference.endswith(".json") and os.path.isfile(reference):  # noqa: PTH113 - any text will do
            return _described(Path(reference), type_name)
        if os.path.isfile(reference) and not reference.endswith(".lock"):  # noqa: PTH113
            return _single(select(reference, self._paths, self._include), reference)
        if os.path.exists(reference) or not _HASH.fullmatch(reference):  # noqa: PTH110
            has_type = not os.path.exists(reference) and split(reference)[0] is not None  # noqa: PTH110
            text = reference if has_type else f"{reference}:{type_name}"
            return self._at(text, reference, type_name)
        return self._of_hash(reference.removesuffix("..."), now)

    def _at(self, text: str, reference: str, type_name: str) -> TypeVersion:
        """The type that `text` names, of the version that `reference` is for users."""
        try:
            return _single(select(text, self._paths, self._include), reference)
        except UsageError as error:
            if not any(d.rule in {"unknown-type", "unknown-package"} for d in error.diagnostics):
                raise
            message = f"{shorten(reference)} has no {type_name}"
            advice = "name a version that has it; if it had another name, write REF:TYPE"
            raise UsageError([Diagnostic("unknown-type", message, help=advice)]) from None

    def _of_hash(self, text: str, now: TypeVersion) -> TypeVersion:
        """The version with this hash, or the revision of this name if no version has it."""
        type_name = now.interface.type_name
        is_revision = not text.startswith("RIHS") and revisions.is_revision(self._place(), text)
        prefix = f"RIHS01_{text.removeprefix('RIHS01_')}"
        known = {found.type_hash: found for found in self._known(type_name) if found.has_hash(prefix)}
        if now.has_hash(prefix):
            known.setdefault(now.type_hash, now)
        if not known and not is_revision:
            known = {f.type_hash: f for f in self._in_history(type_name) if f.has_hash(prefix)}
        if len(known) > 1 or (known and is_revision):
            hashes = [f"{found} ({of.origin})" for found, of in known.items()]
            also = [f"the revision {text}: write refs/... or {text}:{type_name}"] * is_revision
            message = f"'{text}' stands for several versions of {type_name}"
            raise UsageError([Diagnostic("ambiguous-hash", message, help="; ".join((*hashes, *also)))])
        if known:
            return next(iter(known.values()))
        if is_revision:
            return self._at(f"{text}:{type_name}", text, type_name)
        message = f"nobody knows a version of {type_name} with the hash {shorten(text, 80)}"
        advice = (
            f"looked in {NAME} and the history of it and of the file, and in installed packages; name a "
            "revision, a folder, or a .json file with its type description"
        )
        raise UsageError([Diagnostic("unknown-hash", message, help=advice)])

    def _place(self) -> Path:
        return self._paths[0] if self._paths else self._base

    def _known(self, type_name: str) -> Iterator[TypeVersion]:
        """The versions in the lock file, in earlier ones, and among installed packages."""
        lock = self._base / NAME
        if lock.is_file():
            yield from _in_lock(read_source(lock), type_name, NAME)
        for commit, text in revisions.history(lock, _MOST_REVISIONS):
            with suppress(InputError):  # a version that somebody edited
                yield from _in_lock(Source(lock, text), type_name, f"{commit}:{NAME}")
        with suppress(InputError, UsageError):
            yield _single(select(type_name, (), self._include), "installed")

    def _in_history(self, type_name: str) -> Iterator[TypeVersion]:
        """The versions in the commits that changed the file of the type."""
        with suppress(InputError, UsageError):
            source = self.today(type_name).interface.source
            if source is None:
                return
            for commit, _ in revisions.history(source.path, _MOST_REVISIONS):
                with suppress(InputError, UsageError):
                    yield _single(select(f"{commit}:{type_name}", self._paths, self._include), commit)


def _in_lock(source: Source, type_name: str, origin: str) -> Iterator[TypeVersion]:
    if f"\n{type_name} RIHS01_" not in f"\n{source.text}":
        return  # reading takes longer
    registry = lock_file.parse(source).registry
    if (interface := registry.get(type_name)) is not None:
        yield TypeVersion(interface, registry, origin)


def _single(selected: Selection, origin: str) -> TypeVersion:
    """The interface that was selected, the whole of a service or an action if a part was named."""
    if not selected.is_one:
        message = f"{shorten(selected.label)} is not a single type"
        raise UsageError([Diagnostic("unknown-type", message, help="write it as `package/msg/Name`")])
    found = next(iter(selected.interfaces.values()))
    if isinstance(found, Message) and found.folder != "msg":
        found = selected.registry.interface(f"{found.package}/{found.folder}/{interface_name(found)}")
    return TypeVersion(found, selected.registry, origin)


def _described(path: Path, type_name: str) -> TypeVersion:
    """The version in a type description: of `ifgen show --json`, of a node, or in a file of rosidl."""
    try:
        document: Any = json.loads(read_source(path).text)
    except (ValueError, RecursionError) as error:
        message = f"{path} is not the JSON of a type description: {error}"
        raise InputError([Diagnostic("invalid-description", message)]) from None
    of_rosidl = cast("dict[str, Any]", document) if isinstance(document, dict) else {}
    described, registry = read_description(
        of_rosidl.get("type_description_msg", document), _told_hash(of_rosidl.get("type_hashes"), type_name)
    )
    if described.type_name != type_name:
        message = f"{path} describes {described.type_name}, not {type_name}"
        raise UsageError([Diagnostic("unknown-type", message, help="name the type that it describes")])
    return TypeVersion(described, registry, path.name)


def _told_hash(hashes: object, type_name: str) -> str | None:
    """The hash that a file of rosidl says a type has."""
    items = cast("Sequence[Any]", hashes) if isinstance(hashes, list) else ()
    of_types = [cast("dict[str, Any]", item) for item in items if isinstance(item, dict)]
    return next(
        (str(item.get("hash_string")) for item in of_types if item.get("type_name") == type_name), None
    )
