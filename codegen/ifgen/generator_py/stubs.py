"""Stubs for type checkers: `.pyi` files with the signatures and docstrings of modules that are there.

Bodies and private members go.
"""

from __future__ import annotations

import ast
from collections.abc import Callable, Iterable, Iterator, Mapping
from pathlib import Path

# Enumerations get their members elsewhere, which mypy minds in stubs and nowhere else. Messages with views
# have fields of other types than their base.
_HEADER = (
    "# Stub by `ifgen typings`: do not edit.\n"
    '# mypy: disable-error-code="misc, assignment"\n'
    "# pyright: reportIncompatibleVariableOverride=false, reportAssignmentType=false\n"
)
# The part that upstream has, too. The rest of rclpy.impl is ours, and is written as far as the others need
# it.
_UPSTREAMS = {
    "rclpy.impl.implementation_singleton",
    "rclpy.impl.logging_severity",
    "rclpy.impl.rcutils_logger",
}
_CODECS = "\n# The codecs: "  # no types from here on, in generated modules
# The effect of decorators on types; other decorators change only what happens at run time.
_DECORATORS = {
    "abstractmethod",
    "classmethod",
    "contextmanager",
    "overload",
    "property",
    "setter",
    "staticmethod",
}
_ANY = ast.Name("Any")


def of_rclpy(underlay: Path) -> Mapping[str, str]:
    """The stubs of rclpy, by path in its folder: of all that programs import, and of what that needs."""
    sources = _modules(underlay / "rclpy", "rclpy")
    waiting = [name for name in sources if _is_public_module(name)]
    stubs: dict[str, ast.Module] = {}
    while waiting:
        name = waiting.pop()
        if name in stubs:
            continue
        path = sources[name]
        stubs[name] = stub = stub_of(path.read_text(encoding="utf-8"), hidden="rmw_local")
        inside = f"{name}.__init__" if path.stem == "__init__" else name
        waiting += [home for each in imported(stub, inside) for home in _homes(each) if home in sources]
    return {
        _stub_path(sources[name], underlay / "rclpy"): _text(stub) for name, stub in sorted(stubs.items())
    }


def of_messages(folder: Path) -> Mapping[str, str]:
    """The stubs of a generated package of interfaces, by path in its folder; its tests have none."""
    return {
        _stub_path(path, folder): _text(stub_of(path.read_text(encoding="utf-8").partition(_CODECS)[0]))
        for name, path in _modules(folder, folder.name).items()
        if name.split(".")[1:2] != ["test"]
    }


def of_library(folder: Path) -> Mapping[str, str]:
    """The stubs of a package that nodes import besides rclpy, by path in its folder."""
    return {
        _stub_path(path, folder): _text(stub_of(path.read_text(encoding="utf-8")))
        for path in _modules(folder, folder.name).values()
    }


def _modules(folder: Path, package: str) -> dict[str, Path]:
    """The modules of a package, by name."""
    found: dict[str, Path] = {}
    for path in sorted(folder.rglob("*.py")):
        parts = [package, *path.relative_to(folder).with_suffix("").parts]
        found[".".join(parts[:-1] if parts[-1] == "__init__" else parts)] = path
    return found


def _is_public_module(name: str) -> bool:
    if name.startswith("rclpy.impl."):
        return name in _UPSTREAMS
    return not any(part.startswith("_") for part in name.split("."))


def _homes(name: str) -> Iterator[str]:
    """The modules that an import of this name loads, if they are modules: `rclpy`, `rclpy.qos`, ..."""
    parts = name.split(".")
    return (".".join(parts[:count]) for count in range(1, len(parts) + 1))


def _stub_path(path: Path, folder: Path) -> str:
    return path.relative_to(folder).with_suffix(".pyi").as_posix()


def _text(stub: ast.Module) -> str:
    return f"{_HEADER}{ast.unparse(ast.fix_missing_locations(stub))}\n"


def stub_of(source: str, hidden: str = "") -> ast.Module:
    """The stub of a module, given as valid Python; what that imports from the package `hidden` is Any."""
    body = list(_statements(ast.parse(source).body, _at_top))
    kept = [shown for each in _needed(body) for shown in _without(hidden, each)]
    if "Any" in {name for each in kept for name in _used(each)} and not any(map(_imports_any, kept)):
        kept.insert(int(_is_docstring(kept[0])), ast.ImportFrom("typing", [ast.alias("Any")], 0))
    return ast.Module(kept, [])


