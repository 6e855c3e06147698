"""Digests of the files that packages are generated from, each worked out once in a run."""

from __future__ import annotations

import hashlib
from collections.abc import Iterable, Mapping
from pathlib import Path

from ifgen.pipeline.freshness import fingerprints
from ifgen.pipeline.freshness.notes import Note
from ifgen.reading.search_path import SearchPath


class Digests:
    """Digests of packages, each of everything that its files are generated from.

    `generator` stands for what is the same for all, `descriptions` for what packages say about themselves.
    `known` files, by the names of their types or by their paths, are not read.
    """

    def __init__(
        self,
        generator: bytes,
        descriptions: Mapping[str, bytes],
        search: SearchPath,
        known: Mapping[str, bytes] | None = None,
    ) -> None:
        self.generator = generator
        self._descriptions = descriptions
        self._search = search
        self._files = dict(known or {})

    def knowing(self, files: Mapping[str, bytes]) -> Digests:
        """The same with these digests of files, whatever is on disk."""
        return Digests(self.generator, self._descriptions, self._search, files)

    def of_package(self, name: str, note: Note, ours: Iterable[str]) -> str:
        """The digest of everything that a package's generated files depend on."""
        hasher = hashlib.sha256(self.generator + self._descriptions.get(name, b""))
        hasher.update(repr(sorted(ours)).encode())
        types = ((each, self._of_type(each)) for each in (*note.own, *note.needed))
        documents = ((path, self._of_document(path)) for path in note.documents)
        for source, digest in (*types, *documents):
            hasher.update(source.encode(errors="surrogateescape"))
            hasher.update(digest)
        return hasher.hexdigest()

    def _of_type(self, name: str) -> bytes:
        """The digest of the file that a type name stands for today; of nothing if there is none."""
        if name not in self._files:
            package_name, folder, file_name = name.split("/")
            package = self._search.package(package_name)
            file = package.interface(folder, file_name) if package else None
            self._files[name] = fingerprints.of_file(file.path) if file else b""
        return self._files[name]

    def _of_document(self, path: str) -> bytes:
        if path not in self._files:
            self._files[path] = fingerprints.of_file(Path(path))
        return self._files[path]
