"""From packages with NoDL files to descriptions of nodes: everything read, included, resolved and checked."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from ifgen.definition import file_names
from ifgen.definition.interfaces import Registry
from ifgen.definition.problems import FileProblems, one_for_each_cause
from ifgen.definition.resolve import resolve
from ifgen.diagnostics import Diagnostic, InputError, Label, Source, Span
from ifgen.nodl import composition, document, rules
from ifgen.nodl.document import Document, Written, written
from ifgen.nodl.model import Interface, NodeDescription, NodePackage, Nodes, PackageMetadata
from ifgen.reading import package_xml
from ifgen.reading.packages import NODE_FOLDER, InterfaceFile, NodeFile, PackageFiles, node_name
from ifgen.reading.search_path import SearchPath


def load(packages: Sequence[PackageFiles], search: SearchPath) -> Nodes:
    """The nodes that packages describe, and every interface that they use.

    Raises InputError with everything that is wrong, the interfaces that they use included.
    """
    loader = _Loader(search, [composition.real(package.root) for package in packages])
    loaded = tuple(loader.package(package) for package in packages if package.nodes)
    errors, warnings = loader.findings()
    try:
        registry = _registry(loaded, search)
    except InputError as error:
        # Warnings about interfaces appear only when those are asked for.
        errors += (found for found in error.diagnostics if found.severity == "error")
        raise InputError([*errors, *warnings]) from None
    if errors:
        raise InputError([*errors, *warnings])
    return Nodes(loaded, registry, tuple(warnings))


@dataclass(frozen=True, slots=True)
class Loaded:
    """A document with all that it includes.

    `whole` is its interface in the order of its documents. It `exists` if it stands for code that does.
    """

    description: NodeDescription
    whole: Interface
    documents: tuple[Document, ...]
    written: Written
    exists: bool


def load_document(path: Path, search: SearchPath) -> tuple[Loaded | None, list[Diagnostic]]:
    """One document with its includes, wherever it is, and all that is wrong with it.

    It is None if it cannot be read. Interfaces need not exist, which is among the findings.
    """
    path = path.absolute()
    in_package = path.parent.name == NODE_FOLDER
    loader = _Loader(search, [composition.real(path.parent)])
    loaded = loader.document(path.parent.parent.name if in_package else "", NodeFile(path))
    errors, warnings = loader.findings()
    return loaded, [*errors, *warnings]


class _Loader:
    """The documents that have been read so far, each once, and what is wrong with them."""

    def __init__(self, search: SearchPath, roots: Sequence[Path]) -> None:
        self._search = search
        self._roots = roots
        self._documents: dict[Path, Document | None] = {}
        self._problems_of: dict[Path, FileProblems] = {}
        self._others: list[Diagnostic] = []

    def package(self, package: PackageFiles) -> NodePackage:
        """The nodes of a package, except those whose files cannot be read."""
        if package.declared is not None:
            self._problems(package.declared.source)
        self._report(file_names.check_package(package))
        read = {
            composition.real(file.path): (file, found)
            for file in package.nodes
            if (found := self._read(file))
        }
        for path in read:
            self._problems_of[path].sees_all = not package.partial
        self._report(_same_names([found for _, found in read.values()]))
        roots = _roots({path: found for path, (_, found) in read.items()})
        nodes = [self._node(package.name, *read[path]) for path in roots]
        sources = {path: found.source for path, (_, found) in read.items()}
        for loaded in nodes:
            sources.update((composition.real(each.source.path), each.source) for each in loaded.documents)
            self._report(rules.check_node(loaded.description, loaded.written))
        ordered = sorted(nodes, key=lambda loaded: loaded.description.name)
        descriptions = [loaded.description for loaded in ordered if not loaded.exists]
        self._report(rules.check_package(descriptions))
        return NodePackage(
            package.name,
            package.root,
            tuple(descriptions),
            _metadata(package.root),
            tuple(sources.values()),
            tuple(loaded.description for loaded in ordered if loaded.exists),
        )

    def findings(self) -> tuple[list[Diagnostic], list[Diagnostic]]:
        """All errors and all warnings, file by file."""
        of_files = self._problems_of.values()
        found = [*self._others]
        for problems in of_files:
            found += (*problems.errors(), *problems.warnings())
        errors = one_for_each_cause(diagnostic for diagnostic in found if diagnostic.severity == "error")
        return errors, [diagnostic for diagnostic in found if diagnostic.severity == "warning"]

    def document(self, package: str, file: NodeFile) -> Loaded | None:
        """One document with its includes, for itself; None if it cannot be read."""
        root = self._read(file)
        if root is None:
            return None
        loaded = self._node(package, file, root)
        self._report(rules.check_node(loaded.description, loaded.written))
        return loaded

    def _node(self, package: str, file: NodeFile, root: Document) -> Loaded:
        missed: list[Diagnostic | None] = []

        def read(other: NodeFile) -> Document | None:
            found = self._read(other)
            missed.extend([] if found else [None])
            return found

        parts = composition.documents(root, self._search, read, missed.append)
        self._report(filter(None, missed))
        problems = self._problems_of[composition.real(root.source.path)]
        description, whole = composition.described(package, file, parts, problems, self._report)
        documents = [part.document for part in parts]
        return Loaded(
            description,
            whole,
            tuple(documents),
            written(documents, complete=not missed),
            exists=root.barrier is not None,
        )

    def _read(self, file: NodeFile) -> Document | None:
        """A document, read once; None if it cannot be read."""
        path = composition.real(file.path)
        if path not in self._documents:
            self._documents[path] = None
            try:
                source = file.read()
            except InputError as error:
                self._others += error.diagnostics
                return None
            is_asked_for = any(path.is_relative_to(root) for root in self._roots)
            problems = self._problems_of[path] = FileProblems(source, with_warnings=is_asked_for)
            self._documents[path] = document.read(source, self._search, problems)
        return self._documents[path]

    def _problems(self, source: Source) -> FileProblems:
        """The diagnostics found in a file so far, by any reader."""
        return self._problems_of.setdefault(composition.real(source.path), FileProblems(source))

    def _report(self, found: Iterable[Diagnostic]) -> None:
        """Note each diagnostic with its file."""
        for diagnostic in found:
            if diagnostic.primary is None:
                self._others.append(diagnostic)
                continue
            problems = self._problems(diagnostic.primary.span.source)
            add = problems.error if diagnostic.severity == "error" else problems.warning
            add(lambda diagnostic=diagnostic: diagnostic)  # type: ignore[misc]


def _metadata(root: Path) -> PackageMetadata | None:
    texts = package_xml.texts(root)
    if texts is None:
        return None
    return PackageMetadata(
        texts["version"],
        texts["description"],
        texts["maintainer"],
        texts["email"],
        texts["license"],
        package_xml.declared(root),
    )


def _registry(packages: Iterable[NodePackage], search: SearchPath) -> Registry:
    """Every interface that an endpoint names, and what those need."""
    names = {
        endpoint.type_name for package in packages for found in package.nodes for endpoint in found.endpoints
    }
    return registry_of(names, search)


def registry_of(type_names: Iterable[str], search: SearchPath) -> Registry:
    """The interfaces of these names, as far as they exist, and what those need. Raises InputError."""
    needed: dict[str, list[InterfaceFile]] = {}
    for type_name in sorted(type_names):
        package_name, folder, name = type_name.split("/")
        package = search.package(package_name)
        file = package.interface(folder, name) if package else None
        if file is not None:
            needed.setdefault(package_name, []).append(file)
    found = ((search.package(name), tuple(interfaces)) for name, interfaces in needed.items())
    # Nothing is reported about the packages themselves: they were not asked for.
    used = (replace(p, files=files, partial=True, listed=None, xml=None) for p, files in found if p)
    return resolve(used, search)


def _roots(documents: Mapping[Path, Document]) -> list[Path]:
    """The documents of a package that are nodes: all except those that others of it include.

    An included document is a part of others, unless it has its own `codegen.ifgen`, or stands for code that
    exists. In a cycle of includes
    the first document counts as a node, so that the cycle is noticed.
    """
    included = {path: list(composition.local_files(documents[path])) for path in documents}
    parts = {other for others in included.values() for other in others}
    roots = [path for path, found in documents.items() if path not in parts or found.stands_alone]
    reached: set[Path] = set()
    pending = list(roots)
    while len(reached) < len(documents):
        if not pending:
            roots.append(next(path for path in documents if path not in reached))
            pending.append(roots[-1])
        path = pending.pop()
        if path in documents and path not in reached:
            reached.add(path)
            pending += included[path]
    first = {node_name(path.name): path for path in reversed(roots)}
    return [path for path in roots if first[node_name(path.name)] == path]


def _same_names(documents: Iterable[Document]) -> Iterator[Diagnostic]:
    """Files of a package that describe a node of the same name, with another extension."""
    first: dict[str | None, Document] = {}
    for found in documents:
        other = first.setdefault(node_name(found.source.path.name), found)
        if other is not found:
            yield Diagnostic(
                "duplicate-node",
                f"{found.source.path.name} and {other.source.path.name} describe the same node",
                Label(Span(found.source, 0, 0)),
                (Label(Span(other.source, 0, 0), "the other one"),),
                "rename one of them, or delete it",
            )
