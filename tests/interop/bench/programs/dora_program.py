"""A node of dora-rs, over its own implementation of the conventions of rmw_zenoh, in Rust."""

from __future__ import annotations

import json
import os
import threading
import time
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar

if TYPE_CHECKING:
    from tests.interop.bench.programs.conversation import (
        Receiver,
        Value,
        converse,
        is_bytes,
        packed,
        unpacked,
    )
else:
    from conversation import Receiver, Value, converse, is_bytes, packed, unpacked

_TURN = 0.05  # [s]
_FOR_RESULT = 10.0  # [s]
_PARAMETERS = 1000  # depth of the services of parameters


class DoraProgram(Receiver):
    """A node whose subscriptions and servers are polled on threads of their own."""

    lacks: ClassVar[dict[str, str]] = {
        "declare": "its parameters are not served over Zenoh",
        "graph": "it shows the graph to nobody",
    }

    def __init__(self, setting: dict[str, Any]) -> None:
        super().__init__()
        # It looks for type descriptions in the variable only, and takes the domain of data from there.
        os.environ["AMENT_PREFIX_PATH"] = setting["definitions"]
        os.environ["ROS_DOMAIN_ID"] = str(setting["domain"])
        self._shapes: dict[str, Any] = setting["shapes"]
        self._dora: Any = import_module("dora")
        self._arrow: Any = import_module("pyarrow")
        self._contexts: list[Any] = []
        self.node = self.node_over(self._zenoh(setting), setting)
        self._publishers: dict[str, tuple[Any, str]] = {}
        self._clients: dict[str, Any] = {}

    def node_over(self, transport: Any, setting: dict[str, Any]) -> Any:
        """A node over a transport."""
        context = self._dora.Ros2Context([setting["definitions"]], transport, setting["domain"])
        self._contexts.append(context)  # whose end is that of its nodes
        return context.new_node(setting["node"], "/", self._dora.Ros2NodeOptions(rosout=False))

    def _zenoh(self, setting: dict[str, Any]) -> Any:
        file = Path(setting["folder"]) / "dora.json5"
        configuration = {
            "mode": "client",
            "connect": {"endpoints": [setting["router"]]},
            "scouting": {"multicast": {"enabled": False}},
        }
        file.write_text(json.dumps(configuration), encoding="utf-8")
        return self._dora.Ros2Transport.zenoh("rep2016", str(file))

    def profile(self, qos: Value) -> Any:
        """A QoS profile."""
        kinds = self._dora.Ros2Durability
        durability = kinds.TransientLocal if qos["transient_local"] else kinds.Volatile
        return self._dora.Ros2QosPolicies(
            durability=durability, reliable=qos["reliable"], keep_last=qos["depth"]
        )

    def publish(self, topic: str, type: str, qos: Value) -> None:
        """Make a publisher."""
        made = self.node.create_topic(topic, short(type), self.profile(qos))
        self._publishers[topic] = self.node.create_publisher(made), type

    def send(self, topic: str, value: Value) -> None:
        """Publish a message."""
        publisher, type_name = self._publishers[topic]
        publisher.publish(self.array(value, self._shapes[type_name]))

    def subscribe(self, topic: str, type: str, qos: Value) -> None:
        """Make a subscription."""
        queue = self.came[topic] = []
        made = self.node.create_topic(topic, short(type), self.profile(qos))
        subscription, shape = self.node.create_subscription(made), self._shapes[type]

        def poll() -> None:
            while True:
                while (found := subscription.next()) is not None:
                    queue.append(self.plain(found, shape))
                time.sleep(_TURN)

        threading.Thread(target=poll, daemon=True).start()

    def serve(self, service: str, type: str, response: Value) -> None:
        """Serve with this response, and remember the requests."""
        queue = self.came[service] = []
        server = self.node.create_service_server(service, short(type), self.profile(SERVICES))

        def poll() -> None:
            while True:
                if (found := server.take_request(timeout_s=_TURN)) is not None:
                    number, request = found
                    queue.append(self.plain(request, self._shapes[f"{type}_Request"]))
                    server.send_response(number, self.array(response, self._shapes[f"{type}_Response"]))

        threading.Thread(target=poll, daemon=True).start()

    def call(self, service: str, type: str, request: Value, seconds: float) -> Value:
        """Call a service."""
        client = self._clients.get(service)
        if client is None:
            client = self._clients[service] = self.client(self.node, service, type)
        response = client.call(self.array(request, self._shapes[f"{type}_Request"]), timeout_s=seconds)
        return self.plain(response, self._shapes[f"{type}_Response"])

    def client(self, node: Any, service: str, type: str) -> Any:
        """A client of a service; it finds only servers whose QoS is the client's."""
        qos = {**SERVICES, "depth": _PARAMETERS} if service.endswith("_parameters") else SERVICES
        return node.create_service_client(service, short(type), self.profile(qos))

    def serve_action(self, action: str, type: str, feedback: Value, result: Value) -> None:
        """Serve an action: each goal gets this feedback, and succeeds with this result."""
        queue = self.came[action] = []
        server = self.node.create_action_server(action, short(type), self.profile(SERVICES))

        def poll() -> None:
            while True:
                if (found := server.take_goal(timeout_s=_TURN)) is not None:
                    number, goal = found
                    queue.append(self.plain(goal, self._shapes[f"{type}_Goal"]))
                    server.send_feedback(number, self.array(feedback, self._shapes[f"{type}_Feedback"]))
                    ended = self.array(result, self._shapes[f"{type}_Result"])
                    server.send_result(number, ended, "succeeded", _FOR_RESULT)

        threading.Thread(target=poll, daemon=True).start()

    def act(self, action: str, type: str, goal: Value, seconds: float) -> Value:
        """Send a goal, and return its status, feedback and result."""
        client = self.node.create_action_client(action, short(type), self.profile(SERVICES))
        number = client.send_goal(self.array(goal, self._shapes[f"{type}_Goal"]), timeout_s=seconds)
        if number is None:
            return {"status": "rejected"}
        feedback = client.take_feedback(number, timeout_s=seconds)
        ended = client.take_result(number, timeout_s=seconds)
        if ended is None:
            raise TimeoutError(f"no result within {seconds:g} s")
        told = [] if feedback is None else [self.plain(feedback, self._shapes[f"{type}_Feedback"])]
        result = self.plain(ended[1], self._shapes[f"{type}_Result"])
        return {"status": ended[0], "feedback": told, "result": result}

    def array(self, value: Value, shape: dict[str, Any]) -> Any:
        """Plain data as an array of Arrow with one element, of exactly the types of the fields."""
        return self._arrow.array([_with_bytes(value, shape)], type=self._type_of(shape))

    def plain(self, array: Any, shape: dict[str, Any]) -> Value:
        """The opposite of `array`."""
        return {
            name: _plain(array.field(name) if hasattr(array, "field") else array[name], inner)
            for name, inner in shape.items()
        }

    def _type_of(self, shape: Any) -> Any:
        if isinstance(shape, dict):
            fields = [self._arrow.field(name, self._type_of(inner)) for name, inner in shape.items()]
            return self._arrow.struct(fields)
        if isinstance(shape, list):
            return self._arrow.list_(self._type_of(shape[0]))
        return getattr(self._arrow, _ARROW.get(shape, shape))()


