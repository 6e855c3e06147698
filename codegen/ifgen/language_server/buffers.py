"""The texts that are open in an editor, saved or not, in the place of those on disk."""

from __future__ import annotations

import os
from collections.abc import Generator
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path

from ifgen.reading import storage


@dataclass
class Buffers:
    """Open texts, by absolute path, and files that count as removed."""

    texts: dict[Path, str] = field(default_factory=dict[Path, str])
    removed: frozenset[Path] = frozenset()

    @contextmanager
    def read_first(self, *roots: Path) -> Generator[None]:
        """Read these texts in the place of files, below the roots and beside each text."""
        below: dict[Path, dict[str, storage.Entry]] = {}
        for path in self.texts:
            child = path
            for folder in path.parents:
                name = child.name
                known = below.setdefault(folder, {})
                if name in known:
                    break
                known[name] = storage.Entry(name, child != path)
                child = folder
        folders = dict.fromkeys([*roots, *(path.parent for path in self.texts)])
        with storage.as_of(*(_Folder(folder, self.texts, self.removed, below) for folder in folders)):
            yield


@dataclass(frozen=True)
class _Folder:
    """A folder as the editor shows it: a snapshot for `storage.as_of`."""

    root: Path
    texts: dict[Path, str]
    removed: frozenset[Path]
    below: dict[Path, dict[str, storage.Entry]]
    name: str = "editor"

    @property
    def roots(self) -> tuple[str, ...]:
        """The absolute path of the folder."""
        return (str(self.root),)

    def entries(self, path: str) -> list[storage.Entry] | None:
        """The contents of a folder, with the new files that are open."""
        folder = self.root / path
        try:
            with os.scandir(folder) as found:
                entries = {
                    entry.name: storage.Entry(entry.name, entry.is_dir(), entry.is_symlink())
                    for entry in found
                    if folder / entry.name not in self.removed
                }
        except OSError:
            entries = {}
        entries = {**self.below.get(folder, {}), **entries}
        return list(entries.values()) or ([] if folder.is_dir() else None)

    def read(self, path: str) -> bytes | None:
        """The text that is open, or the contents of the file."""
        place = self.root / path
        text = self.texts.get(place)
        if text is not None:
            return text.encode("utf-8", "replace")
        try:
            return place.read_bytes() if self.has_file(path) else None
        except OSError:
            return None

    def has_file(self, path: str) -> bool:
        """Whether such a text is open, or such a file exists."""
        place = self.root / path
        return place in self.texts or (place.is_file() and place not in self.removed)
