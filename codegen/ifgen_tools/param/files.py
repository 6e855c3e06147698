"""`ifgen param dump` and `load`."""

from __future__ import annotations

import json
import sys
from collections.abc import Mapping
from typing import Final

from ifgen_runtime import parameter_yaml
from ifgen_runtime.parameter_scalars import Value

from ifgen_tools.errors import ToolError
from ifgen_tools.graph.lookup import find_node
from ifgen_tools.param.remote import RemoteParameters, SetResult
from ifgen_tools.param.values import finish, json_value, parameter_of, value_of
from ifgen_tools.session import TransportChoice, open_session

_WILDCARD = "/**"


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
    with open_session(transport, use_sim_time=use_sim_time) as session:
        remote = RemoteParameters(session, find_node(session, node, spin_time), patience)
        names = remote.names()
        found = remote.values(names) if names else {}
    values = {name: value for name, value in found.items() if value.type}  # the others have none
    if as_json:
        tree = parameter_yaml.nested({name: json_value(value) for name, value in values.items()})
        print(json.dumps({remote.node: {parameter_yaml.PARAMETERS_KEY: tree}}, indent=2))
    else:
        plain = {name: value_of(value) for name, value in values.items()}
        print(parameter_yaml.file_text(remote.node, plain))
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
    content = _read(file)
    with open_session(transport, use_sim_time=use_sim_time) as session:
        remote = RemoteParameters(session, find_node(session, node, spin_time), patience)
        values = _selected(content, file, remote.node, not no_use_wildcard)
        results = _load(remote, values)
    if not as_json:
        for result in results:
            text = f"Set parameter {result.name} {'successful' if result.successful else 'failed'}"
            stream = sys.stdout if result.successful else sys.stderr
            print(f"{text}: {result.reason}" if result.reason else text, file=stream)
    return finish(results, as_json)


def _load(remote: RemoteParameters, values: Mapping[str, Value]) -> list[SetResult]:
    """Set parameters, but for read-only ones that have their values already, as after a `dump`."""
    found = remote.known_descriptors(list(values))
    fixed = remote.values([name for name, descriptor in found.items() if descriptor.read_only])
    types = {name: descriptor.type for name, descriptor in found.items()}
    parameters = [parameter_of(name, value, types.get(name, 0)) for name, value in values.items()]
    # Compared as texts: a NaN is not equal to itself.
    kept = [each.name for each in parameters if repr(fixed.get(each.name)) == repr(each.value)]
    results = remote.set([each for each in parameters if each.name not in kept])
    return [*(SetResult(name, True, "it is read-only and has this value") for name in kept), *results]


def _read(file: str) -> dict[str, dict[str, Value]]:
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


def _selected(
    sections: dict[str, dict[str, Value]], file: str, node: str, use_wildcard: bool
) -> dict[str, Value]:
    """The parameters of a node; its own come after those of the wildcard, which they replace."""
    wanted = [_WILDCARD] if use_wildcard and _WILDCARD in sections else []
    wanted += [node] if node in sections else []
    if not wanted:
        raise ToolError(
            f"{file} has no parameters for {node!r}", f"it has parameters for: {', '.join(sections)}"
        )
    return {name: value for key in wanted for name, value in sections[key].items()}
