"""Replays of recordings through nodes, in virtual time: the same messages at the same times each time."""

from __future__ import annotations

import importlib
import os
from collections.abc import Callable, Generator, Iterator, Sequence
from contextlib import ExitStack, contextmanager
from copy import copy
from dataclasses import dataclass, field
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple
from unittest import mock

from ifgen_runtime import deserialize, serialize
from ifgen_runtime.bag import Bag, Recorder

from ifgen_pytest.comparison import counted, differences
from ifgen_pytest.domains import RANGE, private_domain
from ifgen_pytest.recording import publications

if TYPE_CHECKING:
    from rclpy.executors import Executor
    from rclpy.node import Node
    from rclpy.publisher import Publisher

# Late imports: rclpy is imported when a test asks for it, once it is known which one that is.

MakeNode = Callable[[], "Node"]
_BACKGROUND = ("/rosout", "/parameter_events")
_SHOWN = 10  # fields of a message that differ


class ReplayError(Exception):
    """A recording cannot be replayed: why, and what to do."""


class Output(NamedTuple):
    """A message that a node published: the virtual time [ns since 1970], the topic, the serialised form."""

    time: int
    topic: str
    data: bytes


@dataclass(frozen=True)
class Replayed:
    """The messages that nodes published in a replay. Two are equal if every time, topic and byte is."""

    path: Path = field(compare=False)
    """The bag that was replayed."""
    outputs: tuple[Output, ...]
    """Everything, in the order in which it was published."""
    classes: dict[str, type[Any]] = field(compare=False, repr=False)
    """The message class of each topic."""

    def __getitem__(self, topic: str) -> list[Any]:
        """The messages that were published on a topic, none if there is no such topic."""
        return [self._message(output) for output in self.outputs if output.topic == topic]

    def save(self, path: str | PathLike[str]) -> None:
        """Write a bag of what was published, in place of what is there."""
        with Recorder(path, overwrite=True) as recorder:
            for topic, cls in self.classes.items():
                recorder.add_topic(topic, cls)
            for output in self.outputs:
                recorder.write_serialized(output.topic, output.data, output.time)

    def expect_recorded(self, *topics: str) -> None:
        """Fail unless the same messages are in the bag, byte by byte, on each of these topics.

        Without `topics`, on all that the bag and the nodes both have. Times are not compared: the real world
        has other ones.
        """
        __tracebackhide__ = True
        with Bag(self.path) as bag:
            compared = topics or [topic for topic in self.classes if topic in bag]
            if not compared:
                published = ", ".join(self.classes) or "nothing"
                raise AssertionError(f"{self.path} has nothing of what the nodes published: {published}")
            lines: list[str] = []
            for topic in compared:
                mine = [output for output in self.outputs if output.topic == topic]
                recorded = [Output(each.received, topic, each.data) for each in bag.recorded(topic)]
                lines += self._compared(topic, mine, recorded)
        if lines:
            raise AssertionError("\n".join([f"published now != recorded in {self.path}", *lines]))

    def differences(self, other: Replayed) -> Iterator[str]:
        """The differences from another replay: a line for each topic, and lines for its first message."""
        for topic in dict.fromkeys([*self.classes, *other.classes]):
            mine, theirs = ([each for each in one.outputs if each.topic == topic] for one in (self, other))
            found = self._compared(topic, mine, theirs)
            yield from found
            if not found:
                for index, (left, right) in enumerate(zip(mine, theirs, strict=True)):
                    if left.time != right.time:
                        yield f"{topic}: message {index} was published at {left.time} ns != {right.time} ns"
                        break

    def _compared(self, topic: str, mine: Sequence[Output], theirs: Sequence[Output]) -> list[str]:
        lines: list[str] = []
        for index, (left, right) in enumerate(zip(mine, theirs, strict=False)):
            if left.data != right.data:
                lines.append(f"{topic}: message {index} of {len(mine)} is the first that differs")
                lines += [f"  {line}" for line in self._fields(left, right)]
                break
        if len(mine) != len(theirs):
            lines.append(f"{topic}: {counted(len(mine), 'message')} != {counted(len(theirs), 'message')}")
        return lines

    def _fields(self, left: Output, right: Output) -> list[str]:
        found = list(differences("", self._message(left), self._message(right)))
        shown = found[:_SHOWN] or ["no field differs, only bytes between them or inside of NaN"]
        return shown if len(found) <= _SHOWN else [*shown, f"and {len(found) - _SHOWN} more"]

    def _message(self, output: Output) -> Any:
        return deserialize(output.data, self.classes[output.topic])


