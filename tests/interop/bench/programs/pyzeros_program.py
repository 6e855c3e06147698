"""A node of pyzeros, with the message classes of ros2-pyterfaces."""

from __future__ import annotations

import asyncio
import threading
from importlib import import_module
from typing import TYPE_CHECKING, Any, ClassVar, get_type_hints

if TYPE_CHECKING:
    from tests.interop.bench.programs.conversation import (
        Cannot,
        Receiver,
        Value,
        converse,
        is_bytes,
        plain,
        unpacked,
        zenoh_session,
    )
else:
    from conversation import Cannot, Receiver, Value, converse, is_bytes, plain, unpacked, zenoh_session

_TO_MAKE = 30.0  # [s], because the codec of a type is compiled when it is needed


class PyzerosProgram(Receiver):
    """A node whose coroutines run on a thread of their own."""

    lacks: ClassVar[dict[str, str]] = {
        "serve_action": "it has no actions",
        "act": "it has no actions",
        "declare": "it has no parameters of its own",
        "graph": "it shows the graph to nobody",
    }

    def __init__(self, setting: dict[str, Any]) -> None:
        super().__init__()
        self._pyzeros: Any = import_module("pyzeros")
        import_module("pyzeros.builtin_msgs").Attachment().serialize()  # so that it is compiled
        self._shapes: dict[str, Any] = setting["shapes"]
        self._node: Any = self._pyzeros.Session(
            setting["node"], zenoh_session(setting), namespace="/", domain_id=setting["domain"]
        )
        self._publishers: dict[str, tuple[Any, str]] = {}
        self._kept: list[Any] = []
        self._loop = asyncio.new_event_loop()
        threading.Thread(target=self._loop.run_forever, daemon=True).start()

    def publish(self, topic: str, type: str, qos: Value) -> None:
        """Make a publisher."""
        cls, profile = _found(type), _profile(qos)
        self._publishers[topic] = (
            self._on_loop(lambda: self._node.create_publisher(cls, topic, profile)),
            type,
        )

    def send(self, topic: str, value: Value) -> None:
        """Publish a message."""
        publisher, type_name = self._publishers[topic]
        publisher.publish(_made(_found(type_name), value, self._shapes[type_name]))

    def subscribe(self, topic: str, type: str, qos: Value) -> None:
        """Make a subscription."""
        queue, cls, profile = self.came.setdefault(topic, []), _found(type), _profile(qos)
        shape = self._shapes[type]
        cls.deserialize(cls().serialize())  # so that it is compiled before a message comes
        subscription = self._on_loop(lambda: self._node.create_subscriber(cls, topic, profile))

        async def listen() -> None:
            async for message in subscription.listen_reliable():
                queue.append(plain(message, shape))

        self._keep(listen())

    def serve(self, service: str, type: str, response: Value) -> None:
        """Serve with this response, and remember the requests."""
        queue, cls = self.came.setdefault(service, []), _found(type)
        answer = _made(cls.Response, response, self._shapes[f"{type}_Response"])
        answer.serialize()
        server = self._on_loop(lambda: self._pyzeros.Server(cls, service, session=self._node))

        async def listen() -> None:
            async for responder in server.listen_reliable():
                queue.append(plain(responder.request, self._shapes[f"{type}_Request"]))
                responder.send(answer)

        self._keep(listen())

    def call(self, service: str, type: str, request: Value, seconds: float) -> Value:
        """Call a service."""
        cls = _found(type)
        asked = _made(cls.Request, request, self._shapes[f"{type}_Request"])
        cls.Response.deserialize(cls.Response().serialize())
        client = self._on_loop(lambda: self._pyzeros.Client(cls, service, session=self._node))

        async def ask() -> Any:
            return await asyncio.wait_for(client.call_async(asked), seconds)

        return plain(self._wait_for(ask(), seconds + 1.0), self._shapes[f"{type}_Response"])

    def _on_loop(self, make: Any) -> Any:
        """Make something on the thread of the loop."""

        async def made() -> Any:
            return make()

        return self._wait_for(made(), _TO_MAKE)

    def _wait_for(self, coroutine: Any, seconds: float) -> Any:
        return asyncio.run_coroutine_threadsafe(coroutine, self._loop).result(seconds)

    def _keep(self, coroutine: Any) -> None:
        self._kept.append(asyncio.run_coroutine_threadsafe(coroutine, self._loop))


def _found(type_name: str) -> Any:
    package, kind, name = type_name.split("/")
    return getattr(import_module(f"ros2_pyterfaces.cyclone.{package}.{kind}"), name)


def _profile(qos: Value) -> Any:
    if qos["transient_local"]:
        raise Cannot("it has no transient local durability")
    return import_module("pyzeros.qos").QosProfile(
        reliability="reliable" if qos["reliable"] else "best_effort",
        depth=qos["depth"],
    )


def _made(cls: Any, value: Value, shape: dict[str, Any]) -> Any:
    """A message of plain data."""
    empty = cls()
    given: Value = {}
    for name, inner in shape.items():
        field = value[name]
        if is_bytes(inner):
            field = unpacked(field)
        elif isinstance(inner, dict):
            field = _made(type(getattr(empty, name)), field, inner)
        elif isinstance(inner, list) and isinstance(inner[0], dict):
            element = _element_of(get_type_hints(cls, include_extras=True)[name])
            field = [_made(element, each, inner[0]) for each in field]
        given[name] = field
    return cls(**given)


def _element_of(annotation: Any) -> Any:
    """The class in the annotation of a sequence of messages."""
    (sequence,) = annotation.__metadata__
    return sequence.subtype


if __name__ == "__main__":
    converse(PyzerosProgram, ["pyzeros", "ros2-pyterfaces", "eclipse-zenoh"])
