"""`ifgen param dump` and `load`."""

from __future__ import annotations

import json
import sys
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any, cast

from ifgen_tools.errors import ToolError
from ifgen_tools.nodes import find_node
from ifgen_tools.param.remote import RemoteParameters, SetResult
from ifgen_tools.param.values import check_integers, finish, value_of
from ifgen_tools.session import TransportChoice, open_session

if TYPE_CHECKING:
    from rcl_interfaces.msg import Parameter

# Late imports: rclpy is found once the transport has been chosen.

_WILDCARD = "/**"
_KEY = "ros__parameters"


def dump_parameters(
    *,
    node: str,
    transport: TransportChoice = "auto",
    spin_time: float | None = None,
    include_hidden: bool = True,
    patience: float | None = None,
    as_json: bool = False,
    use_sim_time: bool = False,
) -> int:
    """Print all parameters of a node in the form of a parameter file."""
    import yaml

    with open_session(transport, use_sim_time=use_sim_time) as session:
        remote = RemoteParameters(session, find_node(session, node, spin_time), patience)
        names = remote.names()
        values = remote.values(names) if names else {}
    tree: dict[str, Any] = {}
    for name in names:
        if name in values:  # one without a value cannot be loaded either
            _put(tree, name, value_of(values[name]))
    document = {remote.node: {_KEY: tree}}
    print(json.dumps(document, indent=2) if as_json else yaml.dump(document, default_flow_style=False))
    return 0


def load_parameters(
    *,
    node: str,
    file: str,
    transport: TransportChoice = "auto",
    spin_time: float | None = None,
    include_hidden: bool = True,
    no_use_wildcard: bool = False,
    patience: float | None = None,
    as_json: bool = False,
    use_sim_time: bool = False,
) -> int:
    """Set the parameters that a file has for a node. Returns 1 if the node has refused one."""
    content = _read(Path(file))
    with open_session(transport, use_sim_time=use_sim_time) as session:
        remote = RemoteParameters(session, find_node(session, node, spin_time), patience)
        values = _selected(content, file, remote.node, not no_use_wildcard)
        results = _load(remote, values, file)
    if not as_json:
        for result in results:
            text = f"Set parameter {result.name} {'successful' if result.successful else 'failed'}"
            stream = sys.stdout if result.successful else sys.stderr
            print(f"{text}: {result.reason}" if result.reason else text, file=stream)
    return finish(results, as_json)


def _load(remote: RemoteParameters, values: Mapping[str, Any], file: str) -> list[SetResult]:
    """Set parameters, but for read-only ones that have their values already, as after a `dump`."""
    known = set(remote.names())
    found = remote.descriptors([name for name in values if name in known])
    types = {descriptor.name: descriptor.type for descriptor in found}
    fixed = remote.values([descriptor.name for descriptor in found if descriptor.read_only])
    parameters = [_parameter(name, value, types.get(name, 0), file) for name, value in values.items()]
    kept = [each.name for each in parameters if fixed.get(each.name) == each.value]
    results = remote.set([each for each in parameters if each.name not in kept])
    return [*(SetResult(name, True, "it is read-only and has this value") for name in kept), *results]


def _parameter(name: str, value: Any, type_: int, file: str) -> Parameter:
    """The message of a value in a file; its type tells what an empty list or a list of bytes is."""
    from rclpy import parameter

    kind = parameter.Parameter.Type(type_) if value == [] and type_ else None
    if type_ == parameter.Parameter.Type.BYTE_ARRAY.value and isinstance(value, list):
        value = [bytes([each]) if each in range(256) else each for each in value]
    try:
        message = parameter.Parameter(name, kind, value).to_parameter_msg()
    except (AssertionError, OverflowError, TypeError, ValueError) as error:
        raise ToolError(f"{file}: the value {value!r} of {name!r} fits no parameter: {error}") from None
    check_integers(name, message.value)
    return message


def _put(tree: dict[str, Any], name: str, value: Any) -> None:
    """Put a value under its name, whose parts are keys within each other."""
    first, dot, rest = name.partition(".")
    if not dot:
        tree[name] = value
    elif isinstance(inner := tree.setdefault(first, {}), dict):
        _put(cast("dict[str, Any]", inner), rest, value)
    else:  # there is a parameter `a` and another one `a.b`
        tree[name] = value


def _read(file: Path) -> Mapping[str, Any]:
    from ifgen_runtime import yaml_text

    try:
        content = yaml_text.read(file.read_text(encoding="utf-8"))
    except OSError as error:
        raise ToolError(f"{file} cannot be read: {error.strerror}") from None
    except UnicodeDecodeError as error:
        raise ToolError(f"{file} is no text in UTF-8: {error.reason} at byte {error.start}") from None
    except yaml_text.YamlError as error:
        raise ToolError(f"{file} is no YAML: {error}") from None
    if not isinstance(content, Mapping):
        raise ToolError(
            f"{file} is no parameter file", f"it begins with the name of a node, and {_KEY!r} below it"
        )
    return cast("Mapping[str, Any]", content)


def _selected(content: Mapping[str, Any], file: str, node: str, use_wildcard: bool) -> dict[str, Any]:
    """The parameters of a node; its own come after those of the wildcard, which they replace."""
    sections = dict(_sections("", content))
    wanted = [_WILDCARD] if use_wildcard and _WILDCARD in sections else []
    wanted += [node] if node in sections else []
    if not wanted:
        held = ", ".join(sections) or "none"
        raise ToolError(f"{file} has no parameters for {node!r}", f"it has parameters for: {held}")
    return {name: value for key in wanted for name, value in _flat("", sections[key])}


def _sections(namespace: str, content: Mapping[str, Any]) -> Iterator[tuple[str, Mapping[str, Any]]]:
    """The parameters of each node in a file, whose name may be split into namespaces."""
    for key, value in content.items():
        name = f"{namespace}/{str(key).strip('/')}"
        if not isinstance(value, Mapping):
            continue
        section = cast("Mapping[str, Any]", value)
        parameters = section.get(_KEY)
        if isinstance(parameters, Mapping):
            yield name, cast("Mapping[str, Any]", parameters)
        elif _KEY not in section:
            yield from _sections(name, section)


def _flat(prefix: str, tree: Mapping[str, Any]) -> Iterator[tuple[str, Any]]:
    for key, value in tree.items():
        if isinstance(value, Mapping):
            yield from _flat(f"{prefix}{key}.", cast("Mapping[str, Any]", value))
        else:
            yield f"{prefix}{key}", value
