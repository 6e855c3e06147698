"""The reference in this process: rosidl_adapter and rosidl_parser, with answers as plain values that compare."""

from __future__ import annotations

import ast
import contextlib
import io
import re
import tempfile
import warnings
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pytest
from ifgen.definition import build
from ifgen.definition.interfaces import Action, Interface, Message, Service
from ifgen.definition.problems import FileProblems
from ifgen.definition.types import (
    Array,
    BasicType,
    BoundedSequence,
    BoundedString,
    BoundedWString,
    NamespacedType,
    UnboundedSequence,
    UnboundedString,
    UnboundedWString,
)
from ifgen.diagnostics import Source

PACKAGE, NAME = "demo_msgs", "Demo"
BYTES, BOOLEAN = BasicType("octet"), BasicType("boolean")


@dataclass(frozen=True)
class Plain:
    """A message in plain values: (name, type, default, lines of comment, unit) per field, less per constant."""

    name: str
    fields: tuple[tuple[Any, ...], ...]
    constants: tuple[tuple[Any, ...], ...]
    comment: tuple[str, ...] | None


@dataclass(frozen=True)
class Refused:
    """A refusal: which tool refused an input, and why. All refusals compare equal."""

    why: str

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Refused)

    __hash__ = None  # type: ignore[assignment]


Answer = tuple[Plain, ...] | Refused


class Ours:
    """The answer of ifgen."""

    def problems(self, kind: Any, text: str, name: str = NAME) -> FileProblems:
        """The diagnostics of ifgen about a file."""
        return self._read(kind, text, name)[1]

    def answer(self, kind: Any, text: str, name: str = NAME) -> Answer:
        """The reading of a file by ifgen."""
        interface, problems = self._read(kind, text, name)
        if problems:
            return Refused("; ".join(f"{problem.rule}: {problem.message}" for problem in problems.errors()))
        match interface:
            case Message():
                return (self._plain(interface),)
            case Service():
                return (self._plain(interface.request), self._plain(interface.response))
            case Action():
                return tuple(map(self._plain, (interface.goal, interface.result, interface.feedback)))

    def _read(self, kind: Any, text: str, name: str) -> tuple[Interface, FileProblems]:
        source = Source(Path(f"{name}.{kind}"), text)
        problems = FileProblems(source)
        return build.interface(source, PACKAGE, kind, name, problems), problems

    def _plain(self, message: Message) -> Plain:
        return Plain(
            message.name,
            tuple(
                (f.name, f.type, f.default_value, lines_of(f.documentation), f.unit) for f in message.fields
            ),
            tuple((c.name, c.type, c.value, lines_of(c.documentation), c.unit) for c in message.constants),
            lines_of(message.documentation),
        )


