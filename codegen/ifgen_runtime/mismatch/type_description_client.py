"""The client of `~/get_type_description` (REP-2016): asks nodes for the definitions of their types.

How a question gets to a node is a `Connection`: through a node of rclpy, which `node_connection` makes, or
through a transport.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Generator, Iterable, Iterator
from contextlib import AbstractContextManager, contextmanager
from dataclasses import dataclass
from importlib import import_module
from itertools import islice
from typing import TYPE_CHECKING, Any, Final, Protocol, TypeAlias

from ifgen_runtime.convert import to_dict
from ifgen_runtime.mismatch.reporting import Definition, Lru, SeenSet
from ifgen_runtime.type_description import hash_of

if TYPE_CHECKING:
    from rclpy.executors import Executor

_AT_ONCE: Final = 16
"""The number of questions that are asked together. Warnings about other types go without the detail."""

_NODES: Final = 3
"""The number of nodes that are asked for one definition, as one of them may be silent."""

_MOST_DEFINITIONS: Final = 128


@dataclass(frozen=True, slots=True)
class Question:
    """A node that has a definition, and which it is."""

    node: str
    type_name: str
    type_hash: str

    @property
    def service(self) -> str:
        """The name of the service that answers."""
        return f"{self.node}/get_type_description"

    def fill(self, request: Any) -> Any:
        """The same request, after setting its fields."""
        request.type_name, request.type_hash = self.type_name, self.type_hash
        request.include_type_sources = True
        return request


@dataclass(frozen=True, slots=True)
class Patience:
    """The time that a node has until it can be asked, and until it has answered [s], from the beginning."""

    to_appear: float
    to_answer: float


OF_WARNINGS: Final = Patience(to_appear=1.0, to_answer=3.0)
"""The patience of a warning: soon where nobody answers, as nodes of older distributions do not.

A node that is busy answers late, and a warning that says what differs is worth the wait.
"""

Answers: TypeAlias = Callable[[], Iterable[Any]]
"""Returns the responses that have come since the last call: several where several nodes have one name.

