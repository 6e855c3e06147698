"""An edit as a diagnostic: what differs, its place in both versions, and what that breaks."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final, NamedTuple, TypeAlias, assert_never

from ifgen.definition.interfaces import Constant, Field, Message
from ifgen.definition.spelling import spelled, spelled_value
from ifgen.definition.types import (
    Array,
    BoundedSequence,
    BoundedString,
    BoundedWString,
    CollectionType,
    FieldType,
    UnboundedSequence,
    UnboundedString,
    UnboundedWString,
)
from ifgen.diagnostics import Diagnostic, Label, Span, shorten
from ifgen.evolution import edits
from ifgen.evolution.compare import Difference, Path
from ifgen.evolution.rules import broken_by
from ifgen.nodl.model import Endpoint, NodeDescription, Parameter, ParameterType

_SHOWN: Final = 3

_Place: TypeAlias = tuple[Span | None, str]
"""A place in one version, and what to say of it."""


class Finding(NamedTuple):
    """The rule and the message about an edit, and its places in both versions."""

    rule: str
    message: str
    new: _Place = (None, "")
    old: _Place = (None, "")


def diagnostic(difference: Difference) -> Diagnostic | None:
    """The diagnostic about a difference, as a warning; None if it breaks nothing and changes no meaning."""
    finding = _finding(difference)
    broken = broken_by(difference.edit)
    if finding is None or not (broken or isinstance(difference.edit, edits.MeaningChanged)):
        return None
    breaks = tuple(category.value for category in edits.Category if category in broken)
    help = f"this breaks {_listed(breaks)}" if broken else "type hash and bytes are as before, values are not"
    if others := _others(difference):
        help += f". It also changes {others}"
    new, old = _label(*finding.new), _label(*finding.old)
    labels = [found for found in (new, old) if found is not None]
    if not difference.is_own:
        user = difference.paths[0].fields[0]
        labels = [Label(user.span, "through this field"), *labels] if user.span else labels
    primary = labels[0] if labels else None
    return Diagnostic(finding.rule, finding.message, primary, tuple(labels[1:]), help, "warning", breaks)


def _finding(difference: Difference) -> Finding | None:
    match difference.edit:
        case edits.InterfaceAdded():
            return None
        case edits.InterfaceRemoved(interface):
            message = f"{interface.type_name} is gone"
            return Finding("interface-removed", message, old=(interface.span, "it was here"))
        case edits.InterfaceRenamed(old, new):
            message = f"{old.type_name} is now {new.type_name}"
            return Finding(
                "interface-renamed", message, (new.span, ""), (old.span, "the same under its old name")
            )
        case edits.PackageRemoved(name, interfaces, nodes, place):
            counts = ((interfaces, "interface"), (nodes, "node"))
            held = " and ".join(_counted(number, noun) for number, noun in counts if number)
            return Finding(
                "package-removed", f"package '{name}' is gone, with {held}", old=(place, "it was here")
            )
        case (
            edits.FieldAdded()
            | edits.FieldRemoved()
            | edits.FieldRenamed()
            | edits.FieldMoved()
            | edits.FieldRetyped()
            | edits.DefaultChanged()
            | edits.MeaningChanged()
            | edits.ConstantAdded()
            | edits.ConstantRemoved()
            | edits.ConstantRenamed()
            | edits.ConstantChanged()
            | edits.EnumChanged()
        ) as edit:
            return _in_message(edit, _owner(difference, edit.within.new))
        case edit:
            return _in_node(edit)


def _in_message(edit: edits.MessageEdit, owner: str) -> Finding | None:
    """The words for an edit of the message that users reach as `owner`."""
    match edit:
        case edits.FieldAdded(_, field):
            return Finding("field-added", f"{owner}.{field.name} is new", (field.span, "this field"))
        case edits.FieldRemoved(within, field, instead):
            at = instead.span if instead is not None else within.new.span
            beside = "it was before this" if instead is not None else ""
            message = f"{owner}.{field.name} is gone"
            return Finding("field-removed", message, (at, beside), (field.span, "this field"))
        case edits.FieldRenamed(_, old, new):
            message = f"{owner}.{new.name} was called `{old.name}`"
            return Finding("field-renamed", message, (new.span, ""), (old.span, "before"))
        case edits.FieldMoved(_, old, new):
            message = f"{owner}.{new.name} has another place among the fields"
            return Finding("field-moved", message, (new.span, "now here"), (old.span, "before"))
        case edits.FieldRetyped():
            return _retyped(edit, owner)
        case edits.DefaultChanged(_, old, new):
            message = f"the default of {owner}.{new.name} {_was(_default(old), _default(new))}"
            return Finding("default-value", message, (new.span, ""), (old.span, "before"))
        case edits.MeaningChanged(_, old, new, aspect, was, now):
            message = f"the {aspect} of {owner}.{new.name} was {shorten(was)}, and is {shorten(now)}"
            return Finding("field-meaning", message, (new.span, ""), (old.span, "before"))
        case edits.ConstantAdded():
            return None
        case edits.ConstantRemoved(within, constant):
            message = f"{owner}.{constant.name} is gone"
            return Finding(
                "constant-removed", message, (within.new.span, ""), (constant.span, "this constant")
            )
        case edits.ConstantRenamed(_, old, new):
            message = f"{owner}.{new.name} was called `{old.name}`"
            return Finding("constant-renamed", message, (new.span, ""), (old.span, "before"))
        case edits.ConstantChanged(_, old, new):
            message = f"{owner}.{new.name} {_was(_value(old), _value(new))}"
            return Finding("constant-value", message, (new.span, ""), (old.span, "before"))
        case edits.EnumChanged(_, field, name, lost):
            names = ", ".join(constant.name for constant in lost[:_SHOWN])
            more = f" and {len(lost) - _SHOWN} more" if len(lost) > _SHOWN else ""
            message = f"{owner}.{name} lacks {names}{more}"
            places = (
                (field.span, "its constants are of another type, or of another field"),
                (lost[0].span, ""),
            )
            return Finding("enum-members", message, *places)


def _retyped(edit: edits.FieldRetyped, owner: str) -> Finding:
    old, new = edit.old, edit.new
    message = f"{owner}.{new.name} {_was(*_shown_type(old.type, new.type))}"
    places = (_type_span(new), ""), (_type_span(old), "before")
    match _elements(old.type) == _elements(new.type), _shape(old.type) == _shape(new.type):
        case (True, True):
            return Finding("field-bound", message, *places)
        case (True, False):
            return Finding("field-array", message, *places)
        case _:
            return Finding("field-type", message, *places)


def _elements(type_: FieldType) -> object:
    """The type of a value or of each element, without a bound."""
    match type_.value_type if isinstance(type_, CollectionType) else type_:
        case BoundedString():
            return UnboundedString()
        case BoundedWString():
            return UnboundedWString()
        case value_type:
            return value_type


def _shape(type_: FieldType) -> str:
    """One value, an array with its size, or a sequence."""
    match type_:
        case Array(size=size):
            return f"array of {size}"
        case BoundedSequence() | UnboundedSequence():
            return "sequence"
        case _:
            return "value"


def _owner(difference: Difference, message: Message) -> str:
    """The message that an edit is in, for users: by its name, or by the path that leads to it."""
    return _shown_name(message) if difference.is_own else _shown_path(difference.paths[0])


def _others(difference: Difference) -> str:
    """The other places where an edit is felt."""
    paths = difference.paths if difference.is_own else difference.paths[1:]
    shown = [_shown_path(path) for path in paths[:_SHOWN]]
    if len(paths) > _SHOWN:
        shown.append(f"{len(paths) - _SHOWN} more")
    return _listed(shown)


def _shown_path(path: Path) -> str:
    return ".".join((_shown_name(path.message), *(field.name for field in path.fields)))


def _shown_name(message: Message) -> str:
    """`pkg/Name`, or `pkg/srv/Name_Request`."""
    return message.type_name if message.folder != "msg" else f"{message.package}/{message.name}"


def _listed(words: Sequence[str]) -> str:
    return " and ".join(filter(None, (", ".join(words[:-1]), *words[-1:])))


def _was(old: str, new: str) -> str:
    return f"was {old}, and is {new}"


def _default(field: Field) -> str:
    return "none" if field.default_value is None else f"`{shorten(spelled_value(field.default_value))}`"


def _value(constant: Constant) -> str:
    return f"`{spelled(constant.type)} {shorten(spelled_value(constant.value))}`"


def _in_node(edit: edits.NodeEdit) -> Finding | None:
    """The words for an edit; None for one that breaks nothing."""
    match edit:
        case edits.NodeAdded() | edits.EndpointAdded():
            return None
        case edits.NodeRemoved(node):
            return Finding("node-removed", f"node {_name(node)} is gone", old=(node.span, "it was here"))
        case edits.NodeRenamed(old, new):
            message = f"node {_name(old)} is now {_name(new)}"
            return Finding("node-renamed", message, (new.span, ""), (old.span, "the same under its old name"))
        case edits.NodeClassChanged(old, new):
            message = f"the class of node {_name(new)} was {_class(old)}, and is {_class(new)}"
            return Finding("node-class", message, (new.span, ""), (old.span, "before"))
        case edits.EndpointRemoved(node, endpoint):
            message = f"{_endpoint(node, endpoint)} is gone"
            return Finding("endpoint-removed", message, (node.span, ""), (endpoint.span, "this one"))
        case edits.EndpointRenamed(node, old, new):
            message = f"{_endpoint(node, new)} was called `{shorten(old.name)}`"
            return Finding("endpoint-renamed", message, (new.span, ""), (old.span, "before"))
        case edits.EndpointRetyped(node, old, new):
            message = f"{_endpoint(node, new)} was of type {old.type_name}, and is of {new.type_name}"
            return Finding("endpoint-type", message, (new.span, ""), (old.span, "before"))
        case edits.QosChanged(node, old, new, mismatch):
            message = f"{_endpoint(node, new)} no longer matches its peers: {mismatch}"
            return Finding("qos-incompatible", message, (_qos(new), ""), (_qos(old), "before"))
        case _:
            return _of_parameter(edit)


def _of_parameter(
    edit: edits.ParameterAdded
    | edits.ParameterRemoved
    | edits.ParameterRenamed
    | edits.ParameterRetyped
    | edits.ParameterDefaultChanged
    | edits.ParameterAccessChanged
    | edits.ValidatorsChanged,
) -> Finding:
    match edit:
        case edits.ParameterAdded(node, parameter):
            message = f"{_parameter(node, parameter)} is new, and has no default"
            return Finding("parameter-required", message, (parameter.span, "each start must give it a value"))
        case edits.ParameterRemoved(node, parameter):
            message = f"{_parameter(node, parameter)} is gone"
            return Finding("parameter-removed", message, (node.span, ""), (parameter.span, "this one"))
        case edits.ParameterRenamed(node, old, new):
            message = f"{_parameter(node, new)} was called `{shorten(old.name)}`"
            return Finding("parameter-renamed", message, (new.span, ""), (old.span, "before"))
        case edits.ParameterRetyped(node, old, new):
            message = f"{_parameter(node, new)} was of type {_type(old.type)}, and is of {_type(new.type)}"
            return Finding("parameter-type", message, (new.span, ""), (old.span, "before"))
        case edits.ParameterDefaultChanged(node, old, new) if new.is_required:
            message = f"{_parameter(node, new)} has no default any more"
            there = "each start must give it a value"
            return Finding("parameter-required", message, (new.span, there), (old.span, "before"))
        case edits.ParameterDefaultChanged(node, old, new):
            was, is_ = shorten(repr(old.default)), shorten(repr(new.default))
            message = f"the default of {_parameter(node, new)} was {was}, and is {is_}"
            return Finding("parameter-default", message, (new.span, ""), (old.span, "before"))
        case edits.ParameterAccessChanged(node, old, new):
            message = f"{_parameter(node, new)} is now read-only"
            return Finding("parameter-read-only", message, (new.span, ""), (old.span, "before"))
        case edits.ValidatorsChanged(node, old, new):
            message = f"{_parameter(node, new)} may refuse values that it took before"
            return Finding(
                "parameter-validation", message, (_validation(new), ""), (_validation(old), "before")
            )
        case _:
            assert_never(edit)


def _name(node: NodeDescription) -> str:
    return f"{node.package}/{node.name}"


def _class(node: NodeDescription) -> str:
    kind = {
        "callbacks": "of callbacks",
        "lifecycle": "with a lifecycle",
        "asyncio": "of coroutines",
        "nodl": "with the names of nodl_generator_py",
    }
    return f"{node.node_class} {kind[node.style]}"


def _endpoint(node: NodeDescription, endpoint: Endpoint) -> str:
    return f"{endpoint.category.singular} `{shorten(endpoint.name)}` of node {_name(node)}"


def _parameter(node: NodeDescription, parameter: Parameter) -> str:
    return f"parameter `{shorten(parameter.name)}` of node {_name(node)}"


def _type(type_: ParameterType) -> str:
    array = "_array" if type_.array else ""
    return f"{type_.base}{array}{f'_fixed_{type_.fixed_size}' if type_.fixed_size is not None else ''}"


def _qos(endpoint: Endpoint) -> Span | None:
    """The place of a QoS profile, as short as its first line."""
    span = endpoint.qos.span if endpoint.qos is not None else None
    return endpoint.span if span is None else _first_line(span)


def _validation(parameter: Parameter) -> Span | None:
    span = parameter.validators[0].span if parameter.validators else None
    return parameter.span if span is None else _first_line(span)


def _first_line(span: Span) -> Span:
    end = span.source.text.find("\n", span.start, span.end)
    return span if end < 0 else Span(span.source, span.start, end)


def _label(span: Span | None, text: str) -> Label | None:
    """A label, if there is a place for it."""
    return None if span is None else Label(span, text)


def _type_span(field: Field) -> Span | None:
    """The place of the whole type of a field, with its brackets; None for derived fields."""
    if field.type_span is not None or field.span is None:
        return field.type_span
    source = field.span.source
    line = field.span.start - field.span.column + 1
    words = source.text[line : field.span.start].split()
    if not words:
        return field.span
    start = source.text.rindex(words[-1], line, field.span.start)
    return Span(source, start, start + len(words[-1]))


def _shown_type(old: FieldType, new: FieldType) -> tuple[str, str]:
    """Two types for a message."""
    return f"`{spelled(old)}`", f"`{spelled(new)}`"


def _counted(number: int, noun: str) -> str:
    """The number with its noun: `1 file`, `2 files`."""
    return f"{number} {noun}{'' if number == 1 else 's'}"
