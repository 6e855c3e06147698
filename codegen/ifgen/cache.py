"""Remembers from which inputs each package was generated, so that rendering it again can be skipped.

It lies in the user's cache folder and is no part of the output, for it names the version of ifgen down to its
code: committed manifests would change for no reason. Losing it costs time only.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Iterable, Iterator
from contextlib import suppress
from pathlib import Path

from ifgen import manifest, transaction
from ifgen.definition.interfaces import Interface, InterfacePackage, Message, Registry
from ifgen.definition.types import Array, BoundedSequence, NamespacedType, UnboundedSequence


class Inputs:
    """Digests of everything that the generated files of a package depend on."""

    def __init__(self, registry: Registry, templates: Iterable[Path]) -> None:
        self._registry = registry
        self._generator = _digest_of_generator(templates)

    def digest(self, package: InterfacePackage) -> str:
        """Changes with ifgen, the templates, the package's files and those of the packages that it needs."""
        hasher = hashlib.sha256(self._generator)
        for name in sorted(self._closure(package)):
            for interface in self._registry.packages[name].interfaces:
                text = interface.source.text if interface.source else ""
                hasher.update(f"{interface.type_name}\0{text}\0".encode())
        return hasher.hexdigest()

    def _closure(self, package: InterfacePackage) -> set[str]:
        found = {package.name}
        pending = [package]
        while pending:
            for interface in pending.pop().interfaces:
                for name in _referenced_packages(interface):
                    if name not in found:
                        found.add(name)
                        pending.append(self._registry.packages[name])
        return found


class Cache:
    """What was generated into one output folder from which inputs."""

    def __init__(self, directory: Path) -> None:
        import platformdirs

        name = hashlib.sha256(str(directory.resolve()).encode(errors="surrogateescape")).hexdigest()[:32]
        self._path = platformdirs.user_cache_path("ifgen") / "generated" / f"{name}.json"
        self._directory = directory
        self._known: dict[str, str] = {}
        with suppress(OSError, ValueError):
            match json.loads(self._path.read_text(encoding="utf-8")):
                case {**known}:
                    self._known = {str(package): str(entry) for package, entry in known.items()}
                case _:
                    pass

    def knows(self, package: str, inputs: str) -> bool:
        """Whether the package there was generated from these inputs, going by its manifest."""
        return self._known.get(package) == self._entry(package, inputs)

    def remember(self, packages: dict[str, str]) -> None:
        """Note from which inputs packages have been generated just now."""
        known = self._known | {name: self._entry(name, inputs) for name, inputs in packages.items()}
        if known != self._known:
            with suppress(OSError):
                self._path.parent.mkdir(parents=True, exist_ok=True)
                text = json.dumps(known, indent=1, sort_keys=True)
                transaction.apply([(self._path, text.encode())], self._path.parent)

    def _entry(self, package: str, inputs: str) -> str:
        """Inputs and manifest, for another ifgen may have generated there since."""
        try:
            record = (self._directory / package / manifest.NAME).read_bytes()
        except OSError:
            return ""
        return f"{inputs}:{manifest.digest(record)}"


def _digest_of_generator(templates: Iterable[Path]) -> bytes:
    """Of ifgen's own code and of templates; a version number would miss changes in a checkout."""
    hasher = hashlib.sha256()
    here = Path(__file__).parent
    code = [
        *here.glob("*.py"),
        *(f for room in ("idl", "definition", "generator_py") for f in _files(here / room)),
    ]
    for path in (*sorted(code), *(f for folder in templates for f in _files(folder))):
        with suppress(OSError):
            hasher.update(f"{path.name}\0".encode(errors="surrogateescape") + path.read_bytes())
    return hasher.digest()


def _files(folder: Path) -> list[Path]:
    return sorted(p for p in folder.rglob("*") if p.is_file() and p.suffix != ".pyc")


def _referenced_packages(interface: Interface) -> Iterator[str]:
    for message in (interface,) if isinstance(interface, Message) else interface.messages:
        for field in message.fields:
            type_ = field.type
            if isinstance(type_, Array | BoundedSequence | UnboundedSequence):
                type_ = type_.value_type
            if isinstance(type_, NamespacedType):
                yield type_.package
