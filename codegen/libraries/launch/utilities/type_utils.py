# Values that users write are Any.
# pyright: reportUnknownArgumentType=false, reportUnknownVariableType=false, reportUnnecessaryIsInstance=false
"""Types of values in launch files: texts that stand for them, and substitutions that make such texts.

A type is int, float, bool or str, a list of one of them, or None: whichever the text stands for in YAML.
"""

from __future__ import annotations

import typing
from collections.abc import Iterable
from typing import TYPE_CHECKING, Any, Final

from launch.substitution import Substitution
from launch.utilities import normalize_to_list_of_substitutions, perform_substitutions

if TYPE_CHECKING:
    from launch.launch_context import LaunchContext

ScalarTypesTuple: Final = (int, float, bool, str)
_BARE_LIST: Final = typing.List  # noqa: UP006 - what programs write, which is not `list`

__all__ = [
    "ScalarTypesTuple",
    "coerce_list",
    "coerce_to_type",
    "extract_type",
    "get_typed_value",
    "is_instance_of",
    "is_instance_of_valid_type",
    "is_normalized_substitution",
    "is_substitution",
    "is_typing_list",
    "is_valid_scalar_type",
    "normalize_typed_substitution",
    "perform_typed_substitution",
]


def is_typing_list(data_type: Any) -> bool:
    """Whether a type is `List`, or a list of something."""
    return data_type is _BARE_LIST or typing.get_origin(data_type) is list


def is_valid_scalar_type(data_type: Any) -> bool:
    """Whether a type is int, float, bool or str."""
    return data_type in ScalarTypesTuple


def extract_type(data_type: Any) -> tuple[type, bool]:
    """Return the type of a value or of a list's elements, and whether it is a list. Raises ValueError."""
    is_list = is_typing_list(data_type)
    scalar: Any = (*typing.get_args(data_type), None)[0] if is_list else data_type
    if not is_valid_scalar_type(scalar):
        raise ValueError(f"expected int, float, bool, str, or a List of one of them, got {data_type!r}")
    return scalar, is_list


def is_instance_of_valid_type(value: Any, *, can_be_str: bool = False) -> bool:
    """Whether a value is of one of the types. With `can_be_str`, elements of a list may be texts as well."""
    if not isinstance(value, list):
        return isinstance(value, ScalarTypesTuple)
    kinds = {type(each) for each in value}
    if can_be_str and len(kinds) > 1:
        kinds.discard(str)
    return len(kinds) == 1 and kinds <= set(ScalarTypesTuple)


def is_instance_of(value: Any, data_type: Any, can_be_str: bool = False) -> bool:
    """Whether a value is of a type, or may be a text in its place. Raises ValueError for another type."""
    if data_type is None:
        return is_instance_of_valid_type(value, can_be_str=can_be_str)
    scalar, is_list = extract_type(data_type)
    allowed = {scalar, str} if can_be_str else {scalar}
    if is_list:
        return isinstance(value, list) and all(type(each) in allowed for each in value)
    return type(value) in allowed


def coerce_to_type(value: str, data_type: Any = None, can_be_str: bool = False) -> Any:
    """Return what a text stands for; with `can_be_str`, a text that stands for none remains.

    Raises TypeError for what is no text, ValueError for a text of another type.
    """
    if not isinstance(value, str):
        raise TypeError(f"expected a text, got {value!r}")
    if data_type is str:
        return value
    if data_type is not None:
        extract_type(data_type)
    read = _read(value, can_be_str=can_be_str)
    if data_type is float and type(read) is int:
        return float(read)
    if is_instance_of(read, data_type, can_be_str):
        return read
    if can_be_str and not is_typing_list(data_type):
        return value
    wanted = "int, float, bool, str or a list of one of them" if data_type is None else repr(data_type)
    raise ValueError(f"the text {value!r} stands for no {wanted}")


def _read(text: str, *, can_be_str: bool) -> Any:
    import yaml  # few launch files need it

    try:
        return yaml.safe_load(text)
    except yaml.YAMLError as error:
        if can_be_str:
            return text
        raise ValueError(f"the text {text!r} is no YAML: {error}") from None


def coerce_list(value: list[str], data_type: Any = None, can_be_str: bool = False) -> list[Any]:
    """Return what the texts of a list stand for. Raises TypeError and ValueError as `coerce_to_type`."""
    if not isinstance(value, list) or not all(isinstance(each, str) for each in value):
        raise TypeError(f"expected a list of texts, got {value!r}")
    found = [coerce_to_type(each, data_type, can_be_str) for each in value]
    if data_type is None and not is_instance_of_valid_type(found, can_be_str=can_be_str):
        raise ValueError(f"the elements of {value!r} stand for several types")
    return found


def get_typed_value(value: str | list[str], data_type: Any, can_be_str: bool = False) -> Any:
    """Return what a text, or a list of texts, stands for. Raises TypeError and ValueError."""
    if not isinstance(value, list):
        return coerce_to_type(value, data_type, can_be_str)
    if data_type is None:
        return coerce_list(value, None, can_be_str)
    scalar, is_list = extract_type(data_type)
    if not is_list:
        raise TypeError(f"a list of texts can be no {data_type!r}: {value!r}")
    return coerce_list(value, scalar, can_be_str)


def is_substitution(value: Any) -> bool:
    """Whether a value is a substitution, or several things that are put together and one of which is one."""
    if isinstance(value, Substitution):
        return True
    if isinstance(value, str) or not isinstance(value, Iterable):
        return False
    parts = list(value)
    has_one = any(isinstance(each, Substitution) for each in parts)
    return has_one and all(isinstance(each, str | Substitution) for each in parts)


def is_normalized_substitution(value: Any) -> bool:
    """Whether a value is a list of substitutions, as `normalize_to_list_of_substitutions` makes it."""
    return isinstance(value, list) and bool(value) and all(isinstance(each, Substitution) for each in value)


def normalize_typed_substitution(value: Any, data_type: Any) -> Any:
    """Return a value with each substitution as a list. Raises TypeError for a value of another type."""
    if is_substitution(value):
        return normalize_to_list_of_substitutions(value)
    if isinstance(value, list) and any(is_substitution(each) for each in value):
        plain = [each for each in value if not is_substitution(each)]
        if data_type is not None and not extract_type(data_type)[1]:
            raise TypeError(f"expected {data_type!r}, got the list {value!r}")
        if plain and not is_instance_of(plain, data_type, can_be_str=True):
            raise TypeError(f"expected elements of {data_type!r}, got {value!r}")
        return [normalize_to_list_of_substitutions(each) if is_substitution(each) else each for each in value]
    if not is_instance_of(value, data_type):
        raise TypeError(f"expected {data_type!r} or a substitution, got {value!r}")
    return value


def perform_typed_substitution(context: LaunchContext, value: Any, data_type: Any) -> Any:
    """Return what a value of `normalize_typed_substitution` stands for. Raises TypeError and ValueError."""
    if is_normalized_substitution(value):
        return get_typed_value(perform_substitutions(context, value), data_type)
    if not isinstance(value, list) or not any(is_normalized_substitution(each) for each in value):
        return value
    scalar = None if data_type is None else extract_type(data_type)[0]
    found = [
        coerce_to_type(perform_substitutions(context, each), scalar)
        if is_normalized_substitution(each)
        else each
        for each in value
    ]
    if not is_instance_of(found, data_type):
        raise ValueError(f"expected {data_type!r}, got {found!r}")
    return found
