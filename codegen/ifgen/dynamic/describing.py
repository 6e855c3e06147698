"""Asks running nodes for the type of a topic.

rclpy is the one of the node that is passed: ifgen itself needs none.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any, Final

from ifgen.dynamic.asking import DescribeError, Endpoint, TypeDescription, asking

_NAMING: Final = 2.0
"""Seconds until the middleware has told which nodes are on a topic."""


def describe(node: Any, topic: str, *, timeout: float = 5.0, type_hash: str | None = None) -> TypeDescription:
    """The type of a topic, from a node that publishes it, or from one that subscribes to it.

    `node` is any node of rclpy, real or ours, whether it spins or not. `topic` is expanded and remapped as
    that node does it. With `type_hash`, only a type with that hash will do: a topic may have several
    versions. Waits up to `timeout` [s] for somebody on the topic and for answers. Call it where waiting is
    allowed: if the node that knows the type spins in this thread only, it cannot answer meanwhile.

    Raises DescribeError if nobody is there, or nobody answers.
    """

    def named() -> list[Endpoint]:
        return [endpoint for endpoint in endpoints_of(node, topic, type_hash) if endpoint.is_named]

    with asking(node, timeout) as questions:
        endpoints = questions.wait_for(lambda: endpoints_of(node, topic, type_hash))
        if not endpoints:
            raise DescribeError(_nobody(node, topic, timeout, type_hash))
        endpoints = questions.wait_for(named, _NAMING) or endpoints
        answer = questions.ask(endpoints)
        if isinstance(answer, TypeDescription):
            return answer
        raise DescribeError(f"nobody describes the type of '{topic}': {'; '.join(answer)}")


def answers(node: Any, endpoints: Iterable[Endpoint], timeout: float) -> dict[Endpoint, TypeDescription]:
    """The answers of other nodes about types that they use. All are asked together, each once.

    Nodes that do not answer within `timeout` [s], or refuse, are left out.
    """
    with asking(node, timeout) as questions:
        return questions.ask_all(endpoints)


def endpoints_of(node: Any, topic: str, type_hash: str | None = None) -> list[Endpoint]:
    """The endpoints of a topic, one for each node and type; publishers come first."""
    infos = (*node.get_publishers_info_by_topic(topic), *node.get_subscriptions_info_by_topic(topic))
    found: dict[Endpoint, None] = {}
    for info in infos:
        name = f"{info.node_namespace.rstrip('/')}/{info.node_name}"
        endpoint = Endpoint(name, info.topic_type, str(info.topic_type_hash))
        if type_hash in {None, endpoint.type_hash}:
            found[endpoint] = None
    return list(found)


def _nobody(node: Any, topic: str, timeout: float, type_hash: str | None) -> str:
    if type_hash is not None and (others := endpoints_of(node, topic)):
        known = ", ".join(dict.fromkeys(endpoint.type_hash for endpoint in others))
        return f"nobody on '{topic}' has the type {type_hash}: they have {known}"
    return f"nobody has published or subscribed to '{topic}' within {timeout:g} s"
