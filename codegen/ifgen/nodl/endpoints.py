"""The six lists of endpoints and their QoS profiles, from a document to the model."""

from __future__ import annotations

from typing import Any, Final, Literal, cast

from ifgen.definition.explain import did_you_mean
from ifgen.definition.problems import FileProblems
from ifgen.definition.references import package_advice
from ifgen.diagnostics import Diagnostic, Label, Span, shorten
from ifgen.nodl import names
from ifgen.nodl.model import Category, Endpoint, QosProfile
from ifgen.nodl.syntax import tree
from ifgen.nodl.syntax.tree import MapNode, Node
from ifgen.reading.packages import PackageFiles
from ifgen.reading.search_path import SearchPath

_KINDS: Final = {"msg": "a message", "srv": "a service", "action": "an action"}
MAX_NS: Final = 2**63 - 1
MAX_DEPTH: Final = 2**31 - 1
DURATIONS: Final = ("deadline_ns", "lifespan_ns", "liveliness_lease_duration_ns")
_Policy = Literal["history", "reliability", "durability", "liveliness"]
POLICIES: Final[dict[_Policy, object]] = {
    "history": Literal["KEEP_LAST", "KEEP_ALL", "SYSTEM_DEFAULT"],
    "reliability": Literal["RELIABLE", "BEST_EFFORT", "SYSTEM_DEFAULT", "BEST_AVAILABLE"],
    "durability": Literal["TRANSIENT_LOCAL", "VOLATILE", "SYSTEM_DEFAULT", "BEST_AVAILABLE"],
    "liveliness": Literal["AUTOMATIC", "MANUAL_BY_TOPIC", "SYSTEM_DEFAULT", "BEST_AVAILABLE"],
}
QOS_KEYS: Final = (
    "history",
    "depth",
    "reliability",
    "durability",
    "deadline_ns",
    "lifespan_ns",
    "liveliness",
    "liveliness_lease_duration_ns",
)


def read(document: MapNode, category: Category, search: SearchPath, problems: FileProblems) -> list[Endpoint]:
    """The endpoints in one of the lists of a document, without those that have no usable name or type."""
    found: list[Endpoint] = []
    for node in tree.items(document, category, "a list of endpoints", problems):
        endpoint = _endpoint(node, category, search, problems)
        if endpoint is not None:
            found.append(endpoint)
    return found


def keys(category: Category) -> tuple[tuple[str, ...], tuple[str, ...]]:
    """The keys that an endpoint may have, and those that it must."""
    match category.folder:
        case "msg":
            return ("name", "type", "qos", "description"), ("name", "type", "qos")
        case "srv":
            return ("name", "type", "qos", "description"), ("name", "type")
        case "action":
            return ("name", "type", "description"), ("name", "type")


def _endpoint(node: Node, category: Category, search: SearchPath, problems: FileProblems) -> Endpoint | None:
    what = f"{_article(category.singular)}"
    known, required = keys(category)
    if (fields := tree.table(node, what, known, required, problems)) is None:
        return None
    name, type_text = tree.text(fields, "name", problems), tree.text(fields, "type", problems)
    description = tree.text(fields, "description", problems) or ""
    qos_node = fields.get("qos") if "qos" in known else None
    qos = _qos(qos_node, problems) if qos_node is not None else None
    type_name = None
    if type_text is not None:
        type_name = _type_name(type_text, _span(fields, "type"), category, search, problems)
    if name is None:
        return None
    span = _span(fields, "name")
    if problem := names.endpoint_name_problem(name):
        if not names.nodl_allows_endpoint(name):
            problems.error(invalid_name, name, span, problem)
            return None
        problems.error(invalid_name, name, span, problem, rule="unusable-name")
    return Endpoint(category, name, type_name, description, qos, span) if type_name else None


def _qos(node: Node, problems: FileProblems) -> QosProfile | None:
    fields = tree.table(node, "a QoS profile", QOS_KEYS, ("history", "reliability"), problems)
    if fields is None:
        return None
    policies = {name: tree.choice(fields, name, options, problems) for name, options in POLICIES.items()}
    durations = {name: tree.integer(fields, name, 0, MAX_NS, problems) for name in DURATIONS}
    depth = tree.integer(fields, "depth", 1, MAX_DEPTH, problems)
    if policies["history"] == "KEEP_LAST" and fields.get("depth") is None:
        history = _span(fields, "history")
        problems.error(
            tree.missing_key,
            "depth",
            "KEEP_LAST",
            history,
            "say how many messages to keep, such as `depth: 10`",
        )
    return QosProfile(**cast("dict[str, Any]", {**policies, **durations}), depth=depth, span=node.span)


