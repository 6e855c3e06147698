"""The names in documents, valid or not: a node may lack one of them only because of a mistake."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from ifgen.nodl.document import Document
from ifgen.nodl.model import Category
from ifgen.nodl.syntax.tree import ListNode, MapNode, Node, ScalarNode


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
