"""From a tree to messages, services and actions: reads types and values, checks names, keeps comments."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import assert_never

from ifgen.definition import derive, explain, names, rules
from ifgen.definition.impossible import check_sizes
from ifgen.definition.interfaces import Constant, Field, Folder, Interface, Message, Scalar
from ifgen.definition.literals import BadValue, default_value, scalar_value
from ifgen.definition.problems import FileProblems
from ifgen.definition.spelling import PRIMITIVES, BadType, field_type
from ifgen.definition.types import FieldType
from ifgen.diagnostics import Source, Span
from ifgen.idl.comments import documentation
from ifgen.idl.parser import OPTIONAL, parse_action, parse_message, parse_service
from ifgen.idl.tree import ConstantNode, FieldNode, InterfaceTree, PartNode
from ifgen.reading.packages import IDL


def interface(
    source: Source,
    package: str,
    kind: Folder,
    name: str,
    problems: FileProblems,
    is_there: Callable[[str], bool] | None = None,
) -> Interface:
    """Parse a file and say what it means; what is wrong with it goes to `problems`.

    With problems the result holds everything that was understood, which is enough to look for more problems.
    `is_there` tests whether a file that an .idl file includes exists.
    """
    if source.path.suffix == IDL:
        # A separate grammar, which most packages do not need.
        from ifgen.definition.omg_idl import build as omg_idl

        return omg_idl.interface(source, package, kind, name, problems, is_there)
    match kind:
        case "msg":
            tree = parse_message(source)
            (message,) = _messages(tree, package, kind, (name,), problems)
            return message
        case "srv":
            tree = parse_service(source)
            parts = _messages(tree, package, kind, (f"{name}_Request", f"{name}_Response"), problems)
            return derive.service(package, kind, name, *parts)
        case "action":
            tree = parse_action(source)
            suffixes = ("Goal", "Result", "Feedback")
            parts = _messages(tree, package, kind, tuple(f"{name}_{suffix}" for suffix in suffixes), problems)
            return derive.action(package, name, *parts)
        case _:
            assert_never(kind)


def _messages(
    tree: InterfaceTree, package: str, folder: Folder, names: tuple[str, ...], problems: FileProblems
) -> list[Message]:
    problems.extend(tree.problems, tree.unexplained)
    builder = _Builder(tree.source, package, folder, problems)
    messages = [builder.message(part, name) for part, name in zip(tree.parts, names, strict=True)]
    if len(messages) > 1:
        rules.check_constants(messages, problems)
    return messages


class _Builder:
    """Builds the messages of one file."""

    def __init__(self, source: Source, package: str, folder: Folder, problems: FileProblems) -> None:
        self._source = source
        self._package = package
        self._folder: Folder = folder
        self._problems = problems
        self._has_backslash = "\\" in source.text
        self._has_tags = "[@" in source.text

    def message(self, part: PartNode, name: str) -> Message:
        """The message that a part defines."""
        fields: dict[str, Field] = {}
        constants: dict[str, Constant] = {}
        for node in part.definitions:
            if type(node) is FieldNode:
                self._field(node, fields)
            elif type(node) is ConstantNode:
                self._constant(node, constants)
        for place in part.optionals:
            self._problems.warning(rules.optional_field, self._span(place, OPTIONAL))
        if self._has_tags:
            from ifgen.definition.meaning.check import check_tags  # late: few files have tags

            check_tags(fields.values(), constants, self._problems)
        if len(fields) == 1 and names.PLACEHOLDER in fields:
            fields.clear()
        start = Span(self._source, 0, 0)
        return Message(
            self._package,
            self._folder,
            name,
            tuple(fields.values()),
            tuple(constants.values()),
            self._documentation(part.comments, start)[0] if part.comments else "",
            start,
            self._source,
        )

    def _field(self, node: FieldNode, fields: dict[str, Field]) -> None:
        name, type_text = node.name, node.type_text
        span = Span(self._source, node.name_start, node.name_start + len(name))
        type_ = field_type(type_text, self._package)
        if isinstance(type_, BadType):
            self._problems.error(explain.bad_type, type_, type_text, self._source, node.type_start)
        elif "<" in type_text or "[" in type_text:
            place = self._span(node.type_start, type_text)
            check_sizes(type_, place, self._problems)
            rules.check_type(type_text, type_, place, self._problems)
        if not names.is_field_name(name):
            if not type_text.endswith("["):  # a space in the brackets: what follows is no name
                self._problems.error(explain.invalid_field_name, name, span)
        elif name in fields:
            self._problems.error(explain.duplicate, "field", name, span, fields[name].span)
        elif not isinstance(type_, BadType):
            if rules.is_troublesome(name):
                self._problems.warning(rules.field_name, name, span)
            value = (
                None if node.value is None else self._default(node.value, node.value_start, type_text, type_)
            )
            text, unit = self._documentation(node.comments, span) if node.comments else ("", None)
            if unit is not None and "\n" in unit:
                self._problems.warning(rules.bracket_over_lines, span)
                unit = None
            if unit is not None and not unit.startswith("@"):
                rules.check_unit(unit, node.comments, span, self._problems)
            fields[name] = Field(name, type_, value, text, unit, span)

    def _constant(self, node: ConstantNode, constants: dict[str, Constant]) -> None:
        name, type_text = node.name, node.type_text
        span = Span(self._source, node.name_start, node.name_start + len(name))
        type_ = PRIMITIVES.get(type_text)
        if type_ is None:
            self._problems.error(explain.constant_type, type_text, self._span(node.type_start, type_text))
        if not names.is_constant_name(name):
            self._problems.error(explain.invalid_constant_name, name, span)
        elif name in constants:
            self._problems.error(explain.duplicate, "constant", name, span, constants[name].span)
        elif type_ is not None:
            value_span = self._span(node.value_start, node.value)
            try:
                value = scalar_value(node.value, type_)
            except BadValue as error:
                self._problems.error(explain.bad_value, error, type_text, value_span)
                return
            rules.check_value(node.value, type_, value, value_span, self._problems)
            text, unit = self._documentation(node.comments, span) if node.comments else ("", None)
            # rosidl minds a bracket over several lines in fields only, whose units it writes down.
            unit = None if unit is None or "\n" in unit else unit
            constants[name] = Constant(name, type_, value, text, span, unit)

    def _default(
        self, text: str, start: int, type_text: str, type_: FieldType
    ) -> Scalar | tuple[Scalar, ...] | None:
        span = self._span(start, text)
        try:
            value = default_value(text, type_)
        except BadValue as error:
            self._problems.error(explain.bad_value, error, type_text, span)
            return None
        rules.check_value(text, type_, value, span, self._problems)
        return value

    def _documentation(self, comments: Sequence[str], span: Span) -> tuple[str, str | None]:
        text, unit = documentation(comments)
        if self._has_backslash:
            rules.check_comment(text, unit, span, self._problems)
        return text, unit

    def _span(self, start: int, text: str) -> Span:
        return Span(self._source, start, start + len(text))
