"""Keys of tables that people write: which values a key may have, and what they become."""

from __future__ import annotations

import json
import re
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import field, fields
from pathlib import Path
from typing import Any, Final, NamedTuple, cast

from ifgen.diagnostics import did_you_mean

_KIND: Final = "kind"
_DEFAULT: Final = "default"


class Kind:
    """A kind of value; `expected` says what to write.

    `wrong` finds the parts of a value that are of another kind. `read` makes the value of a setting from a
    right one; paths are relative to a folder. In a table of tables, those have the keys of the class `inner`.
    """

    def __init__(
        self,
        expected: str,
        wrong: Callable[[Any], Sequence[object]],
        read: Callable[[Any, Path], Any] = lambda value, _: value,
        inner: type | None = None,
    ) -> None:
        self.expected, self.wrong, self.read, self.inner = expected, wrong, read, inner


class Mistake(NamedTuple):
    """A mistake in a table: the path of the key below that table, and what is wrong there.

    `word` is the part of its value that is meant, if there is one.
    """

    path: tuple[str, ...]
    message: str
    label: str
    help: str | None = None
    word: str | None = None


def required(kind: Kind) -> Any:
    """A key that a table must have, as a field of a dataclass."""
    return field(metadata={_KIND: kind})


def key(kind: Kind, default: Any = None) -> Any:
    """A key, as a field of a dataclass. The default is as people would write it; None stands for no value."""

    def value() -> Any:
        return None if default is None else kind.read(default, Path())

    return field(default_factory=value, metadata={_KIND: kind, _DEFAULT: default})


def read(cls: type, table: Mapping[str, Any], base: Path) -> dict[str, Any]:
    """The values of those fields of a class that are keys, from a table without mistakes."""
    values: dict[str, Any] = {}
    for name, metadata in _keys_of(cls).items():
        value = table.get(name, metadata.get(_DEFAULT))
        values[name] = None if value is None else metadata[_KIND].read(value, base)
    return values


def mistakes(cls: type, table: object, shown: str, path: tuple[str, ...] = ()) -> Iterator[Mistake]:
    """The mistakes in a table with the keys of a class; people know it as `shown`."""
    if not isinstance(table, dict):
        yield Mistake(path, f"{shown} must be a table", f"found {_shown(table)}")
        return
    values, keys = cast("dict[str, Any]", table), _keys_of(cls)
    for name, metadata in keys.items():
        if name in values:
            yield from _mistakes_in_value(metadata[_KIND], values[name], shown, (*path, name))
        elif _DEFAULT not in metadata:
            article = "an" if name[0] in "aeiou" else "a"
            yield Mistake((*path, name), f"[{shown}] needs {article} '{name}'", f"'{name}' is missing")
    for name in (name for name in values if name not in keys):
        advice = did_you_mean(name, keys) or f"the keys are {', '.join(keys)}"
        yield Mistake((*path, name), f"[{shown}] has no key '{name}'", "unknown key", advice)


def _mistakes_in_value(kind: Kind, value: Any, shown: str, path: tuple[str, ...]) -> Iterator[Mistake]:
    name = path[-1]
    for wrong in kind.wrong(value):
        expected = "a path without NUL" if "\0" in str(wrong) else kind.expected
        yield Mistake(path, f"'{name}' in [{shown}] must be {expected}", f"found {_shown(wrong)}")
    if kind.inner is not None and not kind.wrong(value):
        for inner, table in value.items():
            yield from mistakes(kind.inner, table, f"{shown}.{name}.{inner}", (*path, inner))


def _keys_of(cls: type) -> dict[str, Mapping[str, Any]]:
    return {field.name: field.metadata for field in fields(cls) if _KIND in field.metadata}


def _shown(value: object) -> str:
    match value:
        case bool():
            return "true" if value else "false"
        case str():
            return json.dumps(value, ensure_ascii=False)
        case list():
            return "a list"
        case dict():
            return "a table"
        case _:
            return str(value)


def _unless(fits: Callable[[Any], object]) -> Callable[[Any], Sequence[object]]:
    return lambda value: () if fits(value) else (value,)


def _is_path(value: object) -> bool:
    return isinstance(value, str) and "\0" not in value


def text(expected: str, pattern: str = "(?s:.*)") -> Kind:
    """A text that a pattern matches, from its beginning to its end."""
    return Kind(expected, _unless(lambda value: isinstance(value, str) and re.fullmatch(pattern, value)))


def one_of(*choices: str) -> Kind:
    """One of some words."""
    *others, last = (f'"{choice}"' for choice in choices)
    return Kind(f"{', '.join(others)} or {last}", _unless(lambda value: value in choices))


def list_of(kind: Kind, expected: str, collection: Callable[[Iterable[Any]], Any] = tuple) -> Kind:
    """A list whose elements are of a kind."""

    def wrong(value: Any) -> Sequence[object]:
        return _wrong(kind, cast("Iterable[Any]", value)) if isinstance(value, list) else [value]

    return Kind(expected, wrong, lambda values, base: collection(kind.read(value, base) for value in values))


def table_of(kind: Kind, expected: str) -> Kind:
    """A table whose values are of a kind."""

    def wrong(value: Any) -> Sequence[object]:
        return _wrong(kind, cast("dict[str, Any]", value).values()) if isinstance(value, dict) else [value]

    return Kind(expected, wrong, lambda table, base: {name: kind.read(v, base) for name, v in table.items()})


def _wrong(kind: Kind, values: Iterable[Any]) -> list[object]:
    return [wrong for value in values for wrong in kind.wrong(value)]


FLAG: Final = Kind("true or false", _unless(lambda value: isinstance(value, bool)))
PATH: Final = Kind("a path in quotes", _unless(_is_path), lambda value, base: base / value)
PATHS: Final = list_of(PATH, 'a list of paths, such as ["interfaces"]')


def _located(value: str, base: Path) -> Path:
    """The path of a setting: below a folder, or `package:NAME/path` in a package that is installed."""
    if not value.startswith("package:"):
        return base / value
    from importlib.util import find_spec  # of use to few

    name, _, rest = value.removeprefix("package:").partition("/")
    try:
        spec = find_spec(name)
    except (ImportError, ValueError):
        spec = None
    if spec is None or not spec.submodule_search_locations:
        return Path(value)  # which does not exist
    return Path(spec.submodule_search_locations[0]) / rest


CODE: Final = Kind('a path in quotes, or "package:NAME/folder"', PATH.wrong, _located)