def imported(module: ast.Module, name: str) -> Iterator[str]:
    """The imports of the stub of this name, modules or names in modules: `rclpy.qos.QoSProfile`."""
    package = name.split(".")
    for node in ast.walk(module):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            start = package[: len(package) - node.level] if node.level else []
            home = ".".join([*start, *([node.module] if node.module else [])])
            yield from (f"{home}.{alias.name}" for alias in node.names)


def _imports_any(statement: ast.stmt) -> bool:
    return isinstance(statement, ast.ImportFrom) and "Any" in {alias.name for alias in statement.names}


def _without(hidden: str, statement: ast.stmt) -> Iterator[ast.stmt]:
    if isinstance(statement, ast.ImportFrom) and (statement.module or "").partition(".")[0] == hidden:
        for alias in statement.names:
            yield ast.Assign([ast.Name(alias.asname or alias.name)], ast.Name("Any"), lineno=0)
    else:
        yield statement


def _statements(
    body: Iterable[ast.stmt], keep: Callable[[ast.stmt], Iterable[ast.stmt]]
) -> Iterator[ast.stmt]:
    """The statements for a checker: one side of `if TYPE_CHECKING`, no implementation of overloads."""
    overloaded = ""
    for statement in body:
        if isinstance(statement, ast.FunctionDef):
            is_overload = "overload" in map(_last_name, statement.decorator_list)
            if statement.name == overloaded and not is_overload:
                continue
            overloaded = statement.name if is_overload else ""
        match statement:
            case ast.If(test=ast.Name("TYPE_CHECKING")):
                yield from _statements(statement.body, keep)
            case ast.If(test=ast.UnaryOp(ast.Not(), ast.Name("TYPE_CHECKING"))):
                yield from _statements(statement.orelse, keep)
            case _:
                yield from keep(statement)


def _at_top(statement: ast.stmt) -> Iterator[ast.stmt]:
    match statement:
        case ast.ImportFrom(module="__future__"):
            return
        case ast.FunctionDef(name="__getattr__"):
            return
        case ast.FunctionDef() | ast.AsyncFunctionDef():
            yield _function(statement)
        case ast.ClassDef():
            yield _class(statement)
        case ast.Assign() if {"__getattr__", "__hash__"} & set(_defined_names(statement)):
            return  # what is looked up late has its types elsewhere; what is not hashable says so at run time
        case ast.Import() | ast.ImportFrom() | ast.Assign() | ast.AnnAssign():
            yield statement
        case ast.Expr(ast.Constant(str())):
            yield statement
        case _:
            return


def _function(function: ast.FunctionDef | ast.AsyncFunctionDef) -> ast.stmt:
    documentation = function.body[:1] if _is_docstring(function.body[0]) else []
    function.body = [*documentation, ast.Expr(ast.Constant(...))]
    function.decorator_list = [each for each in function.decorator_list if _last_name(each) in _DECORATORS]
    arguments = function.args
    arguments.defaults = [_default(each) for each in arguments.defaults]
    arguments.kw_defaults = [each if each is None else _default(each) for each in arguments.kw_defaults]
    return function


def _default(value: ast.expr) -> ast.expr:
    """A default as the stub shows it: what is more than a literal is left out."""
    return value if isinstance(value, ast.Constant) else ast.Constant(...)


def _class(cls: ast.ClassDef) -> ast.stmt:
    attributes = _instance_attributes(cls)  # first: methods lose their bodies
    body = list(_statements(cls.body, _in_class))
    declared = {name for each in body for name in _defined_names(each)}
    methods = next((at for at, each in enumerate(body) if isinstance(each, ast.FunctionDef)), len(body))
    body[methods:methods] = [
        ast.AnnAssign(ast.Name(name), annotation, None, 1)
        for name, annotation in attributes.items()
        if name not in declared
    ]
    cls.body = body or [ast.Expr(ast.Constant(...))]
    return cls


def _in_class(statement: ast.stmt) -> Iterator[ast.stmt]:
    if any(_is_private(name) for name in _defined_names(statement)):
        return
    yield from _at_top(statement)


