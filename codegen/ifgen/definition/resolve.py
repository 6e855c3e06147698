"""From package files to a closed registry: reads what was asked for and whatever its fields need."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from functools import partial
from pathlib import Path
from types import MappingProxyType
from typing import TypeAlias, cast

from ifgen.definition import build, dependencies, derive, file_names, names, references
from ifgen.definition.impossible import check_cycles, check_totals
from ifgen.definition.interfaces import (
    Action,
    Field,
    Folder,
    Interface,
    InterfacePackage,
    Message,
    Registry,
)
from ifgen.definition.problems import FileProblems, one_for_each_cause
from ifgen.definition.types import NamespacedType
from ifgen.diagnostics import Diagnostic, InputError, Label, Source
from ifgen.reading import storage
from ifgen.reading.packages import IDL, InterfaceFile, PackageFiles
from ifgen.reading.search_path import SearchPath, WithDeps


def resolve(packages: Iterable[PackageFiles], search: SearchPath, with_deps: WithDeps = False) -> Registry:
    """Read packages and what they depend on into a registry; InputError with everything that is wrong.

    Reads only the files of a dependency that some field needs, or all if `with_deps` includes it. Warnings
    about the requested packages are in the registry, or in the error after the mistakes.
    """
    packages = tuple(packages)
    resolver = _Resolver(search, with_deps)
    resolver.read(packages)
    errors, warnings = resolver.findings()
    if errors:
        raise InputError([*errors, *warnings])
    return resolver.registry(tuple(package.name for package in packages), tuple(warnings))


Understood: TypeAlias = Mapping[tuple[str, str, str, str], Interface]
"""Interfaces without mistakes, by package, kind, name and text."""


def resolve_what_can_be(
    packages: Iterable[PackageFiles], search: SearchPath, understood: Understood | None = None
) -> tuple[Registry, frozenset[str], list[Diagnostic]]:
    """The same, where something is wrong perhaps: the messages that cannot be described, and the errors.

    What is `understood` of another version of the packages is not read again. Its places are in that.
    """
    packages = tuple(packages)
    resolver = _Resolver(search, False, understood or {})
    resolver.read(packages)
    errors, _ = resolver.findings()
    broken = resolver.broken(errors) if errors else frozenset[str]()
    return resolver.registry(tuple(package.name for package in packages), ()), broken, errors


class _Resolver:
    """The interfaces read so far, and those whose references are still unresolved."""

    def __init__(
        self, search: SearchPath, with_deps: WithDeps, understood: Understood = MappingProxyType({})
    ) -> None:
        self._search = search
        self._understood = understood
        self._with_deps: WithDeps = with_deps
        self._problems: list[Diagnostic] = []
        self._requested: list[PackageFiles] = []
        self._problems_of: dict[Source, FileProblems] = {}
        self._packages: dict[str, PackageFiles] = {}
        self._interfaces: dict[str, Interface] = {}
        self._messages: dict[str, Message] = {}
        self._modules: dict[tuple[str, str, str], Interface] = {}
        self._read: set[InterfaceFile] = set()
        self._twins: set[Path] = set()
        self._pending: list[Interface] = []

    def read(self, packages: Iterable[PackageFiles]) -> None:
        """Read packages and all that they need."""
        for package in packages:
            self.add_package(package, requested=True)
        self.add_dependencies()

    def add_package(self, package: PackageFiles, requested: bool) -> None:
        """Read all files of a package."""
        self._adopt(package, requested)
        if requested:
            self._requested.append(package)
            self._look_at_descriptions(package)
            self._report(package.listed.diagnostics if package.listed else (), requested)
        for file in package.files:
            self._add(package, file, requested)

    def add_dependencies(self) -> None:
        """Read what the fields of everything read so far refer to, and so on until nothing is missing."""
        while self._pending:
            interface = self._pending.pop()
            if isinstance(interface, Action):
                for support in derive.ACTION_SUPPORT:
                    self._require(NamespacedType(*support), interface, None)
            for message in _parts(interface):
                for field, type_ in references.references(message):
                    if type_.type_name not in self._messages:
                        self._require(type_, message, field)

    def findings(self) -> tuple[list[Diagnostic], list[Diagnostic]]:
        """All errors and all warnings, file by file."""
        uses = self._uses()
        for package in self._requested:
            self._report(dependencies.check(package, uses.get(package.name, {}), self._search), True)
        found = [*self._problems]
        for problems in dict.fromkeys(self._problems_of.values()):
            found += (*problems.errors(), *problems.warnings())
        errors = [diagnostic for diagnostic in found if diagnostic.severity == "error"]
        errors += check_cycles(self._messages)
        if not errors:
            errors += check_totals(self._messages)
        return one_for_each_cause(errors), [d for d in found if d.severity == "warning"]

    def broken(self, errors: Iterable[Diagnostic]) -> frozenset[str]:
        """The messages in which something is wrong, or in one that they hold."""
        missing = {"unknown-package", "unknown-type"}  # of one field, while the others are right
        sources = {e.primary.span.source for e in errors if e.primary is not None and e.rule not in missing}
        users: dict[str, list[str]] = {}
        pending: list[str] = []
        for message in self._messages.values():
            if message.source in sources:
                pending.append(message.type_name)
            for _, type_ in references.references(message):
                users.setdefault(type_.type_name, []).append(message.type_name)
        pending += (name for name in users if name not in self._messages)
        found: set[str] = set()
        while pending:
            name = pending.pop()
            if name not in found:
                found.add(name)
                pending += users.get(name, ())
        return frozenset(found)

    def registry(self, requested: tuple[str, ...], warnings: tuple[Diagnostic, ...]) -> Registry:
        """Everything that was read."""
        by_package: dict[str, list[Interface]] = {name: [] for name in requested}
        for interface in self._interfaces.values():
            by_package.setdefault(interface.package, []).append(interface)
        packages = {
            name: InterfacePackage(
                name,
                tuple(sorted(interfaces, key=lambda interface: (interface.folder, interface.name))),
                complete=len(interfaces) == len(self._packages[name].known_files()),
            )
            for name, interfaces in by_package.items()
        }
        return Registry.of(packages, requested, warnings)

    def _adopt(self, package: PackageFiles, requested: bool) -> None:
        """Take note of a package, and of what is wrong with its name."""
        if package.name not in self._packages:
            self._packages[package.name] = package
            self._report(file_names.check_package(package), requested)

    def _look_at_descriptions(self, package: PackageFiles) -> None:
        """Look at package.xml and CMakeLists.txt too: there may be nothing wrong but a comment of no use."""
        for span in (package.declared, package.listed.span if package.listed else None):
            if span is not None:
                problems = self._problems_of.setdefault(span.source, FileProblems(span.source))
                problems.sees_all = not package.partial

    def _report(self, found: Iterable[Diagnostic], with_warnings: bool) -> None:
        """Note a mistake in a package, with its file, if any."""
        for diagnostic in found:
            if diagnostic.primary is None:
                if with_warnings or diagnostic.severity == "error":
                    self._problems.append(diagnostic)
                continue
            source = diagnostic.primary.span.source
            problems = self._problems_of.setdefault(source, FileProblems(source, with_warnings))
            add = problems.error if diagnostic.severity == "error" else problems.warning
            add(lambda diagnostic=diagnostic: diagnostic)  # type: ignore[misc]

    def _uses(self) -> dict[str, dict[str, Label]]:
        """The packages whose types each package names, with the first place."""
        found: dict[str, dict[str, Label]] = {}
        for message in self._messages.values():
            of_package = found.setdefault(message.package, {})
            for field, type_ in references.references(message):
                if type_.package not in of_package and (label := references.label(field)) is not None:
                    of_package[type_.package] = Label(label.span)  # without a place, rosidl has added it
        return found

    def _add(self, package: PackageFiles, file: InterfaceFile, requested: bool) -> None:
        if file in self._read:
            return
        self._read.add(file)
        try:
            source = file.read()
        except InputError as error:
            self._problems += error.diagnostics
            return
        problems = self._problems_of[source] = FileProblems(source, with_warnings=requested)
        problems.sees_all = not package.partial
        problems.extend(file_names.check_file(file, source), 0)
        if (twins := file_names.two_forms(file, source)) is not None:
            stem = file.path.with_suffix("")
            if stem not in self._twins:
                problems.extend([twins], 0)
            self._twins.add(stem)
            return
        kind = cast(Folder, file.kind)
        known = self._understood.get((package.name, kind, file.name, source.text))
        if known is not None and known.source is not None:
            self._problems_of.setdefault(known.source, problems)
            self._register(known, source, problems)
            return
        is_there = partial(self._is_there, source)
        interface = build.interface(source, package.name, kind, file.name, problems, is_there)
        self._register(interface, source, problems)

    def _is_there(self, source: Source, path: str) -> bool:
        """Whether there is a file that an .idl file includes, in whatever form: that is what types need."""
        name, *rest = path.removesuffix(IDL).split("/")
        if len(rest) == 2 and (package := self._package(name)) and package.interface(*rest):
            return True
        try:
            return storage.is_file(source.path.parent / path)
        except (OSError, ValueError):  # no file can be called so
            return False

    def _package(self, name: str) -> PackageFiles | None:
        return self._packages.get(name) or self._search.package(name)

    def _register(self, interface: Interface, source: Source, problems: FileProblems) -> None:
        for part in _described(interface):
            first = self._interfaces.get(part.type_name) or self._messages.get(part.type_name)
            if first is not None:
                problems.error(file_names.duplicate_type, part.type_name, source, first.source)
                return
        module = (interface.package, interface.folder, names.snake_case(interface.name))
        other = self._modules.setdefault(module, interface)
        if other is not interface:
            problems.error(file_names.same_module, interface.type_name, other.type_name, source, other.source)
        self._interfaces[interface.type_name] = interface
        self._messages.update((part.type_name, part) for part in _parts(interface))
        self._pending.append(interface)

    def _require(self, type_: NamespacedType, user: Interface, field: Field | None) -> None:
        """Read the file of a type that an interface needs, or say that there is none."""
        package = self._package(type_.package)
        file = _file_of(type_, package) if package else None
        problems = self._problems_of[user.source] if user.source else None
        if package is None:
            if problems is not None:
                problems.error(references.unknown_package, type_, field, self._search)
        elif file is None:
            if problems is not None:
                problems.error(references.unknown_type, type_, field, package, self._search)
        else:
            if self._search.comes_along(type_.package, self._with_deps):
                self.add_package(package, requested=False)
            else:
                self._adopt(package, requested=False)
            # Also where all of the package comes along: its files may be a single one, which was asked for.
            self._add(package, file, requested=False)
        # A file that was found by the name of the whole may have no such part, and a service is no message.
        is_unknown = type_.folder != "msg" and type_.type_name not in self._messages
        if is_unknown and field and package and file and problems is not None:
            problems.error(references.unknown_type, type_, field, package, self._search)


def _file_of(type_: NamespacedType, package: PackageFiles) -> InterfaceFile | None:
    """The file that defines a type.

    A part such as `srv/Name_Request` is in the file of the whole interface.
    """
    file = package.interface(type_.folder, type_.name)
    name = type_.name
    while file is None and type_.folder != "msg" and "_" in name:
        name = name.rpartition("_")[0]
        file = package.interface(type_.folder, name)
    return file


def _parts(interface: Interface) -> tuple[Message, ...]:
    return (interface,) if isinstance(interface, Message) else interface.messages


def _described(interface: Interface) -> tuple[Interface, ...]:
    return (interface,) if isinstance(interface, Message) else (interface, *interface.messages)
