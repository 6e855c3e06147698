"""Finds where the user's module of a node reads parameters that its description does not have."""

from __future__ import annotations

import ast
from collections import Counter
from collections.abc import Collection, Iterator, Mapping, Sequence

from ifgen.definition.explain import did_you_mean
from ifgen.diagnostics import Diagnostic, Label, Source, shorten
from ifgen.generator_py.nodes.parameters import declared
from ifgen.nodl.model import NodeDescription
from ifgen.reading.python_text import span_of

_ATTRIBUTE = "parameters"
_CHANGED = "on_parameters_changed"
_FUNCTION = ast.FunctionDef | ast.AsyncFunctionDef
_Path = tuple[str, ...]


def vanished(
    node: NodeDescription, lineage: Sequence[ast.ClassDef], own: Collection[str], source: Source
) -> Iterator[Diagnostic]:
    """Say which of the parameters that are read in the classes of a module are not there.

    `own` are the attributes that the classes define themselves.
    """
    if _ATTRIBUTE in own:
        return
    known = [tuple(parameter.name.split(".")) for parameter in declared(node)]
    groups = {(), *(path[:length] for path in known for length in range(len(path)))}
    names = [".".join(path) for path in known]
    for statement in (statement for class_ in lineage for statement in class_.body):
        aliases: Mapping[str, _Path] = _aliases(statement) if isinstance(statement, _FUNCTION) else {}
        for found in ast.walk(statement):
            path = _path(found, aliases)
            # Names below a missing one are reported with that.
            if path and path[:-1] in groups and path not in groups and path not in known:
                yield _vanished(node, ".".join(path), names, found, source)


def _aliases(function: ast.FunctionDef | ast.AsyncFunctionDef) -> Mapping[str, _Path]:
    """The names in a function that stand for all parameters, or for a group of them, and for nothing else."""
    arguments = [argument.arg for argument in function.args.args]
    stored = Counter(
        n.id for n in ast.walk(function) if isinstance(n, ast.Name) and isinstance(n.ctx, ast.Store)
    )
    found: dict[str, _Path] = {}
    if function.name == _CHANGED and len(arguments) > 1 and not stored[arguments[1]]:
        found[arguments[1]] = ()
    for statement in ast.walk(function):
        match statement:
            case ast.Assign(targets=[ast.Name(id=name)], value=value):
                path = _path(value, found)
                if path is not None and stored[name] == 1 and name not in arguments:
                    found[name] = path
            case _:
                pass
    return found


def _path(node: ast.AST, aliases: Mapping[str, _Path]) -> _Path | None:
    """The path that is read below the parameters, `()` for all of them; None for anything else."""
    match node:
        case ast.Attribute(value=ast.Name(id="self"), attr="parameters", ctx=ast.Load()):
            return ()
        case ast.Attribute(value=value, attr=name, ctx=ast.Load()) if not name.startswith("__"):
            path = _path(value, aliases)
            return None if path is None else (*path, name)
        case ast.Name(id=name):
            return aliases.get(name)
        case _:
            return None


def _vanished(
    node: NodeDescription, name: str, known: Sequence[str], place: ast.AST, source: Source
) -> Diagnostic:
    assert isinstance(place, ast.expr)
    listed = f"its parameters are {shorten(', '.join(known), 200)}" if known else "it has no parameters"
    return Diagnostic(
        "vanished-parameter",
        f"there is no parameter {name}: {node.name} has none of that name",
        Label(span_of(place, source)),
        help=did_you_mean(name, known) or listed,
        severity="warning",
    )
