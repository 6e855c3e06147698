"""Publishers, subscriptions and services of zenoh-ros2-sdk, which has no nodes besides."""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any, ClassVar

if TYPE_CHECKING:
    from tests.interop.bench.programs.conversation import Receiver, Value, converse, is_bytes, plain, unpacked
else:
    from conversation import Receiver, Value, converse, is_bytes, plain, unpacked

_NUMBERS = {"boolean": "bool", "float": "float32", "double": "float64", "octet": "uint8"}


class SdkProgram(Receiver):
    """Endpoints with callbacks."""

    lacks: ClassVar[dict[str, str]] = {
        "serve_action": "it has no actions",
        "act": "it has no actions",
        "declare": "it has no parameters of its own",
    }

    def __init__(self, setting: dict[str, Any]) -> None:
        super().__init__()
        self._sdk: Any = import_module("zenoh_ros2_sdk")
        self._numpy: Any = import_module("numpy")
        # Where it looks for definitions; otherwise it clones repositories.
        import_module("zenoh_ros2_sdk.message_registry").get_registry(f"{setting['definitions']}/share")
        host, _, port = setting["router"].removeprefix("tcp/").rpartition(":")
        self._where = {"router_ip": host, "router_port": int(port), "domain_id": setting["domain"]}
        self._session: Any = import_module("zenoh_ros2_sdk.session").ZenohSession.get_instance(
            host, int(port)
        )
        self._node: str = setting["node"]
        self._shapes: dict[str, Any] = setting["shapes"]
        self._publishers: dict[str, tuple[Any, str]] = {}
        self._kept: list[Any] = []

    def publish(self, topic: str, type: str, qos: Value) -> None:
        """Make a publisher."""
        publisher = self._sdk.ROS2Publisher(
            topic=topic, msg_type=type, node_name=self._node, qos=self._profile(qos), **self._where
        )
        self._publishers[topic] = publisher, type

    def send(self, topic: str, value: Value) -> None:
        """Publish a message."""
        publisher, type_name = self._publishers[topic]
        publisher.publish(**self._fields(publisher.msg_class, value, self._shapes[type_name]))

    def subscribe(self, topic: str, type: str, qos: Value) -> None:
        """Make a subscription."""
        queue = self.came[topic] = []
        shape = self._shapes[type]
        self._kept.append(
            self._sdk.ROS2Subscriber(
                topic=topic,
                msg_type=type,
                callback=lambda message: queue.append(plain(message, shape)),
                node_name=self._node,
                qos=self._profile(qos),
                **self._where,
            )
        )

    def serve(self, service: str, type: str, response: Value) -> None:
        """Serve with this response, and remember the requests."""
        queue = self.came[service] = []

        def answered(request: Any) -> Any:
            queue.append(plain(request, self._shapes[f"{type}_Request"]))
            cls = server.response_msg_class
            return cls(**self._fields(cls, response, self._shapes[f"{type}_Response"]))

        server = self._sdk.ROS2ServiceServer(
            service_name=service, srv_type=type, callback=answered, node_name=self._node, **self._where
        )
        self._kept.append(server)

    def call(self, service: str, type: str, request: Value, seconds: float) -> Value:
        """Call a service."""
        client = self._sdk.ROS2ServiceClient(
            service_name=service, srv_type=type, node_name=self._node, timeout=seconds, **self._where
        )
        self._kept.append(client)
        fields = self._fields(client.request_msg_class, request, self._shapes[f"{type}_Request"])
        response = client.call(**fields)
        if response is None:
            raise TimeoutError(f"no answer within {seconds:g} s")
        return plain(response, self._shapes[f"{type}_Response"])

    def graph(self) -> Value:
        """The ends of each topic, and the services."""
        topics = self._sdk.get_topic_names_and_types(**self._where)
        infos = {name: self._sdk.get_topic_info(name, verbose=True, **self._where) for name, _ in topics}
        return {
            "publishers": {name: [_end(each) for each in info.publishers] for name, info in infos.items()},
            "subscriptions": {
                name: [_end(each) for each in info.subscribers] for name, info in infos.items()
            },
            "services": dict(self._sdk.get_service_names_and_types(**self._where)),
        }

    def _profile(self, qos: Value) -> Any:
        module: Any = import_module("zenoh_ros2_sdk.qos")
        return module.QosProfile(
            reliability=getattr(module.QosReliability, "RELIABLE" if qos["reliable"] else "BEST_EFFORT"),
            durability=getattr(
                module.QosDurability, "TRANSIENT_LOCAL" if qos["transient_local"] else "VOLATILE"
            ),
            history_depth=qos["depth"],
        )

    def _fields(self, cls: Any, value: Value, shape: dict[str, Any]) -> Value:
        """The arguments of a message class."""
        types = getattr(cls, "__annotations__", {})
        return {name: self._made(value[name], inner, types.get(name)) for name, inner in shape.items()}

    def _made(self, value: Any, shape: Any, annotation: Any) -> Any:
        if is_bytes(shape):
            return self._numpy.frombuffer(unpacked(value), dtype="uint8")
        if isinstance(shape, dict):
            cls = self._class_like(shape)
            return cls(**self._fields(cls, value, shape))
        if isinstance(shape, list) and isinstance(shape[0], dict):
            return [self._made(each, shape[0], None) for each in value]
        if isinstance(shape, list) and not shape[0].startswith("string"):
            return self._numpy.array(value, dtype=_NUMBERS.get(shape[0], shape[0]))
        return value

    def _class_like(self, shape: dict[str, Any]) -> Any:
        """The class of a nested message: one of those that are registered, with this shape."""
        for name, known in self._shapes.items():
            if known == shape and name in self._session.store.types:
                return self._session.store.types[name]
        raise LookupError(f"no class for a message of {', '.join(shape)}")


def _end(info: Any) -> Value:
    qos = import_module("zenoh_ros2_sdk.qos").QosProfile.decode(info.qos)
    return {
        "node": info.node_name,
        "type": info.topic_type,
        "hash": info.type_hash,
        "qos": {
            "reliable": qos.reliability.name == "RELIABLE",
            "transient_local": qos.durability.name == "TRANSIENT_LOCAL",
        },
    }


if __name__ == "__main__":
    converse(SdkProgram, ["zenoh-ros2-sdk", "eclipse-zenoh"])
