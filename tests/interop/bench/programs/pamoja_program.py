"""The names and the codec of pamoja-ros2, on a bare session of Zenoh: it has no session of its own."""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any, ClassVar

if TYPE_CHECKING:
    from tests.interop.bench.programs.conversation import Cannot, Receiver, Value, converse, zenoh_session
else:
    from conversation import Cannot, Receiver, Value, converse, zenoh_session

_TWIST = "geometry_msgs/msg/Twist"


class PamojaProgram(Receiver):
    """Samples of Zenoh under keys that pamoja-ros2 makes, with a Twist that it encodes."""

    lacks: ClassVar[dict[str, str]] = dict.fromkeys(
        ("serve", "call", "serve_action", "act", "declare", "parameter", "graph"),
        "it makes names and encodes Twist, and has no session",
    )

    def __init__(self, setting: dict[str, Any]) -> None:
        super().__init__()
        self._names: Any = import_module("pamoja.ros2")
        self._session: Any = zenoh_session(setting)
        self._domain: int = setting["domain"]
        self._hashes: dict[str, str] = setting["hashes"]
        self._publishers: dict[str, Any] = {}
        self._kept: list[Any] = []

    def publish(self, topic: str, type: str, qos: Value) -> None:
        """Make a publisher."""
        self._publishers[topic] = self._session.declare_publisher(self._key(topic, type))

    def send(self, topic: str, value: Value) -> None:
        """Publish a message, without an attachment."""
        linear, angular = (tuple(value[part][axis] for axis in "xyz") for part in ("linear", "angular"))
        self._publishers[topic].put(bytes(self._names.twist_to_cdr(linear, angular)))

    def subscribe(self, topic: str, type: str, qos: Value) -> None:
        """Make a subscriber."""
        queue = self.came[topic] = []

        def take(sample: Any) -> None:
            parts = self._names.twist_from_cdr(sample.payload.to_bytes())
            linear, angular = (dict(zip("xyz", part, strict=True)) for part in parts)
            queue.append({"linear": linear, "angular": angular})

        self._kept.append(self._session.declare_subscriber(self._key(topic, type), take))

    def _key(self, topic: str, type_name: str) -> str:
        if type_name != _TWIST:
            raise Cannot("it encodes Twist only")
        key: str = self._names.entity_key(self._domain, topic, type_name, self._hashes[type_name])
        return key


if __name__ == "__main__":
    converse(PamojaProgram, ["pamoja-ros2", "eclipse-zenoh"])
