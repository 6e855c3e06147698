"""Compares what came with what had to come, field by field."""

from __future__ import annotations

from typing import cast


def difference(found: object, expected: object, where: str = "") -> str:
    """The first place where two pieces of plain data differ, in words; empty if they are equal."""
    if found == expected:
        return ""
    if isinstance(found, dict) and isinstance(expected, dict):
        return _of_messages(cast("dict[str, object]", found), cast("dict[str, object]", expected), where)
    if isinstance(found, list) and isinstance(expected, list):
        return _of_lists(cast("list[object]", found), cast("list[object]", expected), where)
    return _at(where, f"got {found!r:.80}, expected {expected!r:.80}")


def _of_messages(found: dict[str, object], expected: dict[str, object], where: str) -> str:
    if found.keys() != expected.keys():
        return _at(where, f"got the fields {', '.join(found)}, expected {', '.join(expected)}")
    name = next(name for name in expected if found[name] != expected[name])
    return difference(found[name], expected[name], f"{where}.{name}" if where else name)


def _of_lists(found: list[object], expected: list[object], where: str) -> str:
    if len(found) != len(expected):
        return _at(where, f"{len(found)} came, expected {len(expected)}")
    number = next(n for n, each in enumerate(expected) if found[n] != each)
    return difference(found[number], expected[number], f"{where}[{number}]")


def _at(where: str, text: str) -> str:
    return f"{where}: {text}" if where else text
