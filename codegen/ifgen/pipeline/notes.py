"""Notes about earlier runs on an output folder, and which modules can stay.

The notes are in the user's cache folder, not in the output, because they identify ifgen's own code: committed
manifests would change for no reason. Losing them costs only time.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Final, TypeAlias

from ifgen import resources
from ifgen.definition.interfaces import Interface
from ifgen.pipeline import earlier
from ifgen.reading import manifest
from ifgen.reading.manifest import Manifest
from ifgen.reading.text_files import MAX_GENERATED, read_json, read_limited
from ifgen.writing import cache

_MOST_RUNS: Final = 30

Run: TypeAlias = list[Any]
"""The digest of what a run was about, and what it said, as `remembered` has it."""


@dataclass(frozen=True, slots=True)
class Note:
    """The sources of a package.

    `own` are its interfaces and nodes and `needed` the interfaces that those need, as `pkg/msg/Name`;
    `documents` are the paths of other files that were read. `inputs` is the digest of all that. `modules` are
    the digests of everything that each single interface depends on. `manifest` is the digest of the package's
    manifest.
    """

    own: tuple[str, ...]
    needed: tuple[str, ...] = ()
    documents: tuple[str, ...] = ()
    modules: Mapping[str, str] = field(default_factory=dict[str, str])
    inputs: str = ""
    manifest: str = ""

    def packages(self) -> set[str]:
        """The packages that it needs."""
        return {type_name.partition("/")[0] for type_name in self.needed}


class Notes:
    """The notes on one output folder: of its packages by name, and of runs by what they asked for."""

    def __init__(self, output: Path) -> None:
        name = hashlib.sha256(str(output.resolve()).encode(errors="surrogateescape")).hexdigest()[:32]
        self._path = resources.cache_folder() / "generated" / f"{name}.json"
        self.packages: dict[str, Note] = {}
        self.runs: dict[str, Run] = {}
        with suppress(OSError, ValueError, TypeError, AttributeError, KeyError):
            document = read_json(self._path)
            packages = {name: _note(note) for name, note in document["packages"].items()}
            self.packages, self.runs = packages, dict(document["runs"])

    def replace(self, packages: Mapping[str, Note], key: str, run: Run) -> None:
        """Keep other notes on the packages, and on a run; of runs that asked for something else, the last."""
        if packages == self.packages and self.runs.get(key) == run:
            return
        others = [(other, noted) for other, noted in self.runs.items() if other != key]
        self.packages, self.runs = dict(packages), dict([*others, (key, run)][-_MOST_RUNS:])
        notes = {
            name: [note.own, note.needed, note.documents, note.modules, note.inputs, note.manifest]
            for name, note in packages.items()
        }
        cache.keep(self._path, json.dumps({"packages": notes, "runs": self.runs}))


class Modules:
    """The modules of interfaces that an earlier run has written and this one would write again.

    `digests` are the current digests of everything that each interface depends on, by type name.
    """

    def __init__(self, output: Path, notes: Notes, digests: Mapping[str, str]) -> None:
        self._output = output
        self._notes = notes.packages
        self._digests = digests
        self._files: dict[str, Mapping[str, str]] = {}

    def text(self, interface: Interface, path: str) -> str | None:
        """The text of an interface's module at a path in its package; None if that needs work."""
        package = interface.package
        note = self._notes.get(package)
        if note is None or note.modules.get(interface.type_name) != self._digests[interface.type_name]:
            return None
        if package not in self._files:
            self._files[package] = self._files_of(self._output / package, note)
        with suppress(OSError):
            data = read_limited(self._output / package / path, MAX_GENERATED)
            if manifest.digest(data) == self._files[package].get(path):
                return data.decode()
        return None

    @staticmethod
    def _files_of(folder: Path, note: Note) -> Mapping[str, str]:
        """The files of a package as the noted run wrote them."""
        record = earlier.record_of(folder) if digest_of_manifest(folder) == note.manifest else None
        return (record or Manifest()).files


def digest_of_manifest(folder: Path) -> str:
    """The digest of a package's manifest: another ifgen may have generated there since. Empty without one."""
    try:
        return manifest.digest(read_limited(folder / manifest.NAME, MAX_GENERATED))
    except OSError:
        return ""


def _note(document: Sequence[Any]) -> Note:
    own, needed, documents, modules, inputs, of_manifest = document
    return Note(tuple(own), tuple(needed), tuple(documents), dict(modules), inputs, of_manifest)
