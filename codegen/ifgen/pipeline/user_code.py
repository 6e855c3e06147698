"""Compares the user's modules of nodes with their descriptions; they are read, never run."""

from __future__ import annotations

import ast
from collections import Counter
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from functools import partial
from pathlib import Path

from ifgen.config import suppressions
from ifgen.definition.explain import did_you_mean
from ifgen.diagnostics import Diagnostic, InputError, Label, Source, Span, shorten
from ifgen.generator_py.nodes.classes import user_module
from ifgen.generator_py.nodes.context import NodeModule
from ifgen.generator_py.nodes.members import RESERVED
from ifgen.generator_py.nodes.package import checks_modules
from ifgen.generator_py.nodes.parameters import declared
from ifgen.nodl.model import NodeDescription, NodePackage
from ifgen.reading.python_text import parse, span_of

_CALLBACKS = ("on_", "handle_", "accept_", "cancel_", "execute_")
_CALLED = ("publish_", "call_", "send_")
_EVERYTHING = "*"  # what `from module import *` imports
_FUNCTION = ast.FunctionDef | ast.AsyncFunctionDef
_NAMED = _FUNCTION | ast.ClassDef
_Path = tuple[str, ...]


def compare(package: NodePackage, inner: Path) -> Iterator[Diagnostic]:
    """Methods that the user's modules lack, and those that nothing calls any more.

    What keeps a node from starting is an error, the rest are warnings. Nothing is said of a module that is
    not there yet.
    """
    for node in package.nodes:
        yield from _compared(inner / node.business_file, partial(_of_node, node))
    for name, checks in checks_modules(package).items():
        functions = [function for function, _, _ in checks.functions]
        yield from _compared(inner / name, partial(_missing_functions, functions))


def _compared(path: Path, look: Callable[[Source, ast.Module], Iterator[Diagnostic]]) -> Iterable[Diagnostic]:
    """The diagnostics about a module, if there is one, without those that comments in it silence."""
    if not path.is_file():
        return ()
    try:
        source, tree = parse(path)
    except InputError as error:
        return error.diagnostics
    found = sorted(look(source, tree), key=lambda d: d.primary.span.start if d.primary else 0)
    return suppressions.by_comments(source, found)


def _missing_functions(functions: Iterable[str], source: Source, tree: ast.Module) -> Iterator[Diagnostic]:
    present = {*_defined(tree), *(s.name for s in _statements(tree) if isinstance(s, _NAMED))}
    for name in functions:
        if name not in present and _EVERYTHING not in present:
            yield Diagnostic(
                "missing-check",
                f"{source.path.name} has no function {name}, which a validator calls",
                Label(Span(source, 0, 0)),
                help=f"write `def {name}(value)`, which raises ValueError with the reason to refuse a value",
            )


def _of_node(node: NodeDescription, source: Source, tree: ast.Module) -> Iterator[Diagnostic]:
    module = _Module(source, tree)
    class_ = module.classes.get(node.node_class)
    if class_ is None:
        if not module.names & {node.node_class, _EVERYTHING}:
            message = f"{source.path.name} has no class {node.node_class}, which starts {node.name}"
            advice = f"write class {node.node_class}({node.node_class}Base)"
            yield Diagnostic("user-module", message, Label(Span(source, 0, 0)), help=advice)
        return
    lineage = module.lineage(class_)
    expected = user_module(node)
    methods = _methods(lineage)
    unknown = module.unknown_bases(lineage) - {expected.base_class}
    if not unknown:
        if not any(found.decorator_list for found in lineage):  # a decorator may add methods
            yield from _missing(expected, methods, class_, source)
        own = methods.keys() | _assigned(lineage)
        yield from _vanished(expected, own, lineage, source)
        yield from _vanished_parameters(node, lineage, own, source)
    yield from _orphaned(expected, methods, module, source)


class _Module:
    """The classes of a module by name, all other names that it defines, and where things are."""

    def __init__(self, source: Source, tree: ast.Module) -> None:
        self.source = source
        self.tree = tree
        self.classes = {found.name: found for found in ast.walk(tree) if isinstance(found, ast.ClassDef)}
        self.names = set(_defined(tree))

    def lineage(self, class_: ast.ClassDef) -> list[ast.ClassDef]:
        """A class and its bases in this module, and theirs."""
        found: dict[str, ast.ClassDef] = {}
        pending = [class_]
        while pending:
            current = pending.pop()
            if current.name not in found:
                found[current.name] = current
                pending += (
                    self.classes[name] for name in map(_last_name, current.bases) if name in self.classes
                )
        return list(found.values())

    def unknown_bases(self, lineage: list[ast.ClassDef]) -> set[str]:
        """The bases of classes that are defined elsewhere."""
        return {name for class_ in lineage for name in map(_last_name, class_.bases)} - self.classes.keys()


def _defined(tree: ast.Module) -> Iterator[str]:
    """The names that a module imports or assigns."""
    for found in ast.walk(tree):
        match found:
            case ast.Import(names=aliases) | ast.ImportFrom(names=aliases):
                yield from (alias.asname or alias.name for alias in aliases)
            case ast.Name(id=name, ctx=ast.Store()):
                yield name
            case _:
                pass


def _statements(node: ast.AST) -> Iterator[ast.stmt]:
    """The statements of a module or a class body itself, also in its `if` and `try`, but not in functions."""
    for child in ast.iter_child_nodes(node):
        if isinstance(child, ast.stmt):
            yield child
        if not isinstance(child, _NAMED | ast.expr):
            yield from _statements(child)


