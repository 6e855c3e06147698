"""Explanations of what is no YAML, no JSON, or goes beyond the limits of a document."""

from __future__ import annotations

from collections.abc import Iterable

from ifgen.definition.explain import did_you_mean
from ifgen.diagnostics import Diagnostic, Label, Span, shorten
from ifgen.nodl.syntax.tree import (
    MAX_CHARACTERS,
    MAX_DEPTH,
    MAX_VALUES,
    Key,
    Node,
    ScalarNode,
    shown,
    source_text,
)


def syntax(language: str, message: str, span: Span, context: Label | None = None) -> Diagnostic:
    """Say that a text is no YAML or no JSON."""
    return Diagnostic(
        f"{language.lower()}-syntax",
        f"this is not {language}: {shorten(message, 120)}",
        Label(span, "here"),
        (context,) if context else (),
    )


def tab(span: Span) -> Diagnostic:
    """Say that YAML does not take tabs."""
    return Diagnostic(
        "yaml-syntax",
        "YAML is indented with spaces only",
        Label(span, "a tab"),
        help="replace tabs by spaces",
    )


def no_yaml_character(span: Span, code: int) -> Diagnostic:
    """Say that a character must not stand in YAML."""
    message = f"the character U+{code:04X} must not stand in YAML"
    return Diagnostic(
        "yaml-syntax", message, Label(span), help='in double quotes write it as "\\x.." or "\\u...."'
    )


def second_document(span: Span) -> Diagnostic:
    """Say that a file holds more than one document."""
    return Diagnostic(
        "several-documents",
        "a file describes one node, but this one has a second document",
        Label(span, "it starts here"),
        help="put each node into its own file, NODE.nodl.yaml",
    )


def too_deep(span: Span) -> Diagnostic:
    """Say that lists and maps lie too deep inside each other."""
    message = f"lists and maps are nested more than {MAX_DEPTH} deep"
    return Diagnostic("too-large", message, Label(span), help="NoDL itself needs six")


def too_large(span: Span) -> Diagnostic:
    """Say that a document has too many values."""
    return Diagnostic(
        "too-large",
        f"the document has more than {MAX_VALUES} values, counting aliased values at each use",
        Label(span),
    )


def too_long(span: Span) -> Diagnostic:
    """Say that a document has too many characters."""
    return Diagnostic("too-large", f"the document has more than {MAX_CHARACTERS} characters", Label(span))


def unknown_anchor(name: str, known: Iterable[str], span: Span) -> Diagnostic:
    """Say that an alias has no anchor."""
    hint = did_you_mean(name, known) or f"write `&{shorten(name)}` before the value that it stands for"
    return Diagnostic(
        "unknown-anchor", f"there is no anchor `&{shorten(name)}` above", Label(span), help=hint
    )


def alias_in_itself(name: str, span: Span) -> Diagnostic:
    """Say that a value contains itself."""
    return Diagnostic("unknown-anchor", f"`*{shorten(name)}` is inside its own value", Label(span))


def tag(span: Span, text: str) -> Diagnostic:
    """Say that tags are not read."""
    return Diagnostic(
        "yaml-tag",
        f"the tag `{shorten(text)}` is not read",
        Label(span),
        help="remove it; to turn a number or a boolean into a text, put it in quotes",
    )


def surrogate(span: Span) -> Diagnostic:
    """Say that a text holds half of a character."""
    message = "half of a surrogate pair is not a character"
    return Diagnostic("invalid-text", message, Label(span), help="write the character itself")


def nul(span: Span) -> Diagnostic:
    """Say that a text holds a NUL."""
    message = "a text cannot hold a NUL: strings of ROS end there"
    return Diagnostic("invalid-text", message, Label(span), help="leave it out")


def code_point(span: Span) -> Diagnostic:
    """Say that an escape is beyond all characters."""
    message = "there is no character of this number: the last one is U+10FFFF"
    return Diagnostic("yaml-syntax", message, Label(span))


def reserved(span: Span, text: str) -> Diagnostic:
    """Say that YAML 1.1 has a meaning of its own for a text."""
    return Diagnostic("yaml-syntax", f"YAML 1.1 reserves `{text}`", Label(span), help="write it in quotes")


def bad_number(span: Span, text: str) -> Diagnostic:
    """Say that a number cannot be read."""
    return Diagnostic("invalid-number", f"`{text}` is not a number that can be read", Label(span))


def unclear_number(value: int, span: Span, text: str) -> Diagnostic:
    """Say that YAML 1.1 reads a number as people do not."""
    return Diagnostic(
        "unclear-number",
        f"YAML 1.1 reads `{shorten(text)}` as {value}",
        Label(span),
        help="write the number without a leading zero, or put it in quotes",
    )


def duplicate_key(key: Key, first: Key) -> Diagnostic:
    """Say that a map has a key twice."""
    return Diagnostic(
        "duplicate-key",
        f"the key `{shorten(key.name)}` is there twice",
        Label(key.span, "again"),
        (Label(first.span, "first here"),),
        "YAML would silently take the last one: remove one of them",
    )


def merge_key(span: Span) -> Diagnostic:
    """Say that a merge key has nothing to merge."""
    return Diagnostic("wrong-value", "`<<` merges a map, or a list of maps", Label(span))


def no_text_key(node: Node) -> Diagnostic:
    """Say that a key is no text."""
    if not isinstance(node, ScalarNode):
        return Diagnostic("no-text-key", f"a key must be a text, this is {shown(node)}", Label(node.span))
    written = shorten(source_text(node))
    return Diagnostic(
        "no-text-key",
        f"a key must be a text, but in YAML 1.1 `{written}` is {shown(node)}",
        Label(node.span),
        help=f'write it in quotes: "{written}"',
    )
