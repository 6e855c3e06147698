"""Asks a running node for the description of a type, by `~/get_type_description` (REP-2016).

rclpy is the one of the node that is passed: ifgen itself needs none.
"""

from __future__ import annotations

from collections.abc import Callable, Generator, Iterable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from importlib import import_module
from typing import Any, Final

from ifgen.dynamic.documents import document_of

_POLL: Final = 0.05
"""Seconds between two looks at the graph."""

_SERVICE: Final = "get_type_description"
_VALID: Final = "RIHS01_"
_UNKNOWN: Final = "_NODE_NAME_UNKNOWN_"


class DescribeError(RuntimeError):
    """Nobody describes the type of a topic, for the reason in one sentence."""


@dataclass(frozen=True, slots=True)
class TypeDescription:
    """The description of a type, as a node sent it.

    `document` has the keys `type_description` and `referenced_type_descriptions`. `sources` are the
    definitions that the node knows: (type name, `msg`, `srv`, `action` or `idl`, text). `node` is the name of
    the node that answered.
    """

    type_name: str
    type_hash: str
    document: dict[str, Any] = field(repr=False)
    node: str
    sources: tuple[tuple[str, str, str], ...] = field(default=(), repr=False)


@dataclass(frozen=True, slots=True)
class Endpoint:
    """A node that may know a type, because it uses it."""

    node: str
    type_name: str
    type_hash: str


def describe(node: Any, topic: str, *, timeout: float = 5.0, type_hash: str | None = None) -> TypeDescription:
    """The type of a topic, from a node that publishes it, or from one that subscribes to it.

    `node` is any node of rclpy, real or ours, whether it spins or not. `topic` is expanded and remapped as
    that node does it. With `type_hash`, only a type with that hash will do: a topic may have several
    versions. Waits up to `timeout` [s] for somebody on the topic and for answers. Call it where waiting is
    allowed: if the node that knows the type spins in this thread only, it cannot answer meanwhile.

    Raises DescribeError if nobody is there, or nobody answers.
    """
    with _asking(node, timeout) as asking:
        endpoints = asking.wait_for(lambda: _endpoints(node, topic, type_hash))
        if not endpoints:
            raise DescribeError(_nobody(node, topic, timeout, type_hash))
        answer = asking.ask(endpoints)
        if isinstance(answer, TypeDescription):
            return answer
        raise DescribeError(f"nobody describes the type of '{topic}': {'; '.join(answer)}")


def answers(node: Any, endpoints: Iterable[Endpoint], timeout: float) -> dict[Endpoint, TypeDescription]:
    """The answers of other nodes about types that they use. All are asked together, each once.

    Nodes that do not answer within `timeout` [s], or refuse, are left out.
    """
    with _asking(node, timeout) as asking:
        return asking.ask_all(endpoints)


def _endpoints(node: Any, topic: str, type_hash: str | None) -> list[Endpoint]:
    """The endpoints of a topic, one for each node and type; publishers come first."""
    infos = (*node.get_publishers_info_by_topic(topic), *node.get_subscriptions_info_by_topic(topic))
    found: dict[Endpoint, None] = {}
    for info in infos:
        name = f"{info.node_namespace.rstrip('/')}/{info.node_name}"
        endpoint = Endpoint(name, info.topic_type, str(info.topic_type_hash))
        if type_hash in {None, endpoint.type_hash}:
            found[endpoint] = None
    return list(found)


def _nobody(node: Any, topic: str, timeout: float, type_hash: str | None) -> str:
    if type_hash is not None and (others := _endpoints(node, topic, None)):
        known = ", ".join(dict.fromkeys(endpoint.type_hash for endpoint in others))
        return f"nobody on '{topic}' has the type {type_hash}: they have {known}"
    return f"nobody has published or subscribed to '{topic}' within {timeout:g} s"


@contextmanager
def _asking(node: Any, timeout: float) -> Generator[_Asking]:
    """A node of our own to ask with: the user's may be spinning in another thread, or not at all."""
    rclpy = import_module("rclpy")
    executors: Any = import_module("rclpy.executors")
    options = {"use_global_arguments": False, "enable_rosout": False, "start_parameter_services": False}
    own = rclpy.create_node("_ifgen_describe", context=node.context, **options)
    executor = executors.SingleThreadedExecutor(context=node.context)
    try:
        executor.add_node(own)
        yield _Asking(own, executor, timeout)
    finally:
        executor.shutdown(timeout_sec=0)
        own.destroy_node()


