"""Parses what templates and generators write, where that can be done, and finds the line to blame."""

from __future__ import annotations

import json
import re
import tomllib
import warnings
from collections.abc import Iterable, Iterator, Mapping
from pathlib import PurePosixPath
from typing import Final, NamedTuple

import jinja2
from jinja2.ext import Extension
from jinja2.lexer import Token, TokenStream

from ifgen.diagnostics import Diagnostic, shorten

_MARK: Final = re.compile("\ue000([^\ue001]*)\ue001([0-9]+)\ue002")


class Broken(NamedTuple):
    """A text that its own language refuses: the line, counted from 1, and why."""

    line: int
    reason: str


class TemplateLine(NamedTuple):
    """The name of a template, and a line in it."""

    template: str
    line: int


def broken(path: str, text: str) -> Broken | None:
    """The first mistake in the text of a .py, .json, .yaml or .toml file; None if it is right, or another."""
    match PurePosixPath(path).suffix:
        case ".py" | ".pyi":
            return _python(text)
        case ".json":
            return _json(text)
        case ".yaml" | ".yml":
            return _yaml(text)
        case ".toml":
            return _toml(text)
        case _:
            return None


def wrong_text(path: str, text: str, who: str) -> Diagnostic | None:
    """The mistake in the text of a file that somebody made; None if there is none, or nobody can tell."""
    try:
        text.encode()
    except UnicodeEncodeError as error:
        return Diagnostic("broken-output", f"{who} makes a broken file: {path}: {text[error.start]!r} in it")
    found = broken(path, text)
    if found is None:
        return None
    lines = text.splitlines()
    shown = lines[found.line - 1].strip() if 0 < found.line <= len(lines) else ""
    message = f"{who} makes a broken file: {path}:{found.line}: {found.reason}"
    return Diagnostic("broken-output", message, help=f"the line is `{shorten(shown)}`" if shown else None)


def _python(text: str) -> Broken | None:
    try:
        with warnings.catch_warnings(action="ignore"):
            compile(text, "output", "exec", dont_inherit=True)
    except SyntaxError as error:
        return Broken(error.lineno or 1, error.msg)
    except ValueError as error:  # a NUL
        return Broken(1, str(error))
    return None


def _json(text: str) -> Broken | None:
    try:
        json.loads(text)
    except json.JSONDecodeError as error:
        return Broken(error.lineno, error.msg)
    except RecursionError:
        return Broken(1, "it is nested too deeply")
    return None


def _toml(text: str) -> Broken | None:
    try:
        tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        place = re.search(r" \(at line (\d+), column \d+\)", str(error))
        line = int(place[1]) if place else text.count("\n") + 1
        return Broken(line, str(error).partition(" (at")[0])
    return None


def _yaml(text: str) -> Broken | None:
    import yaml  # a parser that few outputs need

    try:
        for _ in yaml.parse(text, Loader=yaml.CSafeLoader if yaml.__with_libyaml__ else yaml.SafeLoader):
            pass
    except yaml.MarkedYAMLError as error:
        mark = error.problem_mark
        return Broken(mark.line + 1 if mark else 1, str(error.problem or error.context))
    except yaml.YAMLError as error:
        return Broken(1, " ".join(str(error).split()))
    return None


class _Marks(Extension):
    """Puts a mark with the template and the line before each line of text in a template."""

    def filter_stream(self, stream: TokenStream) -> TokenStream | Iterable[Token]:
        return TokenStream(self._marked(stream), stream.name, stream.filename)

    @staticmethod
    def _marked(stream: TokenStream) -> Iterator[Token]:
        for token in stream:
            if token.type == "data":
                lines = token.value.splitlines(keepends=True)
                marked = (
                    f"\ue000{stream.name}\ue001{token.lineno + i}\ue002{line}" for i, line in enumerate(lines)
                )
                yield Token(token.lineno, token.type, "".join(marked))
            else:
                yield token


def template_line(
    environment: jinja2.Environment, template: str, variables: Mapping[str, object], text: str, line: int
) -> TemplateLine | None:
    """The line of a template that a line of its text comes from; None if that cannot be told."""
    marking = environment.overlay(extensions=[_Marks], cache_size=0)
    marking.bytecode_cache = None
    try:
        marked = marking.get_template(template).render(variables)
    except Exception:  # a filter that does not like the marks
        return None
    if _MARK.sub("", marked) != text:
        return None
    found: TemplateLine | None = None
    current = 1
    for part in re.split("(\ue000[^\ue002]*\ue002)", marked):
        if mark := _MARK.fullmatch(part):
            found = TemplateLine(mark[1], int(mark[2])) if current <= line else found
        else:
            current += part.count("\n")
    return found
