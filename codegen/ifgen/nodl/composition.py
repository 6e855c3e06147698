"""A node out of documents: those that a document includes, each once, and what all of them say together."""

from __future__ import annotations

import os
import re
from collections import deque
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, Final

from ifgen.definition.explain import did_you_mean
from ifgen.definition.problems import FileProblems
from ifgen.diagnostics import Diagnostic, Label, Span, shorten
from ifgen.nodl import barriers, names, resolvers
from ifgen.nodl.document import Document, Include
from ifgen.nodl.model import BaseClass, Category, Endpoint, Interface, NodeDescription, Parameter
from ifgen.reading import storage
from ifgen.reading.packages import NODE_EXTENSIONS, NodeFile, node_name
from ifgen.reading.search_path import SearchPath

MAX_DOCUMENTS: Final = 200
"""Documents that one node may be composed of."""

_REFERENCE: Final = re.compile(r"[a-z][a-z0-9+.-]*://[^\s/][^\s]*")
_LOCAL: Final = "local://"
_NODL: Final = "nodl://"


@dataclass(frozen=True, slots=True)
class Part:
    """A document of a node, the include that led to it, and the names of the documents from the root to it.

    `exists` says that it stands for code that exists, itself or by what includes it; `is_barrier` that it is
    the first one on its way to say so.
    """

    document: Document
    include: Include | None
    chain: tuple[str, ...]
    exists: bool = False
    is_barrier: bool = False


def documents(
    root: Document,
    search: SearchPath,
    read: Callable[[NodeFile], Document | None],
    report: Callable[[Diagnostic], None],
) -> list[Part]:
    """A document and all that it includes, breadth first. What is wrong with the includes is reported."""
    start = Part(root, None, (root.source.path.name,))
    reached = {real(root.source.path): start}
    queue = deque([start])
    while queue:
        current = queue.popleft()
        for include in current.document.includes:
            chain = (*current.chain, include.reference)
            file = _found(include, current.document, search, report)
            if file is None:
                continue
            path = real(file.path)
            if path in reached:
                report(_included_twice(include, chain, reached[path]))
            elif len(reached) >= MAX_DOCUMENTS:
                report(_too_many(include))
                return list(reached.values())
            elif (document := read(file)) is not None:
                is_barrier = document.barrier is not None and not current.exists
                exists = current.exists or document.barrier is not None
                reached[path] = Part(document, include, chain, exists, is_barrier)
                queue.append(reached[path])
    return list(reached.values())


def local_files(document: Document) -> Iterator[Path]:
    """The real paths that a document includes by `local://`, whether they exist or not."""
    for include in document.includes:
        if include.reference.startswith(_LOCAL) and _is_reference(include.reference):
            yield real(_local(include, document))


def real(path: Path) -> Path:
    """The path without links, as far as these do not form a cycle."""
    return Path(os.path.realpath(path))  # Path.resolve raises for a ring


def _is_reference(text: str) -> bool:
    return _REFERENCE.fullmatch(text) is not None and "\0" not in text


def _local(include: Include, document: Document) -> Path:
    return document.source.path.parent / include.reference.removeprefix(_LOCAL)


def _found(
    include: Include, document: Document, search: SearchPath, report: Callable[[Diagnostic], None]
) -> NodeFile | None:
    """The file that a reference leads to; None, with the reason reported, if there is none."""
    reference = include.reference
    if not _is_reference(reference):
        report(_invalid(include))
    elif (own := resolvers.registered_for(reference)) is not None:
        return _resolved(own, include, document, report)
    elif reference.startswith(_LOCAL):
        path = _local(include, document)
        try:
            if storage.is_file(path):
                return NodeFile(path)
        except OSError:
            pass  # a name that no file can have
        report(_no_file(include, path))
    elif reference.startswith(_NODL):
        package, _, name = reference.removeprefix(_NODL).partition("/")
        if not name:
            report(_invalid(include))
        elif (file := search.find_node(package, name)) is not None:
            return file
        elif (package, name) in barriers.OFFICIAL:
            return NodeFile(barriers.OFFICIAL[package, name])
        else:
            report(_no_node(include, package, name, search))
    else:
        return _of_another_scheme(include, document, report)
    return None


