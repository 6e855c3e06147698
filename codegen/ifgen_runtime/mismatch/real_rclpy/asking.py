"""Asks other nodes for their definitions, by `~/get_type_description`: each for each type once."""

from __future__ import annotations

import threading
import time
from collections.abc import Generator, Iterable
from contextlib import contextmanager
from dataclasses import dataclass
from importlib import import_module
from typing import Any, Final

from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node

from ifgen_runtime.mismatch.remembered import Once, Remembered
from ifgen_runtime.mismatch.sides import Definition, definition_from

_PATIENCE: Final = 1.0
"""Seconds for nodes to be found: those of older distributions have nobody who answers."""

_PATIENCE_ONCE_ASKED: Final = 3.0
"""Seconds that all answers have where somebody has been asked: on a busy machine, they take that long."""

_POLL: Final = 0.02
"""Seconds between two looks at whether a node can be asked."""

_AT_ONCE: Final = 16
"""How many questions are asked together; warnings about other types go without the detail."""


@dataclass(frozen=True, slots=True)
class Question:
    """A node that has a definition, and which it is."""

    node: str
    type_name: str
    type_hash: str


class Asker:
    """Asks with a hidden node of its own, which exists only while questions are open."""

    def __init__(self, context: Any, stop: threading.Event) -> None:
        self._context = context
        self._stop = stop
        self._asked = Once()
        self._answers: Remembered[Definition] = Remembered()

    def ask(self, questions: Iterable[Question]) -> None:
        """Ask what has not been asked yet, and wait for the answers, but not long."""
        unknown = {question.type_hash: question for question in questions if question.node}
        asked = [question for type_hash, question in unknown.items() if self._answers.get(type_hash) is None]
        asked = [question for question in asked[:_AT_ONCE] if self._asked.is_new(question)]
        if asked and not self._stop.is_set():
            with _node(self._context) as (node, executor):
                self._converse(node, executor, [_Open(node, question) for question in asked])

    def answer(self, type_hash: str) -> Definition | None:
        """The definition with this hash, if a node has sent it."""
        return self._answers.get(type_hash)

    def _converse(self, node: Any, executor: Any, questions: list[_Open]) -> None:
        began = time.monotonic()
        while questions and not self._stop.is_set():
            waited = time.monotonic() - began
            is_asked = any(question.is_asked for question in questions)
            if waited > (_PATIENCE_ONCE_ASKED if is_asked else _PATIENCE):
                return
            executor.spin_once(timeout_sec=_POLL)
            for question in tuple(questions):
                if question.look():
                    questions.remove(question)
                    if question.definition is not None:
                        self._answers.set(question.asked.type_hash, question.definition)


@contextmanager
def _node(context: Any) -> Generator[tuple[Any, Any]]:
    node: Any = Node(
        "_ifgen_type_mismatch",
        context=context,
        use_global_arguments=False,
        enable_rosout=False,
        start_parameter_services=False,
    )
    executor = SingleThreadedExecutor(context=context)
    try:
        executor.add_node(node)
        yield node, executor
    finally:
        executor.shutdown(timeout_sec=0)
        node.destroy_node()


class _Open:
    """A question that has no answer yet."""

    def __init__(self, node: Any, asked: Question) -> None:
        self.asked = asked
        self.definition: Definition | None = None
        # Only where somebody is asked: it is a package of its own, with its messages.
        self._type = import_module("type_description_interfaces.srv").GetTypeDescription
        self._client = node.create_client(self._type, f"{asked.node}/get_type_description")
        self._future: Any = None

    @property
    def is_asked(self) -> bool:
        """Whether the node has been found, and is to answer."""
        return self._future is not None

    def look(self) -> bool:
        """Whether the question is answered, one way or the other."""
        if self._future is None and self._client.service_is_ready():
            request = self._type.Request(type_name=self.asked.type_name, type_hash=self.asked.type_hash)
            request.include_type_sources = True
            self._future = self._client.call_async(request)
        if self._future is None or not self._future.done():
            return False
        try:
            self.definition = definition_from(self._future.result())
        except ValueError:  # the node does not know
            self.definition = None
        return True
