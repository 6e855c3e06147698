"""`ifgen param get`, `set` and `delete`."""

from __future__ import annotations

import json
import sys
from array import array
from collections.abc import Sequence
from dataclasses import asdict
from typing import TYPE_CHECKING, Any, Final

from ifgen_runtime import parameter_yaml
from ifgen_runtime.parameter_scalars import Value

from ifgen_tools.errors import ToolError
from ifgen_tools.graph.lookup import find_node
from ifgen_tools.param.remote import TYPES, RemoteParameters, SetResult
from ifgen_tools.session import TransportChoice, open_session
from ifgen_tools.texts.set_fields import shown, text_problem

if TYPE_CHECKING:
    from rcl_interfaces.msg import Parameter, ParameterValue

# Late imports: rclpy is found once the transport has been chosen.

_FIELDS: Final = {
    1: "bool_value",
    2: "integer_value",
    3: "double_value",
    4: "string_value",
    5: "byte_array_value",
    6: "bool_array_value",
    7: "integer_array_value",
    8: "double_array_value",
    9: "string_array_value",
}


def value_of(message: ParameterValue) -> Value | bytes:
    """The value in a rcl_interfaces/msg/ParameterValue; None if it is not set."""
    if message.type not in _FIELDS:
        return None
    value: Any = getattr(message, _FIELDS[message.type])
    if message.type == _BYTES:
        return b"".join(value)
    return list(value) if message.type > _BYTES else value


def json_value(message: ParameterValue) -> Any:
    """The value as JSON has it: bytes are a list of int."""
    value = value_of(message)
    return list(value) if isinstance(value, bytes) else value


def get_parameter(
    *,
    node: str,
    name: str,
    transport: TransportChoice = "auto",
    spin_time: float | None = None,
    include_hidden: bool = True,
    hide_type: bool = False,
    patience: float | None = None,
    as_json: bool = False,
    use_sim_time: bool = False,
) -> int:
    """Print a value, after the name of its type."""
    with open_session(transport, use_sim_time=use_sim_time) as session:
        remote = RemoteParameters(session, find_node(session, node, spin_time), patience)
        found = remote.values([name])
        if name not in found:
            raise remote.missing(name)
    message = found[name]
    if as_json:
        parts = {"node": remote.node, "name": name, "type": TYPES[message.type], "value": json_value(message)}
        print(json.dumps(parts))
    elif message.type not in _FIELDS:
        print("None" if hide_type else "Parameter not set.")
    else:
        print(_text(message) if hide_type else f"{_label(message.type)} {_text(message)}")
    return 0


def set_parameters(
    *,
    node: str,
    pairs: Sequence[tuple[str, str]],
    transport: TransportChoice = "auto",
    spin_time: float | None = None,
    include_hidden: bool = True,
    atomic: bool = False,
    patience: float | None = None,
    as_json: bool = False,
    use_sim_time: bool = False,
) -> int:
    """Set parameters to values, which are YAML. Returns 1 if the node has refused one."""
    values = [(name, _read(name, text)) for name, text in pairs]
    with open_session(transport, use_sim_time=use_sim_time) as session:
        remote = RemoteParameters(session, find_node(session, node, spin_time), patience)
        # Only these depend on the declared type.
        unclear = [name for name, value in values if value is None or isinstance(value, list)]
        found = remote.known_descriptors(unclear) if unclear else {}
        types = {name: descriptor.type for name, descriptor in found.items()}
        parameters = [parameter_of(name, value, types.get(name, 0)) for name, value in values]
        results = remote.set_atomically(parameters) if atomic else remote.set(parameters)
        advice = [] if all(each.successful for each in results) else _advice(remote, parameters, results)
    if atomic and not as_json:
        _print(results[0], "Set parameters atomically successful", "Setting parameters atomically failed")
    elif not as_json:
        for result in results:
            prefix = f"{result.name}: " if len(results) > 1 else ""
            _print(result, f"{prefix}Set parameter successful", f"{prefix}Setting parameter failed")
    return finish(results, as_json, advice)


def delete_parameter(
    *,
    node: str,
    name: str,
    transport: TransportChoice = "auto",
    spin_time: float | None = None,
    include_hidden: bool = True,
    patience: float | None = None,
    as_json: bool = False,
    use_sim_time: bool = False,
) -> int:
    """Set a parameter to no value, which deletes it. Returns 1 if the node has refused that."""
    with open_session(transport, use_sim_time=use_sim_time) as session:
        from rcl_interfaces.msg import Parameter

        remote = RemoteParameters(session, find_node(session, node, spin_time), patience)
        if name not in remote.names():
            raise remote.missing(name)
        results = remote.set([Parameter(name=name)])
    if not as_json:
        _print(results[0], "Deleted parameter successfully", "Deleting parameter failed")
    return finish(results, as_json)


