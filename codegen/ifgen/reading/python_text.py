"""The Python that users write, as a tree with places: it is read, never run."""

from __future__ import annotations

import ast
from pathlib import Path

from ifgen.diagnostics import Diagnostic, InputError, Label, Source, Span
from ifgen.reading.storage import read_source


def parse(path: Path) -> tuple[Source, ast.Module]:
    """The text of a module and its tree. Raises InputError if it cannot be read, or is not Python."""
    source = read_source(path)
    try:
        return source, ast.parse(source.text)
    except SyntaxError as error:
        start = _offset(source, error.lineno or 1) + max(error.offset or 1, 1) - 1
        start = min(start, len(source.text))
        raise InputError([_not_python(Span(source, start, start + 1), error.msg)]) from None
    except ValueError:  # of a null byte, before CPython 3.12
        start = source.text.find("\0")
        raise InputError([_not_python(Span(source, start, start + 1), "a null byte")]) from None
    except (RecursionError, MemoryError):
        raise InputError([_not_python(Span(source, 0, 0), "it is nested too deeply")]) from None


def span_of(node: ast.stmt | ast.expr, source: Source) -> Span:
    """The place of a node of a syntax tree in the text."""
    end = node.end_lineno or node.lineno, node.end_col_offset or node.col_offset
    return Span(source, _of_bytes(source, node.lineno, node.col_offset), _of_bytes(source, *end))


def _of_bytes(source: Source, line: int, column: int) -> int:
    """The offset of a column, which syntax trees count in bytes."""
    start = _offset(source, line)
    text = source.text[start:].partition("\n")[0]
    return start + len(text.encode()[:column].decode(errors="ignore"))


def _offset(source: Source, line: int) -> int:
    """The offset of a line as Python counts them: by line feeds only."""
    return sum(len(text) + 1 for text in source.text.split("\n")[: line - 1])


def _not_python(span: Span, why: str) -> Diagnostic:
    return Diagnostic(
        "user-module",
        f"{span.source.path.name} is not Python, so its node cannot start",
        Label(span, why[:1].lower() + why[1:]),
        help="fix this first: other mistakes in the file cannot be found until then",
    )
