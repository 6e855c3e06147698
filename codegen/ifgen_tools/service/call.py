"""`ifgen service call`."""

from __future__ import annotations

import time
from typing import TYPE_CHECKING, Any

from ifgen_tools.calling import (
    answer,
    class_on_the_wire,
    full_type_name,
    known_class,
    values_or_stdin,
    wait_for_server,
)
from ifgen_tools.ros_graph import services
from ifgen_tools.session import open_session
from ifgen_tools.texts.formats import as_json
from ifgen_tools.texts.set_fields import SetStamp, read_yaml, set_fields
from ifgen_tools.verbs import CallOptions

if TYPE_CHECKING:
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
