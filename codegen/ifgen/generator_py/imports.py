"""The imports of generated modules: where names come from, who collects them, and the statements.

Code that makes text asks a `Names` for each name in it, so no other code needs to know which names the text
uses.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping
from functools import lru_cache
from sys import stdlib_module_names
from typing import Final, TypeAlias

Import: TypeAlias = tuple[str, str, str]
"""Module (none for a module itself), name, and what it is called here."""

IN_MESSAGES: Final = {
    "Exception": "builtins",
    "bool": "builtins",
    "bytes": "builtins",
    "dict": "builtins",
    "float": "builtins",
    "int": "builtins",
    "list": "builtins",
    "locals": "builtins",
    "classmethod": "builtins",
    "property": "builtins",
    "range": "builtins",
    "staticmethod": "builtins",
    "str": "builtins",
    "array": "array",
    "Iterable": "collections.abc",
    "Sequence": "collections.abc",
    "IntEnum": "enum",
    "Any": "typing",
    "ClassVar": "typing",
    "Final": "typing",
    "TypeAlias": "typing",
    "numpy": "",
    "NDArray": "numpy.typing",
    "ITERABLES": "ifgen_runtime.copying",
    "array_repr": "ifgen_runtime.copying",
    "arrays": "ifgen_runtime.copying",
    "copied_array": "ifgen_runtime.copying",
    "copied_list": "ifgen_runtime.copying",
    "copied_other": "ifgen_runtime.copying",
    "deepcopy_of": "ifgen_runtime.copying",
    "new_array": "ifgen_runtime.copying",
    "new_object": "ifgen_runtime.copying",
    "repr_name": "ifgen_runtime.copying",
    "repr_of_fields": "ifgen_runtime.copying",
    "unequal": "ifgen_runtime.copying",
    "Int8Array": "ifgen_runtime.views",
    "UInt8Array": "ifgen_runtime.views",
    "Int16Array": "ifgen_runtime.views",
    "UInt16Array": "ifgen_runtime.views",
    "Int32Array": "ifgen_runtime.views",
    "UInt32Array": "ifgen_runtime.views",
    "Int64Array": "ifgen_runtime.views",
    "UInt64Array": "ifgen_runtime.views",
    "Float32Array": "ifgen_runtime.views",
    "Float64Array": "ifgen_runtime.views",
    "Action": "ifgen_runtime.interface",
    "Service": "ifgen_runtime.interface",
    "ServiceMeta": "ifgen_runtime.interface",
    "DEFAULT": "ifgen_runtime.message",
    "Message": "ifgen_runtime.message",
    "MessageMeta": "ifgen_runtime.message",
    "NoSuchField": "ifgen_runtime.message",
    "checks_by_default": "ifgen_runtime.message",
    "default_of": "ifgen_runtime.message",
    "enum_view": "ifgen_runtime.message",
    "initialize_checked": "ifgen_runtime.message",
    "mutable_default": "ifgen_runtime.message",
    "note_field": "ifgen_runtime.message",
}
"""The modules of the names that modules of interfaces use; codecs use more of `ifgen_runtime.codec`."""

IN_NODES: Final = {
    "ABC": "abc",
    "Callable": "collections.abc",
    "FloatingPointRange": "rcl_interfaces.msg",
    "IntegerRange": "rcl_interfaces.msg",
    "ParameterDescriptor": "rcl_interfaces.msg",
    "ActionClient": "rclpy.action",
    "ActionServer": "rclpy.action",
    "CancelResponse": "rclpy.action",
    "GoalResponse": "rclpy.action",
    "ClientGoalHandle": "rclpy.action.client",
    "ServerGoalHandle": "rclpy.action.server",
    "Client": "rclpy.client",
    "Duration": "rclpy.duration",
    "LifecycleNode": "rclpy.lifecycle",
    "LifecyclePublisher": "rclpy.lifecycle",
    "Node": "rclpy.node",
    "Parameter": "rclpy.parameter",
    "Publisher": "rclpy.publisher",
    "DurabilityPolicy": "rclpy.qos",
    "HistoryPolicy": "rclpy.qos",
    "LivelinessPolicy": "rclpy.qos",
    "QoSProfile": "rclpy.qos",
    "ReliabilityPolicy": "rclpy.qos",
    "Service": "rclpy.service",
    "Subscription": "rclpy.subscription",
    "Future": "rclpy.task",
    "Timer": "rclpy.timer",
}
"""The modules of the names that modules of nodes and of their tests use."""

LINE_LENGTH = 110
_DIGITS = re.compile(r"(\d+)")


class Names:
    """The names that one module uses: asking for one says how to spell it, and has it imported."""

    def __init__(self, homes: Mapping[str, str], own_package: str = "") -> None:
        """`homes` are the modules of the names that can be asked for; what is of `own_package` comes last."""
        self._homes = homes
        self._own_package = own_package
        self._used: set[Import] = set()

    def __call__(self, name: str) -> str:
        """How to spell a name of Python, rclpy or ifgen_runtime."""
        self.add(self._homes[name], name)
        return name

    def add(self, module: str, name: str, spelling: str = "") -> None:
        """Import a name of any module, under its own name or as `spelling`."""
        self._used.add((module, name, spelling or name))

    @property
    def lines(self) -> tuple[str, ...]:
        """The import statements, as ruff sorts them."""
        return statements(self._used, self._own_package)


def statements(imports: Iterable[Import], own_package: str = "", *, indent: int = 0) -> tuple[str, ...]:
    """Import statements in the order of ruff: standard library, other packages, this one, this folder.

    An import is (module, name, what it is called here), with an empty module for a module itself.
    """
    groups: tuple[dict[str, list[tuple[str, str]]], ...] = ({}, {}, {}, {})
    for module, name, spelling in imports:
        package = (module or name).partition(".")[0]
        group = 0 if package in stdlib_module_names else 2 if package and package == own_package else 1
        group = 3 if module.startswith(".") else group
        groups[group].setdefault(module, []).append((name, spelling))
    lines: list[str] = []
    for modules in groups:
        if lines and modules:
            lines.append("")
        for module in sorted(modules, key=natural):
            lines += _import(module, indent, sorted(modules[module], key=lambda pair: member_order(pair[0])))
    return tuple(lines)


def _import(module: str, indent: int, members: list[tuple[str, str]]) -> Iterator[str]:
    plain = [name for name, spelling in members if name == spelling]
    renamed = [f"{name} as {spelling}" for name, spelling in members if name != spelling]
    if not module:
        yield from (f"import {name}" for name in (*plain, *renamed))
        return
    if plain:
        yield import_statement(module, plain, indent=indent)
    for name in renamed:
        yield import_statement(module, [name], indent=indent)


def import_statement(module: str, names: Iterable[str], *, indent: int = 0) -> str:
    """`from module import names`, broken as ruff breaks it; the first line is not indented."""
    line = f"from {module} import {', '.join(names)}"
    if indent + len(line) <= LINE_LENGTH:
        return line
    margin = " " * indent
    return f"from {module} import (\n" + "".join(f"{margin}    {name},\n" for name in names) + f"{margin})"


@lru_cache(maxsize=4096)
def member_order(name: str) -> tuple[int, list[str | int]]:
    """A key that sorts names as ruff does: constants, classes, the rest; numbers by their value."""
    kind = 0 if name.isupper() and len(name) > 1 else 1 if name[:1].isupper() else 2
    return kind, natural(name)


@lru_cache(maxsize=4096)
def natural(text: str) -> list[str | int]:
    """A key that sorts text by the value of the numbers in it."""
    return [int(part) if part.isdigit() else part for part in _DIGITS.split(text)]
