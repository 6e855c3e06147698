"""`[tool.ifgen]` in pyproject.toml, the only configuration: what it may say, and what is wrong with it."""

from __future__ import annotations

import re
import tomllib
from difflib import get_close_matches
from pathlib import Path
from typing import Any, cast

from pydantic import BaseModel, ConfigDict, Field, ValidationError

from ifgen.diagnostics import Diagnostic, Label, Source, Span, UsageError


class Config(BaseModel):
    """What `[tool.ifgen]` may say; paths are relative to its file, and absolute once read.

    An option on the command line wins over its key here.
    """

    model_config = ConfigDict(extra="forbid", frozen=True)

    paths: tuple[Path, ...] = Field(default=(), description="what to generate: PATH...")
    output: Path = Field(default=Path("generated"), description="where to: -o")
    include: tuple[Path, ...] = Field(default=(), description="where dependencies are: -I")
    with_deps: bool = Field(
        default=False, strict=True, description="generate the dependencies too: --with-deps"
    )
    templates: Path | None = Field(default=None, description="your templates: --templates")


def read(path: Path) -> Config | None:
    """The configuration in a pyproject.toml; None if it has no `[tool.ifgen]`. Raises UsageError."""
    source = _read_source(path)
    try:
        document = tomllib.loads(source.text)
    except tomllib.TOMLDecodeError as error:
        raise UsageError([_syntax_diagnostic(source, error)]) from None
    tool = document.get("tool")
    table: object = cast("dict[str, object]", tool).get("ifgen") if isinstance(tool, dict) else None
    if table is None:
        return None
    try:
        config = Config.model_validate(table)
    except ValidationError as error:
        raise UsageError(_diagnostic(source, dict(e)) for e in error.errors()) from None
    base = path.parent
    return config.model_copy(
        update={
            "paths": tuple(base / p for p in config.paths),
            "output": base / config.output,
            "include": tuple(base / p for p in config.include),
            "templates": None if config.templates is None else base / config.templates,
        }
    )


def existing(paths: tuple[Path, ...], key: str, path: Path) -> tuple[Path, ...]:
    """The paths that a key of the pyproject.toml at `path` names. Raises UsageError if one does not exist."""
    source = _read_source(path)
    missing = [p for p in paths if not p.exists()]
    if missing:
        label = Label(_find_key(source, key))
        raise UsageError(
            Diagnostic("configuration", f"'{key}' in [tool.ifgen] names {p}, which does not exist", label)
            for p in missing
        )
    return paths


def _read_source(path: Path) -> Source:
    try:
        return Source(path, path.read_text(encoding="utf-8"))
    except UnicodeDecodeError:
        problem = "is not UTF-8"
    except OSError as error:
        problem = f"cannot be read: {error.strerror}"
    raise UsageError([Diagnostic("configuration", f"{path} {problem}")])


def _syntax_diagnostic(source: Source, error: tomllib.TOMLDecodeError) -> Diagnostic:
    # Before Python 3.14 the place stands in the message alone.
    place = re.search(r"\(at line (\d+), column (\d+)\)", str(error))
    message = str(error)[: place.start()].strip() if place else str(error)
    end = len(source.text.rstrip())
    start = _offset(source, int(place[1]), int(place[2])) if place else max(end - 1, 0)
    label = Label(Span(source, start, start + 1), message[:1].lower() + message[1:])
    return Diagnostic("configuration", f"{source.path.name} is not valid TOML", label)


def _diagnostic(source: Source, error: dict[str, Any]) -> Diagnostic:
    key = str(error["loc"][0]) if error["loc"] else ""
    known = Config.model_fields
    if error["type"] == "extra_forbidden":
        close = get_close_matches(key, known, n=1)
        hint = f"did you mean '{close[0]}'?" if close else f"the keys are {', '.join(known)}"
        return Diagnostic(
            "configuration",
            f"[tool.ifgen] has no key '{key}'",
            Label(_find_key(source, key), "unknown key"),
            help=hint,
        )
    if not key:
        label = Label(_find_key(source, "ifgen"), f"found {_toml_type(error['input'])}")
        return Diagnostic("configuration", "tool.ifgen must be a table", label)
    expected = "true or false" if key == "with_deps" else "a path in quotes"
    if key in {"paths", "include"}:
        expected = 'a list of paths, such as ["interfaces"]'
    label = Label(_find_key(source, key), f"found {_toml_type(error['input'])}")
    return Diagnostic("configuration", f"'{key}' in [tool.ifgen] must be {expected}", label)


def _toml_type(value: object) -> str:
    match value:
        case bool():
            return "true" if value else "false"
        case str():
            return f'"{value}"'
        case int() | float():
            return str(value)
        case list():
            return "a list"
        case _:
            return "a table"


def _find_key(source: Source, key: str) -> Span:
    """Where a key of [tool.ifgen] stands: tomllib keeps no places, so the text is searched for it."""
    header = re.search(r"^[ \t]*\[[ \t]*tool[ \t]*\.[ \t]*ifgen[ \t]*\]", source.text, re.MULTILINE)
    quoted = rf"""["']?{re.escape(key)}["']?"""
    if header:
        table = re.compile(rf"^[ \t]*({quoted})[ \t]*[.=]", re.MULTILINE)
        following = re.compile(r"^[ \t]*\[", re.MULTILINE).search(source.text, header.end())
        found = table.search(source.text, header.end(), following.start() if following else len(source.text))
        found = found or re.search(rf"^[ \t]*\[+[ \t]*tool\.ifgen\.({quoted})", source.text, re.MULTILINE)
    else:
        found = re.search(rf"\bifgen\b.*?({quoted})[ \t]*[.=]", source.text) or re.search(
            f"({quoted})", source.text
        )
    if found:
        return Span(source, found.start(1), found.end(1))
    return Span(source, header.start(), header.end()) if header else Span(source, 0, 0)


def _offset(source: Source, line: int, column: int) -> int:
    lines = source.text.split("\n")
    return sum(len(text) + 1 for text in lines[: line - 1]) + column - 1
