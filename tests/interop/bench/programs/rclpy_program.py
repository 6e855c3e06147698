"""A node on rclpy: ours on the local transport, or the real one."""

from __future__ import annotations

import threading
from importlib import import_module
from typing import TYPE_CHECKING, Any, ClassVar

if TYPE_CHECKING:
    from tests.interop.bench.programs.conversation import (
        Receiver,
        Value,
        converse,
        is_bytes,
        plain,
        unpacked,
        wait_for,
    )
else:
    from conversation import Receiver, Value, converse, is_bytes, plain, unpacked, wait_for

_FOR_SERVER = 10.0  # [s]


class RclpyProgram(Receiver):
    """A node that spins on a thread of its own."""

    lacks: ClassVar[dict[str, str]] = {}

    def __init__(self, setting: dict[str, Any]) -> None:
        super().__init__()
        self._shapes: dict[str, Any] = setting["shapes"]
        self._rclpy: Any = import_module("rclpy")
        self._actions: Any = import_module("rclpy.action")
        self._rclpy.init(args=[])
        self._node: Any = self._rclpy.create_node(setting["node"])
        self._publishers: dict[str, tuple[Any, str]] = {}
        self._clients: dict[str, Any] = {}
        executor = import_module("rclpy.executors").MultiThreadedExecutor()
        executor.add_node(self._node)
        threading.Thread(target=executor.spin, daemon=True).start()

    def publish(self, topic: str, type: str, qos: Value) -> None:
        """Make a publisher."""
        self._publishers[topic] = self._node.create_publisher(_found(type), topic, _profile(qos)), type

    def send(self, topic: str, value: Value) -> None:
        """Publish a message."""
        publisher, type_name = self._publishers[topic]
        publisher.publish(_made(_found(type_name), value, self._shapes[type_name]))

    def subscribe(self, topic: str, type: str, qos: Value) -> None:
        """Make a subscription."""
        queue = self.came[topic] = []
        shape = self._shapes[type]
        self._node.create_subscription(
            _found(type), topic, lambda message: queue.append(plain(message, shape)), _profile(qos)
        )

    def serve(self, service: str, type: str, response: Value) -> None:
        """Serve with this response, and remember the requests."""
        queue = self.came[service] = []
        cls = _found(type)

        def answered(request: Any, _: Any) -> Any:
            queue.append(plain(request, self._shapes[f"{type}_Request"]))
            return _made(cls.Response, response, self._shapes[f"{type}_Response"])

        self._node.create_service(cls, service, answered)

    def call(self, service: str, type: str, request: Value, seconds: float) -> Value:
        """Call a service."""
        cls = _found(type)
        client = self._clients.setdefault(service, None) or self._node.create_client(cls, service)
        self._clients[service] = client
        if not client.wait_for_service(timeout_sec=seconds):
            raise TimeoutError(f"no server of {service} within {seconds:g} s")
        future = client.call_async(_made(cls.Request, request, self._shapes[f"{type}_Request"]))
        return plain(_result(future, seconds), self._shapes[f"{type}_Response"])

    def serve_action(self, action: str, type: str, feedback: Value, result: Value) -> None:
        """Serve an action: each goal gets this feedback, and succeeds with this result."""
        queue = self.came[action] = []
        cls = _found(type)

        def execute(handle: Any) -> Any:
            queue.append(plain(handle.request, self._shapes[f"{type}_Goal"]))
            handle.publish_feedback(_made(cls.Feedback, feedback, self._shapes[f"{type}_Feedback"]))
            handle.succeed()
            return _made(cls.Result, result, self._shapes[f"{type}_Result"])

        self._clients[f"server of {action}"] = self._actions.ActionServer(self._node, cls, action, execute)

    def act(self, action: str, type: str, goal: Value, seconds: float) -> Value:
        """Send a goal, and return its status, feedback and result."""
        cls = _found(type)
        client = self._clients[action] = self._actions.ActionClient(self._node, cls, action)
        if not client.wait_for_server(timeout_sec=seconds):
            raise TimeoutError(f"no server of {action} within {seconds:g} s")
        feedback: list[Value] = []
        shape = self._shapes[f"{type}_Feedback"]
        sent = client.send_goal_async(
            _made(cls.Goal, goal, self._shapes[f"{type}_Goal"]),
            feedback_callback=lambda message: feedback.append(plain(message.feedback, shape)),
        )
        handle = _result(sent, seconds)
        if not handle.accepted:
            return {"status": "rejected"}
        ended = _result(handle.get_result_async(), seconds)
        wait_for(lambda: feedback, 1.0)  # another topic than the result's: either may come first
        status = "succeeded" if ended.status == 4 else f"status {ended.status}"
        result = plain(ended.result, self._shapes[f"{type}_Result"])
        return {"status": status, "feedback": feedback, "result": result}

    def declare(self, name: str, value: Any) -> None:
        """Declare a parameter."""
        self._node.declare_parameter(name, value)

    def parameter(self, name: str) -> Any:
        """The value of a parameter."""
        return self._node.get_parameter(name).value

    def graph(self) -> Value:
        """All nodes, and the ends of each topic."""
        node = self._node
        topics = dict(node.get_topic_names_and_types())
        return {
            "nodes": [f"{space.rstrip('/')}/{name}" for name, space in node.get_node_names_and_namespaces()],
            "services": dict(node.get_service_names_and_types()),
            "publishers": {each: list(map(_end, node.get_publishers_info_by_topic(each))) for each in topics},
            "subscriptions": {
                each: list(map(_end, node.get_subscriptions_info_by_topic(each))) for each in topics
            },
        }


def _end(info: Any) -> Value:
    profile = info.qos_profile
    return {
        "node": info.node_name,
        "type": info.topic_type,
        "hash": str(info.topic_type_hash),
        "qos": {
            "reliable": profile.reliability.name == "RELIABLE",
            "transient_local": profile.durability.name == "TRANSIENT_LOCAL",
        },
    }


def _profile(qos: Value) -> Any:
    module: Any = import_module("rclpy.qos")
    return module.QoSProfile(
        depth=qos["depth"],
        reliability=getattr(module.ReliabilityPolicy, "RELIABLE" if qos["reliable"] else "BEST_EFFORT"),
        durability=getattr(
            module.DurabilityPolicy, "TRANSIENT_LOCAL" if qos["transient_local"] else "VOLATILE"
        ),
    )


def _found(type_name: str) -> Any:
    package, kind, name = type_name.split("/")
    return getattr(import_module(f"{package}.{kind}"), name)


def _made(cls: Any, value: Value, shape: dict[str, Any]) -> Any:
    """A message of plain data."""
    message = cls()
    types = cls.get_fields_and_field_types()
    for name, inner in shape.items():
        given = value[name]
        if is_bytes(inner):
            given = unpacked(given)
        elif isinstance(inner, dict):
            given = _made(type(getattr(message, name)), given, inner)
        elif isinstance(inner, list) and isinstance(inner[0], dict):
            package, element = types[name].removeprefix("sequence<").split(">")[0].split(",")[0].split("/")
            given = [_made(_found(f"{package}/msg/{element}"), each, inner[0]) for each in given]
        setattr(message, name, given)
    return message


def _result(future: Any, seconds: float) -> Any:
    if not wait_for(future.done, seconds):
        raise TimeoutError(f"no answer within {seconds:g} s")
    return future.result()


if __name__ == "__main__":
    converse(RclpyProgram, ["ros-rclpy"])
