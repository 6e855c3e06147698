"""Asks running nodes for the descriptions of types, by `~/get_type_description` (REP-2016).

rclpy is the one of the node that is passed: ifgen itself needs none.
"""

from __future__ import annotations

from collections.abc import Callable, Generator, Iterable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from importlib import import_module
from typing import Any, Final, TypeVar

from ifgen.dynamic.documents import document_of

_POLL: Final = 0.05
"""Seconds between two looks at the graph."""

_SERVICE: Final = "get_type_description"
_VALID: Final = "RIHS01_"
_UNKNOWN: Final = "_NODE_NAME_UNKNOWN_"

FoundT = TypeVar("FoundT")


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

    @property
    def is_named(self) -> bool:
        """False while the middleware does not know which node it is: DDS tells that a moment later."""
        return _UNKNOWN not in self.node


@contextmanager
def asking(node: Any, timeout: float) -> Generator[Asking]:
    """A node of our own to ask with: the user's may be spinning in another thread, or not at all."""
    rclpy = import_module("rclpy")
    executors: Any = import_module("rclpy.executors")
    options = {"use_global_arguments": False, "enable_rosout": False, "start_parameter_services": False}
    own = rclpy.create_node("_ifgen_describe", context=node.context, **options)
    executor = executors.SingleThreadedExecutor(context=node.context)
    try:
        executor.add_node(own)
        yield Asking(own, executor, timeout)
    finally:
        executor.shutdown(timeout_sec=0)
        own.destroy_node()


class Asking:
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

    def _looks(self, until: float | None = None) -> Iterator[None]:
        """Let things happen between two looks at something, and stop at the end of the time."""
        yield
        while (left := min(self._until, until or self._until) - self._now()) > 0:
            self._executor.spin_once(timeout_sec=min(left, _POLL))
            yield

    def wait_for(self, look: Callable[[], list[FoundT]], patience: float | None = None) -> list[FoundT]:
        """The first result that is not empty; an empty one if there is none in time, or in `patience` [s]."""
        for _ in self._looks(None if patience is None else self._now() + patience):
            if found := look():
                return found
        return []

    def ask(self, endpoints: Iterable[Endpoint]) -> TypeDescription | list[str]:
        """The first answer, or the reasons why there is none. All nodes are asked together, each once."""
        questions = [Question(self._node, self._type, endpoint) for endpoint in endpoints]
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
        questions = {endpoint: Question(self._node, self._type, endpoint) for endpoint in endpoints}
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


class Question:
    """A question to one node."""

    def __init__(self, node: Any, type_: Any, endpoint: Endpoint) -> None:
        self._node = node
        self._type = type_
        self._endpoint = endpoint
        self._client: Any = None
        self._future: Any = None
        self._refusal = ""
        if not endpoint.is_named:
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
