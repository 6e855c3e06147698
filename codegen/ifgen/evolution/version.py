"""One version of a project's interfaces and nodes, as far as it can be understood."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

from ifgen.definition.interfaces import Interface, Registry
from ifgen.definition.resolve import Understood, resolve_what_can_be
from ifgen.definition.type_description import messages_of
from ifgen.diagnostics import Diagnostic, InputError, Span
from ifgen.nodl.model import NodeDescription
from ifgen.reading.packages import IDL, NodeFile, PackageFiles
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