def _type_name(
    text: str, span: Span, category: Category, search: SearchPath, problems: FileProblems
) -> str | None:
    """The full name of an interface, None for a text that is none. If it does not exist, that is reported."""
    parts = names.split_type(text)
    if parts is None:
        problems.error(_invalid_type, text, span, category, search)
        return None
    package_name, folder, name = parts
    package = search.package(package_name)
    if "_" in name and (package is None or package.interface(category.folder, name) is None):
        # Only .idl files define such names; NoDL has none.
        problems.error(_invalid_type, text, span, category, search)
        return None
    if folder not in {None, category.folder}:
        problems.error(_wrong_folder, text, span, category)
        return None
    if package is None or not package.known_files():
        problems.error(_unknown_package, package_name, span, search)
    elif package.interface(category.folder, name) is None:
        problems.error(_unknown_type, name, span, category, package, search)
    return f"{package_name}/{category.folder}/{name}"


def _span(fields: MapNode, key: str) -> Span:
    node = fields.get(key)
    return fields.span if node is None else node.span


def invalid_name(name: str, span: Span, problem: names.BadName, rule: str = "invalid-name") -> Diagnostic:
    """Say why an endpoint or a parameter cannot have its name."""
    message = f"`{shorten(name)}` is not a valid name: {problem.message}"
    return Diagnostic(rule, message, Label(_part(span, name, problem)), help=problem.advice)


def _part(span: Span, name: str, problem: names.BadName) -> Span:
    """The characters in question, if the name is in the file as it is."""
    start = span.source.text.find(name, span.start, span.end)
    if start < 0 or problem.start == problem.end:
        return span
    return Span(span.source, start + problem.start, start + problem.end)


def _invalid_type(text: str, span: Span, category: Category, search: SearchPath) -> Diagnostic:
    return Diagnostic(
        "invalid-type",
        f"`{shorten(text)}` is not the name of an interface",
        Label(span),
        help=_elsewhere(text, category, search) or names.type_advice(text[:200], category.folder),
    )


def _elsewhere(name: str, category: Category, search: SearchPath) -> str | None:
    """A hint at the packages that have an interface of this name."""
    owners = search.packages_with(name, category.folder)[:3]
    return (
        f"did you mean {' or '.join(f'`{owner}/{category.folder}/{name}`' for owner in owners)}?"
        if owners
        else None
    )


def _wrong_folder(text: str, span: Span, category: Category) -> Diagnostic:
    parts = names.split_type(text)
    folder = parts[1] if parts and parts[1] else category.folder
    fitting = [c.value for c in Category if c.folder == folder]
    return Diagnostic(
        "wrong-interface-kind",
        f"{_article(category.singular)} needs {_KINDS[category.folder]}, "
        f"but `{shorten(text)}` is {_KINDS[folder]}",
        Label(span),
        help=f"move it to `{fitting[0]}` or `{fitting[1]}`, or name a type in {category.folder}/",
    )


def _unknown_package(name: str, span: Span, search: SearchPath) -> Diagnostic:
    return Diagnostic(
        "unknown-package",
        f"there is no interface package '{shorten(name)}'",
        Label(span, "not found"),
        help=package_advice(name, search),
    )


def _unknown_type(
    name: str, span: Span, category: Category, package: PackageFiles, search: SearchPath
) -> Diagnostic:
    kind = _KINDS[category.folder].split()[1]
    hint = _elsewhere(name, category, search) or did_you_mean(name, package.names(category.folder))
    for folder, other in _KINDS.items():
        if hint is None and folder != category.folder and package.interface(folder, name):
            hint = f"{package.name}/{folder}/{name} is {other}; {_article(category.singular)} needs a {kind}"
    return Diagnostic(
        "unknown-type",
        f"package '{package.name}' has no {kind} '{shorten(name)}'",
        Label(span, "not found"),
        help=hint,
    )


def _article(noun: str) -> str:
    return f"an {noun}" if noun[0] in "aeiou" else f"a {noun}"
