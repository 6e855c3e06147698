"""`ifgen service echo`."""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING, Any, Final

import click

from ifgen_tools.calling import class_on_the_wire, full_type_name, known_class
from ifgen_tools.ros_graph import services
from ifgen_tools.services import pick
from ifgen_tools.session import open_session
from ifgen_tools.texts.formats import as_csv, as_json, plain, written

if TYPE_CHECKING:
    from ifgen_tools.service.commands import EchoOptions
    from ifgen_tools.session import Session

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
