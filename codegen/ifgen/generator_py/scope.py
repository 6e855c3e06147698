"""What a generated module imports, and what it calls that."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator
from sys import stdlib_module_names
from typing import Literal, TypeAlias

Import: TypeAlias = tuple[str, str, str]
"""Module (none for a module itself), name, and what it is called here."""

_DIGITS = re.compile(r"(\d+)")

# Where the names come from that generated modules use. Type checkers alone need the second group: importing
# typing takes longer than everything else in a message package.
_RUNTIME = {
    "array": "array",
    "Action": "ifgen_runtime.interface",
    "Service": "ifgen_runtime.interface",
    "ServiceMeta": "ifgen_runtime.interface",
    "DEFAULT": "ifgen_runtime.message",
    "Message": "ifgen_runtime.message",
    "MessageMeta": "ifgen_runtime.message",
    "checks_by_default": "ifgen_runtime.message",
    "default_of": "ifgen_runtime.message",
    "enum_view": "ifgen_runtime.message",
    "initialize_checked": "ifgen_runtime.message",
    "mutable_default": "ifgen_runtime.message",
    "note_field": "ifgen_runtime.message",
    "array_repr": "ifgen_runtime.copying",
    "copied_array": "ifgen_runtime.copying",
    "copied_list": "ifgen_runtime.copying",
    "copied_other": "ifgen_runtime.copying",
    "deepcopy_of": "ifgen_runtime.copying",
    "new_object": "ifgen_runtime.copying",
    "repr_name": "ifgen_runtime.copying",
    "repr_of_fields": "ifgen_runtime.copying",
}
_TYPING = {
    "Any": "typing",
    "ClassVar": "typing",
    "Final": "typing",
    "Never": "typing",
    "TypeAlias": "typing",
    "IntEnum": "enum",
    "Iterable": "collections.abc",
    "Sequence": "collections.abc",
    "NDArray": "numpy.typing",
}
_BUILTINS = (
    *("Exception", "bool", "bytes", "dict", "float", "int", "list", "locals", "property", "staticmethod"),
    "str",
)

LINE_LENGTH = 110


class Scope:
    """The names that one module uses: asking for one says how to spell it, and has it imported.

    `package` is the module's own; `taken` are the classes, fields and constants of the module. Where one of
    them is called as something that generated code needs, everything of ours is spelled with an underscore
    behind it in that module: no class, field or constant is called so.
    """

    def __init__(self, package: str, taken: Iterable[str]) -> None:
        self._package = package
        ours = {*_RUNTIME, *_TYPING, *_BUILTINS, "numpy"}
        self.mark = "" if ours.isdisjoint(taken) else "_"
        self._used: set[str] = set()
        self._classes: set[Import] = set()
        self._codec: set[Import] = set()
        self._nested: set[tuple[str, str]] = set()

    def __call__(self, name: str) -> str:
        """How to spell something of Python's or of ifgen_runtime's."""
        self._used.add(name)
        return name + self.mark

    def nested(self, purpose: Literal["default", "deepcopy"], reference: str) -> str:
        """The function of the module that makes a default message of a class, or copies one deeply."""
        self._nested.add((purpose, reference))
        self(f"{purpose}_of")
        return f"_{purpose}_{reference}"

    def add_class(self, module: str, name: str, reference: str, *, only_codec: bool = False) -> None:
        """Import a class of another module as `reference`; say if only the codec needs it."""
        (self._codec if only_codec else self._classes).add((module, name, reference))

    def add_codec_names(self, names: Iterable[str]) -> None:
        """Import functions that codecs are made of."""
        self._codec.update(("ifgen_runtime.codec", name, name) for name in names)

    @property
    def nested_functions(self) -> tuple[str, ...]:
        """The definitions of what `nested` was asked for."""
        return tuple(
            f"_{purpose}_{reference} = {purpose}_of{self.mark}({reference})"
            for purpose, reference in sorted(self._nested)
        )

    @property
    def imports(self) -> tuple[str, ...]:
        """The import statements of run time."""
        builtins = [("builtins", name, f"{name}_") for name in self._used if self.mark and name in _BUILTINS]
        return statements([*self._own(_RUNTIME), *builtins, *self._classes], self._package)

    @property
    def typing_imports(self) -> tuple[str, ...]:
        """What only type checkers import."""
        numpy = [("", "numpy", f"numpy{self.mark}")] if "numpy" in self._used else []
        return statements([*self._own(_TYPING), *numpy], indent=4)

    @property
    def lazy_imports(self) -> tuple[str, ...]:
        """What stands in for those of `typing_imports` that are used at run time."""
        return statements(
            [("ifgen_runtime.lazy", "numpy", f"numpy{self.mark}")] if "numpy" in self._used else []
        )

    @property
    def codec_imports(self) -> tuple[str, ...]:
        """What only the codecs need."""
        own = {name + self.mark for name in self._used}
        imports = (import_ for import_ in self._codec - self._classes if import_[2] not in own)
        return statements(imports, self._package, indent=4)

    def _own(self, table: dict[str, str]) -> Iterator[Import]:
        return ((table[name], name, name + self.mark) for name in self._used if name in table)


def statements(imports: Iterable[Import], own_package: str = "", *, indent: int = 0) -> tuple[str, ...]:
    """Import statements in the order that ruff wants: standard library, other packages, this package.

    An import is (module, name, what it is called here), with an empty module for a module itself.
    """
    groups: tuple[dict[str, list[tuple[str, str]]], ...] = ({}, {}, {})
    for module, name, spelling in imports:
        package = (module or name).partition(".")[0]
        group = 0 if package in stdlib_module_names else 2 if package and package == own_package else 1
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


def member_order(name: str) -> tuple[int, list[str | int]]:
    """A key that sorts names as ruff does: constants, classes, the rest; numbers by their value."""
    kind = 0 if name.isupper() and len(name) > 1 else 1 if name[:1].isupper() else 2
    return kind, natural(name)


def natural(text: str) -> list[str | int]:
    """A key that sorts text by the value of the numbers in it."""
    return [int(part) if part.isdigit() else part for part in _DIGITS.split(text)]
