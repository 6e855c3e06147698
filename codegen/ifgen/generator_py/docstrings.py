"""Documentation of interfaces as docstrings."""

from __future__ import annotations

import textwrap

from ifgen.definition.interfaces import Field
from ifgen.definition.types import (
    Array,
    BasicType,
    BoundedSequence,
    BoundedString,
    BoundedWString,
    FieldType,
    NamespacedType,
    UnboundedSequence,
    UnboundedString,
    UnboundedWString,
)

_WIDTH = 100
_SPELLINGS = {"boolean": "bool", "octet": "byte", "float": "float32", "double": "float64"}


def docstring(text: str, *, indent: int) -> str:
    """A docstring literal whose first line is already indented; the other lines are indented here."""
    lines: list[str] = []
    for line in text.expandtabs(4).strip().splitlines():
        lines += textwrap.wrap(line.rstrip(), _WIDTH, break_long_words=False, break_on_hyphens=False) or [""]
    lines = [_escaped(line) for line in lines]
    if len(lines) < 2:
        return f'"""{"".join(lines)}"""'
    margin = " " * indent
    return "\n".join(
        [f'"""{lines[0]}', *(margin + line if line else "" for line in lines[1:]), f'{margin}"""']
    )


def _escaped(line: str) -> str:
    """A line as it has to be written between triple quotes."""
    line = line.replace("\\", "\\\\")
    if '"""' in line:
        line = line.replace('"', '\\"')
    elif line.endswith('"'):  # the closing quotes may come next
        line = line[:-1] + '\\"'
    return line if line.isprintable() else "".join(map(_escaped_character, line))


def _escaped_character(character: str) -> str:
    if character.isprintable():
        return character
    code = ord(character)
    return f"\\x{code:02x}" if code < 0x100 else f"\\u{code:04x}" if code < 0x10000 else f"\\U{code:08x}"


def field_documentation(field: Field) -> str:
    """What the definition says about a field, and a last line with its type (bounds included) and unit."""
    last = f"`{spelling(field.type)}`"
    if field.unit:
        last += f", unit {field.unit}"
    return f"{field.documentation}\n\n{last}." if field.documentation else f"{last}."


def spelling(type_: FieldType) -> str:
    """A type as definitions spell it: `string<=5[3]`."""
    match type_:
        case BasicType(typename):
            return _SPELLINGS.get(typename, typename)
        case UnboundedString():
            return "string"
        case UnboundedWString():
            return "wstring"
        case BoundedString(bound):
            return f"string<={bound}"
        case BoundedWString(bound):
            return f"wstring<={bound}"
        case NamespacedType(package, _, name):
            return f"{package}/{name}"
        case Array(value_type, size):
            return f"{spelling(value_type)}[{size}]"
        case BoundedSequence(value_type, maximum):
            return f"{spelling(value_type)}[<={maximum}]"
        case UnboundedSequence(value_type):
            return f"{spelling(value_type)}[]"


def source_literal(text: str) -> str:
    """A definition as a string literal that can be read: one line of it a line."""
    return '"""\\\n' + "\n".join(map(_source_line, text.split("\n"))) + '"""'


def _source_line(line: str) -> str:
    stripped = line.rstrip(" ")
    return _escaped(stripped) + "\\x20" * (len(line) - len(stripped))
