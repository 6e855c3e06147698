"""From a tree to messages, services and actions: types and values are read, names checked, comments attached."""

from __future__ import annotations

from collections.abc import Sequence

from ifgen.definition import derive, explain, names
from ifgen.definition.escapes import BadValue
from ifgen.definition.interfaces import Constant, Field, Folder, Interface, Message
from ifgen.definition.literals import default_value, scalar_value
from ifgen.definition.spelling import PRIMITIVES, BadType, field_type
from ifgen.diagnostics import Diagnostic, Source, Span
from ifgen.idl.comments import documentation
from ifgen.idl.parser import parse_action, parse_message, parse_service
from ifgen.idl.tree import ConstantNode, FieldNode, PartNode

_PARSE = {"msg": parse_message, "srv": parse_service, "action": parse_action}


class Problems(list[Diagnostic]):
    """What is wrong with one file."""


def interface(
    source: Source, package: str, folder: Folder, name: str, problems: list[Diagnostic]
) -> Interface:
    """Parse a file and say what it means; what is wrong with it goes to `problems`.

    With problems the result is what could be understood: good enough to look for more of them.
    """
    tree = _PARSE[folder](source)
    problems += tree.problems
    builder = _Builder(source, package, folder, problems)
    match folder:
        case "msg":
            return builder.message(tree.parts[0], name)
        case "srv":
            request, response = tree.parts
            return derive.service(
                package,
                folder,
                name,
                builder.message(request, f"{name}_Request"),
                builder.message(response, f"{name}_Response"),
            )
        case "action":
            goal, result, feedback = tree.parts
            return derive.action(
                package,
                name,
                builder.message(goal, f"{name}_Goal"),
                builder.message(result, f"{name}_Result"),
                builder.message(feedback, f"{name}_Feedback"),
            )


class _Builder:
    """Builds the messages of one file."""

    def __init__(self, source: Source, package: str, folder: Folder, problems: list[Diagnostic]) -> None:
        self._source = source
        self._package = package
        self._folder: Folder = folder
        self._problems = problems

    def message(self, part: PartNode, name: str) -> Message:
        """The message that a part defines."""
        fields: dict[str, Field] = {}
        constants: dict[str, Constant] = {}
        for node in part.definitions:
            if type(node) is FieldNode:
                self._field(node, fields)
            elif type(node) is ConstantNode:
                self._constant(node, constants)
        text, _ = documentation(part.comments) if part.comments else ("", None)
        return Message(
            self._package,
            self._folder,
            name,
            tuple(fields.values()),
            tuple(constants.values()),
            text,
            Span(self._source, 0, 0),
            self._source,
        )

    def _field(self, node: FieldNode, fields: dict[str, Field]) -> None:
        type_ = field_type(node.type_text, self._package)
        name = node.name
        span = Span(self._source, node.name_start, node.name_start + len(name))
        if not names.is_field_name(name):
            self._problems.append(explain.field_name(name, span))
        elif name in fields:
            self._problems.append(explain.duplicate("field", name, span, fields[name].span))
            return
        if type(type_) is BadType:
            self._problems.append(explain.bad_type(type_, node.type_text, self._source, node.type_start))
            return
        value = None
        if node.value is not None:
            try:
                value = default_value(node.value, type_)
            except BadValue as error:
                self._problems.append(self._bad_value(error, node))
        text, unit = documentation(node.comments) if node.comments else ("", None)
        fields[name] = Field(name, type_, value, text, unit, span)

    def _constant(self, node: ConstantNode, constants: dict[str, Constant]) -> None:
        name = node.name
        span = Span(self._source, node.name_start, node.name_start + len(name))
        if not names.is_constant_name(name):
            self._problems.append(explain.constant_name(name, span))
        elif name in constants:
            self._problems.append(explain.duplicate("constant", name, span, constants[name].span))
            return
        type_ = PRIMITIVES.get(node.type_text)
        if type_ is None:
            type_span = Span(self._source, node.type_start, node.type_start + len(node.type_text))
            self._problems.append(explain.constant_type(node.type_text, type_span))
            return
        try:
            value = scalar_value(node.value, type_)
        except BadValue as error:
            self._problems.append(self._bad_value(error, node))
            return
        text, unit = documentation(node.comments) if node.comments else ("", None)
        constants[name] = Constant(name, type_, value, text, span, unit)

    def _bad_value(self, error: BadValue, node: FieldNode | ConstantNode) -> Diagnostic:
        assert node.value is not None
        span = Span(self._source, node.value_start, node.value_start + len(node.value))
        return explain.bad_value(error, node.type_text, span)
