"""Blocks of templates that extend each other."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from jinja2 import nodes

from ifgen.generator_py.templates.check.frame import Block
from ifgen.generator_py.templates.check.syntax import Template


def definitions(chain: Sequence[Template]) -> dict[str, list[Block]]:
    """The definitions of each block, the one that counts first; a template comes before what it extends."""
    found: dict[str, list[Block]] = {}
    for template in chain:
        for block in _blocks(template.tree):
            found.setdefault(str(block.name), []).append((template, block))
    return found


def idle_blocks(chain: Sequence[Template]) -> Iterator[tuple[Template, nodes.Block, set[str]]]:
    """Blocks that nothing renders, since no template above has their name, with the names that there are."""
    *below, root = chain
    above = {str(block.name) for block in _blocks(root.tree)}
    for template in reversed(below):
        inner = {str(b.name) for block in _blocks(template.tree) for b in _blocks(block)}
        for block in _blocks(template.tree):
            if block.name not in above | inner:
                yield template, block, above
        above |= {str(block.name) for block in _blocks(template.tree)}


def _blocks(node: nodes.Node) -> Iterator[nodes.Block]:
    return node.find_all(nodes.Block)
