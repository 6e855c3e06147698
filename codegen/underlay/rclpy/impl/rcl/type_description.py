"""The handle of `~/get_type_description`: finds a type that the node uses by its hash."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from rmw_local.graph import endpoints
from rmw_local.message import MessageType, ServiceType
from rmw_local.service import ServiceEndpoint

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
        found = next((kind for kind in _types_in_use(node) if kind.type_hash == wanted), None)
        if found is None:
            response.failure_reason = "Type not currently in use by this node"
            return response
        _fill(response, found.cls, with_sources=pyrequest.include_type_sources)
        response.successful = True
        return response

    def _on_destroy(self) -> None:
        self._service.destroy_when_not_in_use()


def _types_in_use(node: Node) -> Iterator[MessageType | ServiceType]:
    place = node.graph_node
    domain = place.participant.domain
    with domain.lock:
        mine = [endpoint for endpoint in endpoints(domain) if endpoint.node is place]
    for endpoint in mine:
        yield endpoint.service_type if isinstance(endpoint, ServiceEndpoint) else endpoint.message_type


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
