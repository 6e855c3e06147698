"""Documentation of interfaces as docstrings."""

from __future__ import annotations

import textwrap

from ifgen.definition.interfaces import Constant, Field
from ifgen.definition.spelling import spelled

_WIDTH = 100


def docstring(text: str, *, indent: int) -> str:
    """A docstring literal whose first line is already indented; the other lines are indented here."""
    lines: list[str] = []
    for line in text.expandtabs(4).strip().splitlines():
        lines += [line.rstrip()] if len(line) <= _WIDTH else _wrapped(line.rstrip())
    lines = [_escaped(line) for line in lines]
    if len(lines) < 2:
        return f'"""{"".join(lines)}"""'
    margin = " " * indent
    return "\n".join(
        [f'"""{lines[0]}', *(margin + line if line else "" for line in lines[1:]), f'{margin}"""']
    )


def _wrapped(line: str) -> list[str]:
    return textwrap.wrap(line, _WIDTH, break_long_words=False, break_on_hyphens=False)


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
    """The definition's comment on a field, and a last line with its type (bounds included) and unit."""
    last = f"`{spelled(field.type)}`"
    if field.unit:
        last += f", unit {field.unit}"
    return f"{field.documentation}\n\n{last}." if field.documentation else f"{last}."


def constant_documentation(constant: Constant) -> str:
    """The definition's comment on a constant, and a last line with its unit if it has one."""
    unit = f"Unit {constant.unit}." if constant.unit else ""
    return "\n\n".join(filter(None, (constant.documentation, unit)))


def source_literal(text: str) -> str:
    """A definition as a string literal that can be read: one line of it a line."""
    return '"""\\\n' + "\n".join(map(_source_line, text.split("\n"))) + '"""'


def _source_line(line: str) -> str:
    stripped = line.rstrip(" ")
    return _escaped(stripped) + "\\x20" * (len(line) - len(stripped))
