"""Digests of the files that packages are generated from, each worked out once in a run."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING

from ifgen.pipeline import fingerprints
from ifgen.reading.packages import PackageFiles
from ifgen.reading.search_path import SearchPath
from ifgen.reading.text_files import read_limited

if TYPE_CHECKING:
    from ifgen.pipeline.job import Job


class Digests:
    """The digests of files, by the names of their types or by their paths; `known` ones are not read."""

    def __init__(self, search: SearchPath, known: Mapping[str, bytes] | None = None) -> None:
        self._search = search
        self._digests = dict(known or {})

    def of_type(self, name: str) -> bytes:
        """The digest of the file that a type name stands for today; of nothing if there is none."""
        if name not in self._digests:
            package_name, folder, file_name = name.split("/")
            package = self._search.package(package_name)
            file = package.interface(folder, file_name) if package else None
            self._digests[name] = _of(file.path) if file else b""
        return self._digests[name]

    def of_path(self, path: str) -> bytes:
        """The digest of the file at a path; of nothing if there is none."""
        if path not in self._digests:
            self._digests[path] = _of(Path(path))
        return self._digests[path]


def as_read(job: Job, packages: Iterable[PackageFiles]) -> dict[str, bytes]:
    """Digests of what was parsed for a job, whatever has become of the files since."""
    parsed = (interface for registry in job.registries for interface in registry)
    found = {i.type_name: fingerprints.of_source(i.source) for i in parsed if i.source}
    xmls = (package.declared.source for package in packages if package.declared)
    documents = (source for target in job.targets if target.nodes for source in target.nodes.sources)
    found.update((str(s.path.resolve()), fingerprints.of_source(s)) for s in (*xmls, *documents))
    return found


def _of(path: Path) -> bytes:
    try:
        return fingerprints.of_text(read_limited(path))
    except OSError:
        return b""