class _Asking:
    """Asks until its time is over."""

    def __init__(self, node: Any, executor: Any, timeout: float) -> None:
        clocks: Any = import_module("rclpy.clock")
        self._clock = clocks.Clock(clock_type=clocks.ClockType.STEADY_TIME)
        self._type = import_module("type_description_interfaces.srv").GetTypeDescription
        self._node = node
        self._executor = executor
        self._timeout = timeout
        self._until = self._now() + timeout

    def _now(self) -> float:
        return float(self._clock.now().nanoseconds) / 1e9

    def _looks(self) -> Iterator[None]:
        """Let things happen between two looks at something, and stop at the end of the time."""
        yield
        while (left := self._until - self._now()) > 0:
            self._executor.spin_once(timeout_sec=min(left, _POLL))
            yield

    def wait_for(self, look: Callable[[], list[Endpoint]]) -> list[Endpoint]:
        """The first result that is not empty; an empty one if there is none in time."""
        for _ in self._looks():
            if found := look():
                return found
        return []

    def ask(self, endpoints: Iterable[Endpoint]) -> TypeDescription | list[str]:
        """The first answer, or the reasons why there is none. All nodes are asked together, each once."""
        questions = [_Question(self._node, self._type, endpoint) for endpoint in endpoints]
        try:
            for _ in self._looks():
                answers = [question.look() for question in questions]
                for answer in answers:
                    if isinstance(answer, TypeDescription):
                        return answer
                if None not in answers:
                    break
            return list(dict.fromkeys(question.reason(self._timeout) for question in questions))
        finally:
            for question in questions:
                question.end()

    def ask_all(self, endpoints: Iterable[Endpoint]) -> dict[Endpoint, TypeDescription]:
        """The answers that come in time."""
        questions = {endpoint: _Question(self._node, self._type, endpoint) for endpoint in endpoints}
        found: dict[Endpoint, TypeDescription] = {}
        for _ in self._looks():
            for endpoint, question in tuple(questions.items()):
                if (answer := question.look()) is not None:
                    question.end()
                    del questions[endpoint]
                    if isinstance(answer, TypeDescription):
                        found[endpoint] = answer
            if not questions:
                break
        for question in questions.values():
            question.end()
        return found


class _Question:
    """A question to one node."""

    def __init__(self, node: Any, type_: Any, endpoint: Endpoint) -> None:
        self._node = node
        self._type = type_
        self._endpoint = endpoint
        self._client: Any = None
        self._future: Any = None
        self._refusal = ""
        if _UNKNOWN in endpoint.node:
            self._refusal = "the middleware does not say which node it is"
        elif not endpoint.type_hash.startswith(_VALID):
            self._refusal = f"{endpoint.node} does not say which hash its type has, as ROS 2 before Iron"
        else:
            self._client = node.create_client(type_, f"{endpoint.node}/{_SERVICE}")

    def look(self) -> TypeDescription | str | None:
        """The answer, the reason why there will be none, or None while that is open."""
        if self._client is None:
            return self._refusal
        if self._future is None and self._client.service_is_ready():
            request = self._type.Request()
            request.type_name, request.type_hash = self._endpoint.type_name, self._endpoint.type_hash
            request.include_type_sources = True
            self._future = self._client.call_async(request)
        if self._future is None or not self._future.done():
            return None
        answer = _answer(self._endpoint, self._future.result())
        self._refusal = answer if isinstance(answer, str) else ""
        return answer

    def reason(self, timeout: float) -> str:
        """The reason why there is no answer."""
        if self._refusal:
            return self._refusal
        if self._future is None:
            return f"{self._endpoint.node} has no service ~/{_SERVICE}"
        return f"{self._endpoint.node} has not answered within {timeout:g} s: is it spinning?"

    def end(self) -> None:
        """Wait no longer."""
        if self._client is not None:
            self._node.destroy_client(self._client)


def _answer(endpoint: Endpoint, response: Any) -> TypeDescription | str:
    if not response.successful:
        return f"{endpoint.node} says: {response.failure_reason or 'no'}"
    sources = tuple((s.type_name, s.encoding, s.raw_file_contents) for s in response.type_sources)
    document = document_of(response.type_description)
    return TypeDescription(endpoint.type_name, endpoint.type_hash, document, endpoint.node, sources)
