# Messages are Any.
# pyright: reportUnknownArgumentType=false, reportUnknownLambdaType=false
# pyright: reportUnknownMemberType=false, reportUnknownVariableType=false
"""Messages as ordered dicts, as YAML and as CSV."""

from __future__ import annotations

import sys
from array import array
from collections import OrderedDict
from dataclasses import dataclass
from typing import Any

import yaml

__all__ = ["get_message_slot_types", "message_to_csv", "message_to_ordereddict", "message_to_yaml"]


@dataclass(frozen=True, slots=True)
class _Style:
    """The part of a message that is shown: texts and arrays up to a length, or none of them."""

    longest: int | None
    no_arr: bool
    no_str: bool

    def cut(self, text: str) -> str:
        """Return a text, or its beginning and three dots."""
        if self.no_str:
            return f"<string length: <{len(text)}>>"
        return text if self.longest is None or len(text) <= self.longest else f"{text[: self.longest]}..."


class _Dumper(yaml.Dumper):
    """Writes ordered dicts as mappings, in their order."""


_Dumper.add_representer(
    OrderedDict,
    lambda dumper, data: yaml.MappingNode(
        "tag:yaml.org,2002:map",
        [(dumper.represent_data(key), dumper.represent_data(value)) for key, value in data.items()],
    ),
)


def message_to_yaml(
    msg: Any,
    *,
    truncate_length: int | None = None,
    no_arr: bool = False,
    no_str: bool = False,
    flow_style: bool = False,
) -> str:
    """Return a message as YAML.

    :param truncate_length: The number of characters of texts, and of elements of arrays, to show.
    :param no_arr: Show only the types and the lengths of arrays.
    :param no_str: Show only the lengths of texts.
    :param flow_style: Write one line.
    """
    shown = message_to_ordereddict(msg, truncate_length=truncate_length, no_arr=no_arr, no_str=no_str)
    text: str = yaml.dump(
        shown, Dumper=_Dumper, allow_unicode=True, width=sys.maxsize, default_flow_style=flow_style
    )
    return text


def message_to_csv(
    msg: Any, *, truncate_length: int | None = None, no_arr: bool = False, no_str: bool = False
) -> str:
    """Return the values of a message with commas between them; the arguments are those of message_to_yaml."""
    style = _Style(truncate_length, no_arr, no_str)
    return ",".join(
        _csv(getattr(msg, name), style, slot_type) for name, slot_type in get_message_slot_types(msg).items()
    )


def message_to_ordereddict(
    msg: Any, *, truncate_length: int | None = None, no_arr: bool = False, no_str: bool = False
) -> OrderedDict[str, Any]:
    """Return the values of a message by the names of its fields, as message_to_yaml shows them."""
    style = _Style(truncate_length, no_arr, no_str)
    return OrderedDict(
        (name, _plain(getattr(msg, name, None), style, slot_type))
        for name, slot_type in get_message_slot_types(msg).items()
    )


def get_message_slot_types(msg: Any) -> OrderedDict[str, Any]:
    """Return the types of the fields by their names: objects of rosidl_parser.definition."""
    return OrderedDict(zip(msg.get_fields_and_field_types(), msg.SLOT_TYPES, strict=True))


def _plain(value: Any, style: _Style, slot_type: Any = None) -> Any:
    if isinstance(value, bytes):
        return _Style(style.longest, no_arr=False, no_str=False).cut(value.decode("latin-1"))
    if isinstance(value, str):
        return style.cut(value)
    if isinstance(value, bool | float | int):
        return value
    if _is_array(value):
        return _list(value, style, slot_type)
    if isinstance(value, dict):
        return type(value)((_plain(key, _WHOLE), _plain(each, style)) for key, each in value.items())
    if hasattr(value, "item"):  # a number of numpy
        return value.item()
    return message_to_ordereddict(
        value, truncate_length=style.longest, no_arr=style.no_arr, no_str=style.no_str
    )


_WHOLE = _Style(None, no_arr=False, no_str=False)


def _list(value: Any, style: _Style, slot_type: Any) -> Any:
    if style.no_arr and slot_type is not None:
        return _abbreviated(value, slot_type)
    is_cut = style.longest is not None and len(value) > style.longest
    shown = [_plain(each, style) for each in (value[: style.longest] if is_cut else value)]
    whole = [*shown, "..."] if is_cut else shown
    return tuple(whole) if isinstance(value, tuple) else whole


def _csv(value: Any, style: _Style, slot_type: Any = None) -> str:
    if isinstance(value, bytes):
        is_cut = style.longest is not None and len(value) > style.longest
        return str(value[: style.longest] + b"..." if is_cut else value)
    if isinstance(value, str):
        return style.cut(value)
    if _is_array(value):
        if style.no_arr and slot_type is not None:
            return _abbreviated(value, slot_type)
        is_cut = style.longest is not None and len(value) > style.longest
        shown = [_csv(each, style) for each in (value[: style.longest] if is_cut else value)]
        return ",".join([*shown, "..."] if is_cut else shown)
    if isinstance(value, bool | float | int) or hasattr(value, "item"):
        return str(value)
    return message_to_csv(value, truncate_length=style.longest, no_arr=style.no_arr, no_str=style.no_str)


def _is_array(value: Any) -> bool:
    # By its name: whoever has no numpy has no array of it, either.
    return isinstance(value, list | tuple | array) or type(value).__name__ == "ndarray"


def _abbreviated(value: Any, slot_type: Any) -> str:
    element = _type_name(slot_type.value_type)
    if hasattr(slot_type, "size"):
        return f"<array type: {element}[{slot_type.size}]>"
    bound = f"[{slot_type.maximum_size}]" if hasattr(slot_type, "maximum_size") else ""
    return f"<sequence type: {element}{bound}, length: {len(value)}>"


def _type_name(value_type: Any) -> str:
    if hasattr(value_type, "typename"):
        return str(value_type.typename)
    if hasattr(value_type, "namespaced_name"):
        return "/".join(value_type.namespaced_name())
    return "wstring" if "WString" in type(value_type).__name__ else "string"
