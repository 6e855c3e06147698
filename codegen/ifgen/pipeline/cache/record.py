"""The record of earlier runs on an output folder.

It is in the user's cache folder, not in the output, because it identifies ifgen's own code: committed
manifests would change for no reason. Losing it costs only time.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Final, TypeAlias

from ifgen import resources
from ifgen.diagnostics import Diagnostic, Label, Source, Span
from ifgen.reading.storage import read_json, read_limited
from ifgen.writing import cache

_MOST_RUNS: Final = 30

_Json: TypeAlias = Any


@dataclass(frozen=True, slots=True)
class PackageRecord:
    """The sources of a generated package, as they were.

    `own` are its interfaces and nodes and `needed` the interfaces that those need, as `pkg/msg/Name`;
    `documents` are the paths of other files that were read. `modules` are the digests of everything that each
    single interface depends on. `inputs` is the digest of all sources, `manifest` that of the package's
    manifest.
    """

    own: Sequence[str]
    needed: Sequence[str]
    documents: Sequence[str]
    modules: Mapping[str, str]
    inputs: str = ""
    manifest: str = ""


@dataclass(frozen=True, slots=True)
class BuildRecord:
    """The packages in an output folder by name, and the diagnostics of runs, as JSON, by their requests."""

    packages: Mapping[str, PackageRecord] = field(default_factory=dict[str, PackageRecord])
    runs: Mapping[str, _Json] = field(default_factory=dict[str, _Json])

    def needed_by(self, package: str) -> set[str]:
        """The packages that one needs, as far as is recorded."""
        recorded = self.packages.get(package)
        return {type_name.partition("/")[0] for type_name in recorded.needed} if recorded else set()

    def diagnostics_of(self, request: str, inputs: str) -> tuple[Diagnostic, ...] | None:
        """The diagnostics of such a run, if there was one, and the files that they show are unchanged."""
        with suppress(KeyError, TypeError, ValueError, IndexError, AttributeError):
            recorded_inputs, document = self.runs[request]
            if recorded_inputs == inputs:
                return _from_json(document)
        return None

    def with_run(self, request: str, inputs: str, diagnostics: Sequence[Diagnostic]) -> BuildRecord:
        """The same with a run; of other requests, the last runs."""
        others = [(other, run) for other, run in self.runs.items() if other != request]
        runs = [*others, (request, [inputs, _to_json(diagnostics)])]
        return BuildRecord(self.packages, dict(runs[-_MOST_RUNS:]))


def read_record(output: Path) -> BuildRecord:
    """The record of an output folder; an empty one if it cannot be read."""
    with suppress(OSError, ValueError, TypeError, AttributeError, KeyError):
        document = read_json(_path(output))
        packages = {name: _package(values) for name, values in document["packages"].items()}
        return BuildRecord(packages, dict(document["runs"]))
    return BuildRecord()


def save_record(record: BuildRecord, output: Path) -> None:
    """Save the record of an output folder for later runs."""
    packages = {
        name: [p.own, p.needed, p.documents, p.modules, p.inputs, p.manifest]
        for name, p in record.packages.items()
    }
    cache.keep(_path(output), json.dumps({"packages": packages, "runs": record.runs}))


def sources_of(diagnostic: Diagnostic) -> Iterator[Source]:
    """The files that a diagnostic shows."""
    if diagnostic.primary is not None:
        for label in (diagnostic.primary, *diagnostic.secondary):
            yield label.span.source


def _path(output: Path) -> Path:
    name = hashlib.sha256(str(output.resolve()).encode(errors="surrogateescape")).hexdigest()[:32]
    return resources.cache_folder() / "generated" / f"{name}.json"


def _package(values: Sequence[_Json]) -> PackageRecord:
    own, needed, documents, modules, inputs, manifest = values
    return PackageRecord(list(own), list(needed), list(documents), dict(modules), inputs, manifest)


def _to_json(diagnostics: Sequence[Diagnostic]) -> _Json:
    """Diagnostics, with the text of the files that they show."""
    sources = list(dict.fromkeys(source for diagnostic in diagnostics for source in sources_of(diagnostic)))
    number = {source: index for index, source in enumerate(sources)}

    def label(label: Label) -> list[_Json]:
        return [number[label.span.source], label.span.start, label.span.end, label.text]

    return {
        "files": [[str(source.path), source.text] for source in sources],
        "found": [
            [
                d.rule,
                d.message,
                d.primary and label(d.primary),
                [*map(label, d.secondary)],
                d.help,
                d.severity,
            ]
            for d in diagnostics
        ],
    }


def _from_json(document: _Json) -> tuple[Diagnostic, ...] | None:
    """The diagnostics; None if one of the files that they show has changed."""
    sources = [Source(Path(path), text) for path, text in document["files"]]
    if not all(map(_is_current, sources)):
        return None

    def label(values: _Json) -> Label:
        index, start, end, text = values
        return Label(Span(sources[int(index)], start, end), text)

    return tuple(
        Diagnostic(rule, message, primary and label(primary), tuple(map(label, secondary)), help, severity)
        for rule, message, primary, secondary, help, severity in document["found"]
    )


def _is_current(source: Source) -> bool:
    with suppress(OSError):
        data = source.text.encode(errors="surrogateescape")
        return read_limited(source.path).replace(b"\r\n", b"\n") == data.replace(b"\r\n", b"\n")
    return False