def _of_another_scheme(
    include: Include, document: Document, report: Callable[[Diagnostic], None]
) -> NodeFile | None:
    try:
        resolver = resolvers.installed_for(include.reference)
    except Exception as error:
        report(_unresolved(include, error))
        return None
    if resolver is None:
        report(_unknown_scheme(include))
        return None
    return _resolved(resolver, include, document, report)


def _resolved(
    resolver: resolvers.Resolver, include: Include, document: Document, report: Callable[[Diagnostic], None]
) -> NodeFile | None:
    """The file that somebody else's resolver finds."""
    try:
        path = Path(resolver.resolve(include.reference, document.source.path))
    except Exception as error:
        report(_unresolved(include, error))
        return None
    if storage.is_file(path):
        return NodeFile(path)
    report(_no_file(include, path))
    return None


def _unresolved(include: Include, error: Exception) -> Diagnostic:
    what = " ".join(f"{type(error).__name__}: {error}".split())
    message = f"`{shorten(include.reference)}` cannot be followed: {shorten(what, 200)}"
    return Diagnostic("unknown-include", message, Label(include.span))


def _invalid(include: Include) -> Diagnostic:
    return Diagnostic(
        "invalid-include",
        f"`{shorten(include.reference)}` is not a reference to a document",
        Label(include.span),
        help="write `local://file.nodl.yaml`, relative to this file, or `nodl://package/name`",
    )


def _unknown_scheme(include: Include) -> Diagnostic:
    scheme = include.reference.partition("://")[0]
    return Diagnostic(
        "unknown-include",
        f"references of the scheme `{shorten(scheme)}` cannot be followed",
        Label(include.span),
        help=did_you_mean(f"{scheme}://", (_LOCAL, _NODL))
        or f"write `local://` or `nodl://`, or install a package with a resolver ({resolvers.GROUP})",
    )


def _no_file(include: Include, path: Path) -> Diagnostic:
    try:
        siblings = [file.name for file in storage.entries(path.parent) if node_name(file.name)]
    except OSError:
        siblings = []
    hint = did_you_mean(path.name, siblings)
    if hint is None and not path.name.endswith(NODE_EXTENSIONS):
        hint = "name the file with its extension, such as .nodl.yaml"
    return Diagnostic("unknown-include", f"there is no file {path}", Label(include.span), help=hint)


def _no_node(include: Include, package: str, name: str, search: SearchPath) -> Diagnostic:
    found = search.package(package)
    known = [node.name for node in found.known_nodes()] if found else []
    advice = did_you_mean(name, known) or (
        f"package '{package}' has {shorten(', '.join(known), 200)}"
        if known
        else "name the folder of the package with -I DIR"
    )
    return Diagnostic(
        "unknown-include",
        f"package '{shorten(package)}' has no NoDL document '{shorten(name)}'",
        Label(include.span, "neither in the search path nor in the ament index"),
        help=advice,
    )


def _included_twice(include: Include, chain: tuple[str, ...], first: Part) -> Diagnostic:
    chains = f"{' > '.join(first.chain)}\nand  {' > '.join(chain)}"
    secondary = (Label(first.include.span, "reached first from here"),) if first.include else ()
    is_cycle = first.include is None or first.chain == chain[: len(first.chain)]
    what = "a document includes itself" if is_cycle else "a document is included twice"
    return Diagnostic(
        "included-twice", what, Label(include.span, "again"), secondary, f"the ways to it are\n     {chains}"
    )


def _too_many(include: Include) -> Diagnostic:
    message = f"a node is composed of more than {MAX_DOCUMENTS} documents"
    return Diagnostic("too-large", message, Label(include.span))


