"""Versions of a project's interfaces and nodes: one that is loaded, and the earlier one that a REF names."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path

from ifgen.definition.interfaces import Interface, Registry
from ifgen.definition.resolve import Understood, resolve_what_can_be
from ifgen.definition.type_description import messages_of
from ifgen.diagnostics import Diagnostic, InputError, Span, UsageError, shorten
from ifgen.nodl.model import NodeDescription
from ifgen.reading import revisions, storage
from ifgen.reading.packages import IDL, NodeFile, PackageFiles, find_packages, find_what_can_be
from ifgen.reading.revisions import Revision
from ifgen.reading.search_path import SearchPath


@dataclass(frozen=True)
class Version:
    """The interfaces and nodes of a version, and the mistakes in what is left out of it.

    `packages` are those that are compared, with the places of their names. The `registry` has the interfaces
    that they need, too. `nodes` is None where nothing is known of nodes. `files` are the types that the
    packages have files for, `broken` those messages that nothing can be said of.
    """

    packages: Mapping[str, Span | None]
    registry: Registry
    nodes: tuple[NodeDescription, ...] | None
    files: frozenset[str] = frozenset()
    broken: frozenset[str] = frozenset()
    mistakes: tuple[Diagnostic, ...] = ()

    @cached_property
    def interfaces(self) -> Mapping[str, Interface]:
        """The interfaces that are compared, by type name."""
        packages = (self.registry.packages.get(name) for name in self.packages)
        found = (i for package in packages if package is not None for i in package.interfaces)
        return {i.type_name: i for i in found if self.broken.isdisjoint(messages_of(i))}

    def leaves_out(self, interface: Interface) -> bool:
        """Whether the version has a file for this interface that cannot be understood."""
        return interface.type_name in self.files and interface.type_name not in self.interfaces

    def understood(self) -> Understood:
        """The interfaces without mistakes, for another version that may have the same ones."""
        wrong = {mistake.primary.span.source for mistake in self.mistakes if mistake.primary is not None}
        return {
            (interface.package, interface.folder, interface.name, interface.source.text): interface
            for interface in self.registry
            if interface.source is not None
            and interface.source not in wrong
            and interface.source.path.suffix != IDL  # what it means depends on the files that it includes
        }


def load(
    packages: Sequence[PackageFiles], search: SearchPath, understood: Understood | None = None
) -> Version:
    """The version that these packages are. Files with mistakes are left out of it, and reported."""
    with_interfaces = [package for package in packages if package.has_interfaces]
    registry, broken, mistakes = resolve_what_can_be(with_interfaces, search, understood)
    nodes, wrong = _nodes(packages, search)
    known = {diagnostic.message for diagnostic in mistakes}
    mistakes += (diagnostic for diagnostic in wrong if diagnostic.message not in known)
    return Version(
        {package.name: package.declared for package in packages},
        registry,
        nodes,
        frozenset(f"{p.name}/{file.folder}/{file.name}" for p in packages for file in p.files),
        broken,
        tuple(mistakes),
    )


def _nodes(
    packages: Sequence[PackageFiles], search: SearchPath
) -> tuple[tuple[NodeDescription, ...], list[Diagnostic]]:
    """The nodes that can be loaded, and the mistakes in the others."""
    if not any(package.nodes for package in packages):
        return (), []
    try:
        return _loaded(packages, search), []
    except InputError as error:
        mistakes = [d for d in error.diagnostics if d.severity == "error"]
    right = [replace(p, nodes=tuple(n for n in p.nodes if _loads(p, n, search))) for p in packages]
    try:
        return _loaded(right, search), mistakes
    except InputError:  # wrong only together, which is said above
        return (), mistakes


def _loads(package: PackageFiles, node: NodeFile, search: SearchPath) -> bool:
    try:
        _loaded([replace(package, nodes=(node,))], search)
    except InputError:
        return False
    return True


def _loaded(packages: Sequence[PackageFiles], search: SearchPath) -> tuple[NodeDescription, ...]:
    from ifgen.nodl.load import load as load_nodes  # with a YAML parser, which interfaces do without

    return tuple(node for package in load_nodes(packages, search).packages for node in package.nodes)


def current(paths: Sequence[Path], include: Sequence[Path]) -> Version:
    """The version on disk. Raises InputError if a path cannot be read or leads to nothing."""
    packages = find_packages(paths)
    return load(packages, SearchPath(packages, include))


def earlier(name: str, paths: Sequence[Path], include: Sequence[Path], base: Path, new: Version) -> Version:
    """The version that `name` stands for, of what is at `paths` in the `new` one.

    `base` is the folder of the project, which the paths are relative to. What cannot be understood is left
    out, with its mistakes. Raises UsageError if there is no such version, or if it is a folder or a lock file
    with nothing to compare. A commit may be older than everything here, which then breaks nothing.
    """
    folder = Path(name)
    if os.path.isfile(name):  # noqa: PTH113 - any text will do, also one that no file can be called
        return _not_empty(name, _in_lock(folder, new))
    if os.path.isdir(name):  # noqa: PTH112
        if _looks_like_a_revision(name) and revisions.is_revision(paths[0], name):
            message = f"'{name}' is a folder here, and a revision too"
            advice = f"write ./{name} for the folder, or refs/heads/{name} or refs/tags/{name}"
            raise UsageError([Diagnostic("unknown-revision", message, help=advice)])
        return _not_empty(name, _in_folder(folder, paths, include, base, new))
    return _of_revision(name, paths, include, new)


def _not_empty(name: str, found: Version) -> Version:
    if not found.packages and not found.mistakes:
        message = f"'{shorten(name)}' has none of these interfaces and nodes: there is nothing to compare"
        advice = "name a revision, or a folder or a lock file with earlier versions of these packages"
        raise UsageError([Diagnostic("unknown-revision", message, help=advice)])
    return found


def _looks_like_a_revision(name: str) -> bool:
    return not name.startswith((".", "/")) and "\\" not in name and not Path(name).is_absolute()


def _in_lock(path: Path, new: Version) -> Version:
    """The version in a lock file, which knows no nodes, nor which packages were asked for."""
    from ifgen.evolution.lock import file as lock_file  # its parser, which other versions do without

    registry = lock_file.read(path).registry
    return Version({name: None for name in new.packages if name in registry.packages}, registry, None)


def _in_folder(
    folder: Path, paths: Sequence[Path], include: Sequence[Path], base: Path, new: Version
) -> Version:
    def there(path: Path) -> Path:
        absolute = path.absolute()
        inside = folder / absolute.relative_to(base) if absolute.is_relative_to(base) else folder
        return inside if inside.exists() else folder

    def there_or_here(path: Path) -> Path:
        found = there(path)
        return path if found == folder else found

    packages, mistakes = find_what_can_be(dict.fromkeys(map(there, paths)))
    return _loaded_there(packages, list(map(there_or_here, include)), mistakes, new)


def _of_revision(name: str, paths: Sequence[Path], include: Sequence[Path], new: Version) -> Version:
    found: list[Revision] = []
    for path in paths:
        with storage.as_of(*found):
            is_known = storage.revision(path) is not None
        if not is_known:
            found.append(revisions.revision_of(path, name))
    with storage.as_of(*found):
        _refuse_missing(found, paths)
        packages, mistakes = find_what_can_be([path for path in paths if storage.exists(path)])
        missing = set(new.packages) - {package.name for package in packages}
        packages += _elsewhere(found, missing)
        return _loaded_there(packages, [path for path in include if storage.exists(path)], mistakes, new)


def _elsewhere(found: Sequence[Revision], missing: set[str]) -> tuple[PackageFiles, ...]:
    """The packages of these names in other folders of the repositories: they may have been moved since."""
    if not missing:
        return ()
    packages, _ = find_what_can_be(Path(revision.roots[0]) for revision in found)
    return tuple(package for package in packages if package.name in missing)


def _refuse_missing(found: Sequence[Revision], paths: Sequence[Path]) -> None:
    """Raise UsageError if a submodule cannot be read: nothing in it could be compared."""
    for revision in found:
        for submodule in revision.submodules:
            place = Path(revision.roots[0]) / submodule
            if any(_is_around(place, path.absolute()) for path in paths):
                message = f"submodule {shorten(submodule)} lacks the commit that {revision.name} has of it"
                advice = f"run `git -C {submodule} fetch`, with --unshallow if it is shallow"
                raise UsageError([Diagnostic("no-git", message, help=advice)])


def _is_around(one: Path, other: Path) -> bool:
    return one.is_relative_to(other) or other.is_relative_to(one)


def _loaded_there(
    packages: Sequence[PackageFiles], include: Sequence[Path], mistakes: Sequence[Diagnostic], new: Version
) -> Version:
    loaded = load(packages, SearchPath(packages, include), new.understood())
    return replace(loaded, mistakes=(*(m for m in mistakes if m.rule != "no-interfaces"), *loaded.mistakes))
