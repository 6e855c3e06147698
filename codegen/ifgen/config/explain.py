"""The mistakes in `[tool.ifgen]`, each with its place."""

from __future__ import annotations

import json
import re
import tomllib
from collections.abc import Iterable, Iterator, Mapping, Sequence
from difflib import get_close_matches
from pathlib import Path
from typing import Any, Final

from ifgen.config import rulebook, toml_places
from ifgen.diagnostics import Diagnostic, Label, Source, Span, UsageError, shown_path
from ifgen.reading.storage import read_limited

_DEEPEST: Final = 100
"""Parts of a dotted key: tomllib takes a time and a memory that are quadratic in their number."""

_WORD: Final = r"""(?:(?<![\w-])[\w-]++|"[^"\n]*+"|'[^'\n]*+')[ \t]*+"""
_LONG_KEY: Final = re.compile(rf"(?:{_WORD}\.[ \t]*+){{{_DEEPEST}}}")


def read_source(path: Path) -> Source:
    """The text of a pyproject.toml. Raises UsageError if it cannot be read."""
    try:
        return Source(path, read_limited(path).decode("utf-8").replace("\r\n", "\n"))
    except UnicodeDecodeError:
        problem = "is not UTF-8"
    except OSError as error:
        problem = f"cannot be read: {error.strerror}"
    raise UsageError([Diagnostic("configuration", f"{path} {problem}")])


def parse(source: Source) -> dict[str, Any]:
    """The document in a pyproject.toml. Raises UsageError if it is no TOML, or nested beyond measure."""
    if found := _LONG_KEY.search(source.text):
        span = Span(source, *found.span())
        raise _beyond_measure(source, f"a key has more than {_DEEPEST} parts", Label(span))
    try:
        return tomllib.loads(source.text)
    except tomllib.TOMLDecodeError as error:
        raise UsageError([_syntax(source, error)]) from None
    except RecursionError:
        raise _beyond_measure(source, "lists or tables are nested too deeply") from None
    except ValueError:
        raise _beyond_measure(source, "a number has thousands of digits") from None


def _beyond_measure(source: Source, what: str, label: Label | None = None) -> UsageError:
    message = f"{shown_path(source.path)} cannot be read: {what}"
    return UsageError([Diagnostic("configuration", message, label)])


def _syntax(source: Source, error: tomllib.TOMLDecodeError) -> Diagnostic:
    """The message of the TOML parser, with its place."""
    # Before Python 3.14 the place stands in the message alone.
    place = re.search(r"\(at line (\d+), column (\d+)\)", str(error))
    message = str(error)[: place.start()].strip() if place else str(error)
    end = len(source.text.rstrip())
    start = _offset(source, int(place[1]), int(place[2])) if place else max(end - 1, 0)
    label = Label(Span(source, start, start + 1), message[:1].lower() + message[1:])
    return Diagnostic("configuration", f"{source.path.name} is not valid TOML", label)


_EXPECTED = {
    "with_deps": 'true, false or "own"',
    "tests": "true or false",
    "paths": 'a list of paths, such as ["interfaces"]',
    "include": 'a list of paths, such as ["interfaces"]',
    "outputs": "a table, whose keys are names for outputs",
    "template": "the name of a template in quotes",
    "path": 'a pattern in quotes, such as "{package}/{interface:snake}.md"',
    "ignore": 'a list of rules, such as ["keyword-name"]',
    "per_file_ignores": 'a table of lists of rules, such as {"vendor/*" = ["keyword-name"]}',
    "strict": "true or false",
    "distributions": 'a name with {package} in it, such as "acme-{package}"',
    "requirements": 'a table of what pip installs, such as {nav2_msgs = "acme-nav2-msgs>=1.2"}',
    "only": 'a list of patterns, such as ["demo_msgs", "*/srv/*"]',
    "exclude": 'a list of packages or patterns, such as ["demo_msgs", "*/srv/*"]',
}


def diagnostic(
    source: Source, error: dict[str, Any], known: Iterable[str], known_of_outputs: Iterable[str]
) -> Diagnostic:
    """A mistake in one key that pydantic found; `known` are the keys of [tool.ifgen], then of an output."""
    location = tuple(map(str, error["loc"]))
    if location[:1] == ("outputs",) and len(location) > 1:
        table, keys = location[:2], location[2:3]
        known = known_of_outputs
    else:
        table, keys = (), location[:1]
    shown = ".".join(("tool.ifgen", *table))
    found = find_key(source, (*table, *keys))
    if not keys:
        label = Label(found, f"found {_toml_type(error['input'])}")
        return Diagnostic("configuration", f"{shown} must be a table", label)
    key = keys[0]
    match error["type"]:
        case "extra_forbidden":
            known = list(known)
            close = get_close_matches(key, known, n=1)
            hint = f"did you mean '{close[0]}'?" if close else f"the keys are {', '.join(known)}"
            return Diagnostic(
                "configuration", f"[{shown}] has no key '{key}'", Label(found, "unknown key"), help=hint
            )
        case "missing":
            label = Label(found, f"'{key}' is missing")
            return Diagnostic("configuration", f"[{shown}] needs {_article(key)} '{key}'", label)
        case "value_error" if "\0" in str(error["input"]):
            expected = "a path without NUL"
        case "literal_error":
            expected = str(error["ctx"]["expected"]).replace("'", '"')
        case _:
            expected = _EXPECTED.get(key, "a path in quotes")
    label = Label(found, f"found {_toml_type(error['input'])}")
    return Diagnostic("configuration", f"'{key}' in [{shown}] must be {expected}", label)


def unknown_rules(
    source: Source, ignored: Iterable[str], per_file: Mapping[str, Iterable[str]]
) -> Iterator[Diagnostic]:
    """The mistakes in the rules to ignore."""
    lists = [(("ignore",), ignored), *((("per_file_ignores", pattern), r) for pattern, r in per_file.items())]
    for path, rules in lists:
        for rule in rules:
            if why_not := rulebook.why_not_ignored(rule):
                label = Label(_element(source, find_key(source, path), rule), f"in '{path[0]}'")
                yield Diagnostic("configuration", why_not[0], label, help=why_not[1])


def _element(source: Source, key: Span, text: str) -> Span:
    """The place of a text within the value of a key, or the key if the text is not there as it is."""
    found = re.compile(rf"""["']{re.escape(text)}["']""").search(source.text, key.end)
    return Span(source, *found.span()) if found else key


def _article(key: str) -> str:
    return "an" if key[:1] in "aeiou" else "a"


def _toml_type(value: object) -> str:
    match value:
        case bool():
            return "true" if value else "false"
        case str():
            return json.dumps(value, ensure_ascii=False)
        case int() | float():
            return str(value)
        case list():
            return "a list"
        case _:
            return "a table"


def find_key(source: Source, path: Sequence[str]) -> Span:
    """The place of a key below [tool.ifgen], or of the innermost table around it."""
    known = toml_places.places(source.text)
    keys = ("tool", "ifgen", *path)
    while keys and keys not in known:
        keys = keys[:-1]
    return Span(source, *known.get(keys, (0, 0)))


def _offset(source: Source, line: int, column: int) -> int:
    lines = source.text.split("\n")
    return sum(len(text) + 1 for text in lines[: line - 1]) + column - 1
