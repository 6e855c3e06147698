"""Writes what was seen of a node as a NoDL document that ifgen reads."""

from __future__ import annotations

import json
from collections.abc import Iterable
from typing import Any, Final

import yaml
from ifgen.diagnostics import shown_character
from ifgen.nodl import names
from ifgen.nodl.model import Category, QosProfile
from ifgen.nodl.syntax.scalars import needs_escapes

from ifgen_tools.nodl.parameters import RunningParameter
from ifgen_tools.ros_graph import Endpoint

_LIFECYCLE: Final = (
    "change_state",
    "get_available_states",
    "get_available_transitions",
    "get_state",
    "get_transition_graph",
)
"""Services in the namespace of a node that each lifecycle node has."""
_TRANSITION_EVENT: Final = "transition_event"


class Inline(dict[str, Any]):
    """A map that takes one line of YAML."""


class _InlineList(list[Any]):
    """A list that takes one line of YAML."""


class _Dumper(yaml.SafeDumper):
    """Writes what is inline so, and in quotes what PyYAML would write raw and others read as a line break."""


def _represent_map(dumper: yaml.SafeDumper, value: Inline) -> yaml.Node:
    return dumper.represent_mapping("tag:yaml.org,2002:map", value, flow_style=True)


def _represent_list(dumper: yaml.SafeDumper, value: _InlineList) -> yaml.Node:
    return dumper.represent_sequence("tag:yaml.org,2002:seq", value, flow_style=True)


def _represent_text(_dumper: yaml.SafeDumper, value: str) -> yaml.Node:
    style = '"' if needs_escapes(value) else None
    return yaml.ScalarNode("tag:yaml.org,2002:str", value, style=style)


_Dumper.add_representer(Inline, _represent_map)
_Dumper.add_representer(_InlineList, _represent_list)
_Dumper.add_representer(str, _represent_text)


def document_of(
    node: str, endpoints: Iterable[Endpoint], parameters: Iterable[RunningParameter] | None
) -> tuple[dict[str, Any], list[str]]:
    """The document of a node of this full name, and what of the node it cannot say.

    `parameters` is None if the node does not report them.
    """
    omitted: list[str] = []
    own = [endpoint for endpoint in endpoints if endpoint.node == node]
    document: dict[str, Any] = {"nodl_version": 2}
    if _is_lifecycle(own, node):
        document["codegen"] = {"ifgen": {"style": "lifecycle"}}
        managed = {f"{node}/{name}" for name in (*_LIFECYCLE, _TRANSITION_EVENT)}
        own = [endpoint for endpoint in own if endpoint.name not in managed]
    if described := _parameters(parameters, omitted):
        document["parameters"] = described
    for category in Category:
        if ends := _endpoints((e for e in own if e.category == category), category, node, omitted):
            document[category.value] = ends
    return document, omitted


def as_yaml(document: dict[str, Any], omitted: Iterable[str], title: str = "left out") -> str:
    """The document as YAML, with comments on what is left out."""
    comments = "".join(f"# {title}: {''.join(map(shown_character, reason))}\n" for reason in omitted)
    return comments + yaml.dump(document, Dumper=_Dumper, sort_keys=False, allow_unicode=True, width=100)


def as_json(document: dict[str, Any], omitted: list[str]) -> str:
    """The document as JSON, which cannot say infinity and nan: what is left out for that joins `omitted`."""
    parameters: dict[str, dict[str, Any]] = document.get("parameters", {})
    finite = {name: _finite(name, parameter, omitted) for name, parameter in parameters.items()}
    document = {key: finite if key == "parameters" else value for key, value in document.items()}
    return json.dumps(document, indent=2, ensure_ascii=False, allow_nan=False) + "\n"


def _finite(name: str, parameter: dict[str, Any], omitted: list[str]) -> dict[str, Any]:
    kept: dict[str, Any] = {}
    for key, value in parameter.items():
        try:
            json.dumps(value, allow_nan=False)
            kept[key] = value
        except ValueError:
            omitted.append(f"the {key} of parameter {name!r}: JSON has no infinity and no nan")
    return kept


