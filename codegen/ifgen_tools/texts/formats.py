"""Messages as YAML and CSV, as `ros2 topic echo` prints them, and as JSON; `--field` and `--filter`.

Most messages hold nothing that YAML would have to quote. They are written here, some twenty times as fast as
PyYAML, which writes the others.
"""

from __future__ import annotations

import builtins
import json
import math
import re
import sys
from array import array
from collections.abc import Callable, Iterator
from functools import cache
from typing import Any, Final

import click
import yaml
from ifgen.command_kit.tool import ToolError, did_you_mean
from ifgen_runtime.field_types import Field, fields_of, type_name

from ifgen_tools.texts.style import WHOLE, Style

_STEP: Final = re.compile(r"(?P<name>\w+)(?:\[(?P<index>\d+)\])?")


def selector(cls: type[Any], path: str) -> Callable[[Any], Any]:
    """A function that returns the field of a message of this class.

    The function raises IndexError where a list is too short. Raises ToolError if there is no such field.
    """
    steps: list[tuple[str, int | None]] = []
    inner: type[Any] | None = cls
    for step in filter(None, path.split(".")):
        match = _STEP.fullmatch(step)
        if match is None:
            raise ToolError(f"{path!r} is no path of fields", "write it as pose.position.x, or poses[0].x")
        if inner is None:
            raise ToolError(f"there is nothing inside the field {steps[-1][0]!r}", f"leave out {step!r}")
        fields = {field.name: field for field in fields_of(inner)}
        name, index = match["name"], match["index"]
        if name not in fields:
            known = f"its fields are {', '.join(fields) or 'none'}"
            raise ToolError(
                f"{type_name(inner)} has no field {name!r}", did_you_mean(name, list(fields)) or known
            )
        steps.append((fields[name].attribute, None if index is None else int(index)))
        inner = _class_within(inner, fields[name], index)
    if not steps:
        names = ", ".join(field.name for field in fields_of(cls))
        raise ToolError(f"{path!r} names no field", f"{type_name(cls)} has {names or 'none'}")

    def select(message: Any) -> Any:
        for attribute, index in steps:
            message = getattr(message, attribute)
            if index is not None:
                message = message[index]
        return message

    return select


def _class_within(cls: type[Any], field: Field, index: str | None) -> type[Any] | None:
    """The class that the next step of a path looks into; None if there is none."""
    if index is not None and not field.is_collection:
        raise ToolError(
            f"the field {field.name!r} of {type_name(cls)} is no list", f"leave out the [{index}]"
        )
    if field.is_collection and index is None:
        return None
    return field.type if isinstance(field.type, type) else None


def condition(expression: str | None) -> Callable[[Any], bool]:
    """Whether a message, called `m` in the expression, is wanted; without an expression all are.

    Python's own names are there too, as in ROS: it is the user's own code. Raises click.UsageError if it is
    no expression; the function raises ToolError for what the expression raises.
    """
    if not expression:
        return lambda _: True
    try:
        code = compile(expression, "--filter", "eval")
    except (SyntaxError, ValueError) as error:
        raise click.UsageError(f"--filter {expression!r} is no Python expression: {error}") from None

    def holds(message: Any) -> bool:
        try:
            return bool(eval(code, {"__builtins__": builtins, "m": message}))
        except Exception as error:  # of the user's own code
            reason = f"{type(error).__name__}: {error}"
            raise ToolError(f"--filter {expression!r} failed: {reason}", "the message is called m") from None

    return holds


_PLAIN: Final = re.compile(r"[A-Za-z_/]([\w/. -]*[\w/.-])?", re.ASCII)
_RESERVED: Final = frozenset({"yes", "no", "true", "false", "on", "off", "null"})
"""Words that YAML takes for something else than text."""


def as_yaml(value: Any, style: Style = WHOLE) -> str:
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


def plain(value: Any, style: Style, field: Field | None = None) -> Any:
    """A message as nested dictionaries, or the value of a field as what YAML knows."""
    if isinstance(value, bool | int | float):
        return value
    if isinstance(value, str):
        return f"<string length: <{len(value)}>>" if style.no_str else _cut(value, style)
    if isinstance(value, bytes):
        return _cut(value.decode("latin-1"), style)
    if hasattr(value, "get_fields_and_field_types"):
        return {f.name: plain(getattr(value, f.attribute), style, f) for f in fields_of(type(value))}
    if hasattr(value, "item") and not getattr(value, "shape", ()):
        return value.item()  # a single number of numpy
    if style.no_arr and field is not None:
        return _abbreviated(len(value), field)
    is_cut = not style.fits(value)
    elements = value[: style.longest] if is_cut else value
    if isinstance(elements, array) or hasattr(elements, "tolist"):
        shown = elements.tolist()
    else:
        shown = [plain(element, style) for element in elements]
    return [*shown, "..."] if is_cut else shown


def _cut(text: str, style: Style) -> str:
    """A text that is not longer than the style allows, but for three dots."""
    return text if style.fits(text) else f"{text[: style.longest]}..."


def _abbreviated(length: int, field: Field) -> str:
    """The type and the length of an array, in its place."""
    if not field.is_sequence:
        return f"<array type: {field.element}[{field.size}]>"
    bound = "" if field.maximum is None else f"[{field.maximum}]"
    return f"<sequence type: {field.element}{bound}, length: {length}>"


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


def as_csv(message: Any, style: Style) -> str:
    """All values of a message, those of nested messages too, in the order of the definition."""
    fields = fields_of(type(message))
    return ",".join(_csv_text(getattr(message, field.attribute), style, field) for field in fields)


def _csv_text(value: Any, style: Style, field: Field | None = None) -> str:
    if isinstance(value, str):
        if style.no_str:
            return f"<string length: <{len(value)}>>"
        return _cell(_cut(value, style))
    if isinstance(value, bytes):
        return _cell(str(value if style.fits(value) else value[: style.longest] + b"..."))
    if hasattr(value, "get_fields_and_field_types"):
        return as_csv(value, style)
    if not hasattr(value, "__len__"):  # a number
        return str(value)
    if style.no_arr and field is not None:
        return _cell(_abbreviated(len(value), field))
    return ",".join(_elements(value, style))


def _cell(text: str) -> str:
    """A text as one cell of a row."""
    return '"' + text.replace('"', '""') + '"' if any(each in text for each in ',"\r\n') else text


def _elements(values: Any, style: Style) -> Iterator[str]:
    for value in values if style.fits(values) else values[: style.longest]:
        yield _csv_text(value, style)
    if not style.fits(values):
        yield "..."


def as_json(value: Any, info: Any = None) -> str:
    """A message, or the value of a field, as JSON; with its info, as the keys `info` and `message`.

    Floats that JSON cannot hold become "NaN", "Infinity" and "-Infinity", and bytes a text of one character
    each.
    """
    document = plain(value, WHOLE)
    if info is not None:
        document = {"info": dict(info), "message": document}
    try:
        return json.dumps(document, allow_nan=False, ensure_ascii=False)
    except ValueError:
        return json.dumps(_finite(document), allow_nan=False, ensure_ascii=False)


def _finite(value: Any) -> Any:
    if isinstance(value, dict):
        return {name: _finite(inner) for name, inner in value.items()}
    if isinstance(value, list):
        return [_finite(inner) for inner in value]
    if isinstance(value, float) and not math.isfinite(value):
        return "NaN" if math.isnan(value) else "Infinity" if value > 0 else "-Infinity"
    return value
