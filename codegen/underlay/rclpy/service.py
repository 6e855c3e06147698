"""Service servers."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any, TypeVar

from rclpy.callback_groups import CallbackGroup
from rclpy.clock import Clock
from rclpy.impl.blocking import Owned
from rclpy.impl.implementation_singleton import rclpy_implementation as _rclpy
from rclpy.impl.messages import wrong_class
from rclpy.impl.reexports import reexport
from rclpy.impl.typed import Generic, ServiceT_co
from rclpy.qos import QoSProfile
from rclpy.service_introspection import ServiceIntrospectionState

if TYPE_CHECKING:
    from rclpy.impl.typed import ResponseT
    from rclpy.impl.typed import Service as ServiceWith
else:
    from rclpy.impl.typed import PlainBase

    __getattr__ = reexport(__name__)

# Programs import them from here.
SrvType = TypeVar("SrvType")
SrvTypeRequest = TypeVar("SrvTypeRequest")
SrvTypeResponse = TypeVar("SrvTypeResponse")


class _BaseService(Generic[ServiceT_co]):
    """The common part of services of all kinds of nodes: `rclpy.service.BaseService`."""

    def __init__(
        self,
        service_impl: _rclpy.Service,
        srv_type: type[ServiceT_co],
        srv_name: str,
        callback: Callable[[Any, Any], Any],
        qos_profile: QoSProfile,
    ) -> None:
        self.__service = service_impl
        self.srv_type = srv_type
        self.srv_name = srv_name
        self.callback = callback
        self.qos_profile = qos_profile

    def send_response(
        self: _BaseService[ServiceWith[Any, ResponseT]], response: ResponseT, header: Any
    ) -> None:
        """Answer the request that came with `header`.

        Raises TypeError for a response of another class, or for what is no header.
        """
        if not isinstance(response, self.srv_type.Response):
            raise wrong_class(response, self.srv_type.Response)
        handle = self.__service
        if handle._destruction_requested:
            handle.refuse_if_destroyed()
        try:
            if isinstance(header, _rclpy.rmw_service_info_t):
                handle.service_send_response(response, header.request_id)
            elif isinstance(header, _rclpy.rmw_request_id_t):
                handle.service_send_response(response, header)
            else:
                raise TypeError(f"expected the header of a request, got {type(header).__name__}")
        except _rclpy.RCLError:
            handle.refuse_if_destroyed()
            raise

    def configure_introspection(
        self,
        clock: Clock,
        service_event_qos_profile: QoSProfile,
        introspection_state: ServiceIntrospectionState,
    ) -> None:
        """Switch the events about requests received and responses sent, stamped with `clock`."""
        with self.handle:
            self.__service.configure_introspection(
                clock.handle, service_event_qos_profile.get_c_qos_profile(), introspection_state
            )

    @property
    def handle(self) -> _rclpy.Service:
        """The handle of the client library."""
        return self.__service

    @property
    def service_name(self) -> str:
        """The full service name: expanded and remapped."""
        with self.handle:
            return self.__service.name

    @property
    def logger_name(self) -> str:
        """The name of the node's logger."""
        with self.handle:
            return self.__service.get_logger_name()

    def destroy(self) -> None:
        """Destroy it; to be called through `Node.destroy_service`."""
        self.__service.destroy_when_not_in_use()


if TYPE_CHECKING:
    _BaseOf = _BaseService
else:
    _BaseOf = PlainBase(_BaseService)


class Service(Owned, _BaseOf[ServiceT_co]):
    """Answers the requests of a service; made by `Node.create_service`."""

    _ros_entity = "Service"

    def __init__(
        self,
        service_impl: _rclpy.Service,
        srv_type: type[ServiceT_co],
        srv_name: str,
        callback: Callable[[Any, Any], Any],
        callback_group: CallbackGroup,
        qos_profile: QoSProfile,
    ) -> None:
        super().__init__(service_impl, srv_type, srv_name, callback, qos_profile)
        self.callback_group = callback_group
        # Set by an executor that has noticed the service and has yet to run the callback
        self._executor_event = False
