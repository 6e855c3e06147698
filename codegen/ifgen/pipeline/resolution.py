"""From the packages of a run to what they mean, without what is left out.

Left out is what the user excludes and, if asked to, what is wrong; and everything that needs either. What
remains is generated as if the rest did not exist, so no generated package names what is not there.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from fnmatch import fnmatchcase
from pathlib import Path
from typing import TYPE_CHECKING, Final

from ifgen.config.ros_distro import refused
from ifgen.definition.explain import did_you_mean
from ifgen.definition.interfaces import Registry
from ifgen.definition.problems import one_for_each_cause
from ifgen.definition.resolve import resolve as resolve_interfaces
from ifgen.diagnostics import Diagnostic, InputError, Span, UsageError
from ifgen.pipeline.values import LeftOut, Request, ResolvedInput, Target
from ifgen.reading.packages import NODE_FOLDER, PackageFiles
from ifgen.reading.search_path import SearchPath, WithDeps

if TYPE_CHECKING:
    from ifgen.nodl.model import Nodes

_UNKNOWN: Final = {"unknown-package", "unknown-type"}
_SEPARATOR: Final = re.compile("/|::")
_TYPE: Final = re.compile(r"[\w/:]+")


def without_excluded(
    packages: Sequence[PackageFiles], patterns: Sequence[str]
) -> tuple[tuple[PackageFiles, ...], tuple[str, ...]]:
    """The packages without what patterns name, and the names that these stand for.

    A pattern is a package or, with a slash, an interface or a node: `demo_msgs`, `demo_msgs/msg/*`. Raises
    UsageError for a pattern that matches nothing.
    """
    if not patterns:
        return tuple(packages), ()
    names = {name: package for package in packages for name in (package.name, *_names(package))}
    excluded: dict[str, None] = {}
    problems: list[Diagnostic] = []
    for pattern in patterns:
        matches = [n for n in names if ("/" in n) == ("/" in pattern) and fnmatchcase(n, pattern)]
        if not matches:
            message = f"`exclude` has the pattern {pattern!r}, which matches no package, interface or node"
            advice = did_you_mean(pattern, names) or "write a package, or an interface as demo_msgs/msg/Name"
            problems.append(Diagnostic("configuration", message, help=advice))
        excluded |= dict.fromkeys(matches)
    if problems:
        raise UsageError(problems)
    kept = tuple(_without(package, excluded) for package in packages if package.name not in excluded)
    return tuple(package for package in kept if package.files or package.nodes), tuple(excluded)


def resolve_what_can_be(request: Request) -> ResolvedInput:
    """Resolve without what is left out.

    Raises InputError with all mistakes if the run does not keep going, or nothing can be generated.
    """
    leaving = _Leaving(request)
    mistakes: list[Diagnostic] = []
    first: Sequence[Diagnostic] = ()
    while True:
        try:
            resolved = resolve(leaving.request())
        except InputError as error:
            first = first or error.diagnostics
            if not request.keep_going and not request.excluded:
                raise
            wrong = leaving.mistakes(error.diagnostics)
            mistakes = one_for_each_cause(dict.fromkeys((*mistakes, *wrong)))
            if wrong and not request.keep_going:
                raise InputError(wrong) from None
            before = len(leaving.reasons)
            leaving.leave_out(error.diagnostics)
            if len(leaving.reasons) == before or leaving.is_empty():
                raise InputError(mistakes or first) from None
        else:
            return replace(resolved, left_out=leaving.left_out(), mistakes=tuple(mistakes))


def about_the_rest(
    found: Iterable[Diagnostic], packages: Sequence[PackageFiles], excluded: Iterable[str]
) -> list[Diagnostic]:
    """The diagnostics, except that something needs what is excluded."""
    excluded = frozenset(excluded)
    return [diagnostic for diagnostic in found if not (excluded and _cause(diagnostic, packages, excluded))]


def resolve(request: Request) -> ResolvedInput:
    """Parse and resolve everything. Raises InputError with all that is wrong."""
    packages, search, with_deps = request.packages, request.search, request.with_deps
    problems: list[Diagnostic] = []
    nodes = None
    if any(package.nodes for package in packages):
        from ifgen.nodl.load import load  # with a YAML parser, which interfaces do without

        try:
            nodes = load(packages, search)
        except InputError as error:
            problems += error.diagnostics
    with_interfaces = [package for package in packages if package.has_interfaces]
    if with_deps and nodes is not None:
        with_interfaces += _needed_by(nodes, with_interfaces, search, with_deps)
    try:
        registry = resolve_interfaces(with_interfaces, search, with_deps)
    except InputError as error:
        problems += error.diagnostics
        raise InputError(one_for_each_cause(dict.fromkeys(problems))) from None
    problems += refused(registry.warnings, request.custom.ros_distro)
    if problems:
        raise InputError(problems)
    targets = tuple(_targets(registry, nodes, search, with_deps))
    return ResolvedInput(packages, registry, nodes, targets, request.output)


def _targets(
    registry: Registry, nodes: Nodes | None, search: SearchPath, with_deps: WithDeps
) -> Iterator[Target]:
    along = (name for name in registry.packages if search.comes_along(name, with_deps))
    names = dict.fromkeys((*registry.requested, *along))
    interfaces = {name: registry.packages[name] for name in names if registry.packages[name].interfaces}
    described = {package.name: package for package in nodes.packages if package.nodes} if nodes else {}
    for name in sorted({*interfaces, *described}):
        yield Target(name, interfaces.get(name), described.get(name))


def _needed_by(
    nodes: Nodes, present: Iterable[PackageFiles], search: SearchPath, with_deps: WithDeps
) -> Iterator[PackageFiles]:
    """The packages to generate whose interfaces nodes use, without those that are present."""
    known = {package.name for package in present}
    for name in sorted(nodes.registry.packages.keys() - known):
        package = search.package(name)
        if package is not None and search.comes_along(name, with_deps):
            yield package


class _Leaving:
    """The names that are left out so far, and why."""

    def __init__(self, request: Request) -> None:
        self._request = request
        self.reasons: dict[str, str] = {}

    def request(self) -> Request:
        """The request without what is left out."""
        if not self.reasons:
            return self._request
        names = {name.partition("/")[0] for name in self.reasons}
        own = [_without(package, self.reasons) for package in self._request.packages]
        kept = tuple(p for p in own if p.name not in self.reasons and (p.files or p.nodes))
        search = self._request.search
        # Dependencies too: a mistake in one of those is a mistake of everything that needs it.
        others = (search.package(name) for name in names - {package.name for package in own})
        left = {package.name for package in own} - {package.name for package in kept}
        hidden = (replace(p, files=(), nodes=()) for p in own if p.name in left)
        known = (*kept, *hidden, *(_without(package, self.reasons) for package in others if package))
        return replace(self._request, packages=kept, search=search.knowing(known))

    def is_empty(self) -> bool:
        """Whether nothing would be generated."""
        return not self.request().packages

    def mistakes(self, found: Iterable[Diagnostic]) -> list[Diagnostic]:
        """The errors that do not come from what is left out."""
        return [each for each in found if each.severity == "error" and not self._cause(each)]

    def leave_out(self, found: Iterable[Diagnostic]) -> None:
        """Leave out everything that errors are about."""
        for each in found:
            if each.severity == "error":
                cause = self._cause(each)
                reason = f"needs {cause}, which is left out" if cause else each.message
                for name in self._owners(each):
                    self.reasons.setdefault(name, reason)

    def left_out(self) -> tuple[LeftOut, ...]:
        """All names, with their reasons."""
        return tuple(LeftOut(name, reason) for name, reason in self.reasons.items())

    def _cause(self, diagnostic: Diagnostic) -> str:
        return _cause(diagnostic, self._request.packages, {*self._request.excluded, *self.reasons})

    def _owners(self, diagnostic: Diagnostic) -> Iterator[str]:
        """The interfaces, nodes or packages that an error is about."""
        if diagnostic.primary is None:
            yield from self._unreadable()
            return
        labels = (diagnostic.primary, *(diagnostic.secondary if diagnostic.rule in _UNKNOWN else ()))
        for path in dict.fromkeys(label.span.source.path for label in labels):
            yield from self._owner(path.absolute())

    def _owner(self, path: Path) -> Iterator[str]:
        for package in self._packages():
            name = next((name for name, file in _files(package) if file == path), None)
            is_node = path.parent.name == NODE_FOLDER
            if name is not None and not (is_node and name in self.reasons):
                yield name
                return
            root = package.root.absolute()
            if path.is_relative_to(root):
                if is_node and package.nodes:  # a part that others include
                    yield from (f"{package.name}/{NODE_FOLDER}/{node.name}" for node in package.nodes)
                else:
                    yield package.name
                return

    def _packages(self) -> Iterator[PackageFiles]:
        yield from self._request.packages
        yield from self._request.search.found()

    def _unreadable(self) -> Iterator[str]:
        for package in self._request.packages:
            for name, path in _files(package):
                try:
                    path.read_text()
                except (OSError, ValueError):
                    yield name


def _cause(diagnostic: Diagnostic, packages: Sequence[PackageFiles], left: Iterable[str]) -> str:
    """The name that is left out and that an error is about; empty if it is about something else."""
    left = frozenset(left)
    if diagnostic.rule not in _UNKNOWN or diagnostic.primary is None or not left:
        return ""
    span = diagnostic.primary.span
    *places, name = _SEPARATOR.split(_type_text(span))
    path = span.source.path.absolute()
    own = next((package.name for package in packages if path.is_relative_to(package.root.absolute())), "")
    package = places[0] if places else own
    wanted = (package, *(f"{package}/{folder}/{name}" for folder in ("msg", "srv", "action")))
    return next((each for each in wanted if each in left), "")


def _type_text(span: Span) -> str:
    match = _TYPE.search(span.source.text, span.start, span.end)
    return match[0] if match else ""


def _without(package: PackageFiles, names: Mapping[str, object]) -> PackageFiles:
    """The package without the interfaces and nodes of these names."""
    files = tuple(f for f in package.files if f"{package.name}/{f.folder}/{f.name}" not in names)
    nodes = tuple(n for n in package.nodes if f"{package.name}/{NODE_FOLDER}/{n.name}" not in names)
    gone = {(f.folder, f.name) for f in package.files} - {(f.folder, f.name) for f in files}
    return replace(package, files=files, nodes=nodes, left_out=package.left_out | gone)


def _names(package: PackageFiles) -> Iterator[str]:
    return (name for name, _ in _files(package))


def _files(package: PackageFiles) -> Iterator[tuple[str, Path]]:
    """The interfaces and nodes of a package, with their files."""
    for file in package.files:
        yield f"{package.name}/{file.folder}/{file.name}", file.path.absolute()
    for node in package.nodes:
        yield f"{package.name}/{NODE_FOLDER}/{node.name}", node.path.absolute()
