"""Python text as `ruff format` leaves it: literals, calls, signatures and QoS profiles."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator

from ifgen.generator_py.imports import LINE_LENGTH
from ifgen.nodl.model import ParameterValue, QosProfile

_LONG = 36


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