def finish(results: Sequence[SetResult], as_json: bool, advice: Sequence[str] = ()) -> int:
    """Print results as JSON if that is wanted, and advice; returns the exit code."""
    if as_json:
        print(json.dumps([asdict(each) for each in results], indent=2))
    for line in advice:
        print(f"  = help: {line}", file=sys.stderr)
    return 0 if all(each.successful for each in results) else 1


def _print(result: SetResult, success: str, failure: str) -> None:
    text = success if result.successful else failure
    file = sys.stdout if result.successful else sys.stderr
    print(f"{text}: {result.reason}" if result.reason else text, file=file)


def _label(type_: int) -> str:
    """The words that ROS writes before a value: `Integer value is:`, `Double values are:`."""
    kind, *is_array = TYPES[type_].capitalize().split()
    return f"{kind} values are:" if is_array else f"{kind} value is:"


def _text(message: ParameterValue) -> str:
    """A value as `ros2 param get` prints it, which is as Python does."""
    value: Any = getattr(message, _FIELDS[message.type])
    # Our messages have arrays where those of rosidl have arrays, and both print these alike.
    return str(value if isinstance(value, array) else list(value) if message.type > 4 else value)


def _read(name: str, text: str) -> Value:
    """The value that a text stands for, as `-p name:=text` has it; an empty one is an empty text."""
    try:
        return parameter_yaml.value_of(text) if text else ""
    except parameter_yaml.ParameterYamlError as error:
        raise ToolError(
            f"the value {shown(text)} of {name!r} fits no parameter: {error.reason}", _QUOTES
        ) from None


_QUOTES: Final = "put a text in quotes of YAML within those of the shell, such as '\"a: b\"'"


def parameter_of(name: str, value: Value, declared: int) -> Parameter:
    """The message of a parameter that has a value as rcl reads it; None is an empty list.

    The type that the node has declared, or 0, says what an empty list and a list of bytes are. Raises
    ToolError.
    """
    from rcl_interfaces.msg import Parameter, ParameterValue

    type_ = declared if value is None and declared in _ELEMENTS else _TYPES_OF.get(type(value), 0)
    converted: Any = [] if value is None else value
    if isinstance(value, list):
        type_ = next(array for array, kind in _ELEMENTS.items() if isinstance(value[0], kind))
        if declared == _BYTES and type_ == _INTEGERS:
            if wrong := [each for each in value if each not in range(256)]:
                raise ToolError(f"the value {wrong[0]} in {name!r} fits no byte", "bytes are 0 to 255")
            type_, converted = _BYTES, [bytes([each]) for each in value]
    if problem := text_problem(name):
        raise ToolError(f"{name!r} can be no name of a parameter: {problem}")
    for text in converted if isinstance(converted, list) else [converted]:
        if isinstance(text, str) and (problem := text_problem(text)):
            raise ToolError(f"the value of {name!r} fits no parameter: {problem}")
    message = ParameterValue(type=type_ or _EMPTY)
    setattr(message, _FIELDS[message.type], converted)
    return Parameter(name=name, value=message)


_BYTES: Final = 5
_EMPTY: Final = 6  # what rclpy makes of an empty list
_INTEGERS: Final = 7
_TYPES_OF: Final[dict[type, int]] = {bool: 1, int: 2, float: 3, str: 4}
_ELEMENTS: Final[dict[int, type]] = {6: bool, 7: int, 8: float, 9: str, 5: bytes}
"""The types of elements of arrays; a bool is an int, so it comes first."""


def _advice(remote: RemoteParameters, parameters: Sequence[Any], results: Sequence[SetResult]) -> list[str]:
    """Advice where a value has another type than its parameter."""
    known = remote.names()
    lines: list[str] = []
    for parameter, result in zip(parameters, results, strict=True):
        if result.successful:
            continue
        if parameter.name not in known:
            lines.append(remote.near(parameter.name, known))
            continue
        type_ = remote.types([parameter.name]).get(parameter.name, 0)
        if type_ not in {0, parameter.value.type}:
            lines.append(
                f"{parameter.name!r} has the type {TYPES[type_]}: write a value such as {_EXAMPLES[type_]}"
            )
    return lines


_EXAMPLES: Final = {
    1: "true",
    2: "1, of 64 bits",
    3: "1.0",
    4: "\"'1'\"",
    5: "'[1, 255]'",
    6: "'[true, false]'",
    7: "'[1, 2]'",
    8: "'[1.0, 2.0]'",
    9: "'[a, b]'",
}
"""A value of each type as it is written in a shell."""
