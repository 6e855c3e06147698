"""From package files to a closed registry: reads what was asked for and whatever its fields need."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import Final, cast

from ifgen.definition import build, derive, explain, names
from ifgen.definition.interfaces import Action, Field, Folder, Interface, InterfacePackage, Message, Registry
from ifgen.definition.types import Array, BoundedSequence, NamespacedType, UnboundedSequence
from ifgen.diagnostics import Diagnostic, InterfaceError, Label
from ifgen.read import InterfaceFile, PackageFiles, SearchPath


def resolve(
    packages: Iterable[PackageFiles], search: SearchPath, whole_dependencies: bool = False
) -> Registry:
    """Read packages and what they depend on into a registry; InterfaceError with everything that is wrong.

    Of a dependency only the files are read that somebody's fields need, or all with `whole_dependencies`.
    """
    resolver = _Resolver(search, whole_dependencies)
    packages = tuple(packages)
    for package in packages:
        resolver.add_package(package)
    resolver.add_dependencies()
    if resolver.problems:
        raise InterfaceError(resolver.problems)
    return resolver.registry(packages)


class _Resolver:
    """What has been read so far, and whose references are still to be looked at."""

    def __init__(self, search: SearchPath, whole_dependencies: bool) -> None:
        self.problems: list[Diagnostic] = []
        self._search = search
        self._whole_dependencies = whole_dependencies
        self._interfaces: dict[str, Interface] = {}
        self._files: dict[str, PackageFiles] = {}
        self._read: set[str] = set()
        self._messages: dict[str, Message] = {}
        self._pending: list[Interface] = []

    def add_package(self, package: PackageFiles) -> None:
        """Read all files of a package."""
        self._files[package.name] = package
        for file in package.files:
            self._add(package, file)

    def add_dependencies(self) -> None:
        """Read what the fields of everything read so far refer to, and so on until nothing is missing."""
        while self._pending:
            interface = self._pending.pop()
            if isinstance(interface, Action):
                for package, folder, name in derive.ACTION_SUPPORT:
                    self._require(NamespacedType(package, folder, name), interface, None)
            for message in (interface,) if isinstance(interface, Message) else interface.messages:
                for field, type_ in _references(message):
                    if type_.type_name not in self._messages:
                        self._require(type_, message, field)

    def registry(self, requested: tuple[PackageFiles, ...]) -> Registry:
        """Everything that was read."""
        by_package: dict[str, list[Interface]] = {package.name: [] for package in requested}
        for interface in self._interfaces.values():
            by_package.setdefault(interface.package, []).append(interface)
        packages = {
            name: InterfacePackage(
                name,
                tuple(sorted(interfaces, key=lambda interface: (interface.folder, interface.name))),
                complete=self._is_complete(name),
            )
            for name, interfaces in by_package.items()
        }
        return Registry.of(packages, tuple(package.name for package in requested))

    def _is_complete(self, name: str) -> bool:
        files = self._files[name]
        return all(f"{name}/{file.folder}/{file.name}" in self._interfaces for file in files.known_files())

    def _add(self, package: PackageFiles, file: InterfaceFile) -> None:
        type_name = f"{package.name}/{file.folder}/{file.name}"
        if type_name in self._read:
            return
        self._read.add(type_name)
        try:
            source = file.read()
        except InterfaceError as error:
            self.problems += error.diagnostics
            return
        interface = build.interface(source, package.name, cast(Folder, file.folder), file.name, self.problems)
        self._interfaces[type_name] = interface
        parts = (interface,) if isinstance(interface, Message) else interface.messages
        for part in parts:
            self._messages[part.type_name] = part
        self._pending.append(interface)

    def _require(self, type_: NamespacedType, message: Interface, field: Field | None) -> None:
        """Read the file of a type, or say that there is none."""
        if type_.type_name in self._read:
            return
        package = self._files.get(type_.package) or self._search.find(type_.package)
        file = package.find(type_.folder, type_.name) if package else None
        if package is not None and file is not None:
            self._files[package.name] = package
            if self._whole_dependencies:
                self.add_package(package)
            else:
                self._add(package, file)
            return
        label = Label(field.span) if field is not None and field.span is not None else None
        if package is None:
            self.problems.append(
                Diagnostic("unknown-package", f"package '{type_.package}' is nowhere to be found", label)
            )
        else:
            self.problems.append(Diagnostic("unknown-type", f"there is no {type_.type_name}", label))


def _references(message: Message) -> Iterator[tuple[Field, NamespacedType]]:
    for field in message.fields:
        type_ = field.type
        if isinstance(type_, Array | BoundedSequence | UnboundedSequence):
            type_ = type_.value_type
        if isinstance(type_, NamespacedType):
            yield field, type_
