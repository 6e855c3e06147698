"""Finds types and packages by their names, wherever interfaces can be found."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from ifgen.config.settings import settle
from ifgen.definition.interfaces import Registry
from ifgen.definition.resolve import resolve, resolve_what_can_be
from ifgen.definition.type_description import Described, described_types, messages_of
from ifgen.diagnostics import Diagnostic, UsageError, did_you_mean, near_names
from ifgen.reading.packages import FOLDERS, InterfaceFile, PackageFiles, find_packages
from ifgen.reading.search_path import SearchPath


def search_path(include: tuple[Path, ...]) -> SearchPath:
    """Where commands look for types by name: the paths of the configuration first."""
    settings = settle(None, None, include)
    return SearchPath(find_packages(settings.paths), settings.include)


def find_type(name: str, search: SearchPath) -> tuple[Described, Registry]:
    """A message, service or action, or a type derived from one, and a registry with all that it needs.

    `name` is `pkg/msg/Name`; `pkg/Name` will do where only one folder has it, and `Name` where only one
    package has. Raises UsageError if nothing has this name, and InputError if its file or one that it
    needs is wrong.
    """
    described, registry = find_types([name], search)
    found = [d for d in described if d.name == _plain(name).rpartition("/")[2]]
    if len(found) == 1:
        return found[0], registry
    if found:
        raise UsageError([_ambiguous(name, [d.type_name for d in found])])
    raise UsageError([_unknown_type(name, [d.type_name for d in described])])


def types_in(name: str, search: SearchPath) -> list[str]:
    """The types that are defined in a package, or in its folder `pkg/msg`; none if it is neither."""
    package_name, _, folder = _plain(name).partition("/")
    package = search.package(package_name) if folder in {"", *FOLDERS} else None
    files = package.known_files() if package else ()
    return sorted(f"{package_name}/{f.folder}/{f.name}" for f in files if folder in {"", f.folder})


def find_types(names: Iterable[str], search: SearchPath) -> tuple[list[Described], Registry]:
    """The types for the names, with derived types and all types of packages, and one registry of them.

    Raises UsageError with every name that nothing has, and InputError if one of the files is wrong.
    """
    matches = _matches(names, search)
    registry = resolve(_packages(matches), search)
    return _described(matches, registry), registry


def find_what_can_be(
    names: Iterable[str], search: SearchPath
) -> tuple[list[Described], Registry, list[Diagnostic]]:
    """The same, without types that have mistakes in them or in what they need; and those mistakes.

    Raises UsageError with every name that nothing has.
    """
    matches = _matches(names, search)
    registry, broken, errors = resolve_what_can_be(_packages(matches), search)
    found = _described(matches, registry)
    return [d for d in found if broken.isdisjoint(messages_of(d))], registry, errors


def _matches(names: Iterable[str], search: SearchPath) -> list[_Match]:
    matches: list[_Match] = []
    problems: list[Diagnostic] = []
    for name in names:
        try:
            matches.append(_match(name, search))
        except UsageError as error:
            problems.extend(error.diagnostics)
    if problems:
        raise UsageError(problems)
    return matches


def _described(matches: Iterable[_Match], registry: Registry) -> list[Described]:
    problems: list[Diagnostic] = []
    found: dict[str, Described] = {}
    for match in matches:
        described = match.described(registry)
        wanted = [d for d in described if match.derived in {None, d.name}]
        if described and not wanted:
            problems.append(_unknown_type(match.name, [d.type_name for d in described]))
        found.update((d.type_name, d) for d in wanted)
    if problems:
        raise UsageError(problems)
    return list(found.values())


@dataclass(frozen=True, slots=True)
class _Match:
    """The files that a name stands for, and the derived type that it names, if any."""

    name: str
    package: PackageFiles
    files: tuple[InterfaceFile, ...]
    derived: str | None

    def described(self, registry: Registry) -> list[Described]:
        """All that these files describe, as far as they could be read."""
        names = (f"{self.package.name}/{file.folder}/{file.name}" for file in self.files)
        interfaces = (interface for name in names if (interface := registry.get(name)) is not None)
        return [described for interface in interfaces for described in described_types(interface)]


def _match(name: str, search: SearchPath) -> _Match:
    """The types that `pkg`, `pkg/msg`, `Name`, `pkg/Name` or `pkg/msg/Name` stands for.

    UsageError if none.
    """
    package_name, *rest = _plain(name).split("/")
    package = search.package(package_name)
    if package is None:
        if not rest and package_name[:1].isupper():  # names of packages are lower-case
            return _everywhere(package_name, search)
        raise UsageError([_unknown_package(_plain(name), search)])
    folder = rest.pop(0) if rest and rest[0] in FOLDERS else None
    short = "/".join(rest)
    files = [file for file in package.known_files() if folder in {None, file.folder}]
    if not short:
        return _Match(name, package, tuple(files), None)
    # A derived type, such as AddTwoInts_Request, is in the file that its name starts with.
    stem, separator = short, "_"
    while stem and separator:
        found = tuple(file for file in files if file.name == stem)
        if found:
            return _Match(name, package, found, short if stem != short else None)
        stem, separator, _ = stem.rpartition("_")
    raise UsageError(
        [_unknown_type(name, [f"{package.name}/{f.folder}/{f.name}" for f in package.known_files()])]
    )


def _plain(name: str) -> str:
    """A name as ROS writes it, also if it is written as in Python or C++: `pkg.msg.Name`, `pkg::Name`."""
    return name.replace("::", "/").replace(".", "/")


def _everywhere(name: str, search: SearchPath) -> _Match:
    """The type that a bare name stands for. Raises UsageError unless exactly one file fits."""
    found: list[tuple[str, PackageFiles, InterfaceFile]] = []
    for package in filter(None, map(search.package, search.package_names())):
        found += ((f"{package.name}/{f.folder}/{f.name}", package, f) for f in package.known_files())
    stem = name.partition("_")[0]  # of a derived type, such as AddTwoInts_Request
    named = [known for known in found if known[2].name in {name, stem}]
    if len(named) == 1:
        [(_, package, file)] = named
        return _Match(name, package, (file,), None if file.name == name else name)
    if named:
        raise UsageError([_ambiguous(name, [type_name for type_name, _, _ in named])])
    close = near_names(name, {file.name for _, _, file in found})
    known = [type_name for type_name, _, file in found if file.name in close]
    advice = f"did you mean {' or '.join(map(repr, known))}?" if known else "write it as `package/msg/Name`"
    raise UsageError([Diagnostic("unknown-type", f"there is no type '{name}'", help=advice)])


def _packages(matches: Iterable[_Match]) -> list[PackageFiles]:
    """Each package once, with the files that its matches ask for."""
    packages: dict[str, PackageFiles] = {}
    for match in matches:
        earlier = packages[match.package.name].files if match.package.name in packages else ()
        files = tuple(dict.fromkeys((*earlier, *match.files)))
        packages[match.package.name] = replace(match.package, files=files, partial=True, listed=None)
    return list(packages.values())


def _ambiguous(name: str, known: Sequence[str]) -> Diagnostic:
    message = f"'{name}' stands for {len(known)} types"
    return Diagnostic("ambiguous-type", message, help=f"write {', '.join(known[:-1])} or {known[-1]}")


def _unknown_package(name: str, search: SearchPath) -> Diagnostic:
    package, slash, rest = name.partition("/")
    message = f"there is no interface package '{package}'"
    close = near_names(package, search.package_names())
    hint = ""
    if close:
        found = search.package(close[0])
        stem = rest.rpartition("/")[2].partition("_")[0]  # of a derived type, such as AddTwoInts_Request
        has_type = found is not None and stem in {file.name for file in found.known_files()}
        meant = f"'{close[0]}{slash}{rest}'" if has_type or not rest else f"the package '{close[0]}'"
        hint = f"did you mean {meant}? If not, "
    return Diagnostic("unknown-package", message, help=f"{hint}name the folder that it is in with -I DIR")


def _unknown_type(name: str, known: list[str]) -> Diagnostic:
    advice = did_you_mean(name, known, limit=3) or f"see `ifgen hash {name.partition('/')[0]}`"
    return Diagnostic("unknown-type", f"there is no type '{name}'", help=advice)