def _instance_attributes(cls: ast.ClassDef) -> dict[str, ast.expr]:
    """The public attributes that the methods of a class assign on `self`, with their types as written."""
    found: dict[str, ast.expr] = {}
    for method in cls.body:
        if not isinstance(method, ast.FunctionDef | ast.AsyncFunctionDef):
            continue
        parameters = {
            each.arg: each.annotation
            for each in (*method.args.posonlyargs, *method.args.args, *method.args.kwonlyargs)
        }
        for node in ast.walk(method):
            match node:
                case ast.AnnAssign(target=ast.Attribute(ast.Name("self"), name), annotation=annotation):
                    if not _is_private(name):
                        found[name] = annotation
                case ast.Assign(targets=[ast.Attribute(ast.Name("self"), name)], value=value):
                    if not _is_private(name):
                        found.setdefault(name, _type_of(value, parameters))
                case _:
                    pass
    return found


def _type_of(value: ast.expr, parameters: dict[str, ast.expr | None]) -> ast.expr:
    """The type of a value, as far as it is clear without a checker."""
    match value:
        case ast.Name(name) if parameters.get(name):
            return parameters[name] or _ANY
        case ast.Constant(bool() | int() | float() | str() as constant):
            return ast.Name(type(constant).__name__)
        case ast.Call(func=ast.Name() | ast.Attribute() as function) if _last_name(function)[:1].isupper():
            return function
        case _:
            return _ANY


def _needed(body: list[ast.stmt]) -> list[ast.stmt]:
    """Statements that are public, and what these need of the others."""
    exported = _exported(body)
    kept = {at for at, each in enumerate(body) if _is_public(each, exported)}
    while True:
        used = {
            name
            for at in kept
            if not isinstance(body[at], ast.Import | ast.ImportFrom)
            for name in _used(body[at])
        }
        more = {
            at
            for at, each in enumerate(body)
            if not isinstance(each, ast.Import | ast.ImportFrom) and used & set(_defined_names(each))
        }
        if more <= kept:
            break
        kept |= more
    result: list[ast.stmt] = []
    for at, statement in enumerate(body):
        if isinstance(statement, ast.Import | ast.ImportFrom):
            statement.names = [
                alias
                for alias in statement.names
                if alias.asname == alias.name
                or (alias.asname or alias.name).partition(".")[0] in used | exported
            ]
            if statement.names:
                result.append(statement)
        elif at in kept:
            result.append(statement)
    return result


def _exported(body: Iterable[ast.stmt]) -> set[str]:
    """The names in `__all__`."""
    for statement in body:
        if isinstance(statement, ast.Assign) and "__all__" in _defined_names(statement):
            return set(ast.literal_eval(statement.value))
    return set()


def _is_public(statement: ast.stmt, exported: set[str]) -> bool:
    names = list(_defined_names(statement))
    return _is_docstring(statement) or any(not _is_private(name) or name in exported for name in names)


def _used(statement: ast.stmt) -> Iterator[str]:
    for node in ast.walk(statement):
        if isinstance(node, ast.Name):
            yield node.id
        elif isinstance(node, ast.Constant) and isinstance(node.value, str) and node.value.isidentifier():
            yield node.value  # an annotation in quotes


def _defined_names(statement: ast.stmt) -> Iterator[str]:
    match statement:
        case ast.FunctionDef() | ast.AsyncFunctionDef() | ast.ClassDef():
            yield statement.name
        case ast.Assign():
            for target in statement.targets:
                yield from (node.id for node in ast.walk(target) if isinstance(node, ast.Name))
        case ast.AnnAssign(target=ast.Name(name)):
            yield name
        case _:
            return


def _is_private(name: str) -> bool:
    return name.startswith("_") and not (name.startswith("__") and name.endswith("__"))


def _is_docstring(statement: ast.stmt) -> bool:
    match statement:
        case ast.Expr(ast.Constant(str())):
            return True
        case _:
            return False


def _last_name(expression: ast.expr) -> str:
    match expression:
        case ast.Name(name) | ast.Attribute(attr=name):
            return name
        case ast.Call(function):
            return _last_name(function)
        case _:
            return ""
