"""dora-rs between two transports: what comes over DDS goes on over Zenoh, and the other way."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable
from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from tests.interop.bench.programs.conversation import Value, converse
    from tests.interop.bench.programs.dora_program import SERVICES, DoraProgram, short
else:
    from conversation import Value, converse
    from dora_program import SERVICES, DoraProgram, short

_TURN = 0.01  # [s]
_LIMIT = 15.0  # [s]
_TO_MATCH = 2.0  # [s]; an action client does not say whether it has found its server


class BridgeProgram(DoraProgram):
    """A node on either side. `to_zenoh` says in which direction messages, or requests and goals, go."""

    def __init__(self, setting: dict[str, Any]) -> None:
        super().__init__(setting)
        self._other = self.node_over(import_module("dora").Ros2Transport.dds(), setting)

    def forward(self, topic: str, type: str, qos: Value, to_zenoh: bool) -> None:
        """Pass on the messages of a topic."""
        source, sink = self._ends(to_zenoh)
        profile = self.profile(qos)
        subscription = source.create_subscription(source.create_topic(topic, short(type), profile))
        publisher = sink.create_publisher(sink.create_topic(topic, short(type), profile))

        def step() -> None:
            message = subscription.next()
            if message is None:
                time.sleep(_TURN)
            else:
                publisher.publish(message)

        _always(step)

    def forward_service(self, service: str, type: str, to_zenoh: bool) -> None:
        """Pass on requests to the server on the other side, and its responses."""
        source, sink = self._ends(to_zenoh)
        profile = self.profile(SERVICES)
        client = self.client(sink, service, type)  # waits for the server
        server = source.create_service_server(service, short(type), profile)

        def step() -> None:
            if (found := server.take_request(timeout_s=_TURN)) is not None:
                server.send_response(found[0], client.call(found[1], timeout_s=_LIMIT))

        _always(step)

    def forward_action(self, action: str, type: str, to_zenoh: bool) -> None:
        """Pass on goals to the server on the other side, and its feedback and results."""
        source, sink = self._ends(to_zenoh)
        profile = self.profile(SERVICES)
        client = sink.create_action_client(action, short(type), profile)
        time.sleep(_TO_MATCH)
        server = source.create_action_server(action, short(type), profile)

        def step() -> None:
            if (found := server.take_goal(timeout_s=_TURN)) is None:
                return
            number = client.send_goal(found[1], timeout_s=_LIMIT)
            if (feedback := client.take_feedback(number, timeout_s=_LIMIT)) is not None:
                server.send_feedback(found[0], feedback)
            if (ended := client.take_result(number, timeout_s=_LIMIT)) is not None:
                server.send_result(found[0], ended[1], ended[0], _LIMIT)

        _always(step)

    def _ends(self, to_zenoh: bool) -> tuple[Any, Any]:
        return (self._other, self.node) if to_zenoh else (self.node, self._other)


def _always(step: Callable[[], None]) -> None:
    def run() -> None:
        while True:
            step()

    threading.Thread(target=run, daemon=True).start()


if __name__ == "__main__":
    converse(BridgeProgram, ["dora-rs"])
