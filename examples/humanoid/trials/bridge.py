"""The simulator in a process of its own and the other nodes in this one, on the local transport, in lockstep.

Messages between processes keep no order among topics. So serialized ones go through a pipe here, and the
local transport stays within each process. Each message to the simulator waits for everything that the
simulator publishes in response, like a call within one process.
The order of events is therefore the same, and a run has the same state hash as in one process.
"""

from __future__ import annotations

import multiprocessing
from collections.abc import Generator, Iterable
from contextlib import contextmanager, suppress
from functools import partial
from multiprocessing.connection import Connection
from typing import Any, NamedTuple

import rclpy
from rclpy.duration import Duration
from rclpy.executors import SingleThreadedExecutor, TimeoutException
from rclpy.node import Node
from rclpy.publisher import Publisher
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy
from rclpy.signals import SignalHandlerOptions
from rclpy.subscription import Subscription
from std_srvs.srv import Trigger

from .alone import alone
from .graph import NodeGraph, make_simulator

_LONGEST = 60.0  # s for an answer; a later one is an error, because time must not go on without it
_ENDING = 5.0  # s that the simulator's process has to end
_KEPT = ("/rosout", "/parameter_events", "/head_camera")  # each process has its own; images take long

Sent = tuple[int, bytes]
"""The number of a topic, and a message as CDR."""


class Topic(NamedTuple):
    """The description of a topic that both ends need."""

    name: str
    kind: type[Any]
    depth: int
    reliability: int
    durability: int
    deadline: int  # ns

    @property
    def qos(self) -> QoSProfile:
        """The QoS profile of both ends."""
        return QoSProfile(
            depth=self.depth,
            reliability=ReliabilityPolicy(self.reliability),
            durability=DurabilityPolicy(self.durability),
            deadline=Duration(nanoseconds=self.deadline),
        )


class StandIn(Node):
    """Stands in for the simulator in the process of the other nodes."""

    def __init__(self, pipe: Connection) -> None:
        super().__init__("humanoid_simulator")
        self._pipe = pipe
        taken, published, first = self._receive()
        self._publish_to = [self.create_publisher(topic.kind, topic.name, topic.qos) for topic in published]
        for number, topic in enumerate(taken):
            self.create_subscription(
                topic.kind, topic.name, partial(self._forward, number), topic.qos, raw=True
            )
        self._publish(first)

    def _forward(self, number: int, data: bytes) -> None:
        self._pipe.send((number, data))
        self._publish(self._receive())

    def _publish(self, messages: Iterable[Sent]) -> None:
        for number, data in messages:
            self._publish_to[number].publish(data)

    def _receive(self) -> Any:
        if not self._pipe.poll(_LONGEST):
            raise TimeoutError(f"the simulator's process has not answered for {_LONGEST:.0f} s")
        return self._pipe.recv()


class Attendant(Node):
    """Works next to the simulator: publishes what arrives for it, and collects what it publishes."""

    def __init__(self, simulator: Node) -> None:
        super().__init__("attendant")
        self.taken = _topics(simulator.subscriptions)
        self.published = _topics(simulator.publishers)
        self._publish_to = [self.create_publisher(topic.kind, topic.name, topic.qos) for topic in self.taken]
        self._heard: list[Sent] = []
        for number, topic in enumerate(self.published):
            self.create_subscription(topic.kind, topic.name, partial(self._hear, number), topic.qos, raw=True)
        self._reset = self.create_client(Trigger, "/humanoid_simulator/reset")
        self._executor = SingleThreadedExecutor()
        for node in (simulator, self):
            self._executor.add_node(node)

    def begin(self) -> list[Sent]:
        """Start again, now that somebody listens; returns the first readings."""
        self._reset.call_async(Trigger.Request())
        return self._answer()

    def pass_on(self, number: int, data: bytes) -> list[Sent]:
        """Pass a message to the simulator; returns what it publishes in response."""
        self._publish_to[number].publish(data)
        return self._answer()

    def _hear(self, number: int, data: bytes) -> None:
        self._heard.append((number, data))

    def _answer(self) -> list[Sent]:
        busy = True
        while busy:  # a round ends even if its callbacks have made others ready
            busy = False
            with suppress(TimeoutException):
                while True:
                    run, _, _ = self._executor.wait_for_ready_callbacks(timeout_sec=0)
                    run()
                    busy = True
        heard, self._heard = self._heard, []
        return heard


@contextmanager
def split(**parameters: Any) -> Generator[NodeGraph]:
    """Make all nodes except the simulator, which has these parameters and runs in another process."""
    context = multiprocessing.get_context("spawn")
    here, there = context.Pipe()
    process = context.Process(target=_serve, args=(there, parameters), daemon=True)
    process.start()
    there.close()
    try:
        with NodeGraph(simulator=lambda: StandIn(here)) as graph:
            yield graph
    finally:
        here.close()
        process.join(_ENDING)
        process.kill()


def _serve(pipe: Connection, parameters: dict[str, Any]) -> None:
    """Simulate until the other end is closed."""
    with alone():
        rclpy.init(args=[], signal_handler_options=SignalHandlerOptions.NO)
    simulator = make_simulator(**parameters)
    attendant = Attendant(simulator)
    pipe.send((attendant.taken, attendant.published, attendant.begin()))
    with suppress(EOFError):
        while True:
            pipe.send(attendant.pass_on(*pipe.recv()))
    for node in (attendant, simulator):
        node.destroy_node()
    rclpy.try_shutdown()


def _topics(ends: Iterable[Publisher[Any] | Subscription[Any]]) -> list[Topic]:
    return [
        Topic(
            end.topic_name,
            end.msg_type,
            end.qos_profile.depth,
            int(end.qos_profile.reliability),
            int(end.qos_profile.durability),
            int(end.qos_profile.deadline.nanoseconds),
        )
        for end in ends
        if not end.topic_name.startswith(_KEPT)
    ]
