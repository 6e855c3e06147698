"""The readings of .idl text by rosidl and ifgen, as plain values that compare.

rosidl's answer goes through what would fail on it: rosidl_parser, the type description, and the Python text of
constants and default values.
"""

from __future__ import annotations

import ast
import contextlib
import io
import re
import warnings
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from ifgen.definition import build
from ifgen.definition.interfaces import Folder, Interface, Message, Service
from ifgen.definition.problems import FileProblems
from ifgen.definition.types import Array, BoundedSequence, UnboundedSequence
from ifgen.diagnostics import Source

from .conftest import NAME, PACKAGE, Answer, Plain, Refused, lines_of, type_of_idl, unbounded

PARTS = {"Message": "msg", "Service": "srv", "Action": "action"}
PLACES = {
    "const": "constants",
    **dict.fromkeys(["typedef", "enum", "module", "struct", "union", "bitmask", "interface"], "before"),
    **dict.fromkeys(["#include", "#define", "#pragma", "native", "constlong"], "before"),
}
COLLECTIONS = (Array, BoundedSequence, UnboundedSequence)


def ours(kind: Folder, text: str) -> tuple[Answer, FileProblems]:
    """The reading of a text by ifgen, and its diagnostics."""
    source = Source(Path(f"{NAME}.idl"), text)
    problems = FileProblems(source)
    interface = build.interface(source, PACKAGE, kind, NAME, problems)
    if problems:
        return Refused("; ".join(f"{p.rule}: {p.message}" for p in problems.errors())), problems
    return tuple(map(_plain, parts_of(interface))), problems


def parts_of(interface: Interface) -> tuple[Message, ...]:
    """The parts that a file defines."""
    match interface:
        case Message():
            return (interface,)
        case Service():
            return (interface.request, interface.response)
        case _:
            return (interface.goal, interface.result, interface.feedback)


def framed(text: str) -> str:
    """The file made of some lines: each is a member, a constant of the message, or comes before it.

    A text that is already a whole file is unchanged.
    """
    if text.startswith(("module demo_msgs", "@x module demo_msgs")):
        return text
    lines: dict[str, list[str]] = {"before": [], "constants": [], "members": []}
    for line in text.split("\n"):
        word = re.sub(r"^(@\w+ *(\(.*?\))? *)+", "", line).partition(" ")[0]
        lines[PLACES.get(word, "members")].append(line)
    constants, members = "\n".join(lines["constants"]), "\n".join(lines["members"] or ["long a;"])
    module = f"module {NAME}_Constants {{\n{constants}\n}};" if constants else ""
    before = "\n".join(lines["before"])
    return f"module {PACKAGE} {{ module msg {{\n{before}\n{module} struct {NAME} {{\n{members}\n}}; }}; }};"


def _plain(message: Message) -> Plain:
    return Plain(
        message.type_name,
        tuple(
            (f.name, f.type, f.default_value, lines_of(f.documentation), f.unit, _annotations(f.annotations))
            for f in message.fields
        ),
        tuple((c.name, c.type, c.value, lines_of(c.documentation)) for c in message.constants),
        lines_of(message.documentation),
    )


def _annotations(annotations: tuple[Any, ...]) -> tuple[Any, ...]:
    return tuple((a.name, a.value, dict(a.parameters)) for a in annotations)


def rosidl(kind: Folder, text: str) -> Answer:
    """The reading of a text by rosidl; the reason of a refusal begins with the tool that refuses."""
    from rosidl_parser.parser import parse_idl_string

    stage = "rosidl_parser"
    with (
        contextlib.redirect_stdout(io.StringIO()),
        contextlib.redirect_stderr(io.StringIO()),
        warnings.catch_warnings(action="ignore"),
    ):
        try:
            content = parse_idl_string(text)
            (interface,) = (e for e in content.elements if type(e).__name__ in PARTS)
            parts = _reference_parts(interface)
            stage = "rosidl_generator_type_description"
            for part in parts:
                _describe(part)
            stage = "rosidl_generator_py"
            answer = tuple(_plain_reference(part) for part in parts)
            stage = "rosidl_generator_c"
            for part in parts:
                _write_constants(part)
        except Exception as error:  # rosidl fails in every way there is
            return Refused(f"{stage}: {type(error).__name__}: {error}")
    if PARTS[type(interface).__name__] != kind or not answer[0].name.startswith(f"{PACKAGE}/{kind}/{NAME}"):
        return Refused("rosidl_generator_py: ImportError: the class is not where its package looks for it")
    return answer


def _reference_parts(interface: Any) -> tuple[Any, ...]:
    match type(interface).__name__:
        case "Message":
            return (interface,)
        case "Service":
            return (interface.request_message, interface.response_message)
        case _:
            return (interface.goal, interface.result, interface.feedback)


def _describe(message: Any) -> None:
    from rosidl_generator_type_description import serialize_individual_type_description

    structure = message.structure
    for field in serialize_individual_type_description(structure.namespaced_type, structure.members)[
        "fields"
    ]:
        nested = field["type"]["nested_type_name"]
        if nested and nested.count("/") != 2:
            raise KeyError(nested)  # as it does when it looks up the type's own description


def _plain_reference(message: Any) -> Plain:
    structure = message.structure
    fields = []
    for member in structure.members:
        type_ = type_of_idl(member.type)
        fields.append(
            (
                member.name,
                type_,
                _default(member, type_),
                tuple(member.get_comment_lines()),
                _unit(member),
                tuple(_other_annotations(member)),
            )
        )
    if [field[0] for field in fields] == ["structure_needs_at_least_one_member"]:
        fields = []
    constants = [
        (c.name, unbounded(type_of_idl(c.type)), _constant(c), tuple(c.get_comment_lines()))
        for c in message.constants
    ]
    return Plain(
        "/".join(structure.namespaced_type.namespaced_name()),
        tuple(fields),
        tuple(constants),
        tuple(structure.get_comment_lines()),
    )


def _default(member: Any, type_: Any) -> Any:
    from rosidl_generator_py.generate_py_impl import primitive_value_to_py, value_to_py

    if not member.has_annotation("default"):
        return None
    value = member.get_annotation_value("default")["value"]
    value_to_py(member.type, value)
    if not isinstance(type_, COLLECTIONS):
        return ast.literal_eval(primitive_value_to_py(member.type, value))
    return tuple(
        ast.literal_eval(primitive_value_to_py(member.type.value_type, item))
        for item in ast.literal_eval(value)
    )


def _constant(constant: Any) -> Any:
    from rosidl_generator_py.generate_py_impl import constant_value_to_py

    return ast.literal_eval(constant_value_to_py(constant.type, constant.value))


def _write_constants(message: Any) -> None:
    from rosidl_generator_c import value_to_c

    for constant in message.constants:
        value_to_c(constant.type, constant.value)


def _unit(member: Any) -> Any:
    if not member.has_annotation("unit"):
        return None
    value = member.get_annotation_value("unit")
    value = value.get("value") if isinstance(value, dict) else value
    return None if value is None else str(value)


def _other_annotations(member: Any) -> Iterator[Any]:
    for annotation in member.annotations:
        parameters = annotation.value if isinstance(annotation.value, dict) else {}
        is_comment = parameters.get("language") == "comment" and "text" in parameters
        if annotation.name not in ("unit", "default") and not (annotation.name == "verbatim" and is_comment):
            yield annotation.name, None if parameters else annotation.value, parameters
