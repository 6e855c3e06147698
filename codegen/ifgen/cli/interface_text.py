"""An interface as resolved, in the manner of `ros2 interface show`: nested types stand below their field."""

from __future__ import annotations

from collections.abc import Iterator

from ifgen.definition.interfaces import Constant, Field, Message, Registry, Service
from ifgen.definition.meaning.reading import reading_of
from ifgen.definition.meaning.values import bracketed
from ifgen.definition.spelling import spelled, spelled_value
from ifgen.definition.type_description import Described, type_hash
from ifgen.definition.types import Array, BoundedSequence, NamespacedType, UnboundedSequence

_INDENT = "    "
_WIDTH = 80


def lines(described: Described, registry: Registry) -> Iterator[str]:
    """Type name, hash and documentation, then the fields; `---` between the parts of a service or action."""
    yield described.type_name
    yield type_hash(described, registry)
    yield ""
    if described.documentation:
        yield from _comment(described.documentation, "")
        yield ""
    for index, part in enumerate(_parts(described)):
        if index:
            yield "---"
        if part.documentation != described.documentation:
            yield from _comment(part.documentation, "")
        yield from _message(part, registry, "", with_comments=True)


def definition(described: Described, registry: Registry) -> Iterator[str]:
    """Type name, hash, fields and constants without any comment."""
    yield described.type_name
    yield type_hash(described, registry)
    for index, part in enumerate(_parts(described)):
        if index:
            yield "---"
        yield from _message(part, registry, "", with_comments=False)


def _parts(described: Described) -> tuple[Message, ...]:
    match described:
        case Message():
            return (described,)
        case Service():
            return (described.request, described.response)
        case _:
            return (described.goal, described.result, described.feedback)


def _message(message: Message, registry: Registry, indent: str, *, with_comments: bool) -> Iterator[str]:
    """The constants and fields of a message; a nested message's comments are its own affair."""
    for constant in message.constants:
        text = f"{spelled(constant.type, message.package)} {constant.name}={spelled_value(constant.value)}"
        yield from _with_comment(text, constant, indent, with_comments=with_comments)
    for field in message.fields:
        default = "" if field.default_value is None else f" {spelled_value(field.default_value)}"
        text = f"{spelled(field.type, message.package)} {field.name}{default}"
        yield from _with_comment(text, field, indent, with_comments=with_comments)
        value_type = field.type
        if isinstance(value_type, Array | BoundedSequence | UnboundedSequence):
            value_type = value_type.value_type
        if isinstance(value_type, NamespacedType):
            nested = registry.message(value_type.type_name)
            yield from _message(nested, registry, indent + _INDENT, with_comments=False)


def _with_comment(
    text: str, described: Field | Constant, indent: str, *, with_comments: bool
) -> Iterator[str]:
    found = reading_of(described)
    comment = f"{found.text} {bracketed(found.meaning)}".strip() if with_comments else ""
    beside = f"{indent}{text}  # {comment.strip()}" if comment.strip() else indent + text
    if "\n" in comment or len(beside) > _WIDTH:
        yield from _comment(comment, indent)
        beside = indent + text
    yield beside


def _comment(documentation: str, indent: str) -> Iterator[str]:
    for line in documentation.splitlines():
        yield f"{indent}# {line}".rstrip()
