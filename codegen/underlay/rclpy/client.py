"""Service clients."""

from __future__ import annotations

import threading
from typing import TYPE_CHECKING, Any, TypeVar, overload

from rmw_local import timing

from rclpy.callback_groups import CallbackGroup
from rclpy.clock import Clock
from rclpy.context import Context
from rclpy.impl import blocking, distro
from rclpy.impl.blocking import Owned, wait_for_graph
from rclpy.impl.implementation_singleton import rclpy_implementation as _rclpy
from rclpy.impl.messages import wrong_class
from rclpy.impl.reexports import reexport
from rclpy.impl.typed import Generic, ServiceT_co
from rclpy.qos import QoSProfile
from rclpy.service_introspection import ServiceIntrospectionState
from rclpy.task import Future

if TYPE_CHECKING:
    from rclpy.impl.typed import RequestT, ResponseT
    from rclpy.impl.typed import Service as ServiceWith
else:
    from rclpy.impl.typed import PlainBase

    __getattr__ = reexport(__name__)

# Programs import them from here.
SrvType = TypeVar("SrvType")
SrvTypeRequest = TypeVar("SrvTypeRequest")
SrvTypeResponse = TypeVar("SrvTypeResponse")


class _BaseClient(Generic[ServiceT_co]):
    """The common part of clients of all kinds of nodes: `rclpy.client.BaseClient`."""

    def __init__(
        self, client_impl: _rclpy.Client, srv_type: type[ServiceT_co], srv_name: str, qos_profile: QoSProfile
    ) -> None:
        self.__client = client_impl
        self.srv_type = srv_type
        self.srv_name = srv_name
        self.qos_profile = qos_profile

    def service_is_ready(self) -> bool:
        """Whether a service is there."""
        with self.handle:
            return self.__client.service_server_is_available()

    def configure_introspection(
        self,
        clock: Clock,
        service_event_qos_profile: QoSProfile,
        introspection_state: ServiceIntrospectionState,
    ) -> None:
        """Switch the events about requests sent and responses received, stamped with `clock`."""
        with self.handle:
            self.__client.configure_introspection(
                clock.handle, service_event_qos_profile.get_c_qos_profile(), introspection_state
            )

    @property
    def handle(self) -> _rclpy.Client:
        """The handle of the client library."""
        return self.__client

    @property
    def service_name(self) -> str:
        """The full service name: expanded and remapped."""
        with self.handle:
            return self.__client.service_name

    @property
    def logger_name(self) -> str:
        """The name of the node's logger."""
        with self.handle:
            return self.__client.get_logger_name()

    def destroy(self) -> None:
        """Destroy it; to be called through `Node.destroy_client`."""
        self.__client.destroy_when_not_in_use()


if TYPE_CHECKING:
    _BaseOf = _BaseClient
else:
    _BaseOf = PlainBase(_BaseClient)


class Client(Owned, _BaseOf[ServiceT_co]):
    """Sends requests to a service; made by `Node.create_client`."""

    _ros_entity = "Client"

    def __init__(
        self,
        context: Context,
        client_impl: _rclpy.Client,
        srv_type: type[ServiceT_co],
        srv_name: str,
        qos_profile: QoSProfile,
        callback_group: CallbackGroup,
    ) -> None:
        super().__init__(client_impl, srv_type, srv_name, qos_profile)
        self.context = context
        self._pending_requests: dict[int, Future[Any]] = {}  # by request number
        self.callback_group = callback_group
        # Set by an executor that has noticed the client and has yet to set a future
        self._executor_event = False
        self._lock = threading.Lock()

    @overload
    def call(
        self: Client[ServiceWith[RequestT, ResponseT]], request: RequestT, timeout_sec: None = None
    ) -> ResponseT: ...
    @overload
    def call(
        self: Client[ServiceWith[RequestT, ResponseT]], request: RequestT, timeout_sec: float | None
    ) -> ResponseT | None: ...
    def call(
        self: Client[ServiceWith[RequestT, ResponseT]], request: RequestT, timeout_sec: float | None = None
    ) -> ResponseT | None:
        """Send a request and wait for the response, which another thread has to receive.

        At the timeout it returns None, or raises TimeoutError as newer ROS does. Not for callbacks of a
        single-threaded executor: the response waits until they return. Raises TypeError for a request of
        another class, and what the future holds as its exception.
        """
        if blocking.enabled:
            call = f"service '{self.srv_name}'"
            blocking.must_be_answerable(self, call, "client.call_async(request)", timeout_sec)
        future = self.call_async(request)
        answered = timing.Event()
        future.add_done_callback(lambda _: answered.set())
        # The future may have been completed, with no executor to run the callback, before that was added.
        if not future.done() and not answered.wait(timeout_sec):
            self.remove_pending_request(future)
            if distro.follows("call_timeout"):
                raise TimeoutError
        exception = future.exception()
        if exception is not None:
            raise exception
        return future.result()

    def call_async(self: Client[ServiceWith[RequestT, ResponseT]], request: RequestT) -> Future[ResponseT]:
        """Send a request; the future completes with the response.

        Raises TypeError for a request of another class.
        """
        if not isinstance(request, self.srv_type.Request):
            raise wrong_class(request, self.srv_type.Request)
        handle = self.handle
        with self._lock:
            if handle._destruction_requested:
                handle.refuse_if_destroyed()
            try:
                number = handle.send_request(request)
            except _rclpy.RCLError:
                handle.refuse_if_destroyed()
                raise
            if number in self._pending_requests:
                raise RuntimeError(f"Sequence ({number}) conflicts with pending request")
            future: Future[ResponseT] = Future()
            self._pending_requests[number] = future
        future.add_done_callback(self.remove_pending_request)
        return future

    def get_pending_request(self, sequence_number: int) -> Future[Any]:
        """Return the future of a request by its number; KeyError if it is not pending."""
        with self._lock:
            return self._pending_requests[sequence_number]

    def remove_pending_request(self, future: Future[Any]) -> None:
        """Forget a request: its response will be dropped."""
        with self._lock:
            for number, pending in self._pending_requests.items():
                if pending is future:
                    del self._pending_requests[number]
                    break

    def wait_for_service(self, timeout_sec: float | None = None) -> bool:
        """Wait until a service is there, at most `timeout_sec` seconds; returns whether it is."""
        with self.handle:
            node = self.handle.node
        return wait_for_graph(node, self.service_is_ready, timeout_sec)
