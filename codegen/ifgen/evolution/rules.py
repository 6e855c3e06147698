"""The rules: what each edit breaks. docs/evolution.md explains the categories."""

from __future__ import annotations

from typing import Final, assert_never

from ifgen.evolution import edits

NOTHING: Final = frozenset[edits.Category]()
_SOURCE: Final = frozenset({edits.Category.SOURCE})
_HASH: Final = frozenset({edits.Category.HASH})
_LAYOUT: Final = frozenset({edits.Category.HASH, edits.Category.WIRE})
_NAME: Final = frozenset({edits.Category.SOURCE, edits.Category.HASH})
_ALL: Final = frozenset(edits.Category)


def broken_by(edit: edits.Edit) -> frozenset[edits.Category]:
    """The categories that an edit breaks. Whatever breaks the wire changes a hash, too."""
    match edit:
        case edits.FieldRemoved() | edits.InterfaceRemoved() | edits.PackageRemoved():
            return _ALL
        case edits.FieldAdded() | edits.FieldMoved():
            return _LAYOUT
        case edits.FieldRenamed() | edits.InterfaceRenamed():
            return _NAME
        case edits.FieldRetyped():
            layout = _HASH if edit.same_layout else _LAYOUT
            return layout if edit.same_values else layout | _SOURCE
        case (
            edits.DefaultChanged()
            | edits.ConstantRemoved()
            | edits.ConstantRenamed()
            | edits.ConstantChanged()
            | edits.EnumChanged()
        ):
            return _SOURCE
        case (
            edits.EndpointRemoved()
            | edits.EndpointRenamed()
            | edits.EndpointRetyped()
            | edits.NodeRemoved()
            | edits.NodeRenamed()
        ):
            return _NAME
        case edits.QosChanged():
            return NOTHING if edit.mismatch is None else _HASH
        case edits.ParameterRetyped() | edits.ValidatorsChanged():
            return NOTHING if edit.accepts_all else _SOURCE
        case edits.ParameterAdded():
            return _SOURCE if edit.parameter.is_required else NOTHING
        case edits.ParameterDefaultChanged():
            return NOTHING if edit.old.default is None else _SOURCE
        case edits.ParameterAccessChanged():
            return _SOURCE if edit.new.read_only else NOTHING
        case edits.ParameterRemoved() | edits.ParameterRenamed() | edits.NodeClassChanged():
            return _SOURCE
        case edits.MeaningChanged():  # no program fails, and no promise is about comments: it is a warning
            return NOTHING
        case edits.ConstantAdded() | edits.InterfaceAdded() | edits.NodeAdded() | edits.EndpointAdded():
            return NOTHING
        case _:
            assert_never(edit)


def is_broken(category: edits.Category, edit: edits.Edit) -> bool:
    """Whether an edit breaks the promise of a category.

    Who promises that Python code works promises that peers match, and who promises this that bytes keep
    their meaning.
    """
    promised = list(edits.Category)[list(edits.Category).index(category) :]
    return not broken_by(edit).isdisjoint(promised)