def replay(
    path: str | PathLike[str],
    *nodes: MakeNode,
    topics: Sequence[str] | None = None,
    after: float = 0.0,
    seed: int = 0,
) -> Replayed:
    """Send a recording through nodes, and return what they publish.

    `path` is a bag. `nodes` are classes or functions, each of which makes a node. The run begins, in virtual
    time, when the bag's first message was received. The nodes are made then. They get the messages of all
    topics that they have subscribed to, or of `topics`, when those were received. Topics on which they
    publish are left out. Time goes on for `after` [s] at the end. `seed` chooses the order of their threads.

    Raises ReplayError if there is nothing to replay, BagError if the bag is damaged, and whatever a callback
    raises.
    """
    with Bag(path, strict=True) as bag, _world(bag, seed) as executor:
        outputs: list[Output] = []
        classes: dict[str, type[Any]] = {}

        def heard(topic: str, publisher: Any, message: Any, now: int) -> None:
            if topic not in _BACKGROUND:
                classes[topic] = publisher.msg_type
                data = message if isinstance(message, bytes) else serialize(message)
                outputs.append(Output(now, topic, data))

        with publications(heard), _made(executor, nodes) as made:
            _Player(bag, executor, made, topics).play(after)
        return Replayed(bag.path, tuple(outputs), classes)


@contextmanager
def _world(bag: Bag, seed: int) -> Generator[Executor]:
    """An executor in a context of its own, in virtual time that begins with the bag."""
    try:
        virtual_time = importlib.import_module("rmw_local.virtual_time").virtual_time
    except ImportError:
        raise ReplayError("a replay needs the local transport: run pytest with --transport local") from None
    import rclpy
    from rclpy.executors import SingleThreadedExecutor
    from rclpy.signals import SignalHandlerOptions
    from rmw_local import observer

    if bag.start is None:
        raise ReplayError(f"{bag.path} has no messages to replay")
    if rclpy.ok():
        raise ReplayError(
            "rclpy is running already: a replay starts it by itself, in the time of its bag. "
            "Call it in a test without ros_context, ros_node and their like"
        )
    with ExitStack() as stack:
        stack.enter_context(mock.patch.dict(os.environ, {RANGE: "OFF"}))
        stack.enter_context(virtual_time(seed, bag.start))
        stack.callback(observer.install, observer.install(None))  # nobody has to read what the nodes publish
        rclpy.init(args=[], domain_id=private_domain(), signal_handler_options=SignalHandlerOptions.NO)
        stack.callback(rclpy.try_shutdown)
        executor = SingleThreadedExecutor()
        stack.callback(executor.shutdown)
        yield executor


@contextmanager
def _made(executor: Executor, nodes: Sequence[MakeNode]) -> Generator[list[Node]]:
    made: list[Node] = []
    try:
        for make in nodes:
            made.append(make())
            executor.add_node(made[-1])
        yield made
    finally:
        for node in reversed(made):
            executor.remove_node(node)
            node.destroy_node()


class _Player:
    """Publishes the messages of a bag when it is their time."""

    def __init__(
        self, bag: Bag, executor: Executor, nodes: Sequence[Node], topics: Sequence[str] | None
    ) -> None:
        from rclpy.node import Node
        from rmw_local import timing

        self._now = timing.time_ns
        self._bag = bag
        self._executor = executor
        self._node = Node("ifgen_replay", start_parameter_services=False, enable_rosout=False)
        # Their handles: what is sent into the nodes is none of their publications.
        self._send = {
            topic: self._publisher(topic, nodes).handle.publish_raw for topic in self._inputs(nodes, topics)
        }

    def play(self, after: float) -> None:
        """Send everything, and let time go on for `after` [s]."""
        for recorded in self._bag.recorded(*self._send):
            self._pass_until(recorded.received)
            self._send[recorded.topic](recorded.data)
        self._finish_work()
        self._pass_until(self._now() + round(after * 1e9))
        self._node.destroy_node()

    def _pass_until(self, due: int) -> None:
        """Do what is to be done until a time [ns since 1970]."""
        executor, now = self._executor, self._now
        if due <= now():
            self._finish_work()
        while (left := due - now()) > 0:
            executor.spin_once(timeout_sec=left / 1e9)

    def _finish_work(self) -> None:
        """Do what is to be done now: no message waits behind another one that has the same time."""
        executor: Any = self._executor
        executor.spin_once(timeout_sec=0)
        while executor._work is not None:  # until its search has found nothing
            executor.spin_once(timeout_sec=0)

    def _inputs(self, nodes: Sequence[Node], topics: Sequence[str] | None) -> list[str]:
        if topics is not None:
            return list(topics)
        wanted = {each.topic_name for node in nodes for each in node.subscriptions}
        own = {each.topic_name for node in nodes for each in node.publishers}
        found = [topic for topic in self._bag.topics if topic in wanted - own]
        if not found:
            raise ReplayError(
                f"{self._bag.path} has nothing that the nodes listen to: they subscribe to "
                f"{', '.join(sorted(wanted)) or 'nothing'}, and it has {', '.join(self._bag.topics)}"
            )
        return found

    def _publisher(self, topic: str, nodes: Sequence[Node]) -> Publisher[Any]:
        """A publisher that offers what the nodes request."""
        from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy

        wanted = [
            each.qos_profile for node in nodes for each in node.subscriptions if each.topic_name == topic
        ]
        offered = copy(wanted[0]) if wanted else QoSProfile(depth=10)
        offered.reliability = ReliabilityPolicy.RELIABLE
        if any(each.durability is DurabilityPolicy.TRANSIENT_LOCAL for each in wanted):
            offered.durability = DurabilityPolicy.TRANSIENT_LOCAL
        return self._node.create_publisher(self._bag.class_of(topic), topic, offered)
