"""A folder of packages as it stands in the editor: what is wrong, what is defined, and who uses it.

A keystroke reads one package again. A search for the uses of a type reads each file that has changed.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Final

from ifgen.config.settings import Settings, settle
from ifgen.config.suppressions import judged
from ifgen.definition.interfaces import Constant, Field, Interface, Message, Registry, Service
from ifgen.definition.problems import one_for_each_cause
from ifgen.definition.references import references, type_span
from ifgen.definition.resolve import Understood, resolve_what_can_be
from ifgen.definition.type_description import messages_of
from ifgen.diagnostics import Diagnostic, InputError, Source, Span
from ifgen.language_server.buffers import Buffers
from ifgen.pipeline.inspection import findings_of
from ifgen.reading import storage
from ifgen.reading.packages import IDL, PackageFiles, find_what_can_be, packages_at
from ifgen.reading.search_path import SearchPath

_TYPE_NAME: Final = re.compile(r"\b([a-z][a-z0-9_]*)/(?:(msg|srv|action)/)?([A-Z][A-Za-z0-9]*)\b")


@dataclass(frozen=True, slots=True)
class Use:
    """A place that names a type."""

    type_name: str
    span: Span


@dataclass
class _State:
    """The contents of the files, as long as none came or went."""

    settings: Settings
    packages: tuple[PackageFiles, ...]
    problems: list[Diagnostic]
    search: SearchPath


@dataclass
class Workspace:
    """The packages below a folder, with the buffers of an editor in the place of files."""

    root: Path
    buffers: Buffers = field(default_factory=Buffers)
    _state: _State | None = None
    _understood: dict[tuple[str, str, str, str], Interface] = field(
        default_factory=dict[tuple[str, str, str, str], Interface]
    )
    _registry: Registry | None = None
    _broken: frozenset[str] = frozenset()
    _found: dict[Path, list[Diagnostic]] = field(default_factory=dict[Path, list[Diagnostic]])
    _uses: dict[str, list[Use]] | None = None

    def open(self, path: Path, text: str) -> None:
        """Take a text in the place of a file."""
        is_new = path not in self.buffers.texts and not path.exists()
        self.buffers.texts[path] = text.replace("\r\n", "\n")
        self._forget()
        if is_new or not _is_definition(path):
            self._state = None

    def close(self, path: Path) -> None:
        """Take the file on disk again."""
        self.buffers.texts.pop(path, None)
        self.files_changed()

    def files_changed(self) -> None:
        """Look again for packages: files came, went, or changed on disk."""
        self._state = None
        self._forget()

    def source(self, path: Path) -> Source | None:
        """The text of a file, with plain line ends; None if it cannot be read."""
        with self.buffers.read_first(self.root), suppress(InputError):
            return storage.read_source(path)
        return None

    def settings(self) -> Settings:
        """The configuration that holds in the folder."""
        with self.buffers.read_first(self.root):
            return self._known().settings

    def package_of(self, path: Path) -> PackageFiles | None:
        """The package that a file is in."""
        owners = [package for package in self.packages() if package.root.absolute() in path.parents]
        if owners:
            return max(owners, key=lambda package: len(package.root.parts))
        with self.buffers.read_first(self.root), suppress(OSError):
            return next(iter(packages_at(path, [])), None)
        return None

    def packages(self) -> tuple[PackageFiles, ...]:
        """The packages below the folder, or those of [tool.ifgen]."""
        with self.buffers.read_first(self.root):
            return self._known().packages

    def findings(self, path: Path) -> list[Diagnostic]:
        """The diagnostics about the package of a file, as `ifgen check` has them."""
        with self.buffers.read_first(self.root):
            try:
                state = self._known()
            except InputError as error:
                return list(error.diagnostics)
            package = self.package_of(path)
            place = package.root if package is not None else path
            if place not in self._found:  # a client may ask for what it has been told already
                self._found[place] = self._findings([package] if package else [])
            return self._found[place] + state.problems

    def all_findings(self) -> list[Diagnostic]:
        """The diagnostics about all packages."""
        with self.buffers.read_first(self.root):
            try:
                state = self._known()
            except InputError as error:
                return list(error.diagnostics)
            return self._findings(state.packages) + state.problems

    def registry(self) -> Registry:
        """All that is defined in the workspace and what that needs, as far as it can be understood."""
        if self._registry is None:
            with self.buffers.read_first(self.root):
                state = self._known()
                self._registry, self._broken, mistakes = resolve_what_can_be(
                    (package for package in state.packages if package.has_interfaces),
                    state.search,
                    self._understood,
                )
            wrong = {each.primary.span.source for each in mistakes if each.primary is not None}
            self._understood = {
                (each.package, each.folder, each.name, each.source.text): each
                for package in self._registry.packages.values()
                for each in package.interfaces
                if each.source is not None
                and each.source not in wrong
                and each.source.path.suffix != IDL  # what it means depends on the files that it includes
            }
        return self._registry

    def is_whole(self, interface: Interface) -> bool:
        """Whether an interface of the workspace, and all that it holds, can be understood."""
        return self._broken.isdisjoint(messages_of(interface))

    def interface(self, type_name: str) -> tuple[Interface, Registry] | None:
        """A type by its full name, wherever packages are looked for."""
        registry = self.registry()
        found = registry.get(type_name)
        if found is not None:
            return found, registry
        package_name, folder, name = type_name.split("/")
        with self.buffers.read_first(self.root), suppress(InputError):
            package = self._known().search.package(package_name)
            file = package.interface(folder, name) if package else None
            if package is not None and file is not None:
                alone = replace(package, files=(file,), partial=True, listed=None)
                registry, _, _ = resolve_what_can_be([alone], self._known().search)
                found = registry.get(type_name)
                return (found, registry) if found is not None else None
        return None

    def understood(self) -> Understood:
        """The interfaces without mistakes, for another version of them."""
        self.registry()
        return self._understood

    def search(self) -> SearchPath:
        """Where packages are looked for."""
        with self.buffers.read_first(self.root):
            return self._known().search

    def uses(self, type_name: str) -> list[Use]:
        """The fields and endpoints that have a type."""
        if self._uses is None:
            uses: dict[str, list[Use]] = {}
            for use in self.all_uses():
                uses.setdefault(use.type_name, []).append(use)
            self._uses = uses
        return self._uses.get(type_name, [])

    def all_uses(self) -> Iterator[Use]:
        """Every place that names a type: fields first, then node descriptions."""
        registry = self.registry()
        for package in registry.packages.values():
            for interface in package.interfaces:
                for message in parts_of(interface):
                    for field_, type_ in references(message):
                        span = type_span(field_)
                        if span is not None:
                            yield Use(type_.type_name, span)
        for known in self.packages():
            for node in known.nodes:
                source = self.source(node.path.absolute())
                if source is not None:
                    yield from uses_in_document(source, self.search())

    def _forget(self) -> None:
        """Forget what followed from the texts."""
        self._registry = self._uses = None
        self._found = {}

    def _known(self) -> _State:
        if self._state is None:
            settings = settle()
            paths = settings.paths or (self.root,)
            packages, problems = find_what_can_be(paths)
            if not settings.paths:
                problems = []  # a folder without packages is no mistake
            self._state = _State(settings, packages, problems, SearchPath(packages, settings.include))
        return self._state

    def _findings(self, packages: Sequence[PackageFiles]) -> list[Diagnostic]:
        state = self._known()
        found, _ = findings_of(packages, state.search, state.settings.output)
        distribution = state.settings.custom.ros_distro
        return list(
            state.settings.policy.told(one_for_each_cause(dict.fromkeys(judged(found, distribution))))
        )


def members_of(message: Message) -> Iterator[Field | Constant]:
    """The fields of a message, then its constants."""
    yield from message.fields
    yield from message.constants


def parts_of(interface: Interface) -> tuple[Message, ...]:
    """The messages that a file writes out, in order."""
    match interface:
        case Message():
            return (interface,)
        case Service():
            return (interface.request, interface.response)
        case _:
            return (interface.goal, interface.result, interface.feedback)


def uses_in_document(source: Source, search: SearchPath) -> Iterator[Use]:
    """The types that a node description names, in full or without their folder."""
    for match in _TYPE_NAME.finditer(source.text):
        package, folder, name = match.groups()
        line = source.text[source.text.rfind("\n", 0, match.start()) + 1 : match.start()]
        if "#" in line:
            continue
        known = search.package(package)
        folders = [folder] if folder else ["msg", "srv", "action"]
        for each in folders:
            if known is not None and known.interface(each, name):
                yield Use(f"{package}/{each}/{name}", Span(source, *match.span()))
                break


def _is_definition(path: Path) -> bool:
    """Whether a change of a file changes definitions only, and not which files there are."""
    return path.suffix in {".msg", ".srv", ".action", ".idl"} or ".nodl." in path.name
