"""The handle of a service server."""

from __future__ import annotations

from functools import partial
from typing import Any

from rmw_local.graph import TypeConflictError
from rmw_local.message import service_type
from rmw_local.qos import unknown_policy

from .clock import Clock
from .endpoint import EndpointHandle, SourceHandle, resolve
from .errors import RCLError
from .names import as_string
from .qos import profile_dict, profile_of
from .service_introspection import REQUEST_RECEIVED, RESPONSE_SENT, Introspection, ServiceIntrospectionState
from .structs import rmw_request_id_t, rmw_service_info_t


class Service(SourceHandle, EndpointHandle):
    """Answers one service. Raises ValueError for a bad name, RCLError for anything else that is wrong."""

    def __init__(self, node: object, pysrv_type: type[Any], service_name: str, pyqos_profile: object) -> None:
        super().__init__()
        self._profile = profile_of(pyqos_profile)
        kind = service_type(pysrv_type)
        node, name = resolve(node, as_string(service_name), "service", is_service=True)
        if policy := unknown_policy(self._profile):
            raise RCLError(f"failed to create service: the {policy} policy is unknown")
        try:
            self._server = server = node.graph_node.create_server(kind, name, self._profile)
        except TypeConflictError as error:
            raise RCLError(f"failed to create service: create_service() called for {error}") from None
        self._attach(node, partial(node.graph_node.close_service_endpoint, server))
        self._use(server)
        self._introspection: Introspection | None = None

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

    def configure_introspection(
        self,
        clock: Clock,
        pyqos_service_event_pub: object,
        introspection_state: ServiceIntrospectionState,
    ) -> None:
        """Switch the events about requests received and responses sent."""
        self._introspection = Introspection.switch(
            self._introspection, self._node, self._server, clock, pyqos_service_event_pub, introspection_state
        )

    def _on_destroy(self) -> None:
        super()._on_destroy()
        if self._introspection is not None:
            self._introspection.close()
