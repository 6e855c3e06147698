"""One node, merged from the documents that it is composed of, with the options of `codegen.ifgen`."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence

from ifgen.definition.problems import FileProblems
from ifgen.diagnostics import Diagnostic, Label, Span, shorten
from ifgen.nodl import names
from ifgen.nodl.document import Document
from ifgen.nodl.model import Category, Endpoint, NodeDescription, Parameter
from ifgen.reading.packages import NodeFile


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