class Reference:
    """rosidl's answer, by the text stage alone (fast) or with the way through .idl and back (~50 ms)."""

    def __init__(self) -> None:
        from rosidl_adapter import parser

        # On a wrong name of thirty letters the original takes longer than anyone waits; test_mutations.py shows
        # that ours means the same.
        self.constant_pattern: re.Pattern[str] = parser.VALID_CONSTANT_NAME_PATTERN
        parser.VALID_CONSTANT_NAME_PATTERN = re.compile(r"[A-Z][A-Z0-9]*(?:_[A-Z0-9]+)*(?!.)", re.DOTALL)

    def adapter(self, kind: str, text: str) -> Answer:
        """The answer of rosidl_adapter. Escapes in its strings are not resolved yet."""
        from rosidl_adapter import parser

        parse = {
            "msg": parser.parse_message_string,
            "srv": parser.parse_service_string,
            "action": parser.parse_action_string,
        }[kind]
        with contextlib.redirect_stderr(io.StringIO()):
            try:
                spec = parse(PACKAGE, NAME, text)
            except BaseException as error:  # rosidl fails in every way there is
                return Refused(f"{type(error).__name__}: {error}")
        parts: tuple[Any, ...]
        match kind:
            case "msg":
                parts = (spec,)
            case "srv":
                parts = (spec.request, spec.response)
            case _:
                parts = (spec.goal, spec.result, spec.feedback)
        return tuple(map(self._plain_text, parts))

    def full(self, kind: str, text: str | bytes) -> Answer:
        """The answer of rosidl_parser about the .idl file that rosidl_adapter writes.

        The reason begins with the tool that refuses it.
        """
        from rosidl_adapter import convert_to_idl
        from rosidl_parser.definition import IdlLocator
        from rosidl_parser.parser import parse_idl_file

        data = text.encode() if isinstance(text, str) else text
        silence = io.StringIO()
        with (
            tempfile.TemporaryDirectory() as folder,
            contextlib.redirect_stdout(silence),
            contextlib.redirect_stderr(silence),
            warnings.catch_warnings(action="ignore"),
        ):
            root = Path(folder)
            (root / kind).mkdir()
            (root / kind / f"{NAME}.{kind}").write_bytes(data)
            stage = "rosidl_adapter"
            try:
                convert_to_idl(root, PACKAGE, Path(kind) / f"{NAME}.{kind}", root / "idl")
                stage = "rosidl_parser"
                file = parse_idl_file(IdlLocator(root / "idl", f"{kind}/{NAME}.idl"))
            except BaseException as error:  # rosidl fails in every way there is, SystemExit included
                return Refused(f"{stage}: {type(error).__name__}: {error}")
            interface = next(
                e for e in file.content.elements if type(e).__name__ in ("Message", "Service", "Action")
            )
            parts: tuple[Any, ...]
            match kind:
                case "msg":
                    parts = (interface,)
                case "srv":
                    parts = (interface.request_message, interface.response_message)
                case _:
                    parts = (interface.goal, interface.result, interface.feedback)
            try:
                return tuple(self._plain_idl(part, kind) for part in parts)
            except (ValueError, SyntaxError) as error:
                return Refused(f"rosidl_generator_py: {type(error).__name__}: {error}")

    def _plain_text(self, spec: Any) -> Plain:
        def comment(element: Any) -> tuple[str, ...]:
            return tuple(element.annotations.get("comment", ()))

        def value(type_: Any, written: Any) -> Any:
            return _octets(type_, tuple(written) if isinstance(written, list) else written)

        fields = []
        for field in spec.fields:
            type_ = _type_of_text(field.type)
            fields.append(
                (
                    field.name,
                    type_,
                    value(type_, field.default_value),
                    comment(field),
                    field.annotations.get("unit"),
                )
            )
        constants = []
        for constant in spec.constants:
            type_ = _primitive_of_text(constant.type)
            constants.append(
                (
                    constant.name,
                    type_,
                    value(type_, constant.value),
                    comment(constant),
                    constant.annotations.get("unit"),
                )
            )
        return Plain(spec.msg_name, tuple(fields), tuple(constants), comment(spec))

    def _plain_idl(self, message: Any, kind: str) -> Plain:
        def annotation(element: Any, name: str, key: str) -> Any:
            if not element.has_annotation(name):
                return None
            return element.get_annotation_value(name)[key]

        def comment(element: Any) -> tuple[str, ...]:
            return lines_of(annotation(element, "verbatim", "text") or "")

        fields = []
        for member in message.structure.members:
            type_ = type_of_idl(member.type)
            default = annotation(member, "default", "value")
            if isinstance(type_, Array | BoundedSequence | UnboundedSequence) and default is not None:
                with warnings.catch_warnings(action="ignore"):
                    default = ast.literal_eval(default)
            fields.append(
                (
                    member.name,
                    type_,
                    _octets(type_, default),
                    comment(member),
                    annotation(member, "unit", "value"),
                )
            )
        if [field[0] for field in fields] == ["structure_needs_at_least_one_member"]:
            fields = []
        constants = [
            (c.name, type_, _octets(type_, c.value), comment(c), None)
            for c in message.constants
            for type_ in [unbounded(type_of_idl(c.type))]
        ]
        structure = message.structure
        return Plain(
            structure.namespaced_type.name,
            tuple(fields),
            tuple(constants),
            comment(structure) if kind == "msg" else None,
        )


def lines_of(text: str) -> tuple[str, ...]:
    return tuple(text.split("\n")) if text else ()


def _octets(type_: Any, value: Any) -> Any:
    """Octets as we have them: rosidl keeps them as integers."""
    if type_ == BYTES and isinstance(value, int):
        return bytes([value])
    if isinstance(value, tuple) and type_.value_type == BYTES:
        return tuple(bytes([item]) for item in value)
    return value


