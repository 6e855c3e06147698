"""`ifgen param set`, `delete` and `load`."""

from __future__ import annotations

import json
import sys
from collections.abc import Mapping, Sequence
from dataclasses import asdict
from typing import TYPE_CHECKING, Any, Final

from ifgen.command_kit.tool import ToolError
from ifgen_runtime.parameters import parameter_yaml
from ifgen_runtime.parameters.parameter_scalars import Value

from ifgen_tools.param.client import BYTES, FIELDS, TYPES, RemoteParameters, SetResult
from ifgen_tools.param.options import GetOptions, LoadOptions, SetOptions
from ifgen_tools.param.show import opened
from ifgen_tools.texts.set_fields import shown, text_problem

if TYPE_CHECKING:
    from rcl_interfaces.msg import Parameter

# Late imports: rclpy is found once the transport has been chosen.


def set_parameters(chosen: SetOptions) -> int:
    """Set parameters to values, which are YAML. Returns 1 if the node has refused one."""
    pairs = zip(chosen.pairs[::2], chosen.pairs[1::2], strict=True)
    values = [(name, _read(name, text)) for name, text in pairs]
    with opened(chosen) as remote:
        # Only these depend on the declared type.
        unclear = [name for name, value in values if value is None or isinstance(value, list)]
        found = remote.known_descriptors(unclear) if unclear else {}
        types = {name: descriptor.type for name, descriptor in found.items()}
        parameters = [_parameter(name, value, types.get(name, 0)) for name, value in values]
        results = remote.set_atomically(parameters) if chosen.atomic else remote.set(parameters)
        advice = [] if all(each.successful for each in results) else _advice(remote, parameters, results)
    if chosen.atomic and not chosen.as_json:
        _print(results[0], "Set parameters atomically successful", "Setting parameters atomically failed")
    elif not chosen.as_json:
        for result in results:
            prefix = f"{result.name}: " if len(results) > 1 else ""
            _print(result, f"{prefix}Set parameter successful", f"{prefix}Setting parameter failed")
    return _finish(results, chosen.as_json, advice)


def delete_parameter(chosen: GetOptions) -> int:
    """Set a parameter to no value, which deletes it. Returns 1 if the node has refused that."""
    with opened(chosen) as remote:
        from rcl_interfaces.msg import Parameter

        if chosen.name not in remote.names():
            raise remote.missing(chosen.name)
        results = remote.set([Parameter(name=chosen.name)])
    if not chosen.as_json:
        _print(results[0], "Deleted parameter successfully", "Deleting parameter failed")
    return _finish(results, chosen.as_json)


def load_parameters(chosen: LoadOptions) -> int:
    """Set the parameters that a file has for a node. Returns 1 if the node has refused one."""
    sections = _sections(chosen.file)
    with opened(chosen) as remote:
        results = _load(remote, _selected(sections, chosen, remote.node))
    if not chosen.as_json:
        for result in results:
            name = f"Set parameter {result.name}"
            _print(result, f"{name} successful", f"{name} failed")
    return _finish(results, chosen.as_json)


def _load(remote: RemoteParameters, values: Mapping[str, Value]) -> list[SetResult]:
    """Set parameters, but for read-only ones that have their values already, as after a `dump`."""
    found = remote.known_descriptors(list(values))
    fixed = remote.values([name for name, descriptor in found.items() if descriptor.read_only])
    types = {name: descriptor.type for name, descriptor in found.items()}
    parameters = [_parameter(name, value, types.get(name, 0)) for name, value in values.items()]
    # Compared as texts: a NaN is not equal to itself.
    kept = [each.name for each in parameters if repr(fixed.get(each.name)) == repr(each.value)]
    results = remote.set([each for each in parameters if each.name not in kept])
    return [*(SetResult(name, True, "it is read-only and has this value") for name in kept), *results]


def _sections(file: str) -> dict[str, dict[str, Value]]:
    """The parameters in a file by the full names of nodes, or by patterns. Raises ToolError."""
    found: dict[str, parameter_yaml.Entry] = {}
    try:
        parameter_yaml.read_file(file, lambda node: found.setdefault(node, {}), everything=True)
    except parameter_yaml.ParameterYamlError as error:
        is_about_form = error.reason == str(error).strip()
        raise ToolError(f"{file}: {error.reason}", _FORM if is_about_form else "") from None
    if not found:
        raise ToolError(f"{file} is no parameter file", _FORM)
    sections: dict[str, dict[str, Value]] = {}
    for node, entry in found.items():
        section = sections.setdefault(f"/{node.strip('/')}", {})
        section.update({name: variant.value() for name, variant in entry.items()})
    return sections


_FORM: Final = f"it begins with the name of a node, and {parameter_yaml.PARAMETERS_KEY!r} below it"


def _selected(sections: dict[str, dict[str, Value]], chosen: LoadOptions, node: str) -> dict[str, Value]:
    """The parameters of a node; its own come after those of the wildcard, which they replace."""
    wanted = [_WILDCARD] if not chosen.no_use_wildcard and _WILDCARD in sections else []
    wanted += [node] if node in sections else []
    if not wanted:
        raise ToolError(
            f"{chosen.file} has no parameters for {node!r}", f"it has parameters for: {', '.join(sections)}"
        )
    return {name: value for key in wanted for name, value in sections[key].items()}


_WILDCARD: Final = "/**"


def _finish(results: Sequence[SetResult], as_json: bool, advice: Sequence[str] = ()) -> int:
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


def _read(name: str, text: str) -> Value:
    """The value that a text stands for, as `-p name:=text` has it; an empty one is an empty text."""
    try:
        return parameter_yaml.value_of(text) if text else ""
    except parameter_yaml.ParameterYamlError as error:
        raise ToolError(
            f"the value {shown(text)} of {name!r} fits no parameter: {error.reason}", _QUOTES
        ) from None


_QUOTES: Final = "put a text in quotes of YAML within those of the shell, such as '\"a: b\"'"


def _parameter(name: str, value: Value, declared: int) -> Parameter:
    """The message of a parameter that has a value as rcl reads it; None is an empty list.

    The type that the node has declared, or 0, says what an empty list and a list of bytes are. Raises
    ToolError.
    """
    from rcl_interfaces.msg import Parameter, ParameterValue

    type_ = declared if value is None and declared in _ELEMENTS else _TYPES_OF.get(type(value), 0)
    converted: Any = [] if value is None else value
    if isinstance(value, list):
        type_ = next(array for array, kind in _ELEMENTS.items() if isinstance(value[0], kind))
        if declared == BYTES and type_ == _INTEGERS:
            if wrong := [each for each in value if each not in range(256)]:
                raise ToolError(f"the value {wrong[0]} in {name!r} fits no byte", "bytes are 0 to 255")
            type_, converted = BYTES, [bytes([each]) for each in value]
    if problem := text_problem(name):
        raise ToolError(f"{name!r} can be no name of a parameter: {problem}")
    for text in converted if isinstance(converted, list) else [converted]:
        if isinstance(text, str) and (problem := text_problem(text)):
            raise ToolError(f"the value of {name!r} fits no parameter: {problem}")
    message = ParameterValue(type=type_ or _EMPTY)
    setattr(message, FIELDS[message.type], converted)
    return Parameter(name=name, value=message)


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
