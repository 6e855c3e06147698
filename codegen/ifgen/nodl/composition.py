"""A node out of documents: those that a document includes, each once, and what all of them say together."""

from __future__ import annotations

import os
import re
from collections import deque
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Final

from ifgen.definition.explain import did_you_mean
from ifgen.definition.problems import FileProblems
from ifgen.diagnostics import Diagnostic, Label, Span, shorten
from ifgen.nodl import names
from ifgen.nodl.document import Document, Include
from ifgen.nodl.model import Category, Endpoint, NodeDescription, Parameter
from ifgen.reading import storage
from ifgen.reading.packages import NODE_EXTENSIONS, NodeFile, node_name
from ifgen.reading.search_path import SearchPath

MAX_DOCUMENTS: Final = 200
"""Documents that one node may be composed of."""

_REFERENCE: Final = re.compile(r"[a-z][a-z0-9+.-]*://[^\s/][^\s]*")
_LOCAL: Final = "local://"
_NODL: Final = "nodl://"


@dataclass(frozen=True, slots=True)
class _Reached:
    """A document, the include that led to it, and the names of the documents from the root to it."""

    document: Document
    include: Include | None
    chain: tuple[str, ...]


def documents(
    root: Document,
    search: SearchPath,
    read: Callable[[NodeFile], Document | None],
    report: Callable[[Diagnostic], None],
) -> list[Document]:
    """A document and all that it includes, breadth first. What is wrong with the includes is reported."""
    start = _Reached(root, None, (root.source.path.name,))
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
                return [known.document for known in reached.values()]
            elif (document := read(file)) is not None:
                reached[path] = _Reached(document, include, chain)
                queue.append(reached[path])
    return [known.document for known in reached.values()]


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
        else:
            report(_no_node(include, package, name, search))
    else:
        report(_unknown_scheme(include))
    return None


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
        "invalid-include",
        f"references of the scheme `{shorten(scheme)}` cannot be followed",
        Label(include.span),
        help=did_you_mean(f"{scheme}://", (_LOCAL, _NODL)) or "write `local://` or `nodl://`",
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


def _included_twice(include: Include, chain: tuple[str, ...], first: _Reached) -> Diagnostic:
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
    documents: Sequence[Document], report: Callable[[Iterable[Diagnostic]], None]
) -> tuple[list[Parameter], list[Endpoint]]:
    """The parameters and endpoints of all documents, the root's first; of two with one name the first."""
    parameters: dict[str, Parameter] = {}
    endpoints: dict[tuple[Category, str], Endpoint] = {}
    for document in documents:
        for parameter in document.parameters:
            first = parameters.setdefault(parameter.name, parameter)
            if first is not parameter:
                report([_duplicate("parameter", parameter.name, parameter.span, first.span)])
        for endpoint in document.endpoints:
            known = endpoints.setdefault((endpoint.category, endpoint.name), endpoint)
            if known is not endpoint:
                report([_duplicate(endpoint.category.singular, endpoint.name, endpoint.span, known.span)])
    return list(parameters.values()), list(endpoints.values())


def described(
    package: str,
    file: NodeFile,
    root: Document,
    parameters: list[Parameter],
    endpoints: list[Endpoint],
    problems: FileProblems,
) -> NodeDescription:
    """The description of a node; what is wrong with its name or its options is in `problems`."""
    if problem := names.node_name_problem(file.name):
        problems.error(_invalid_node_name, file, root, problem)
    of = {category: tuple(e for e in endpoints if e.category == category) for category in Category}
    description = NodeDescription(
        package=package,
        name=file.name,
        description=root.description,
        style="callbacks",
        node_class=names.class_name(file.name),
        business_file=f"{file.name}.py",
        parameters=tuple(parameters),
        publishers=of[Category.PUBLISHER],
        subscriptions=of[Category.SUBSCRIPTION],
        service_servers=of[Category.SERVICE_SERVER],
        service_clients=of[Category.SERVICE_CLIENT],
        action_servers=of[Category.ACTION_SERVER],
        action_clients=of[Category.ACTION_CLIENT],
        path=file.path,
        span=Span(root.source, 0, 0),
    )
    if root.options is None:
        return description
    # pydantic is worth its import only where there is something for it.
    from ifgen.nodl import options

    return options.applied(description, root.options, problems)


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
