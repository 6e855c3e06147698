"""`ifgen service echo`."""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING, Any, Final

from ifgen_tools.calling import class_on_the_wire, full_type_name, known_class
from ifgen_tools.graph.reading import services
from ifgen_tools.service.graph import pick_service
from ifgen_tools.session import open_session
from ifgen_tools.texts.formats import Style, as_csv, as_json, plain, written

if TYPE_CHECKING:
    from ifgen_tools.session import Session, TransportChoice

# Late imports: rclpy is found once the transport has been chosen.

_EVENTS: Final = ("REQUEST_SENT", "REQUEST_RECEIVED", "RESPONSE_SENT", "RESPONSE_RECEIVED")
"""The names of service_msgs/msg/ServiceEventInfo."""


def echo(
    *,
    name: str,
    type_name: str | None,
    style: Style,
    form: str = "yaml",
    transport: TransportChoice = "auto",
    most: int | None = None,
) -> None:
    """Print the events of a service as `yaml`, `csv` or `json`: the first `most`, or without end."""
    with open_session(transport) as session:
        service, cls = _service(session, name, type_name)
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
            print(_text(events.pop(0), style, form), end="", flush=True)
            shown += 1


def _service(session: Session, name: str, type_name: str | None) -> tuple[str, type[Any]]:
    """The full name of a service, and its class. Raises ToolError."""
    session.discover()
    if type_name is None:
        found = pick_service(session.node, name)
        service, type_name = found.name, found.types[0]
    else:
        service, type_name = session.node.resolve_service_name(name), full_type_name(type_name, "service")
    known = known_class(type_name, "service")
    if isinstance(known, type) and service not in {each.name for each in services(session.node)}:
        return service, known  # it may come yet
    return service, class_on_the_wire(session, "service", service, known)


def _text(event: Any, style: Style, form: str) -> str:
    if form == "json":
        return f"{as_json(event)}\n"
    if form == "csv":
        return f"{as_csv(event, style)}\n"
    document = plain(event, style)
    number = event.info.event_type
    document["info"]["event_type"] = _EVENTS[number] if number < len(_EVENTS) else number
    return f"{written(document, style)}---\n"
