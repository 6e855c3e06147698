"""Finds types and packages by their names, wherever interfaces can be found."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace
from difflib import get_close_matches

from ifgen.definition.interfaces import Registry
from ifgen.definition.resolve import resolve
from ifgen.definition.type_description import Described, described_types
from ifgen.diagnostics import Diagnostic, UsageError
from ifgen.read import FOLDERS, InterfaceFile, PackageFiles, SearchPath


def find_type(name: str, search: SearchPath) -> tuple[Described, Registry]:
    """A message, service or action, or a type derived from one, and a registry with all that it needs.

    `name` is `pkg/msg/Name`; `pkg/Name` will do where only one folder has it. Raises UsageError if nothing has
    this name, and InterfaceError if its file or one that it needs is wrong.
    """
    package, files = _find_files(name, search)
    registry = resolve([replace(package, files=files, partial=True)], search)
    described = [d for file in files for d in _described(package, file, registry)]
    found = [d for d in described if d.name == name.rpartition("/")[2]]
    if len(found) == 1:
        return found[0], registry
    if found:
        message = f"'{name}' is {' and '.join(d.type_name for d in found)}"
        raise UsageError([Diagnostic("ambiguous-type", message, help="name its folder too")])
    raise UsageError([_unknown_type(name, [d.type_name for d in described])])


def find_types(names: Iterable[str], search: SearchPath) -> tuple[list[Described], Registry]:
    """The types of these names and of these packages, derived types included, and one registry of them.

    Raises UsageError with every name that nothing has, and InterfaceError if one of the files is wrong.
    """
    packages: dict[str, PackageFiles] = {}
    wanted: dict[str, dict[InterfaceFile, None]] = {}
    problems: list[Diagnostic] = []
    for name in names:
        try:
            package, files = _find_files(name, search)
        except UsageError as error:
            problems.extend(error.diagnostics)
        else:
            packages[package.name] = package
            wanted.setdefault(package.name, {}).update(dict.fromkeys(files))
    if problems:
        raise UsageError(problems)
    requested = [replace(packages[name], files=tuple(files), partial=True) for name, files in wanted.items()]
    registry = resolve(requested, search)
    found = [d for p in requested for file in p.files for d in _described(p, file, registry)]
    return found, registry


def _described(package: PackageFiles, file: InterfaceFile, registry: Registry) -> list[Described]:
    return list(described_types(registry.interface(f"{package.name}/{file.folder}/{file.name}")))


def _find_files(name: str, search: SearchPath) -> tuple[PackageFiles, tuple[InterfaceFile, ...]]:
    """The files that `pkg`, `pkg/msg`, `pkg/Name` or `pkg/msg/Name` stands for, at least one."""
    package_name, *rest = name.split("/")
    package = search.find(package_name)
    if package is None:
        raise UsageError([_unknown_package(name, search)])
    folder = rest.pop(0) if rest and rest[0] in FOLDERS else None
    short = "/".join(rest)
    # A derived type, such as AddTwoInts_Request, is in the file that its name starts with.
    stems = {short, short.partition("_")[0]} if short else None
    files = tuple(
        file
        for file in package.known_files()
        if folder in {None, file.folder} and (stems is None or file.name in stems)
    )
    if not files:
        known = [f"{package.name}/{file.folder}/{file.name}" for file in package.known_files()]
        raise UsageError([_unknown_type(name, known)])
    return package, files


def _unknown_package(name: str, search: SearchPath) -> Diagnostic:
    package, slash, rest = name.partition("/")
    close = get_close_matches(package, search.package_names(), n=1)
    advice = (
        f"did you mean '{close[0]}{slash}{rest}'?" if close else "name the folder that it is in with -I DIR"
    )
    return Diagnostic("unknown-package", f"there is no interface package '{package}'", help=advice)


def _unknown_type(name: str, known: list[str]) -> Diagnostic:
    close = get_close_matches(name, known, n=3)
    package = name.partition("/")[0]
    advice = f"did you mean {' or '.join(map(repr, close))}?" if close else f"see `ifgen hash {package}`"
    return Diagnostic("unknown-type", f"there is no type '{name}'", help=advice)
