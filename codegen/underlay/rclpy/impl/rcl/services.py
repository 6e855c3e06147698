"""The handles of service clients and servers, and that of `~/get_type_description`."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import TYPE_CHECKING, Any

from ifgen_runtime.errors import ServerGoneError
from rmw_local.domain import endpoints
from rmw_local.graph import GraphNode
from rmw_local.message import service_type

from .clock import Clock
from .endpoint import EndpointHandle, SourceHandle
from .handle import Destroyable, RCLError
from .names import as_string
from .node import Node
from .qos import profile_dict, profile_of
from .service_introspection import (
    REQUEST_RECEIVED,
    REQUEST_SENT,
    RESPONSE_RECEIVED,
    RESPONSE_SENT,
    Introspection,
    ServiceIntrospectionState,
)
from .structs import rmw_request_id_t, rmw_service_info_t

if TYPE_CHECKING:
    from rmw_local.service import ServiceEndpoint


class _ServiceHandle(SourceHandle, EndpointHandle):
    """Either end of a service."""

    _endpoint: ServiceEndpoint
    _introspection: Introspection | None = None

    def configure_introspection(
        self,
        clock: Clock,
        pyqos_service_event_pub: object,
        introspection_state: ServiceIntrospectionState,
    ) -> None:
        """Switch the events about what this end sends and receives."""
        self._introspection = Introspection.switch(
            self._introspection,
            self._node,
            self._endpoint,
            clock,
            pyqos_service_event_pub,
            introspection_state,
        )

    def _count_waiting(self) -> int:
        return self._endpoint.unread

    def _on_destroy(self) -> None:
        super()._on_destroy()
        if self._introspection is not None:
            self._introspection.close()


class Client(_ServiceHandle):
    """Asks one service. Raises ValueError for a bad name, RCLError for anything else that is wrong."""

    def __init__(self, node: object, pysrv_type: type[Any], service_name: str, pyqos_profile: object) -> None:
        super().__init__()
        profile, kind = profile_of(pyqos_profile), service_type(pysrv_type)
        self._client = self._open(
            "client",
            node,
            as_string(service_name),
            profile,
            lambda place, name: place.create_client(kind, name, profile),
            GraphNode.close_service_endpoint,
        )
        self._endpoint = self._client
        self._use(self._client)

    def set_on_new_response_callback(self, callback: Callable[[int], object]) -> None:
        """Call back with the number of new responses, on the thread that brings them."""
        self._call_on_arrival(callback)

    def clear_on_new_response_callback(self) -> None:
        """End it."""
        self._call_on_arrival(None)

    @property
    def service_name(self) -> str:
        """The service's full name."""
        return self._client.name

    @property
    def node(self) -> Node:
        """The node's handle."""
        return self._node

    def send_request(self, pyrequest: Any, *, expects_server: bool = False) -> int:
        """Send a request; return its number. If a server is expected, it fails without one."""
        if self._destroyed:
            raise RCLError("failed to send request: client pointer is invalid")
        number = self._client.send(pyrequest, expects_server=expects_server)
        if self._introspection is not None:
            self._introspection.record(REQUEST_SENT, self._client.gid, number, request=pyrequest)
        return number

    def service_server_is_available(self) -> bool:
        """Whether a service is matched."""
        if not self._node.context.valid:
            raise RCLError("failed to check service availability: context is invalid")
        self._close_pending()
        return bool(self._client.servers)

    def take_response(self, pyresponse_type: type[Any]) -> tuple[rmw_service_info_t | None, Any]:
        """Take the oldest response with its header; (None, None) if there is none, or it is malformed."""
        letter = self._client.take()
        if letter is None:
            return None, None
        response = self._client.read(letter)
        if response is None:
            return None, None
        _, stamp, gid, number, *_ = letter
        if self._introspection is not None:
            self._introspection.record(RESPONSE_RECEIVED, gid, number, response=response)
        return rmw_service_info_t(stamp, stamp, rmw_request_id_t(number, gid)), response

    def take_failure(self) -> tuple[rmw_service_info_t, ServerGoneError] | tuple[None, None]:
        """Take the header of a request that nobody will answer, with the reason; (None, None) if none is."""
        failure = self._client.take_failure()
        if failure is None:
            return None, None
        number, reason = failure
        request = rmw_request_id_t(number, self._client.gid)
        return rmw_service_info_t(0, 0, request), ServerGoneError(reason)


class Service(_ServiceHandle):
    """Answers one service. Raises ValueError for a bad name, RCLError for anything else that is wrong."""

    def __init__(self, node: object, pysrv_type: type[Any], service_name: str, pyqos_profile: object) -> None:
        super().__init__()
        self._profile = profile = profile_of(pyqos_profile)
        kind = service_type(pysrv_type)
        self._server = self._open(
            "service",
            node,
            as_string(service_name),
            profile,
            lambda place, name: place.create_server(kind, name, profile),
            GraphNode.close_service_endpoint,
        )
        self._endpoint = self._server
        self._use(self._server)

    def set_on_new_request_callback(self, callback: Callable[[int], object]) -> None:
        """Call back with the number of new requests, on the thread that brings them."""
        self._call_on_arrival(callback)

    def clear_on_new_request_callback(self) -> None:
        """End it."""
        self._call_on_arrival(None)

    @property
    def name(self) -> str:
        """The service's full name."""
        return self._server.name

    @property
    def qos(self) -> dict[str, Any]:
        """The profile it was created with, as keyword arguments of `rclpy.qos.QoSProfile`."""
        return profile_dict(self._profile)

    def service_take_request(self, pyrequest_type: type[Any]) -> tuple[Any, rmw_service_info_t | None]:
        """Take the oldest request with its header; (None, None) if there is none, or it is malformed."""
        letter = self._server.take()
        if letter is None:
            return None, None
        request = self._server.read(letter)
        if request is None:
            return None, None
        _, stamp, gid, number, *_ = letter
        if self._introspection is not None:
            self._introspection.record(REQUEST_RECEIVED, gid, number, request=request)
        return request, rmw_service_info_t(stamp, stamp, rmw_request_id_t(number, gid))

    def service_send_response(self, pyresponse: Any, header: rmw_request_id_t) -> None:
        """Answer a request; nothing happens if its client is gone."""
        if self._destroyed:
            raise RCLError("failed to send response: service pointer is invalid")
        self._server.respond(header.writer_guid, header.sequence_number, pyresponse)
        if self._introspection is not None:
            self._introspection.record(
                RESPONSE_SENT, header.writer_guid, header.sequence_number, response=pyresponse
            )

    def fail(self, header: rmw_request_id_t, reason: str) -> None:
        """Let the client know that there will be no response; nothing happens if it has one, or is gone."""
        self._server.fail(header.writer_guid, header.sequence_number, reason)


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
