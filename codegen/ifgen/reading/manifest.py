"""The manifest in each generated package: the files that ifgen wrote there, as opposed to yours."""

from __future__ import annotations

import hashlib
import json
import os
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path, PurePosixPath
from typing import cast

from ifgen.reading.storage import MAX_GENERATED, json_of, read_limited

NAME = ".ifgen-manifest.json"
TARGETS = ".ifgen-targets.json"
"""The manifest in a folder of targets (`[tool.ifgen.generate]`), which is not the folder of a package."""

_FORMAT = 1


@dataclass(frozen=True, slots=True)
class Manifest:
    """The files that earlier runs generated in one package folder.

    `interfaces` are names such as `msg/Twist`; `source` is the folder that they came from, seen from the
    output folder, or None where it is no folder of the user's; `files` maps each path in the package (with
    `/`) to the SHA-256 of its bytes, and `beside` does so for files elsewhere in the output folder, by their
    paths in that. `yours` are the paths of files that were written once and are the user's. `digest` is that
    of the manifest itself, as it was read.
    """

    generator: str = ""
    source: str | None = None
    interfaces: tuple[str, ...] = ()
    files: Mapping[str, str] = field(default_factory=dict[str, str])
    beside: Mapping[str, str] = field(default_factory=dict[str, str])
    yours: tuple[str, ...] = ()
    digest: str = field(default="", compare=False, repr=False)

    def to_text(self) -> str:
        """As it stands in the file: one line a file, in sorted order, so that versions of it merge well."""
        document: dict[str, object] = {
            "format": _FORMAT,
            "generator": self.generator,
            "source": self.source,
            "interfaces": sorted(self.interfaces),
            "files": dict(sorted(self.files.items())),
        }
        if self.beside:
            document["beside"] = dict(sorted(self.beside.items()))
        if self.yours:
            document["yours"] = sorted(self.yours)
        return json.dumps(document, indent=1, ensure_ascii=False) + "\n"

    def source_folder(self, directory: Path) -> Path | None:
        """The folder of the package's interfaces; `directory` is the output folder."""
        return None if self.source is None else Path(os.path.normpath(directory.absolute() / self.source))


def read(package_folder: Path, name: str = NAME) -> Manifest | None:
    """The manifest of a generated package; None if there is none. Raises OSError and ValueError."""
    path = package_folder / name
    try:
        data = read_limited(path, MAX_GENERATED)
    except (FileNotFoundError, NotADirectoryError):
        return None
    document = json_of(data)
    match document:
        case {
            "format": 1,
            "generator": str() as generator,
            "source": (str() | None) as source,
            "interfaces": [*interfaces],
            "files": {**listed},
        }:
            beside, yours = document.get("beside", {}), document.get("yours", [])
            if not isinstance(beside, dict) or not isinstance(yours, list):
                raise ValueError("this version of ifgen does not understand it")
            return Manifest(
                generator,
                source,
                tuple(map(str, interfaces)),
                _files(listed),
                _files(cast("dict[object, object]", beside)),
                tuple(_files(dict.fromkeys(cast("list[object]", yours)))),
                digest(data),
            )
        case _:
            raise ValueError("this version of ifgen does not understand it")


def is_generated(folder: Path) -> bool:
    """Whether ifgen wrote a package there, from sources elsewhere."""
    try:
        record = read(folder)
    except (OSError, ValueError):
        return True
    if record is None or not record.interfaces:
        return False
    source = record.source_folder(folder.parent)
    return source is None or source.resolve() != folder.resolve()


def _files(listed: Mapping[object, object]) -> dict[str, str]:
    files = {str(name): str(of_content) for name, of_content in listed.items()}
    for name in files:
        if PurePosixPath(name).is_absolute() or ".." in PurePosixPath(name).parts:
            raise ValueError(f"it names '{name}', which lies outside the package")
    return files


def digest(data: bytes) -> str:
    """The digest of the content of a file, as in a manifest."""
    return hashlib.sha256(data).hexdigest()
