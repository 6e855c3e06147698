"""Python text as `ruff format` leaves it: docstrings, literals, calls, signatures and QoS profiles."""

from __future__ import annotations

import math
import textwrap
from collections.abc import Callable, Iterable, Iterator
from typing import TYPE_CHECKING

from ifgen.generator_py.imports import LINE_LENGTH

if TYPE_CHECKING:
    from ifgen.nodl.model import ParameterValue, QosProfile

_WIDTH = 100


def docstring(text: str, *, indent: int) -> str:
    """A docstring literal whose first line is already indented; the other lines are indented here."""
    lines: list[str] = []
    for line in text.expandtabs(4).strip().splitlines():
        if len(line) > _WIDTH:
            lines += textwrap.wrap(line.rstrip(), _WIDTH, break_long_words=False, break_on_hyphens=False)
        else:
            lines.append(line.rstrip())
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


def source_literal(text: str) -> str:
    """A definition as a string literal that can be read: one line of it a line."""
    return '"""\\\n' + "\n".join(map(_source_line, text.split("\n"))) + '"""'


def _source_line(line: str) -> str:
    stripped = line.rstrip(" ")
    return _escaped(stripped) + "\\x20" * (len(line) - len(stripped))


_LONG = 36


def plain_literal(value: object) -> str:
    """A value of an interface as a Python literal, as `repr` shows it."""
    if isinstance(value, float) and not math.isfinite(value):
        return f'float("{value}")'
    return repr(value)


def literal(value: ParameterValue) -> str:
    """A Python literal; the list of an array's elements, single bytes for a byte_array."""
    match value:
        case str():
            return quoted(value)
        case float() if not math.isfinite(value):
            return f'float("{value}")'
        case bytes():
            return f"[{', '.join(_double_quoted(repr(bytes([byte]))) for byte in value)}]"
        case tuple():
            return f"[{', '.join(map(literal, value))}]"
        case _:
            return repr(value)


def quoted(text: str) -> str:
    """A string literal, in double quotes unless single ones need fewer backslashes."""
    return _double_quoted(repr(text))


def _double_quoted(literal: str) -> str:
    start = literal.index("'") if literal.endswith("'") else -1
    if start < 0:
        return literal
    prefix, body = literal[:start], literal[start + 1 : -1]
    if '"' in body and body.count('"') > body.count("\\'"):
        return literal
    body = body.replace('"', '\\"').replace("\\'", "'")
    return f'{prefix}"{body}"'


def call(function: str, arguments: Iterable[str], indent: int) -> str:
    """A call whose arguments have a line each; the first line is not indented."""
    margin = " " * indent
    return f"{function}(\n" + "".join(f"{margin}    {argument},\n" for argument in arguments) + f"{margin})"


def signature(name: str, parameters: Iterable[str], result: str, *, is_async: bool = False) -> str:
    """The first line of a method, or its first lines where that would be too long; `self` is understood."""
    start = f"{'async ' if is_async else ''}def {name}"
    everything = ["self", *parameters]
    line = f"{start}({', '.join(everything)}) -> {result}:"
    if len(line) + 4 <= LINE_LENGTH:
        return line
    return f"{call(start, everything, indent=4)} -> {result}:"


def are_long(names: Iterable[str]) -> bool:
    """Whether lines with two of these names may be too long; `ruff format` would break them in other ways."""
    return any(len(name) > _LONG for name in names)


def qos_profile(qos: QosProfile, imports: Callable[[str], str]) -> str:
    """The call that makes a profile; what the description leaves open is rclpy's default."""
    return call(imports("QoSProfile"), qos_arguments(qos, imports), indent=0)


def qos_arguments(qos: QosProfile, imports: Callable[[str], str]) -> Iterator[str]:
    """The arguments of a profile; `imports` gets the names that they need."""
    yield f"history={imports('HistoryPolicy')}.{qos.history}"
    if qos.depth:
        yield f"depth={qos.depth}"
    yield f"reliability={imports('ReliabilityPolicy')}.{qos.reliability}"
    if qos.durability:
        yield f"durability={imports('DurabilityPolicy')}.{qos.durability}"
    durations = (("deadline", qos.deadline_ns), ("lifespan", qos.lifespan_ns))
    for name, nanoseconds in durations:
        if nanoseconds:
            yield _duration(name, nanoseconds, imports)
    if qos.liveliness:
        yield f"liveliness={imports('LivelinessPolicy')}.{qos.liveliness}"
    if qos.liveliness_lease_duration_ns:
        yield _duration("liveliness_lease_duration", qos.liveliness_lease_duration_ns, imports)


def _duration(name: str, nanoseconds: int, imports: Callable[[str], str]) -> str:
    return f"{name}={imports('Duration')}(nanoseconds={nanoseconds:_})"