SERVICES: Value = {"reliable": True, "transient_local": False, "depth": 10}
_ARROW = {"boolean": "bool_", "float": "float32", "double": "float64", "octet": "uint8"}


def short(type_name: str) -> str:
    """The name of a type as dora-rs has it."""
    package, _, name = type_name.split("/")
    return f"{package}/{name}"


def _with_bytes(value: Any, shape: Any) -> Any:
    if is_bytes(shape):
        return list(unpacked(value))
    if isinstance(shape, list):
        return [_with_bytes(each, shape[0]) for each in value]
    if isinstance(shape, dict):
        return {name: _with_bytes(value[name], inner) for name, inner in shape.items()}
    return value


def _plain(array: Any, shape: Any) -> Any:
    """The first element of an array."""
    if is_bytes(shape):
        return packed(array[0].values.to_numpy(zero_copy_only=False))
    found = array[0].as_py()
    return _of_python(found, shape)


def _of_python(found: Any, shape: Any) -> Any:
    if is_bytes(shape):
        return packed(found)
    if isinstance(shape, list):
        return [_of_python(each, shape[0]) for each in found]
    if isinstance(shape, dict):
        return {name: _of_python(found[name], inner) for name, inner in shape.items()}
    return found


if __name__ == "__main__":
    converse(DoraProgram, ["dora-rs"])
