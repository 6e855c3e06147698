"""Values, copies and texts of fields: what the straight-line methods of generated classes call."""

from __future__ import annotations

from array import array

from ifgen_runtime.lazy import LazyModule

TYPE_CHECKING = False  # typing itself takes longer to import than this module
if TYPE_CHECKING:
    from collections.abc import Callable
    from typing import Any, TypeAlias

    from ifgen_runtime import arrays

    DeepCopy: TypeAlias = Callable[[Any, dict[int, Any]], Any]
else:
    arrays = LazyModule("ifgen_runtime.arrays")

ITERABLES = frozenset({list, tuple, range, set, frozenset, map, filter, type(_ for _ in ())})
"""Classes whose values have no buffer: fields of numbers read them item by item."""

__all__ = [
    "ITERABLES",
    "array_repr",
    "arrays",
    "copied_array",
    "copied_list",
    "copied_other",
    "deepcopy_of",
    "new_array",
    "new_list",
    "new_object",
    "repr_name",
    "repr_of_fields",
    "unequal",
]

new_object: Any = object.__new__
new_list: Any = list
new_array: Any = array


def deepcopy_of(message_class: type) -> DeepCopy:
    """The function that copies messages of a class deeply, however rosidl's compiled classes do it."""
    attribute = (
        "__generated_deepcopy__" if "__generated_deepcopy__" in vars(message_class) else "__deepcopy__"
    )
    return getattr(message_class, attribute, copied_other)


def copied_other(value: Any, memo: dict[int, Any]) -> Any:
    """A deep copy of anything."""
    from copy import deepcopy  # most copies never come here

    return deepcopy(value, memo)


def copied_array(value: Any, memo: dict[int, Any]) -> Any:
    """A deep copy of an array.array or a numpy array, or of what a field holds in its place."""
    copied = memo.get(id(value))
    if copied is None:
        try:
            copy = value.__deepcopy__
        except AttributeError:
            return copied_other(value, memo)
        memo[id(value)] = copied = copy(memo)
    return copied


def copied_list(value: Any, element_class: type, deepcopy: DeepCopy | None, memo: dict[int, Any]) -> Any:
    """A deep copy of a list, or of what a field holds in its place.

    `deepcopy` copies elements of exactly this class; without it they cannot change and are shared.
    """
    if value.__class__ is not list:
        return copied_other(value, memo)
    copied: Any = memo.get(id(value))
    if copied is None:
        copied = memo[id(value)] = new_list()
        if deepcopy is None:
            copied += [e if e.__class__ is element_class else copied_other(e, memo) for e in value]
        else:
            copied += [(deepcopy if e.__class__ is element_class else copied_other)(e, memo) for e in value]
    return copied


def unequal(one: Any, other: Any) -> bool:
    """Whether two sequences of integers differ. A numpy array in place of one compares its elements."""
    if one.__class__ is other.__class__ is array or not (hasattr(one, "dtype") or hasattr(other, "dtype")):
        return one != other  # type: ignore[no-any-return]
    from numpy import array_equal  # a message with such a sequence has it loaded

    return not array_equal(one, other)


def copied_odd(value: Any, cls: type, memo: dict[int, Any]) -> Any:
    """A deep copy of what the copy in C found in a field for a `cls`: not exactly one."""
    if value.__class__ is not cls:  # one with checks says that it is
        return copied_other(value, memo)
    deepcopy = getattr(cls, "__deepcopy__", None)
    return deepcopy(value, memo) if deepcopy else value


def copied_odd_list(value: Any, cls: type, memo: dict[int, Any]) -> Any:
    """The same, for a field that should hold a list of `cls`."""
    return copied_list(value, cls, getattr(cls, "__deepcopy__", None), memo)


def copied_fields(message: Any) -> Any:
    """A copy of a message that shares the values of its fields."""
    copied = new_object(type(message))
    for slot in message.__slots__:
        if slot != "_check_fields" and hasattr(message, slot):
            setattr(copied, slot, getattr(message, slot))
    return copied


def repr_name(message: Any) -> str:
    """A class as the repr of its objects shows it: `geometry_msgs.msg.Pose`."""
    cls = message.__class__
    package, dot, _ = cls.__module__.rpartition(".")
    return f"{package}{dot}{cls.__name__}"


def repr_of_fields(message: Any) -> str:
    """The repr of a message that has too many fields for an expression with all of them."""
    renamed = message.__renamed__
    values = (
        (name := renamed.get(field, field), getattr(message, name))
        for field in message._fields_and_field_types
    )
    shown = (
        f"{name}={array_repr(value) if hasattr(value, 'typecode') else repr(value)}" for name, value in values
    )
    return f"{repr_name(message)}({', '.join(shown)})"


def array_repr(values: array[Any]) -> str:
    """The elements of a numeric sequence as the repr of a message shows them: `[1.0, 2.0]`."""
    return repr(values.tolist())