_IDL_NAMES = {"bool": "boolean", "byte": "octet", "char": "uint8", "float32": "float", "float64": "double"}


def _primitive_of_text(name: str, bound: int | None = None) -> Any:
    match name, bound:
        case "string", None:
            return UnboundedString()
        case "wstring", None:
            return UnboundedWString()
        case "string", _:
            return BoundedString(bound)
        case "wstring", _:
            return BoundedWString(bound)
        case _:
            return BasicType(_IDL_NAMES.get(name, name))  # type: ignore[arg-type]


def _type_of_text(type_: Any) -> Any:
    if type_.pkg_name:
        element: Any = NamespacedType(type_.pkg_name, "msg", type_.type)
    else:
        element = _primitive_of_text(type_.type, type_.string_upper_bound)
    if not type_.is_array:
        return element
    if type_.array_size is None:
        return UnboundedSequence(element)
    return (BoundedSequence if type_.is_upper_bound else Array)(element, type_.array_size)


def type_of_idl(type_: Any) -> Any:
    match type(type_).__name__:
        case "BasicType":
            return BasicType(type_.typename)
        case "NamespacedType":
            package, folder = type_.namespaces
            return NamespacedType(package, folder, type_.name)
        case "Array":
            return Array(type_of_idl(type_.value_type), type_.size)
        case "BoundedSequence":
            return BoundedSequence(type_of_idl(type_.value_type), type_.maximum_size)
        case "UnboundedSequence":
            return UnboundedSequence(type_of_idl(type_.value_type))
        case "BoundedString":
            return BoundedString(type_.maximum_size)
        case "BoundedWString":
            return BoundedWString(type_.maximum_size)
        case "UnboundedString":
            return UnboundedString()
        case _:
            return UnboundedWString()


def unbounded(type_: Any) -> Any:
    """rosidl_parser bounds the type of a string constant by the constant's length."""
    match type_:
        case BoundedString():
            return UnboundedString()
        case BoundedWString():
            return UnboundedWString()
        case _:
            return type_


_CHARACTERS = {
    **{
        "EMPTY": "",
        "BOM": "\ufeff",
        "TAB": "\t",
        "CR": "\r",
        "VT": "\v",
        "FF": "\f",
        "FS": "\x1c",
        "GS": "\x1d",
    },
    **{
        "RS": "\x1e",
        "US": "\x1f",
        "NEL": "\x85",
        "NBSP": "\xa0",
        "EM": "\u2003",
        "LS": "\u2028",
        "PS": "\u2029",
    },
    **{"NUL": "\0", "SOH": "\x01", "DEL": "\x7f"},
}


def decode(shown: str) -> str:
    """The input that a line of inputs.txt or a cell of docs/rosidl-differences.md denotes."""
    text = shown.replace("⏎", "\n").replace("␠", " ")
    return re.sub("⟨([A-Z]+)⟩", lambda match: _CHARACTERS[match[1]], text)


def comparable(answer: Answer, kind: str) -> Answer:
    """An answer without information that only one of the two can report.

    rosidl_parser drops units of constants and the comments of parts; we drop spaces at the ends of lines.
    """
    if isinstance(answer, Refused):
        return answer
    return tuple(
        Plain(
            part.name,
            part.fields,
            tuple(constant[:-1] for constant in part.constants),
            _tidy(part.comment) if kind == "msg" else None,
        )
        for part in answer
    )


def _tidy(lines: tuple[str, ...] | None) -> tuple[str, ...]:
    kept: list[str] = []
    for line in map(str.rstrip, lines or ()):
        if line or (kept and kept[-1]):
            kept.append(line)
    return tuple(kept[:-1] if kept and not kept[-1] else kept)


@pytest.fixture(scope="session")
def ours() -> Ours:
    """The answer of ifgen."""
    return Ours()


@pytest.fixture(scope="session")
def rosidl() -> Reference:
    """The answer of rosidl; skips if its wheels are missing."""
    for needed in ("rosidl_adapter", "rosidl_parser"):
        pytest.importorskip(needed, reason="the rosidl wheels are not installed (Linux x86_64 only)")
    return Reference()
