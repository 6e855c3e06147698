"""Calls services as a bag has recorded: `ifgen bag play --publish-service-requests`."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, Final

from ifgen.command_kit.tool import ToolError
from ifgen_runtime.bag.definitions import decoder
from ifgen_runtime.codec import serialize

from ifgen_tools.bag.files import warn
from ifgen_tools.bag.options import SERVICE_EVENTS
from ifgen_tools.calling import class_on_the_wire, known_class

if TYPE_CHECKING:
    from rclpy.task import Future

    from ifgen_tools.session import Session

_READY: Final = 3.0
"""Seconds that servers have to be there before the first request."""

_LAST: Final = 1.0
"""Seconds that servers have to answer after the last one."""


class Requester:
    """Calls one service: `send` takes its recorded events, and sends the requests in them."""

    def __init__(self, session: Session, topic: str, event_class: type[Any], event_type: int) -> None:
        """Find the service, as its server defines it. Raises ToolError if nobody can say how."""
        self.name = session.node.resolve_service_name(topic.removesuffix(SERVICE_EVENTS))
        type_name = _type_name(event_class)
        cls = class_on_the_wire(session, "service", self.name, known_class(type_name, "service"))
        self._request_class: Any = getattr(cls, "Request")  # noqa: B009 - of any service
        self._client = session.node.create_client(cls, self.name)
        self._decode = decoder(event_class, views=False)
        self._event_type = event_type
        self._pending: list[Future[Any]] = []
        self._said: set[str] = set()

    def is_ready(self) -> bool:
        """Whether the server is there."""
        return self._client.service_is_ready()

    def is_idle(self) -> bool:
        """Whether all requests have been answered."""
        self._pending = [future for future in self._pending if not future.done()]
        return not self._pending

    def send(self, data: bytes) -> None:
        """Send the request of a serialized event, if it is one of the kind that is wanted."""
        event = self._decode(data)
        if event.info.event_type != self._event_type:
            return
        if not event.request:
            self._say("its events have no contents: introspection told only when it was called")
        elif not self.is_ready():
            self._say("nobody serves it")
        elif (request := self._fitting(event.request[0])) is not None:
            future = self._client.call_async(request)
            future.add_done_callback(lambda done: done.exception())  # a server that goes is no concern here
            self._pending.append(future)

    def _fitting(self, request: Any) -> Any:
        """A request of the server's class, None if that has another definition."""
        cls = self._request_class
        if isinstance(request, cls):
            return request
        if getattr(cls, "__type_hash__", None) != getattr(type(request), "__type_hash__", None):
            self._say("its server has another definition; `ifgen bag check` says what differs")
            return None
        return decoder(cls, views=False)(serialize(request))

    def _say(self, why: str) -> None:
        if why not in self._said:
            self._said.add(why)
            warn(f"requests of {self.name} are not sent: {why}")


def wait_for_servers(session: Session, requesters: Sequence[Requester]) -> None:
    """Wait a moment until all servers are there."""
    session.wait_for(lambda: all(each.is_ready() for each in requesters), _READY)


def wait_for_answers(session: Session, requesters: Sequence[Requester]) -> None:
    """Wait a moment until all requests are answered, so that they have arrived."""
    session.wait_for(lambda: all(each.is_idle() for each in requesters), _LAST)


def requester(session: Session, topic: str, event_class: type[Any], event_type: int) -> Requester | None:
    """A Requester, None if there can be none, which is said on stderr."""
    try:
        return Requester(session, topic, event_class, event_type)
    except ToolError as error:
        service = topic.removesuffix(SERVICE_EVENTS)
        warn(f"requests of {service} are not sent: {error.message}")
        return None


def _type_name(event_class: type[Any]) -> str:
    """`pkg/srv/Name` of the class of its events."""
    package, folder = event_class.__module__.split(".")[:2]
    return f"{package}/{folder}/{event_class.__name__.removesuffix('_Event')}"
