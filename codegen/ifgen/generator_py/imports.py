"""The imports of generated modules: where names come from, who collects them, and the statements.

Code that makes text asks a `Names` for each name in it, so no other code needs to know which names the text
uses.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from functools import lru_cache
from sys import stdlib_module_names
from typing import Final, Literal, TypeAlias

Import: TypeAlias = tuple[str, str, str]
"""Module (none for a module itself), name, and what it is called here."""


def _homes(names: Mapping[str, str]) -> Mapping[str, str]:
    """The module of each name; `names` has the names of each module."""
    return {name: module for module, text in names.items() for name in text.split()}


IN_MESSAGES: Final = _homes(
    {
        "builtins": (
            "Exception bool bytes dict float int list locals classmethod property range staticmethod str"
        ),
        "array": "array",
        "collections.abc": "Iterable Sequence",
        "enum": "IntEnum",
        "typing": "Annotated Any ClassVar Final TypeAlias",
        "": "numpy",
        "numpy.typing": "NDArray",
        "ifgen_runtime": "meaning",
        "ifgen_runtime.copying": (
            "ITERABLES array_repr arrays copied_array copied_list copied_other deepcopy_of new_array "
            "new_object repr_name repr_of_fields unequal"
        ),
        "ifgen_runtime.views": (
            "Int8Array UInt8Array Int16Array UInt16Array Int32Array UInt32Array Int64Array UInt64Array "
            "Float32Array Float64Array"
        ),
        "ifgen_runtime.interface": "Action Service ServiceMeta",
        "ifgen_runtime.message": (
            "DEFAULT Message MessageMeta NoSuchField checks_by_default default_of enum_view "
            "initialize_checked mutable_default note_field"
        ),
    }
)
"""The modules of the names that modules of interfaces use; codecs use more of `ifgen_runtime.codec`."""

IN_NODES: Final = _homes(
    {
        "abc": "ABC",
        "collections.abc": "Callable",
        "rcl_interfaces.msg": "FloatingPointRange IntegerRange ParameterDescriptor",
        "rclpy.action": "ActionClient ActionServer CancelResponse GoalResponse",
        "rclpy.action.client": "ClientGoalHandle",
        "rclpy.action.server": "ServerGoalHandle",
        "rclpy.client": "Client",
        "rclpy.duration": "Duration",
        "rclpy.lifecycle": "LifecycleNode LifecyclePublisher",
        "rclpy.node": "Node",
        "rclpy.parameter": "Parameter",
        "rclpy.publisher": "Publisher",
        "rclpy.qos": "DurabilityPolicy HistoryPolicy LivelinessPolicy QoSProfile ReliabilityPolicy",
        "rclpy.service": "Service",
        "rclpy.subscription": "Subscription",
        "rclpy.task": "Future",
        "rclpy.timer": "Timer",
    }
)
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


_CODEC: Final = "ifgen_runtime.codec"
# Type checkers alone need these: importing typing takes longer than everything else in a message package.
_FOR_TYPE_CHECKERS: Final = {
    "typing",
    "enum",
    "numpy.typing",
    "ifgen_runtime",
    "ifgen_runtime.views",
    "",
}


_IN_HINTS: Final = {"Annotated", "meaning"}
"""The names that `typing.get_type_hints` needs at run time."""


class Scope(Names):
    """The names that the module of an interface uses.

    `package` is the module's own; `taken` are the classes, fields and constants of the module. If one of them
    has a name that generated code needs, all our names have an underscore at their end in that module: no
    class, field or constant can have such a name.
    """

    def __init__(self, package: str, taken: Iterable[str]) -> None:
        super().__init__(IN_MESSAGES, package)
        self.mark = "" if IN_MESSAGES.keys().isdisjoint(taken) else "_"
        self._codec: set[Import] = set()
        self._nested: set[tuple[str, str]] = set()

    def __call__(self, name: str) -> str:
        """How to spell a name of Python or ifgen_runtime."""
        spelling = name + self.mark
        self.add(IN_MESSAGES[name], name, spelling)
        return spelling

    def nested(self, purpose: Literal["default", "deepcopy"], reference: str) -> str:
        """The function of the module that makes a default message of a class, or copies one deeply."""
        self._nested.add((purpose, reference))
        self(f"{purpose}_of")
        return f"_{purpose}_{reference}"

    def add_for_codec(self, names: Iterable[str], classes: Iterable[Import]) -> None:
        """Import functions that codecs are made of, and classes that only they may need."""
        self._codec.update((_CODEC, name, name) for name in names)
        self._codec.update(classes)

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
        return statements(
            (
                (module, name, spelling)
                for module, name, spelling in self._used
                if module not in _FOR_TYPE_CHECKERS and (module != "builtins" or spelling != name)
            ),
            self._own_package,
        )

    @property
    def typing_imports(self) -> tuple[str, ...]:
        """The imports that only type checkers need."""
        return statements((import_ for import_ in self._used if import_[0] in _FOR_TYPE_CHECKERS), indent=4)

    @property
    def lazy_imports(self) -> tuple[str, ...]:
        """The replacements of those of `typing_imports` that are used at run time."""
        return statements(
            ("ifgen_runtime.lazy", name, spelling)
            for module, name, spelling in self._used
            if not module or name in _IN_HINTS
        )

    @property
    def codec_imports(self) -> tuple[str, ...]:
        """The imports that only the codecs need."""
        known = {spelling for _, _, spelling in self._used}
        return statements(
            (import_ for import_ in self._codec if import_[2] not in known), self._own_package, indent=4
        )


_UNFORMATTED: Final = "# fmt: off"
# An import statement or the first line of code, at the left margin. Strings of many lines are skipped.
_AT_MARGIN: Final = re.compile(
    r"\n(?:from (?P<module>(?!__future__)\w[\w.]*) import (?:\((?P<lines>[\w\s,]+)\)|(?P<names>[\w, ]+))$"
    r"|import (?P<modules>[\w., ]+)$"
    r"""|(?P<head>[^\n"'#]*)\"{3}(?:\\.|[^\\])*?\"{3}"""
    rf"|(?P<code>@|async def |def |class |\w+(?:: [^\n]+)? = |{_UNFORMATTED}$))",
    re.MULTILINE | re.DOTALL,
)


@dataclass(slots=True)
class _Run:
    """Import statements with nothing but blank lines between them: where they are, and what they import."""

    start: int
    end: int
    imports: set[Import] = field(default_factory=set[Import])


def gathered(text: str, own_package: str) -> str:
    """The text with all its import statements at its top, each once, as ruff sorts them.

    There may be several runs of them at the top, with calls in between. A statement stays in its run, but the
    standard library belongs to the first. Whatever comes after the first line of code goes to the last one. A
    statement with a comment stays where it is.
    """
    text = f"\n{text}"
    top, scattered, code = _runs(text)
    if not top:
        if not scattered:
            return text[1:]
        top = [_Run(code, code)]
    for run in (*top[1:], *scattered):
        standard = {import_ for import_ in run.imports if _package(import_) in stdlib_module_names}
        top[0].imports |= standard
        run.imports -= standard
    for run in scattered:
        top[-1].imports |= run.imports
        run.imports = set()
    parts: list[str] = []
    end = 0
    for run in (*top, *scattered):
        lines = statements(run.imports, own_package)
        parts += [text[end : run.start], *(f"\n{line}" for line in lines)]
        end = run.end
    return "".join([*parts, text[end:]])[1:]


def _runs(text: str) -> tuple[list[_Run], list[_Run], int]:
    """The runs at the top, those after the first line of code, and where that is."""
    top: list[_Run] = []
    scattered: list[_Run] = []
    code = len(text)
    last = max(text.rfind("\nfrom "), text.rfind("\nimport "))
    for match in _AT_MARGIN.finditer(text):
        if match.start() > last:
            break
        if match["code"]:
            if top or match["code"] != _UNFORMATTED:  # which may hold for the whole file
                code = min(code, match.start())
        elif match["head"] is not None:
            if "=" in match["head"] and not match["head"].startswith(" "):
                code = min(code, match.start())
        elif match.start() > code:
            scattered.append(_Run(match.start(), match.end(), set(_imports(match))))
        else:
            if not top or text[top[-1].end : match.start()].strip():
                top.append(_Run(match.start(), match.end()))
            top[-1].end = match.end()
            top[-1].imports.update(_imports(match))
    return top, scattered, code


def _imports(match: re.Match[str]) -> Iterator[Import]:
    names = match["modules"] or match["lines"] or match["names"]
    for part in filter(None, map(str.strip, names.split(","))):
        name, _, spelling = part.partition(" as ")
        yield match["module"] or "", name, spelling or name


def _package(import_: Import) -> str:
    module, name, _ = import_
    return (module or name).partition(".")[0]