def _is_lifecycle(endpoints: Iterable[Endpoint], node: str) -> bool:
    served = {e.name for e in endpoints if e.category == Category.SERVICE_SERVER}
    return all(f"{node}/{name}" in served for name in _LIFECYCLE)


def _endpoints(
    endpoints: Iterable[Endpoint], category: Category, node: str, omitted: list[str]
) -> list[dict[str, Any]]:
    found: dict[str, dict[str, Any]] = {}
    for endpoint in sorted(endpoints, key=lambda e: e.name):
        name = (
            endpoint.name.replace(f"{node}/", "~/", 1)
            if endpoint.name.startswith(f"{node}/")
            else endpoint.name
        )
        what = f"{category.singular} {endpoint.name} ({endpoint.type_name})"
        if name in found:
            omitted.append(f"another {what}: NoDL allows only one with the same name")
        elif names.endpoint_name_problem(name) or names.split_type(endpoint.type_name) is None:
            omitted.append(f"{what}: NoDL does not allow this name")
        else:
            found[name] = {"name": name, "type": endpoint.type_name}
            if endpoint.qos is not None and category.folder == "msg":
                found[name]["qos"] = _qos(endpoint.qos)
    return list(found.values())


def _qos(qos: QosProfile) -> Inline:
    """A profile without what it leaves open; a depth of 0 is none, so it is left open too."""
    history = "SYSTEM_DEFAULT" if qos.history == "KEEP_LAST" and qos.depth < 1 else qos.history
    profile: dict[str, Any] = {
        "history": history,
        "depth": qos.depth if history == "KEEP_LAST" else None,
        "reliability": qos.reliability,
        "durability": qos.durability,
        "deadline_ns": qos.deadline_ns,
        "lifespan_ns": qos.lifespan_ns,
        # Defaults that every endpoint has are left out.
        "liveliness": None if qos.liveliness == "AUTOMATIC" else qos.liveliness,
        "liveliness_lease_duration_ns": qos.liveliness_lease_duration_ns,
    }
    return Inline((key, value) for key, value in profile.items() if value)


def _parameters(seen: Iterable[RunningParameter] | None, omitted: list[str]) -> dict[str, dict[str, Any]]:
    if seen is None:
        omitted.append("the parameters: the node's parameter services did not answer")
        return {}
    found: dict[str, dict[str, Any]] = {}
    own = [parameter for parameter in seen if not names.reserved_parameter(parameter.name)]
    for parameter in sorted(own, key=lambda parameter: parameter.name):
        if problem := names.parameter_name_problem(parameter.name):
            omitted.append(f"parameter {parameter.name!r}: {problem.message}")
        elif any(parameter.name.startswith(f"{group}.") for group in found):
            omitted.append(f"parameter {parameter.name!r}: another parameter has the name of its group")
        else:
            found[parameter.name] = _parameter(parameter, omitted)
    return found


def _parameter(seen: RunningParameter, omitted: list[str]) -> dict[str, Any]:
    parameter: dict[str, Any] = {"type": seen.type}
    if seen.value is not None:
        is_array = seen.type.endswith("_array")
        parameter["default_value"] = _InlineList(seen.value) if is_array else seen.value
    if seen.description:
        parameter["description"] = seen.description
    if seen.read_only:
        parameter["read_only"] = True
    if seen.additional_constraints:
        parameter["additional_constraints"] = seen.additional_constraints
    if seen.bounds and seen.type in {"int", "double"}:
        lower, upper = seen.bounds
        if lower <= (lower if seen.value is None else seen.value) <= upper:
            parameter["validation"] = {"bounds": _InlineList(seen.bounds)}
        else:
            omitted.append(f"the range of parameter {seen.name!r}: its value lies outside")
        if seen.step > (1 if seen.type == "int" else 0):
            omitted.append(f"the step {seen.step} of parameter {seen.name!r}: NoDL has no validator for it")
    return parameter
