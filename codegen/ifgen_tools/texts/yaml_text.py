"""Messages as YAML, as `ros2 topic echo` prints them.

Most messages hold nothing that YAML would have to quote. They are written here, some twenty times as fast as
PyYAML, which writes the others.
"""

from __future__ import annotations

import re
import sys
from array import array
from dataclasses import dataclass
from functools import cache
from typing import Any, Final

import yaml

from ifgen_tools.texts.field_types import FieldType, field_types

_PLAIN: Final = re.compile(r"[A-Za-z_/]([\w/. -]*[\w/.-])?", re.ASCII)
_RESERVED: Final = frozenset({"yes", "no", "true", "false", "on", "off", "null"})
"""Words that YAML takes for something else than text."""


@dataclass(frozen=True, slots=True)
class Style:
    """How a message is shown.

    `longest` is the length after which arrays, strings and bytes are cut (None: never). `no_arr` and `no_str`
    put the type and the length in place of arrays and strings. `flow` writes lists in one line.
    """

    longest: int | None = None
    no_arr: bool = False
    no_str: bool = False
    flow: bool = False


def as_yaml(value: Any, style: Style = Style()) -> str:
    """A message, or a value that `plain` takes, as YAML that ends with a line break."""
    return written(plain(value, style), style)


def written(document: Any, style: Style) -> str:
    """The value that `plain` returned, as YAML that ends with a line break."""
    if not style.flow and isinstance(document, dict) and document:
        try:
            return "\n".join(_lines(document, "")) + "\n"
        except _Hard:
            pass
    text: str = yaml.dump(
        document, Dumper=_Dumper, allow_unicode=True, width=sys.maxsize, default_flow_style=style.flow
    )
    return text


def plain(value: Any, style: Style, type_: FieldType | None = None) -> Any:
    """A message as nested dictionaries, or the value of a field as what YAML knows."""
    if isinstance(value, bool | int | float):
        return value
    if isinstance(value, str):
        return f"<string length: <{len(value)}>>" if style.no_str else cut(value, style)
    if isinstance(value, bytes):
        return cut(value.decode("latin-1"), style)
    if hasattr(value, "get_fields_and_field_types"):
        types = field_types(type(value)).items()
        return {name: plain(getattr(value, field.attribute), style, field) for name, field in types}
    if hasattr(value, "item") and not getattr(value, "shape", ()):
        return value.item()  # a single number of numpy
    if style.no_arr and type_ is not None:
        return abbreviated(len(value), type_)
    is_cut = style.longest is not None and len(value) > style.longest
    elements = value[: style.longest] if is_cut else value
    if isinstance(elements, array) or hasattr(elements, "tolist"):
        shown = elements.tolist()
    else:
        shown = [plain(element, style) for element in elements]
    return [*shown, "..."] if is_cut else shown


def cut(text: str, style: Style) -> str:
    """A text that is not longer than the style allows, but for three dots."""
    if style.longest is None or len(text) <= style.longest:
        return text
    return f"{text[: style.longest]}..."


def abbreviated(length: int, type_: FieldType) -> str:
    """The type and the length of an array, in its place."""
    if type_.is_array:
        return f"<array type: {type_.element}[{type_.size}]>"
    bound = "" if type_.size is None else f"[{type_.size}]"
    return f"<sequence type: {type_.element}{bound}, length: {length}>"


class _Hard(Exception):
    """A text that YAML has to quote."""


def _lines(mapping: dict[str, Any], indent: str) -> list[str]:
    lines: list[str] = []
    for name, value in mapping.items():
        key = f"{indent}{_key(name)}:"
        if isinstance(value, dict):
            lines += [key, *_lines(value, f"{indent}  ")] if value else [f"{key} {{}}"]
        elif isinstance(value, list):
            lines += [key, *_items(value, indent)] if value else [f"{key} []"]
        else:
            lines.append(f"{key} {_scalar(value)}")
    return lines


def _items(values: list[Any], indent: str) -> list[str]:
    if not isinstance(values[0], dict):
        start = f"{indent}- "
        return [start + _scalar(value) for value in values]
    lines: list[str] = []
    for value in values:
        if isinstance(value, dict) and value:
            inner = _lines(value, f"{indent}  ")
            inner[0] = f"{indent}- {inner[0][len(indent) + 2 :]}"
            lines += inner
        else:  # an empty message, or what stands for the rest
            lines.append(f"{indent}- {{}}" if value == {} else f"{indent}- {_scalar(value)}")
    return lines


def _scalar(value: Any) -> str:
    if value.__class__ is float:
        return _float(value)
    if value.__class__ is bool:
        return "true" if value else "false"
    if value.__class__ is int:
        return str(value)
    if value == "":
        return "''"
    if value == "...":
        return "'...'"
    if _PLAIN.fullmatch(value) and value.lower() not in _RESERVED:
        return str(value)
    raise _Hard


def _float(value: float) -> str:
    text = repr(value)
    if "e" in text and "." not in text:
        return text.replace("e", ".0e")
    if text[-1] in "fn":
        return {"inf": ".inf", "-inf": "-.inf"}.get(text, ".nan")
    return text


@cache
def _key(name: str) -> str:
    return f"'{name}'" if name.lower() in _RESERVED else name


class _Dumper(yaml.SafeDumper):
    """Writes dictionaries in their order, and in several lines also where lists take one, as ROS does."""

    def represent_fields(self, data: dict[str, Any]) -> yaml.MappingNode:
        items = [(self.represent_data(key), self.represent_data(value)) for key, value in data.items()]
        return yaml.MappingNode("tag:yaml.org,2002:map", items)


_Dumper.add_representer(dict, _Dumper.represent_fields)
