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
from ifgen_tools.graph.reading import services
from ifgen_tools.session import open_session
from ifgen_tools.texts.formats import as_json
from ifgen_tools.texts.set_fields import SetStamp, read_yaml, set_fields

if TYPE_CHECKING:
    from ifgen_tools.session import Session, TransportChoice


def call(
    *,
    name: str,
    type_name: str,
    values: str | None = None,
    from_stdin: bool = False,
    rate: float | None = None,
    transport: TransportChoice = "auto",
    in_json: bool = False,
) -> None:
    """Call a service, with `rate` [Hz] until it is interrupted, and print requests and responses."""
    type_name = full_type_name(type_name, "service")
    given = read_yaml(values_or_stdin(values, from_stdin), "the values of the request")
    with open_session(transport) as session:
        name = session.node.resolve_service_name(name)
        known = known_class(type_name, "service")
        if isinstance(known, type):
            set_fields(known.Request(), given)  # a mistake in it is said before anybody is waited for
        wait_for_server(session, "service", name, type_name, lambda: services(session.node))
        cls = class_on_the_wire(session, "service", name, known)
        request = cls.Request()
        _Caller(session, name, cls, in_json).call(request, set_fields(request, given), rate)


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
