"""A list of templates: what each makes, its variables and parts, and what it is part of."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import jinja2
import jinja2.meta
from jinja2 import nodes

from ifgen import resources
from ifgen.config.customization import Customization
from ifgen.generator_py.templates.checking import given
from ifgen.generator_py.templates.exports import files
from ifgen.generator_py.templates.table import OUTPUT_VARIABLES, TEMPLATES
from ifgen.reading.storage import read_limited


@dataclass(frozen=True, slots=True)
class Listed:
    """A template. `makes` is empty for one that is a part of others, which `part_of` names.

    `given` are its variables with their types, `blocks` what can be replaced singly, and `yours` is the file
    of the user's that stands in its place, if there is one.
    """

    name: str
    makes: str
    given: Mapping[str, str]
    part_of: tuple[str, ...]
    blocks: tuple[str, ...]
    yours: Path | None


def listed(custom: Customization) -> tuple[Listed, ...]:
    """All our templates, then the user's templates for outputs. Broken ones have no blocks."""
    own = {name: path for folder in custom.folders for name, path in files(folder).items()}
    trees = {name: _parsed(path) for name, path in files(resources.templates()).items()}
    variables = given(jinja2.Environment())
    found = [_ours(name, trees, variables.get(name, {}), own.get(name)) for name in trees]
    for output in custom.outputs:
        tree = _parsed(own[output.template]) if output.template in own else None
        makes, types = f"{output.path}, output '{output.name}'", _shown(OUTPUT_VARIABLES[output.per])
        found.append(Listed(output.template, makes, types, (), _blocks(tree), own.get(output.template)))
    return tuple(found)


def type_name(type_: object) -> str:
    """A type as a reader wants to see it: `InterfaceModule`, `tuple[PackageView, ...]`."""
    return (
        type_.__name__
        if isinstance(type_, type)
        else str(type_).replace("ifgen.generator_py.outputs.view.", "")
    )


def _ours(
    name: str, trees: Mapping[str, nodes.Template | None], variables: Mapping[str, str], yours: Path | None
) -> Listed:
    entry = TEMPLATES.get(name)
    users = () if entry else tuple(user for user, tree in trees.items() if name in _referenced(tree))
    return Listed(name, entry.makes if entry else "", variables, users, _blocks(trees[name]), yours)


def _shown(variables: Mapping[str, object]) -> dict[str, str]:
    return {name: type_name(type_) for name, type_ in variables.items()}


def _parsed(path: Path) -> nodes.Template | None:
    try:
        return jinja2.Environment().parse(read_limited(path).decode("utf-8"))
    except (jinja2.TemplateSyntaxError, OSError, RecursionError, UnicodeDecodeError):
        return None


def _referenced(tree: nodes.Template | None) -> set[str | None]:
    return set(jinja2.meta.find_referenced_templates(tree)) if tree else set()


def _blocks(tree: nodes.Template | None) -> tuple[str, ...]:
    return tuple(str(block.name) for block in tree.find_all(nodes.Block)) if tree else ()
