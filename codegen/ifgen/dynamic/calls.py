"""Asks running nodes for the type of a service or an action.

A node describes a type to whoever knows its hash. The hash of a service is in the graph of our transport, but
not in that of DDS, which has those of the request and the response only, and by these no node of a real ROS
describes anything. It describes the events of a service, where its introspection is switched on.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from importlib import import_module
from importlib.util import find_spec
from typing import Any, Final

from ifgen.definition.described.reading import ACTION_PARTS, SERVICE_PARTS, read
from ifgen.definition.type_description import TypeId, type_hash
from ifgen.dynamic.asking import Asking, DescribeError, Endpoint, TypeDescription, asking
from ifgen.dynamic.describing import endpoints_of

_EVENTS: Final = "/_service_event"
_EVENT: Final = "_Event"


def describe_service(node: Any, service: str, *, timeout: float = 5.0) -> TypeDescription:
    """The type of a service, from a node that serves it.

    `node`, `timeout` [s] and waiting are as for `describe`. On real rclpy a node can tell only while the
    introspection of the service is switched on, at the server or at a client.

    Raises DescribeError if nobody serves it, or nobody describes it.
    """
    with asking(node, timeout) as questions:
        return _service(questions, node, node.resolve_service_name(service), f"service '{service}'", timeout)


def describe_action(node: Any, action: str, *, timeout: float = 5.0) -> TypeDescription:
    """The type of an action, from a node that serves it: on our transport only.

    `node`, `timeout` [s] and waiting are as for `describe`. Raises DescribeError if nobody serves it, or
    nobody describes it.
    """
    what = f"action '{action}'"
    name = node.resolve_topic_name(action)
    with asking(node, timeout) as questions:
        parts = [
            _service(questions, node, f"{name}/_action/{part}", what, timeout)
            for part in ("send_goal", "get_result")
        ]
        parts.append(_answer(questions.ask(endpoints_of(node, f"{name}/_action/feedback")), what))
    whole = parts[0].type_name.removesuffix("_SendGoal")
    return _composed(whole, ACTION_PARTS, parts)


def _service(questions: Asking, node: Any, name: str, what: str, timeout: float) -> TypeDescription:
    if not questions.wait_for(lambda: _types(node, name)):
        raise DescribeError(f"nobody has served the {what} within {timeout:g} s")
    known = servers_of(node, name)
    if known is not None:
        return _answer(questions.ask(known), what)
    events = [e for e in endpoints_of(node, name + _EVENTS) if e.type_name.endswith(_EVENT)]
    if not events:
        raise DescribeError(
            f"nobody can describe the type of the {what}: nodes of a real ROS know it by a hash that "
            "DDS does not tell, and nobody publishes events about it (service introspection)"
        )
    event = _answer(questions.ask(events), what)
    return _composed(event.type_name.removesuffix(_EVENT), SERVICE_PARTS, [event])


def _types(node: Any, name: str) -> list[str]:
    return [type_ for known, types in node.get_service_names_and_types() if known == name for type_ in types]


def servers_of(node: Any, name: str) -> list[Endpoint] | None:
    """The servers of a service with its hash; None on a real rclpy, which does not tell."""
    if find_spec("rmw_local") is None:
        return None
    with node.handle:
        found = import_module("rclpy.impl.rcl.graph").service_types(node.handle, name)
    return [Endpoint(*server) for server in dict.fromkeys(found)]


def _answer(answer: TypeDescription | list[str], what: str) -> TypeDescription:
    if isinstance(answer, TypeDescription):
        return answer
    raise DescribeError(f"nobody describes the type of the {what}: {'; '.join(answer) or 'nobody serves it'}")


def _composed(
    type_name: str, suffixes: Mapping[str, str], parts: Sequence[TypeDescription]
) -> TypeDescription:
    """The description of a service or an action, all of whose parts are described by others."""
    types: dict[str, Any] = {}
    sources: dict[str, tuple[str, str, str]] = {}
    for part in parts:
        described = [part.document["type_description"], *part.document["referenced_type_descriptions"]]
        types.update((each["type_name"], each) for each in described)
        sources.update((source[0], source) for source in part.sources)
    fields = [_field(name, type_name + suffix) for name, suffix in suffixes.items()]
    document = {
        "type_description": {"type_name": type_name, "fields": fields},
        "referenced_type_descriptions": [types[name] for name in sorted(types)],
    }
    found = type_hash(*read(document))
    return TypeDescription(type_name, found, document, parts[0].node, tuple(sources.values()))


def _field(name: str, type_name: str) -> dict[str, Any]:
    type_ = {
        "type_id": int(TypeId.NESTED),
        "capacity": 0,
        "string_capacity": 0,
        "nested_type_name": type_name,
    }
    return {"name": name, "type": type_, "default_value": ""}
