"""The annotations of an .idl file: documentation, unit, default value, and others."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

from ifgen.definition.explain import bad_value
from ifgen.definition.interfaces import Annotation, Plain
from ifgen.definition.literals import BadValue
from ifgen.definition.omg_idl.values import plain_value
from ifgen.definition.problems import FileProblems
from ifgen.diagnostics import Diagnostic, Label, Source, Span
from ifgen.idl.omg_tree import AnnotationNode, ValueNode

_COMMENT: Final = "verbatim"
_ONCE: Final = ("unit", "default")


@dataclass(frozen=True, slots=True)
class Said:
    """The annotations of a definition.

    The default value is still a literal, because its type is not known yet.
    """

    documentation: str = ""
    unit: str | None = None
    default: ValueNode | None = None
    others: tuple[Annotation, ...] = ()


NOTHING: Final = Said()


def read_annotations(nodes: Sequence[AnnotationNode], source: Source, problems: FileProblems) -> Said:
    """Read the annotations of a definition; what is wrong with them goes to `problems`."""
    return _Reader(source, problems).read(nodes) if nodes else NOTHING


class _Reader:
    """Reads the annotations of one definition."""

    def __init__(self, source: Source, problems: FileProblems) -> None:
        self._source = source
        self._problems = problems
        self._first: dict[str, AnnotationNode] = {}

    def read(self, nodes: Sequence[AnnotationNode]) -> Said:
        """Whatever is said more than once is said by the first."""
        comments: list[str] = []
        others: list[Annotation] = []
        unit: str | None = None
        default: ValueNode | None = None
        for node in nodes:
            if node.name in _ONCE and not self._is_first(node):
                continue
            annotation = self._annotation(node)
            if annotation is None:
                continue
            parameters = dict(annotation.parameters)
            if node.name == _COMMENT and not _has_text(annotation):
                self._problems.error(_no_comment, self._span(node))
            elif node.name == _COMMENT and parameters.get("language") == "comment" and "text" in parameters:
                comments += str(parameters["text"]).splitlines()
            elif node.name == "unit":
                said = parameters.get("value", annotation.value)
                unit = None if said is None else str(said)
            elif node.name == "default":
                default = self._default(node)
            else:
                others.append(annotation)
        return Said("\n".join(comments), unit, default, tuple(others))

    def _is_first(self, node: AnnotationNode) -> bool:
        first = self._first.setdefault(node.name, node)
        if first is not node:
            self._problems.error(_twice, node, self._span(node), self._span(first))
        return first is node

    def _span(self, node: AnnotationNode) -> Span:
        return Span(self._source, node.start, node.end)

    def _default(self, node: AnnotationNode) -> ValueNode | None:
        for parameter in node.parameters:
            if parameter.name == "value":
                return parameter.value
        self._problems.error(_without_value, node, self._span(node))
        return None

    def _annotation(self, node: AnnotationNode) -> Annotation | None:
        value = None if node.value is None else self._plain(node.value)
        # The text of a default is looked at later, with the type in mind.
        parameters = (
            node.parameters if node.name != "default" else [p for p in node.parameters if p.name != "value"]
        )
        read = [(parameter.name, self._plain(parameter.value)) for parameter in parameters]
        if (node.value is not None and value is None) or any(item is None for _, item in read):
            return None
        return Annotation(node.name, value, tuple((name, item) for name, item in read if item is not None))

    def _plain(self, node: ValueNode) -> Plain | None:
        try:
            return plain_value(node)
        except BadValue as error:
            span = Span(self._source, node.start, node.end)
            self._problems.error(bad_value, error, None, span)
            return None


def _has_text(annotation: Annotation) -> bool:
    """Whether a `verbatim` holds text, and no number or nothing in its place."""
    if not annotation.parameters:
        return isinstance(annotation.value, str)
    return isinstance(dict(annotation.parameters).get("text", ""), str)


def _no_comment(span: Span) -> Diagnostic:
    return Diagnostic(
        "invalid-annotation",
        "`@verbatim` has no text",
        Label(span, "rosidl's generators fail on it"),
        help='write `@verbatim (language="comment", text="...")`',
    )


def _twice(node: AnnotationNode, span: Span, first: Span) -> Diagnostic:
    return Diagnostic(
        "invalid-annotation",
        f"there are two `@{node.name}`",
        Label(span, "rosidl then ignores both"),
        (Label(first, "the first"),),
        "remove one of them",
    )


def _without_value(node: AnnotationNode, span: Span) -> Diagnostic:
    return Diagnostic(
        "invalid-annotation",
        "`@default` has no `value`",
        Label(span, "rosidl_generator_type_description fails on it"),
        help="write `@default (value=...)`",
    )
