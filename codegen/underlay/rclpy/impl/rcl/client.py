"""The handle of a service client."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING, Any

from ifgen_runtime.errors import ServerGoneError
from rmw_local.graph import TypeConflictError
from rmw_local.message import service_type
from rmw_local.qos import unknown_policy

from .clock import Clock
from .endpoint import EndpointHandle, SourceHandle, resolve
from .errors import RCLError
from .names import as_string
from .qos import profile_of
from .service_introspection import REQUEST_SENT, RESPONSE_RECEIVED, Introspection, ServiceIntrospectionState
from .structs import rmw_request_id_t, rmw_service_info_t

if TYPE_CHECKING:
    from .node import Node


class Client(SourceHandle, EndpointHandle):
    """Asks one service. Raises ValueError for a bad name, RCLError for anything else that is wrong."""

    def __init__(self, node: object, pysrv_type: type[Any], service_name: str, pyqos_profile: object) -> None:
        super().__init__()
        profile = profile_of(pyqos_profile)
        kind = service_type(pysrv_type)
        node, name = resolve(node, as_string(service_name), "client", is_service=True)
        if policy := unknown_policy(profile):
            raise RCLError(f"failed to create client: the {policy} policy is unknown")
        try:
            self._client = client = node.graph_node.create_client(kind, name, profile)
        except TypeConflictError as error:
            raise RCLError(f"failed to create client: create_client() called for {error}") from None
        self._attach(node, partial(node.graph_node.close_service_endpoint, client))
        self._use(client)
        self._introspection: Introspection | None = None

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
        self._bury()
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

    def configure_introspection(
        self,
        clock: Clock,
        pyqos_service_event_pub: object,
        introspection_state: ServiceIntrospectionState,
    ) -> None:
        """Switch the events about requests sent and responses received."""
        self._introspection = Introspection.switch(
            self._introspection, self._node, self._client, clock, pyqos_service_event_pub, introspection_state
        )

    def _on_destroy(self) -> None:
        super()._on_destroy()
        if self._introspection is not None:
            self._introspection.close()