def merged(
    parts: Sequence[Part], report: Callable[[Iterable[Diagnostic]], None]
) -> tuple[Interface, Interface]:
    """The interface of all documents, the root's first, and the share of those whose code exists.

    Of two entries with one name, the first counts.
    """
    parameters: dict[str, Parameter] = {}
    endpoints: dict[tuple[Category, str], Endpoint] = {}
    existing: set[int] = set()
    for part in parts:
        for parameter in part.document.parameters:
            first = parameters.setdefault(parameter.name, parameter)
            if first is not parameter:
                report([_duplicate("parameter", parameter.name, parameter.span, first.span)])
        for endpoint in part.document.endpoints:
            known = endpoints.setdefault((endpoint.category, endpoint.name), endpoint)
            if known is not endpoint:
                report([_duplicate(endpoint.category.singular, endpoint.name, endpoint.span, known.span)])
        if part.exists:
            existing.update(id(each) for each in (*part.document.parameters, *part.document.endpoints))
    whole = Interface(tuple(parameters.values()), tuple(endpoints.values()))
    inherited = Interface(
        tuple(each for each in whole.parameters if id(each) in existing),
        tuple(each for each in whole.endpoints if id(each) in existing),
    )
    return whole, inherited


def described(
    package: str,
    file: NodeFile,
    parts: Sequence[Part],
    problems: FileProblems,
    report: Callable[[Iterable[Diagnostic]], None],
) -> tuple[NodeDescription, Interface]:
    """The description of a node, and its whole interface in the order of its documents.

    What is wrong with its name or its options is in `problems`, all else is reported.
    """
    root = parts[0].document
    if problem := names.node_name_problem(file.name):
        problems.error(_invalid_node_name, file, root, problem)
    whole, inherited = merged(parts, report)
    base = _base(parts, report)
    is_lifecycle = base is not None and base.is_lifecycle
    description = NodeDescription(
        package=package,
        name=file.name,
        description=root.description,
        style="lifecycle" if is_lifecycle else "callbacks",
        node_class=names.class_name(file.name),
        business_file=f"{file.name}.py",
        parameters=whole.parameters,
        **_lists(()),
        base=base,
        inherited=inherited,
        references=tuple(_references(parts, package)),
        codegen=root.codegen,
        path=file.path,
        span=Span(root.source, 0, 0),
    )
    if root.options is not None:
        # pydantic is worth its import only where there is something for it.
        from ifgen.nodl import options

        description = options.applied(description, root.options, problems)
    # The options have said which functions the validators of parameters are.
    inherits = {parameter.name for parameter in inherited.parameters}
    own = Interface(
        tuple(each for each in description.parameters if each.name not in inherits),
        whole.without(inherited).endpoints,
    )
    own, reserved = barriers.without_framework(own, is_lifecycle=description.style == "lifecycle")
    if root.barrier is None:
        report(map(barriers.reserved_parameter, reserved.parameters))
        report(map(barriers.reserved_endpoint, reserved.endpoints))
    lists = _lists(own.endpoints)
    return replace(description, parameters=own.parameters, reserved=reserved, **lists), whole


def _lists(endpoints: Iterable[Endpoint]) -> dict[str, Any]:
    """The six lists of a description, as keyword arguments."""
    known = tuple(endpoints)
    return {category.value: tuple(e for e in known if e.category == category) for category in Category}


def _base(parts: Sequence[Part], report: Callable[[Iterable[Diagnostic]], None]) -> BaseClass | None:
    found = [part.document.barrier for part in parts if part.is_barrier and part.document.barrier]
    base, wrong = barriers.base_of(found)
    unclear = (each for each in found if each.base is None and not each.is_mixin)
    report([*wrong, *map(barriers.no_base, unclear)])
    return base


def _references(parts: Sequence[Part], package: str) -> Iterator[str]:
    """The names by which others include the documents whose code exists."""
    for part in parts:
        if part.is_barrier and part.include is not None:
            reference = part.include.reference
            name = node_name(part.document.source.path.name)
            yield f"{_NODL}{package}/{name}" if reference.startswith(_LOCAL) and name else reference


def _duplicate(what: str, name: str, span: Span | None, first: Span | None) -> Diagnostic:
    assert span is not None
    return Diagnostic(
        f"duplicate-{'parameter' if what == 'parameter' else 'endpoint'}",
        f"there are two {what}s named `{shorten(name)}`",
        Label(span, "again"),
        (Label(first, "first here"),) if first else (),
        "rename one of them, or leave it out",
    )


def _invalid_node_name(file: NodeFile, root: Document, problem: names.BadName) -> Diagnostic:
    return Diagnostic(
        "invalid-node-name",
        f"'{shorten(file.name)}' {problem.message}",
        Label(Span(root.source, 0, 0)),
        help=problem.advice,
    )
