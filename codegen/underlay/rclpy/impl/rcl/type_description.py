"""The handle of `~/get_type_description`: finds a type that the node uses by its hash."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from rmw_local.domain import endpoints

from .destroyable import Destroyable
from .node import Node
from .service import Service

_HASH = len("RIHS01_") + 64


class TypeDescriptionService(Destroyable):
    """The service of one node; `impl` is its ordinary service handle."""

    def __init__(self, node: Node) -> None:
        super().__init__()
        from type_description_interfaces.srv import (
            GetTypeDescription,  # generated: not needed to import rclpy
        )

        self._service = Service(node, GetTypeDescription, "~/get_type_description", None)

    @property
    def impl(self) -> Service:
        """The handle of the service."""
        return self._service

    def handle_request(self, pyrequest: Any, pyresponse_type: type[Any], node: Node) -> Any:
        """Return the answer to a request."""
        response = pyresponse_type()
        wanted = pyrequest.type_hash
        if not (wanted.startswith("RIHS01_") and len(wanted) == _HASH):
            response.failure_reason = "Failed to parse type hash"
            return response
        found = next((cls for cls in _types_in_use(node) if _hash_of(cls) == wanted), None)
        if found is None:
            response.failure_reason = "Type not currently in use by this node"
            return response
        _fill(response, found, with_sources=pyrequest.include_type_sources)
        response.successful = True
        return response

    def _on_destroy(self) -> None:
        self._service.destroy_when_not_in_use()


def _types_in_use(node: Node) -> Iterator[type[Any]]:
    """The types of a node's endpoints; then what these are parts of, and their own parts."""
    place = node.graph_node
    domain = place.participant.domain
    with domain.lock:
        mine = [endpoint.kind for endpoint in endpoints(domain) if endpoint.node is place]
    yield from (kind.cls for kind in mine)
    for kind in dict.fromkeys(mine):
        for whole in (kind.cls, kind.action):
            yield from _parts(whole)


def _parts(whole: Any) -> Iterator[type[Any]]:
    """A service or an action, and its parts; nothing of a message."""
    if hasattr(whole, "Goal"):
        yield from (whole, whole.Goal, whole.Result, whole.Feedback)
    elif hasattr(whole, "Request"):
        yield from (whole.Request, whole.Response, whole.Event)


def _hash_of(cls: type[Any]) -> str:
    return str(getattr(cls, "__type_hash__", ""))


def _fill(response: Any, cls: type[Any], *, with_sources: bool) -> None:
    """Fill the response of type_description_interfaces/srv/GetTypeDescription."""
    # Nobody else needs these, and few nodes are ever asked.
    from ifgen_runtime import from_dict
    from ifgen_runtime.type_description import describe, sources
    from type_description_interfaces.msg import TypeDescription, TypeSource

    response.type_description = from_dict(TypeDescription, describe(cls))
    if with_sources:
        response.type_sources = [
            TypeSource(type_name=name, encoding=encoding, raw_file_contents=text)
            for name, encoding, text in sources(cls)
        ]
