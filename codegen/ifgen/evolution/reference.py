"""Reads the earlier version that a REF names: a revision of the repository, a folder, or a lock file."""

from __future__ import annotations

import os
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

from ifgen.diagnostics import Diagnostic, UsageError, shorten
from ifgen.evolution import version
from ifgen.evolution.version import Version
from ifgen.reading import revisions, storage
from ifgen.reading.packages import PackageFiles, find_packages, find_what_can_be
from ifgen.reading.revisions import Revision
from ifgen.reading.search_path import SearchPath


def current(paths: Sequence[Path], include: Sequence[Path]) -> Version:
    """The version on disk. Raises InputError if a path cannot be read or leads to nothing."""
    packages = find_packages(paths)
    return version.load(packages, SearchPath(packages, include))


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
    return _loaded(packages, list(map(there_or_here, include)), mistakes, new)


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
        return _loaded(packages, [path for path in include if storage.exists(path)], mistakes, new)


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


def _loaded(
    packages: Sequence[PackageFiles], include: Sequence[Path], mistakes: Sequence[Diagnostic], new: Version
) -> Version:
    loaded = version.load(packages, SearchPath(packages, include), new.understood())
    return replace(loaded, mistakes=(*(m for m in mistakes if m.rule != "no-interfaces"), *loaded.mistakes))
