"""One NoDL document: from its text to endpoints and parameters; what it includes is not looked at yet."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Final

from ifgen.definition.problems import FileProblems
from ifgen.diagnostics import Diagnostic, Label, Source, Span
from ifgen.nodl import barriers, endpoints, parameters
from ifgen.nodl.barriers import Barrier
from ifgen.nodl.model import Category, Endpoint, Parameter
from ifgen.nodl.syntax import explain_syntax, reader, tree
from ifgen.nodl.syntax.tree import MAX_CHARACTERS, ListNode, MapNode, Node, ScalarNode
from ifgen.reading.search_path import SearchPath

VERSION: Final = 2

_KEYS: Final = (
    "nodl_version",
    "description",
    "codegen",
    "include",
    "parameters",
    *(category.value for category in Category),
)


@dataclass(frozen=True, slots=True)
class Include:
    """A reference to another document, as it is written."""

    reference: str
    span: Span


@dataclass(frozen=True, slots=True)
class Document:
    """The contents of one file, as far as they are valid.

    `options` is what is under `codegen.ifgen`, `root` is all of it; both are unchecked, and may be missing.
    `barrier` says that its code exists, and `codegen` is what it says to other tools, as (tool, JSON).
    """

    source: Source
    description: str = ""
    includes: tuple[Include, ...] = ()
    parameters: tuple[Parameter, ...] = ()
    endpoints: tuple[Endpoint, ...] = ()
    options: MapNode | None = None
    root: MapNode | None = None
    barrier: Barrier | None = None
    codegen: tuple[tuple[str, str], ...] = ()

    @property
    def stands_alone(self) -> bool:
        """Whether it is more than a part of the documents that include it."""
        return self.options is not None or self.barrier is not None


def parse(source: Source, problems: FileProblems) -> Node | None:
    """The tree of a document; None where it cannot be read, with the reason in `problems`."""
    if len(source.text) > MAX_CHARACTERS:
        problems.error(explain_syntax.too_long, Span(source, MAX_CHARACTERS, MAX_CHARACTERS + 1))
        return None
    try:
        node = reader.parse(source, problems)
    except reader.UnreadableError as error:
        problems.extend([error.diagnostic], 0)
        return None
    if node is None:
        problems.error(_empty, source)
    return node


def read(source: Source, search: SearchPath, problems: FileProblems) -> Document:
    """Everything that a document says by itself; what is wrong with it is in `problems`."""
    node = parse(source, problems)
    if node is None:
        return Document(source)
    root = tree.table(node, "a NoDL document", _KEYS, (), problems)
    if root is None:
        return Document(source)
    _check_version(root, problems)
    codegen = tree.entries(root, "codegen", "a map from tools to maps", problems)
    for key, value in codegen.entries if codegen else ():
        if not isinstance(value, MapNode):
            problems.error(tree.wrong_value, value, f"`codegen.{key.name}`", "a map")
    own = codegen.get("ifgen") if codegen else None
    declared = parameters.read(root, problems)
    if isinstance(own, MapNode):
        declared += parameters.expanded(own, declared, problems)
    return Document(
        source,
        tree.text(root, "description", problems) or "",
        tuple(_includes(root, problems)),
        tuple(declared),
        tuple(e for category in Category for e in endpoints.read(root, category, search, problems)),
        own if isinstance(own, MapNode) else None,
        root,
        barriers.read(codegen, problems),
        barriers.other_tools(codegen),
    )


def _check_version(root: MapNode, problems: FileProblems) -> None:
    node = root.get("nodl_version")
    if node is None:
        start = Span(root.span.source, root.span.start, root.span.start)
        problems.error(tree.missing_key, "nodl_version", "a NoDL document", start, "write `nodl_version: 2`")
    elif not isinstance(node, ScalarNode) or isinstance(node.value, bool) or node.value != VERSION:
        problems.error(_wrong_version, node)


def _includes(root: MapNode, problems: FileProblems) -> list[Include]:
    found: list[Include] = []
    for node in tree.items(root, "include", "a list of references", problems):
        fields = tree.table(node, "an include", ("ref",), ("ref",), problems)
        reference = tree.text(fields, "ref", problems) if fields else None
        value = fields.get("ref") if fields else None
        if reference is not None and value is not None:
            found.append(Include(reference, value.span))
    return found


def _empty(source: Source) -> Diagnostic:
    return Diagnostic(
        "empty-document",
        "the file is empty",
        Label(Span(source, 0, 0)),
        help="the shortest description of a node is `nodl_version: 2`",
    )


def _wrong_version(node: Node) -> Diagnostic:
    return Diagnostic(
        "nodl-version",
        "this version of NoDL is not known",
        Label(node.span),
        help="write `nodl_version: 2`, which is the version that ifgen reads",
    )


@dataclass(frozen=True, slots=True)
class Written:
    """The names as they are in the documents of a node; None if they are unknown.

    `functions` are the custom validators that `codegen.ifgen` names functions for.
    """

    parameters: frozenset[str] | None
    publishers: frozenset[str] | None
    functions: frozenset[str] | None


def written(documents: Sequence[Document], complete: bool) -> Written:
    """The names in a node's documents, the root's first; `complete` if every include could be followed."""
    read_all = complete and all(document.root is not None for document in documents)
    roots = [document.root for document in documents if document.root is not None]
    options = documents[0].options
    functions = _keys([options.get("validators")] if options else [])
    return Written(
        _keys(root.get("parameters") for root in roots) if read_all else None,
        _names(root.get(Category.PUBLISHER) for root in roots) if read_all else None,
        functions,
    )


def may_be(name: str, known: frozenset[str] | None) -> bool:
    """True if a name is among the written ones, as far as is known."""
    return known is None or name in known


def _keys(nodes: Iterable[Node | None]) -> frozenset[str] | None:
    """The keys of maps, some of which may be missing."""
    found: set[str] = set()
    for node in nodes:
        if isinstance(node, MapNode):
            found.update(key.name for key, _ in node.entries)
        elif node is not None:
            return None
    return frozenset(found)


def _names(nodes: Iterable[Node | None]) -> frozenset[str] | None:
    """The values under `name` in the maps of lists, some of which may be missing."""
    found: set[str] = set()
    for node in nodes:
        if node is not None and not isinstance(node, ListNode):
            return None
        for item in node.items if node else ():
            name = item.get("name") if isinstance(item, MapNode) else None
            if not isinstance(name, ScalarNode) or not isinstance(name.value, str):
                return None
            found.add(name.value)
    return frozenset(found)
