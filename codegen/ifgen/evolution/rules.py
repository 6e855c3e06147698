"""The rules: what each edit breaks. docs/evolution.md explains the categories."""

from __future__ import annotations

from typing import Final, assert_never

from ifgen.evolution.edits import (
    Category,
    ConstantAdded,
    ConstantChanged,
    ConstantRemoved,
    ConstantRenamed,
    DefaultChanged,
    Edit,
    EndpointAdded,
    EndpointRemoved,
    EndpointRenamed,
    EndpointRetyped,
    EnumChanged,
    FieldAdded,
    FieldMoved,
    FieldRemoved,
    FieldRenamed,
    FieldRetyped,
    InterfaceAdded,
    InterfaceRemoved,
    InterfaceRenamed,
    NodeAdded,
    NodeClassChanged,
    NodeRemoved,
    NodeRenamed,
    PackageRemoved,
    ParameterAccessChanged,
    ParameterAdded,
    ParameterDefaultChanged,
    ParameterRemoved,
    ParameterRenamed,
    ParameterRetyped,
    QosChanged,
    ValidatorsChanged,
)

NOTHING: Final = frozenset[Category]()
_SOURCE: Final = frozenset({Category.SOURCE})
_HASH: Final = frozenset({Category.HASH})
_LAYOUT: Final = frozenset({Category.HASH, Category.WIRE})
_NAME: Final = frozenset({Category.SOURCE, Category.HASH})
_ALL: Final = frozenset(Category)


def broken_by(edit: Edit) -> frozenset[Category]:
    """The categories that an edit breaks. Whatever breaks the wire changes a hash, too."""
    match edit:
        case FieldRemoved() | InterfaceRemoved() | PackageRemoved():
            return _ALL
        case FieldAdded() | FieldMoved():
            return _LAYOUT
        case FieldRenamed() | InterfaceRenamed():
            return _NAME
        case FieldRetyped():
            layout = _HASH if edit.same_layout else _LAYOUT
            return layout if edit.same_values else layout | _SOURCE
        case DefaultChanged() | ConstantRemoved() | ConstantRenamed() | ConstantChanged() | EnumChanged():
            return _SOURCE
        case EndpointRemoved() | EndpointRenamed() | EndpointRetyped() | NodeRemoved() | NodeRenamed():
            return _NAME
        case QosChanged():
            return NOTHING if edit.mismatch is None else _HASH
        case ParameterRetyped() | ValidatorsChanged():
            return NOTHING if edit.accepts_all else _SOURCE
        case ParameterAdded():
            return _SOURCE if edit.parameter.is_required else NOTHING
        case ParameterDefaultChanged():
            return NOTHING if edit.old.default is None else _SOURCE
        case ParameterAccessChanged():
            return _SOURCE if edit.new.read_only else NOTHING
        case ParameterRemoved() | ParameterRenamed() | NodeClassChanged():
            return _SOURCE
        case ConstantAdded() | InterfaceAdded() | NodeAdded() | EndpointAdded():
            return NOTHING
        case _:
            assert_never(edit)


def is_broken(category: Category, edit: Edit) -> bool:
    """Whether an edit breaks the promise of a category.

    Who promises that Python code works promises that peers match, and who promises this that bytes keep
    their meaning.
    """
    promised = list(Category)[list(Category).index(category) :]
    return not broken_by(edit).isdisjoint(promised)
