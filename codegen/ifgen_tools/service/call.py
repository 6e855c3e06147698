"""`ifgen service call` and `ifgen service echo`."""

from __future__ import annotations

import sys
import time
from typing import TYPE_CHECKING, Any, Final

import click

from ifgen_tools.calling import (
    answer,
    class_on_the_wire,
    full_type_name,
    known_class,
    values_or_stdin,
    wait_for_server,
)
from ifgen_tools.ros_graph import services
from ifgen_tools.services import pick
from ifgen_tools.session import open_session
from ifgen_tools.texts.formats import as_csv, as_json, plain, written
from ifgen_tools.texts.set_fields import SetStamp, read_yaml, set_fields
from ifgen_tools.verbs import CallOptions

if TYPE_CHECKING:
    from ifgen_tools.service.commands import EchoOptions
    from ifgen_tools.session import Session


def call(chosen: CallOptions) -> None:
    """Call a service, with a rate until it is interrupted, and print requests and responses."""
    type_name = full_type_name(chosen.type_name, "service")
    values = read_yaml(values_or_stdin(chosen.values, chosen.from_stdin), "the values of the request")
    with open_session(chosen.transport) as session:
        name = session.node.resolve_service_name(chosen.name)
        known = known_class(type_name, "service")
        if isinstance(known, type):
            set_fields(known.Request(), values)  # a mistake in it is said before anybody is waited for
        wait_for_server(session, "service", name, type_name, lambda: services(session.node))
        cls = class_on_the_wire(session, "service", name, known)
        request = cls.Request()
        caller = _Caller(session, name, cls, chosen.as_json)
        caller.call(request, set_fields(request, values), chosen.rate)


class _Caller:
    """Calls one service."""

    def __init__(self, session: Session, name: str, cls: type[Any], in_json: bool) -> None:
        self._session = session
        self._name = name
        self._in_json = in_json
        self._client = session.node.create_client(cls, name)

    def call(self, request: Any, stamps: list[SetStamp], rate: float | None) -> None:
        """Call once, or again and again."""
        self._session.wait_for(self._client.service_is_ready)
        while True:
            started = time.monotonic()
            now = self._session.node.get_clock().now().to_msg()
            for stamp in stamps:
                stamp(now)
            self._once(request)
            if rate is None:
                return
            self._session.wait_for(lambda: False, max(started + 1 / rate - time.monotonic(), 0))

    def _once(self, request: Any) -> None:
        if not self._in_json:
            print(f"requester: making request: {request!r}\n", flush=True)
        future = self._client.call_async(request)
        response = answer(self._session, future, self._client.service_is_ready, f"service {self._name!r}")
        if self._in_json:
            print(f'{{"request": {as_json(request)}, "response": {as_json(response)}}}', flush=True)
        else:
            print(f"response:\n{response!r}\n", flush=True)


# Late imports: rclpy is found once the transport has been chosen.

_EVENTS: Final = ("REQUEST_SENT", "REQUEST_RECEIVED", "RESPONSE_SENT", "RESPONSE_RECEIVED")
"""The names of service_msgs/msg/ServiceEventInfo."""


def echo(chosen: EchoOptions, most: int | None = None) -> None:
    """Print the events of a service: the first `most`, or without end."""
    if chosen.csv and chosen.as_json:
        raise click.UsageError("--csv and --json exclude each other")
    with open_session(chosen.transport) as session:
        service, cls = _service(session, chosen.name, chosen.type_name)
        from rclpy.qos import qos_profile_services_default

        events: list[Any] = []
        topic = f"{service}/_service_event"
        session.node.create_subscription(cls.Event, topic, events.append, qos_profile_services_default)
        if not session.node.count_publishers(topic):
            print(
                f"note: nobody publishes events of {service!r} yet: a server or a client does so once its "
                "introspection is on (configure_introspection)",
                file=sys.stderr,
                flush=True,
            )
        shown = 0
        while most is None or shown < most:
            session.wait_for(lambda: bool(events))
            print(_text(events.pop(0), chosen), end="", flush=True)
            shown += 1


def _service(session: Session, name: str, type_name: str | None) -> tuple[str, type[Any]]:
    """The full name of a service, and its class. Raises ToolError."""
    session.discover()
    if type_name is None:
        found = pick("service", session.node, name)
        service, type_name = found.name, found.types[0]
    else:
        service, type_name = session.node.resolve_service_name(name), full_type_name(type_name, "service")
    known = known_class(type_name, "service")
    if isinstance(known, type) and service not in {each.name for each in services(session.node)}:
        return service, known  # it may come yet
    return service, class_on_the_wire(session, "service", service, known)


def _text(event: Any, chosen: EchoOptions) -> str:
    if chosen.as_json:
        return f"{as_json(event)}\n"
    if chosen.csv:
        return f"{as_csv(event, chosen.style)}\n"
    document = plain(event, chosen.style)
    number = event.info.event_type
    document["info"]["event_type"] = _EVENTS[number] if number < len(_EVENTS) else number
    return f"{written(document, chosen.style)}---\n"
