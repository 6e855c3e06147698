"""`list()` and `string()`: each yields the variables that it sets."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Sequence
from typing import Final

from ifgen.reading.cmake.patterns import Unsure
from ifgen.reading.cmake.values import elements, joined

Lookup = Callable[[str], str]
Regex = Callable[[str, Sequence[str]], re.Pattern[str]]
Change = tuple[str, str]

_REFERENCE: Final = re.compile(r"\\(\d)")


def list_command(words: Sequence[str], lookup: Lookup, regex: Regex) -> Iterator[Change]:
    """The variables that `list(WORDS)` sets.

    Raises Unsure for unknown forms, also after the first variable.
    """
    action, name, *rest = words if len(words) > 1 else ("", "")
    items = elements(lookup(name), keep_empty=True)
    match action, rest:
        case "APPEND", _:
            yield name, joined([*items, *rest])
        case "PREPEND", _:
            yield name, joined([*rest, *items])
        case "INSERT", [at, *new]:
            index = _index(at, len(items) + 1)
            yield name, joined([*items[:index], *new, *items[index:]])
        case "REMOVE_ITEM", _:
            yield name, joined(item for item in items if item not in rest)
        case "REMOVE_AT", _:
            gone = {_index(at, len(items)) for at in rest}
            yield name, joined(item for at, item in enumerate(items) if at not in gone)
        case "REMOVE_DUPLICATES", _:
            yield name, joined(dict.fromkeys(items))
        case "SORT", _:  # how does not matter: which interfaces there are is not a question of order
            yield name, joined(sorted(items))
        case "REVERSE", _:
            yield name, joined(reversed(items))
        case "FILTER", [("INCLUDE" | "EXCLUDE") as how, "REGEX", pattern]:
            compiled = regex(pattern, items)
            wanted = how == "INCLUDE"
            yield name, joined(item for item in items if bool(compiled.search(item)) == wanted)
        case "TRANSFORM", [_, *_]:
            yield from _transformed(name, items, rest, regex)
        case "LENGTH", [out]:
            yield out, str(len(items))
        case "GET", [*at, out]:
            yield out, joined(items[_index(one, len(items))] for one in at)
        case "JOIN", [glue, out]:
            yield out, glue.join(items)
        case "SUBLIST", [begin, length, out]:
            first = _index(begin, len(items) + 1)
            count = _number(length)
            yield out, joined(items[first:] if count < 0 else items[first : first + count])
        case "FIND", [value, out]:
            yield out, str(items.index(value) if value in items else -1)
        case (("POP_BACK" | "POP_FRONT"), []):
            yield name, joined(items[:-1] if action == "POP_BACK" else items[1:])
        case _:
            raise Unsure


def _transformed(name: str, items: Sequence[str], rest: Sequence[str], regex: Regex) -> Iterator[Change]:
    out = name
    if len(rest) > 2 and rest[-2] == "OUTPUT_VARIABLE":
        *rest, _, out = rest
    match rest:
        case ["APPEND", text]:
            yield out, joined(item + text for item in items)
        case ["PREPEND", text]:
            yield out, joined(text + item for item in items)
        case ["TOLOWER"]:
            yield out, joined(item.lower() for item in items)
        case ["TOUPPER"]:
            yield out, joined(item.upper() for item in items)
        case ["STRIP"]:
            yield out, joined(item.strip() for item in items)
        case ["REPLACE", pattern, replacement]:
            yield out, joined(_replaced(regex(pattern, items), replacement, item) for item in items)
        case _:
            raise Unsure


def string_command(words: Sequence[str], lookup: Lookup, regex: Regex) -> Iterator[Change]:
    """The variables that `string(WORDS)` sets. Raises Unsure for unknown forms."""
    match list(words):
        case ["REPLACE", old, new, out, *texts]:
            text = "".join(texts)
            yield out, text.replace(old, new) if old else text
        case ["REGEX", "REPLACE", pattern, replacement, out, *texts]:
            text = "".join(texts)
            yield out, _replaced(regex(pattern, [text]), replacement, text)
        case ["REGEX", "MATCH", pattern, out, *texts]:
            text = "".join(texts)
            match = regex(pattern, [text]).search(text)
            yield out, match[0] if match else ""
        case ["REGEX", "MATCHALL", pattern, out, *texts]:
            text = "".join(texts)
            yield out, joined(match[0] for match in regex(pattern, [text]).finditer(text))
        case ["APPEND", name, *texts]:
            yield name, lookup(name) + "".join(texts)
        case ["PREPEND", name, *texts]:
            yield name, "".join(texts) + lookup(name)
        case ["CONCAT", out, *texts]:
            yield out, "".join(texts)
        case ["JOIN", glue, out, *texts]:
            yield out, glue.join(texts)
        case ["TOLOWER", text, out]:
            yield out, text.lower()
        case ["TOUPPER", text, out]:
            yield out, text.upper()
        case ["STRIP", text, out]:
            yield out, text.strip()
        case ["LENGTH", text, out]:
            yield out, str(len(text.encode()))
        case ["FIND", text, part, out]:
            yield out, str(text.find(part))
        case ["SUBSTRING", text, begin, length, out]:
            first, count = _number(begin), _number(length)
            yield out, text[first:] if count < 0 else text[first : first + count]
        case _:
            raise Unsure


def _replaced(pattern: re.Pattern[str], replacement: str, text: str) -> str:
    def filled(match: re.Match[str]) -> str:
        def group(reference: re.Match[str]) -> str:
            number = int(reference[1])
            return (match[number] or "") if number <= pattern.groups else ""

        return _REFERENCE.sub(group, replacement)

    return pattern.sub(filled, text)


def _index(text: str, size: int) -> int:
    number = _number(text)
    if not -size <= number < size:
        raise Unsure
    return number % size


def _number(text: str) -> int:
    if not re.fullmatch(r"-?[0-9]{1,9}", text):
        raise Unsure
    return int(text)
