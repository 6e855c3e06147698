"""An edit as a diagnostic: what differs, its place in both versions, and what that breaks."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

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
from ifgen.diagnostics import Diagnostic, Label, shorten
from ifgen.evolution import node_words
from ifgen.evolution.compare import Difference, Path
from ifgen.evolution.edits import (
    Category,
    ConstantAdded,
    ConstantChanged,
    ConstantRemoved,
    ConstantRenamed,
    DefaultChanged,
    EnumChanged,
    FieldAdded,
    FieldMoved,
    FieldRemoved,
    FieldRenamed,
    FieldRetyped,
    InterfaceAdded,
    InterfaceRemoved,
    InterfaceRenamed,
    MessageEdit,
    PackageRemoved,
)
from ifgen.evolution.rules import broken_by
from ifgen.evolution.words_of_places import Said, counted, label, shown_type, type_span

_SHOWN: Final = 3


def diagnostic(difference: Difference) -> Diagnostic | None:
    """The diagnostic about a difference, as a warning; None if the difference breaks no category."""
    said = _said(difference)
    broken = broken_by(difference.edit)
    if said is None or not broken:
        return None
    breaks = tuple(category.value for category in Category if category in broken)
    help = f"this breaks {_listed(breaks)}"
    if others := _others(difference):
        help += f". It also changes {others}"
    new, old = label(*said.new), label(*said.old)
    labels = [found for found in (new, old) if found is not None]
    if not difference.is_own:
        user = difference.paths[0].fields[0]
        labels = [Label(user.span, "through this field"), *labels] if user.span else labels
    primary = labels[0] if labels else None
    return Diagnostic(said.rule, said.message, primary, tuple(labels[1:]), help, "warning", breaks)


def _said(difference: Difference) -> Said | None:
    match difference.edit:
        case InterfaceAdded():
            return None
        case InterfaceRemoved(interface):
            message = f"{interface.type_name} is gone"
            return Said("interface-removed", message, old=(interface.span, "it was here"))
        case InterfaceRenamed(old, new):
            message = f"{old.type_name} is now {new.type_name}"
            return Said(
                "interface-renamed", message, (new.span, ""), (old.span, "the same under its old name")
            )
        case PackageRemoved(name, interfaces, nodes, place):
            counts = ((interfaces, "interface"), (nodes, "node"))
            held = " and ".join(counted(number, noun) for number, noun in counts if number)
            return Said(
                "package-removed", f"package '{name}' is gone, with {held}", old=(place, "it was here")
            )
        case (
            FieldAdded()
            | FieldRemoved()
            | FieldRenamed()
            | FieldMoved()
            | FieldRetyped()
            | DefaultChanged()
            | ConstantAdded()
            | ConstantRemoved()
            | ConstantRenamed()
            | ConstantChanged()
            | EnumChanged()
        ) as edit:
            return _in_message(edit, _owner(difference, edit.within.new))
        case edit:
            return node_words.said(edit)


def _in_message(edit: MessageEdit, owner: str) -> Said | None:
    """The words for an edit of the message that users reach as `owner`."""
    match edit:
        case FieldAdded(_, field):
            return Said("field-added", f"{owner}.{field.name} is new", (field.span, "this field"))
        case FieldRemoved(within, field, instead):
            at = instead.span if instead is not None else within.new.span
            beside = "it was before this" if instead is not None else ""
            message = f"{owner}.{field.name} is gone"
            return Said("field-removed", message, (at, beside), (field.span, "this field"))
        case FieldRenamed(_, old, new):
            message = f"{owner}.{new.name} was called `{old.name}`"
            return Said("field-renamed", message, (new.span, ""), (old.span, "before"))
        case FieldMoved(_, old, new):
            message = f"{owner}.{new.name} has another place among the fields"
            return Said("field-moved", message, (new.span, "now here"), (old.span, "before"))
        case FieldRetyped():
            return _retyped(edit, owner)
        case DefaultChanged(_, old, new):
            message = f"the default of {owner}.{new.name} {_was(_default(old), _default(new))}"
            return Said("default-value", message, (new.span, ""), (old.span, "before"))
        case ConstantAdded():
            return None
        case ConstantRemoved(within, constant):
            message = f"{owner}.{constant.name} is gone"
            return Said("constant-removed", message, (within.new.span, ""), (constant.span, "this constant"))
        case ConstantRenamed(_, old, new):
            message = f"{owner}.{new.name} was called `{old.name}`"
            return Said("constant-renamed", message, (new.span, ""), (old.span, "before"))
        case ConstantChanged(_, old, new):
            message = f"{owner}.{new.name} {_was(_value(old), _value(new))}"
            return Said("constant-value", message, (new.span, ""), (old.span, "before"))
        case EnumChanged(_, field, name, lost):
            names = ", ".join(constant.name for constant in lost[:_SHOWN])
            more = f" and {len(lost) - _SHOWN} more" if len(lost) > _SHOWN else ""
            message = f"{owner}.{name} lacks {names}{more}"
            places = (
                (field.span, "its constants are of another type, or of another field"),
                (lost[0].span, ""),
            )
            return Said("enum-members", message, *places)


def _retyped(edit: FieldRetyped, owner: str) -> Said:
    old, new = edit.old, edit.new
    message = f"{owner}.{new.name} {_was(*shown_type(old.type, new.type))}"
    places = (type_span(new), ""), (type_span(old), "before")
    match _elements(old.type) == _elements(new.type), _shape(old.type) == _shape(new.type):
        case (True, True):
            return Said("field-bound", message, *places)
        case (True, False):
            return Said("field-array", message, *places)
        case _:
            return Said("field-type", message, *places)


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
