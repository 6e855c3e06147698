"""Notes about earlier runs on an output folder.

The notes are in the user's cache folder, not in the output, because they identify ifgen's own code: committed
manifests would change for no reason. Losing them costs only time.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Iterable, Mapping, Sequence, Set
from contextlib import suppress
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any, Final, TypeAlias

from ifgen import resources
from ifgen.diagnostics import Diagnostic
from ifgen.pipeline.freshness import remembered
from ifgen.reading.manifest import Manifest
from ifgen.reading.storage import read_json
from ifgen.writing import cache

_MOST_RUNS: Final = 30

Run: TypeAlias = list[Any]
"""The digest of what a run was about, and what it said, as `remembered` has it."""


@dataclass(frozen=True, slots=True)
class Found:
    """One package as a run finds it, and what the output has of it.

    `own` are its interfaces and nodes by name; None if the package is gone, or has a name twice. `inputs` is
    the digest of everything that it is generated from; None if other names were noted. `source` is its
    folder, seen from the output, if it was asked for. `manifest` is the one in the output.
    """

    own: Set[str] | None
    inputs: str | None
    source: str | None
    manifest: Manifest | None


@dataclass(frozen=True, slots=True)
class Note:
    """The sources of a package, as they were.

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

    def manifest_of(self, package: Found) -> Manifest | None:
        """The manifest of a package, if that and everything that it is generated from are as noted."""
        made = package.manifest
        if made is None or made.source != package.source:
            return None
        found = (package.own, package.inputs, made.digest)
        return made if found == (set(self.own), self.inputs, self.manifest) else None


@dataclass(frozen=True, slots=True)
class Notes:
    """The notes on one output folder: of its packages by name, and of runs by what they asked for."""

    packages: Mapping[str, Note] = field(default_factory=dict[str, Note])
    runs: Mapping[str, Run] = field(default_factory=dict[str, Run])

    def needed_by(self, package: str) -> set[str]:
        """The packages that one needs, as far as is noted."""
        note = self.packages.get(package)
        return {type_name.partition("/")[0] for type_name in note.needed} if note else set()

    def of_run(self, names: Iterable[str], users: Mapping[str, bytes] | None = None) -> str:
        """The digest of everything that packages are generated from, and of modules of the user's."""
        inputs = "\n".join(self.packages[name].inputs for name in sorted(names))
        hasher = hashlib.sha256(inputs.encode())
        for path, digest in sorted((users or {}).items()):
            hasher.update(path.encode(errors="surrogateescape") + digest)
        return hasher.hexdigest()

    def told(
        self, request: str, names: Iterable[str], users: Mapping[str, bytes]
    ) -> tuple[Diagnostic, ...] | None:
        """The diagnostics of a run with the same request; None if there was none, or something is new."""
        with suppress(KeyError, TypeError, ValueError, IndexError, AttributeError):
            inputs, document = self.runs[request]
            if inputs == self.of_run(names, users):
                return remembered.from_document(document)
        return None

    def with_run(self, request: str, run: Run) -> Notes:
        """The same with a run; of runs that asked for something else, the last."""
        others = [(other, noted) for other, noted in self.runs.items() if other != request]
        return replace(self, runs=dict([*others, (request, run)][-_MOST_RUNS:]))


def read(output: Path) -> Notes:
    """The notes on an output folder."""
    with suppress(OSError, ValueError, TypeError, AttributeError, KeyError):
        document = read_json(_place(output))
        packages = {name: _note(note) for name, note in document["packages"].items()}
        return Notes(packages, dict(document["runs"]))
    return Notes()


def keep(notes: Notes, output: Path) -> None:
    """Keep the notes on an output folder for later runs."""
    packages = {
        name: [note.own, note.needed, note.documents, note.modules, note.inputs, note.manifest]
        for name, note in notes.packages.items()
    }
    cache.keep(_place(output), json.dumps({"packages": packages, "runs": notes.runs}))


def _place(output: Path) -> Path:
    name = hashlib.sha256(str(output.resolve()).encode(errors="surrogateescape")).hexdigest()[:32]
    return resources.cache_folder() / "generated" / f"{name}.json"


def _note(document: Sequence[Any]) -> Note:
    own, needed, documents, modules, inputs, of_manifest = document
    return Note(tuple(own), tuple(needed), tuple(documents), dict(modules), inputs, of_manifest)
