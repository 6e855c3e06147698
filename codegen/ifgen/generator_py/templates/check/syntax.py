"""Templates as syntax trees whose nodes know their column: `lineno` of a node is its offset in the source.

jinja2 keeps only lines. Its parser copies the line of a token to a node and never looks at it, so tokens with
an offset in place of the line lead to nodes with an offset.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import TypeAlias

import jinja2
from jinja2 import nodes
from jinja2.lexer import Lexer, newline_re
from jinja2.parser import Parser

from ifgen.diagnostics import Diagnostic, InputError, Label, Source, Span
from ifgen.reading.storage import read_limited

_UNCLOSED = "The innermost block that needs to be closed is"  # so jinja2 ends what it says of these
_WORD = re.compile(r"\w+")


@dataclass(frozen=True, eq=False)
class Template:
    """A parsed template: its name for `{% include %}`, its text, and its tree."""

    name: str
    source: Source
    tree: nodes.Template

    def span(self, node: nodes.Node, word: str = "") -> Span:
        """The place where a node starts, or where this word is in it."""
        text = self.source.text
        start = min(node.lineno, max(len(text) - 1, 0))
        found = text.find(word, start) if word else start
        if found < 0 or found - start > 200:
            return Span(self.source, start, min(start + 1, len(text)))
        return Span(self.source, found, min(found + max(len(word), 1), len(text)))


Block: TypeAlias = tuple[Template, nodes.Block]


def refusal(template: Template, environment: jinja2.Environment) -> Diagnostic | None:
    """The errors of jinja2 in compiling a template that it could parse, such as two blocks of one name."""
    try:
        environment.compile(template.source.text, template.name, str(template.source.path))
    except jinja2.TemplateSyntaxError as error:
        return _refused(template.source, _line_span(template.source, error.lineno), error)
    return None


class _OffsetLexer(Lexer):
    def tokeniter(
        self, source: str, name: str | None, filename: str | None = None, state: str | None = None
    ) -> Iterator[tuple[int, str, str]]:
        offset = 0
        for _, token, text in super().tokeniter(source, name, filename, state):
            # Only white space may have been left out before a token.
            while not source.startswith(text, offset) and source[offset : offset + 1].isspace():
                offset += 1
            yield offset, token, text
            offset += len(text)


def parse(name: str, path: Path, environment: jinja2.Environment) -> Template:
    """Parse a template. Raises InputError if it is not UTF-8, or not what jinja2 understands."""
    try:
        text = read_limited(path).decode("utf-8")
    except UnicodeDecodeError:
        raise InputError([Diagnostic("template-syntax", f"the template {path} is not UTF-8")]) from None
    except OSError as error:
        message = f"the template {path} cannot be read: {error.strerror}"
        raise InputError([Diagnostic("template-syntax", message)]) from None
    return parse_text(name, Source(path, text), environment)


def parse_text(name: str, source: Source, environment: jinja2.Environment) -> Template:
    """Parse the text of a template, whose line ends become line feeds."""
    source = Source(source.path, "\n".join(newline_re.split(source.text)[::2]))
    try:
        list(environment.lexer.tokeniter(source.text, name))  # an error of the lexer has a line
    except jinja2.TemplateSyntaxError as error:
        raise InputError([_refused(source, _line_span(source, error.lineno), error)]) from None
    parser = _Parser(_offset_environment(), source.text, name)
    try:
        return Template(name, source, parser.parse())
    except jinja2.TemplateSyntaxError as error:
        if _UNCLOSED in str(error.message):
            raise InputError([_unclosed(source, parser.begun, error)]) from None
        start = min(error.lineno, max(len(source.text.rstrip()) - 1, 0))
        span = Span(source, start, min(start + 1, len(source.text)))
        raise InputError([_refused(source, span, error)]) from None
    except RecursionError:
        message = "this template is nested too deeply"
        raise InputError([Diagnostic("template-syntax", message, Label(Span(source, 0, 0)))]) from None


class _Parser(Parser):
    """Knows which statements were not at their end when it failed: where they start, the innermost first."""

    def __init__(self, environment: jinja2.Environment, source: str, name: str) -> None:
        super().__init__(environment, source, name)
        self.begun: list[int] = []

    def parse_statement(self) -> nodes.Node | list[nodes.Node]:
        start = self.stream.current.lineno
        try:
            return super().parse_statement()
        except jinja2.TemplateSyntaxError:
            self.begun.append(start)
            raise


class _OffsetEnvironment(jinja2.Environment):
    @property
    def lexer(self) -> _OffsetLexer:
        return _offset_lexer()


@cache
def _offset_lexer() -> _OffsetLexer:
    return _OffsetLexer(jinja2.Environment(keep_trailing_newline=True))


@cache
def _offset_environment() -> jinja2.Environment:
    return _OffsetEnvironment()


def _line_span(source: Source, line: int) -> Span:
    start = sum(len(text) + 1 for text in source.text.split("\n")[: line - 1])
    return Span(source, start, start + len(source.text[start:].partition("\n")[0]))


def _unclosed(source: Source, begun: Sequence[int], error: jinja2.TemplateSyntaxError) -> Diagnostic:
    """Say which statement has no end, or another's."""
    is_at_end = not source.text[error.lineno :].strip() or error.lineno not in begun
    opening = next(start for start in begun if is_at_end or start != error.lineno)
    word = _WORD.match(source.text, opening)
    tag = word[0] if word else ""
    place = Span(source, opening, opening + len(tag))
    message, help = "jinja2 cannot parse this template", f"write {{% end{tag} %}} where it ends"
    if is_at_end:
        return Diagnostic("template-syntax", message, Label(place, f"this `{tag}` has no end"), help=help)
    other = _WORD.match(source.text, error.lineno)
    found = Label(Span(source, error.lineno, other.end() if other else error.lineno + 1), "found this first")
    return Diagnostic("template-syntax", message, found, (Label(place, f"this `{tag}` has no end"),), help)


def _refused(source: Source, span: Span, error: jinja2.TemplateSyntaxError) -> Diagnostic:
    message = str(error.message).rstrip(".")
    label = Label(span, message[:1].lower() + message[1:])
    return Diagnostic("template-syntax", "jinja2 cannot parse this template", label)


def definitions(chain: Sequence[Template]) -> dict[str, list[Block]]:
    """The definitions of each block, the one that counts first; a template comes before what it extends."""
    found: dict[str, list[Block]] = {}
    for template in chain:
        for block in template.tree.find_all(nodes.Block):
            found.setdefault(str(block.name), []).append((template, block))
    return found


def idle_blocks(chain: Sequence[Template]) -> Iterator[tuple[Template, nodes.Block, set[str]]]:
    """Blocks that nothing renders, since no template above has their name, with the names that there are."""
    *below, root = chain
    above = {str(block.name) for block in root.tree.find_all(nodes.Block)}
    for template in reversed(below):
        inner = {
            str(b.name) for block in template.tree.find_all(nodes.Block) for b in block.find_all(nodes.Block)
        }
        for block in template.tree.find_all(nodes.Block):
            if block.name not in above | inner:
                yield template, block, above
        above |= {str(block.name) for block in template.tree.find_all(nodes.Block)}