def _last_name(expression: ast.expr) -> str:
    """`Base` for `Base`, `module.Base` and `Base[int]`."""
    match expression:
        case ast.Name(id=name) | ast.Attribute(attr=name):
            return name
        case ast.Subscript(value=value):
            return _last_name(value)
        case _:
            return "?"


def _methods(lineage: list[ast.ClassDef]) -> dict[str, ast.stmt]:
    """The names that classes define in their bodies: methods, and assigned names."""
    found: dict[str, ast.stmt] = {}
    for class_ in lineage:
        for statement in _statements(class_):
            match statement:
                case ast.FunctionDef(name=name) | ast.AsyncFunctionDef(name=name):
                    found.setdefault(name, statement)
                case ast.Assign(targets=targets):
                    for target in targets:
                        if isinstance(target, ast.Name):
                            found.setdefault(target.id, statement)
                case ast.AnnAssign(target=ast.Name(id=name), value=ast.expr()):
                    found.setdefault(name, statement)
                case _:
                    pass
    return found


def _callbacks(expected: NodeModule) -> Mapping[str, tuple[str, str]]:
    """The methods that a node has to have: their first lines, and what calls them."""
    found: dict[str, tuple[str, str]] = {}
    for subscription in expected.subscriptions:
        found[subscription.callback] = (subscription.signature, f"the subscription of {subscription.topic}")
    for service in expected.services:
        found[service.callback] = (service.signature, f"the service {service.name}")
    for server in expected.action_servers:
        for name, line in (
            (server.accept, server.accept_signature),
            (server.cancel, server.cancel_signature),
            (server.execute, server.execute_signature),
        ):
            found[name] = (line, f"the action {server.name}")
    for timer in expected.timers:
        found[timer.callback] = (timer.signature, "a timer")
    return found


def _missing(
    expected: NodeModule, methods: Mapping[str, ast.stmt], class_: ast.ClassDef, source: Source
) -> Iterator[Diagnostic]:
    in_base = {name for server in expected.action_servers for name in (server.accept, server.cancel)}
    optional = in_base if expected.style == "nodl" else set[str]()
    for name, (signature, caller) in _callbacks(expected).items():
        if name not in methods and name not in optional:
            yield Diagnostic(
                "missing-method",
                f"{class_.name} has no method {name}, which {caller} calls: it cannot start",
                Label(_of_name(class_, class_.name, source), "in this class"),
                help=f"add `{' '.join(signature.split())}`",
            )


def _orphaned(
    expected: NodeModule, methods: Mapping[str, ast.stmt], module: _Module, source: Source
) -> Iterator[Diagnostic]:
    """Methods with names of callbacks that neither the base class nor the module itself mentions."""
    known = {*_callbacks(expected), *RESERVED}
    mentioned = {found.attr for found in ast.walk(module.tree) if isinstance(found, ast.Attribute)}
    for name, statement in methods.items():
        if name.startswith(_CALLBACKS) and name not in known and name not in mentioned:
            yield Diagnostic(
                "orphaned-method",
                f"nothing calls {name}: {expected.plain_name} has no endpoint or timer of that name",
                Label(_of_name(statement, name, source)),
                help="rename it, if the endpoint was renamed, or delete it",
                severity="warning",
            )


def _vanished(
    expected: NodeModule,
    own: Collection[str],
    lineage: list[ast.ClassDef],
    source: Source,
) -> Iterator[Diagnostic]:
    """Calls of what the base class offered for an endpoint that is gone."""
    offered = {publisher.publish for publisher in expected.publishers}
    offered |= {client.call for client in expected.clients} | {c.send for c in expected.action_clients}
    for class_ in lineage:
        for found in ast.walk(class_):
            match found:
                case ast.Attribute(value=ast.Name(id="self"), attr=name, ctx=ast.Load()):
                    if name.startswith(_CALLED) and name not in offered and name not in own:
                        yield Diagnostic(
                            "vanished-method",
                            f"there is no {name}: {expected.plain_name} has no endpoint of that name",
                            Label(span_of(found, source)),
                            severity="warning",
                        )
                case _:
                    pass


def _vanished_parameters(
    node: NodeDescription, lineage: Sequence[ast.ClassDef], own: Collection[str], source: Source
) -> Iterator[Diagnostic]:
    """Say which of the parameters that are read in the classes of a module are not there.

    `own` are the attributes that the classes define themselves.
    """
    if "parameters" in own:
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
                yield _vanished_parameter(node, ".".join(path), names, found, source)


def _aliases(function: ast.FunctionDef | ast.AsyncFunctionDef) -> Mapping[str, _Path]:
    """The names in a function that stand for all parameters, or for a group of them, and for nothing else."""
    arguments = [argument.arg for argument in function.args.args]
    stored = Counter(
        n.id for n in ast.walk(function) if isinstance(n, ast.Name) and isinstance(n.ctx, ast.Store)
    )
    found: dict[str, _Path] = {}
    if function.name == "on_parameters_changed" and len(arguments) > 1 and not stored[arguments[1]]:
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


def _vanished_parameter(
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


def _assigned(lineage: list[ast.ClassDef]) -> set[str]:
    """The attributes that classes assign, of whatever."""
    return {
        found.attr
        for class_ in lineage
        for found in ast.walk(class_)
        if isinstance(found, ast.Attribute) and isinstance(found.ctx, ast.Store)
    }


def _of_name(statement: ast.stmt, name: str, source: Source) -> Span:
    """The place of the name of a class or method, after `class` or `def`; decorators do not count."""
    whole = span_of(statement, source)
    start = source.text.find(name, whole.start, whole.end)
    return Span(source, start, start + len(name)) if start >= 0 else whole
