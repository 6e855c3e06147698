"""The catalogue of templates, and their variables for an interface or a node, for `ifgen templates`.

The catalogue says what a template makes, its variables and blocks, and what it is part of. Variables are
shown as values, as JSON, and as a JSON schema.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, fields, is_dataclass
from pathlib import Path
from typing import Any, TypeAlias, cast

import jinja2
import jinja2.meta
from jinja2 import nodes

from ifgen import resources
from ifgen.config.customization import Customization
from ifgen.definition.interfaces import Interface, InterfacePackage, Registry
from ifgen.generator_py.messages import package as message_package
from ifgen.generator_py.nodes import package as node_package
from ifgen.generator_py.outputs.interfaces import interface_model
from ifgen.generator_py.outputs.nodes import node_model
from ifgen.generator_py.templates.checking import given
from ifgen.generator_py.templates.exports import files
from ifgen.generator_py.templates.table import OUTPUT_VARIABLES, TEMPLATES
from ifgen.generator_py.tests import package as test_package
from ifgen.model import Package
from ifgen.nodl.model import NodeDescription, NodePackage
from ifgen.reading.storage import read_limited

Contexts: TypeAlias = Mapping[str, Mapping[str, object]]
"""The variables of templates, by the template or by the kind of output that is given them."""

_SHOWN = 72


def of_interface(interface: Interface, registry: Registry) -> Contexts:
    """The variables of templates for an interface, as if it were alone in its package."""
    package = InterfacePackage(interface.package, (interface,))
    view = interface_model(interface, registry)
    alone = Package(interface.package, (view,), (), generate=True)
    planned = (
        *message_package.plan(package, registry),
        *test_package.plan_interface_tests(package, registry),
    )
    return {
        **{artifact.template: artifact.variables for artifact in planned},
        output_key("interface"): {"interface": view, "package": alone},
        output_key("package"): {"package": alone},
        output_key("run"): {"packages": (alone,)},
    }


def of_node(package: NodePackage, node: NodeDescription) -> Contexts:
    """The variables of templates for a node, as if it were alone in its package."""
    only = NodePackage(package.name, package.root, (node,), package.metadata, package.sources)
    view = node_model(node)
    alone = Package(package.name, (), (view,), generate=True)
    planned = (*node_package.plan_nodes(only), *node_package.plan_users_files(only))
    return {
        **{artifact.template: artifact.variables for artifact in planned},
        output_key("node"): {"node": view, "package": alone},
        output_key("package"): {"package": alone},
        output_key("run"): {"packages": (alone,)},
    }


def output_key(per: str) -> str:
    """The heading of the variables of an output: `outputs per interface`."""
    return f"outputs per {per}"


def as_json(contexts: Contexts) -> dict[str, Any]:
    """The same in what JSON knows: objects, lists, texts, numbers, true, false and null."""
    return {key: {name: _plain(value) for name, value in given.items()} for key, given in contexts.items()}


def schema() -> dict[str, Any]:
    """The JSON schema of `as_json` for any interface or node, with a description of every type."""
    from pydantic import TypeAdapter  # takes longer to import than everything else here

    adapter: Any = TypeAdapter
    given = {
        **{template: entry.variables for template, entry in TEMPLATES.items()},
        **{output_key(per): variables for per, variables in OUTPUT_VARIABLES.items()},
    }
    adapters: list[Any] = [
        ((key, name), "serialization", adapter(type_))
        for key, variables in given.items()
        for name, type_ in variables.items()
    ]
    found, definitions = TypeAdapter.json_schemas(adapters)
    return {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": "The variables of ifgen's templates",
        "type": "object",
        "additionalProperties": False,
        "properties": {
            key: {
                "type": "object",
                "additionalProperties": False,
                "required": list(variables),
                "properties": {name: found[(key, name), "serialization"] for name in variables},
            }
            for key, variables in given.items()
        },
        **definitions,
    }


def lines(contexts: Contexts) -> Iterator[str]:
    """The same for people: an indented line for each attribute, with its value if that is short."""
    for key, variables in contexts.items():
        yield key
        for name, value in variables.items():
            yield from _lines(name, value, "  ")
        yield ""


def _lines(name: str, value: object, indent: str) -> Iterator[str]:
    if is_dataclass(value):
        yield f"{indent}{name}: {type_name(type(value))}"
        for field in fields(value):
            yield from _lines(field.name, getattr(value, field.name), f"{indent}  ")
        return
    text = _short(value)  # before it is treated as a tuple of unknown types
    elements = cast("tuple[object, ...]", value) if isinstance(value, tuple) else ()
    if any(map(is_dataclass, elements)):
        yield f"{indent}{name}:"
        for index, element in enumerate(elements):
            yield from _lines(f"[{index}]", element, f"{indent}  ")
    else:
        yield f"{indent}{name} = {text}"


def _short(value: object) -> str:
    text = repr(value)
    return text if len(text) <= _SHOWN else text[: _SHOWN - 3] + "..."


def _plain(value: object) -> Any:
    if is_dataclass(value) and not isinstance(value, type):
        return {field.name: _plain(getattr(value, field.name)) for field in fields(value)}
    if isinstance(value, tuple | list):
        return [_plain(element) for element in cast("tuple[object, ...]", value)]
    if isinstance(value, Mapping):
        return {str(k): _plain(element) for k, element in cast("Mapping[object, object]", value).items()}
    return value


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


def blocks_of(folder: Path) -> dict[str, tuple[str, ...]]:
    """The blocks of the templates in a folder, by template."""
    paths = sorted(folder.rglob("*.j2"))
    return {path.relative_to(folder).as_posix(): _blocks(_parsed(path)) for path in paths}


def type_name(type_: object) -> str:
    """A type as a reader wants to see it: `InterfaceModule`, `tuple[Package, ...]`."""
    return type_.__name__ if isinstance(type_, type) else re.sub(r"\b[a-z_.]+\.(?=\w)", "", str(type_))


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