None stands for one that cannot be read, or will not come, because the node is gone.
"""


class Connection(Protocol):
    """The way of questions to nodes."""

    def now(self) -> float:
        """The time [s] by which patience ends."""
        ...

    def wait(self, seconds: float) -> None:
        """Let answers come, for at most this long."""

    def send(self, question: Question, patience: float) -> Answers | None:
        """Ask, and wait for `patience` [s] at most; None if the node cannot be asked, or not yet."""
        ...


class Inquiry:
    """Questions that are asked together, each as soon as its node can be asked."""

    def __init__(
        self,
        connection: Connection,
        questions: Iterable[Question],
        is_over: Callable[[], bool] = lambda: False,
    ) -> None:
        """Once everything `is_over`, nothing is waited for."""
        self.unsent = dict.fromkeys(questions)
        """Questions to nodes that cannot be asked yet."""
        self.unanswered: dict[Question, Answers] = {}
        """Questions that were sent."""
        self._connection = connection
        self._is_over = is_over

    def responses(self, patience: Patience) -> Iterator[tuple[Question, Any]]:
        """The responses, as they come. A caller that has heard enough stops iterating."""
        began = self._connection.now()
        while (self.unsent or self.unanswered) and not self._is_over():
            limit = patience.to_answer if self.unanswered else patience.to_appear
            left = began + limit - self._connection.now()
            if left <= 0:
                return
            for question in tuple(self.unsent):
                answers = self._connection.send(question, left)
                if answers is not None:
                    del self.unsent[question]
                    self.unanswered[question] = answers
            self._connection.wait(left)
            for question, answers in tuple(self.unanswered.items()):
                for response in answers():
                    self.unanswered.pop(question, None)
                    yield question, response

    def drop(self, type_hash: str) -> None:
        """Wait for no further answers about a definition."""
        self.unsent = {each: None for each in self.unsent if each.type_hash != type_hash}
        self.unanswered = {
            each: answers for each, answers in self.unanswered.items() if each.type_hash != type_hash
        }


def worth_asking(questions: Iterable[Question]) -> list[Question]:
    """Questions to a few nodes about each definition; the first ones are about a definition each."""
    ranks: Counter[str] = Counter()
    ranked: list[tuple[int, Question]] = []
    for question in dict.fromkeys(questions):
        if question.node and question.type_hash and ranks[question.type_hash] < _NODES:
            ranked.append((ranks[question.type_hash], question))
            ranks[question.type_hash] += 1
    return [question for _, question in sorted(ranked, key=lambda pair: pair[0])]


def definition_from(response: Any) -> Definition:
    """The definition in a response of another node's `~/get_type_description`.

    It is what that node says: nobody has checked it yet. Raises ValueError, with the node's reason, if the
    node refused.
    """
    if not response.successful:
        raise ValueError(response.failure_reason or "the node does not say why")
    texts = ((known.type_name, known.encoding, known.raw_file_contents) for known in response.type_sources)
    return Definition(to_dict(response.type_description), tuple(texts))


class Definitions:
    """Asks each node for each definition once, and remembers what it has said. One thread uses it."""

    def __init__(
        self,
        connect: Callable[[], AbstractContextManager[Connection]],
        is_over: Callable[[], bool],
    ) -> None:
        """While it waits for answers, it looks whether everything `is_over`."""
        self._connect = connect
        self._is_over = is_over
        self._asked = SeenSet()
        self._by_hash: Lru[Definition] = Lru(_MOST_DEFINITIONS)  # those that fit their hashes
        self._lies: Lru[Definition] = Lru(_MOST_DEFINITIONS)  # by question

    def ask(self, questions: Iterable[Question]) -> None:
        """Ask what has not been asked yet, and wait for the answers, but not long."""
        unknown = worth_asking(each for each in questions if self._by_hash.get(each.type_hash) is None)
        asked = list(islice((each for each in unknown if self._asked.add(each)), _AT_ONCE))
        if not asked or self._is_over():
            return
        with self._connect() as connection:
            inquiry = Inquiry(connection, asked, self._is_over)
            for question, response in inquiry.responses(OF_WARNINGS):
                if self.keep(question, response):
                    inquiry.drop(question.type_hash)

    def get(self, question: Question) -> Definition | None:
        """The definition, if its node or another one has sent it. It may be a lie."""
        return self._by_hash.get(question.type_hash) or self._lies.get(question)

    def keep(self, question: Question, response: Any) -> bool:
        """Remember what a node has said, and return whether it fits the hash.

        What does not is believed of no other node.
        """
        try:
            definition = definition_from(response)
            is_true = hash_of(definition.document) == question.type_hash
        except Exception:  # the node does not know, or has sent whatever it likes: the warning is to come
            return False
        if is_true:
            self._by_hash.set(question.type_hash, definition)
        else:
            self._lies.set(question, definition)
        return is_true


@contextmanager
def node_connection(context: Any, name: str, poll: float) -> Generator[Connection]:
    """A connection through a hidden node of this name, in a context of rclpy, which looks each `poll` [s].

    It is a node of its own: the user's may be spinning in another thread, or not at all.
    """
    # Late: whoever has a context has an rclpy, the real one or ours.
    from rclpy.executors import SingleThreadedExecutor
    from rclpy.node import Node

    node: Any = Node(
        name,
        context=context,
        use_global_arguments=False,
        enable_rosout=False,
        start_parameter_services=False,
    )
    executor = SingleThreadedExecutor(context=context)
    try:
        executor.add_node(node)
        yield _NodeConnection(node, executor, poll)
    finally:
        executor.shutdown(timeout_sec=0)
        node.destroy_node()


class _NodeConnection:
    """A connection through clients of a node."""

    def __init__(self, node: Any, executor: Executor, poll: float) -> None:
        from rclpy.clock import Clock  # late, as above
        from rclpy.clock_type import ClockType

        self._clock = Clock(clock_type=ClockType.STEADY_TIME)  # virtual where time is
        # A package of its own, which not every program has loaded.
        self._type: Any = import_module("type_description_interfaces.srv").GetTypeDescription
        self._node = node
        self._executor = executor
        self._poll = poll
        self._clients: dict[Question, Any] = {}

    def now(self) -> float:
        """The time of the steady clock [s]."""
        return float(self._clock.now().nanoseconds) / 1e9

    def wait(self, seconds: float) -> None:
        """Spin, for `poll` [s] at most."""
        self._executor.spin_once(timeout_sec=min(seconds, self._poll))

    def send(self, question: Question, patience: float) -> Answers | None:
        """Ask by a client, once there is a server."""
        client = self._clients.get(question)
        if client is None:
            client = self._clients[question] = self._node.create_client(self._type, question.service)
        if not client.service_is_ready():
            return None
        future = client.call_async(question.fill(self._type.Request()))

        def answers() -> list[Any]:
            if not future.done():
                return [] if client.service_is_ready() else [None]
            return [None if future.exception() else future.result()]

        return answers
