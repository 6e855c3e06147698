"""Two processes of one test, and what is between them.

A domain of this process stands for a process, or a context for one if all share a domain. Within it, and over the
recording transport, everything arrives at once; over Zenoh a little later; in lockstep when the pair is spun.
"""

from __future__ import annotations

import itertools
import socket
import tempfile
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pytest
from rclpy.context import Context
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile
from rmw_local.domain import Domain
from rmw_local.lockstep.side import Channel, Side
from rmw_local.lockstep.transport import LockstepTransport
from rmw_local.transports.discovery import Discovery
from rmw_local.transports.environment import Environment
from rmw_local.transports.link import Link

from tests.rclpy.network import Network

LIMIT = 10.0  # [s] for what another thread does
DURABLE = QoSProfile(depth=3, durability=DurabilityPolicy.TRANSIENT_LOCAL)
WITHIN, ACROSS, IN_ROUNDS = ("inside",), ("recorded", "zenoh"), ("lockstep",)
BY_QUERIES = ("queries",)  # Zenoh as it connects machines
_domains = itertools.count(1000)  # no test uses those


@dataclass
class Process:
    """What stands for a process."""

    name: str
    node: Node
    executor: SingleThreadedExecutor
    domain: Domain
    link: Link | None
    side: Side | None = None

    def leave(self) -> None:
        """Leave the graph: the others see it no longer."""
        if self.link is None:
            self.node.destroy_node()
        elif self.side is not None:
            self.link.close()
            self.side.is_over = True
        else:
            self.link.close()


class Pair:
    """Processes and what is between them: `inside` (nothing), `recorded`, `zenoh`, `queries` or `lockstep`."""

    def __init__(self, kind: str, folder: Path) -> None:
        self.kind = kind
        self.network = Network()
        self.folder = folder
        self._endpoints: list[str] = []
        self._shared = next(_domains)
        self.reach = Environment()
        self.processes: list[Process] = []
        self.sides: list[Side] = []

    def process(self, name: str) -> Process:
        """One more of them, with a node of this name."""
        domain = Domain.numbered(self._shared if self.kind == "inside" else next(_domains))
        domain.discovery = Discovery(domain)  # never begun: nobody else is looked for
        context = Context()
        context.init(args=[], domain_id=domain.number, initialize_logging=False)
        node = Node(name, context=context)
        executor = SingleThreadedExecutor(context=context)
        executor.add_node(node)
        process = Process(name, node, executor, domain, None)
        self.processes.append(process)
        if self.kind != "inside":
            self.join(process)
        return process

    def join(self, process: Process) -> None:
        """Connect it to the others, once more if it had left."""
        if self.kind == "lockstep":
            process.side = Side(len(self.sides), Channel(socket.socketpair()[0]))
            self.sides.append(process.side)
            transport = process.side._transports[0] = LockstepTransport(process.side, 0)
            process.link = Link(process.domain, transport)
            process.link.open()
            return
        process.link = Link(process.domain, self._transport(process.name))
        process.link.open()

    def _transport(self, name: str) -> Any:
        if self.kind == "recorded":
            return self.network.join(name)
        from rmw_local.transports.zenoh.config import configuration
        from rmw_local.transports.zenoh.engine import ZenohTransport

        others = list(self._endpoints)
        endpoint = f"unixsock-stream/{self.folder}/{len(others)}"
        self._endpoints.append(endpoint)
        if self.reach.routers:
            return ZenohTransport(7, lambda: configuration(self.reach, [], []))
        return ZenohTransport(
            7, lambda: configuration(self.reach, [endpoint], others), is_private=self.kind == "zenoh"
        )

    def until(self, condition: Callable[[], Any]) -> None:
        """Spin everybody until it is so."""
        end = time.monotonic() + LIMIT
        while not condition():
            assert time.monotonic() < end, "it did not happen in time"
            self._spin()

    def settle(self) -> None:
        """Spin everybody for a moment, so that what should not arrive would have."""
        for _ in range(40 if self.kind in {"zenoh", "queries"} else 3):
            self._spin()

    def _end_round(self) -> None:
        """Do for sides of lockstep what their coordinator does."""
        changes: list[tuple[Side, Any]] = []
        mail: list[Any] = []
        for side in self.sides:
            found, side._changes = side._changes, []
            changes += [(side, each) for each in found]
            mail.append(side._mail())
        gone = [side.number for side in self.sides if side.is_over]
        present = [side for side in self.sides if not side.is_over]
        for side in present:
            mail.append(side._learn([each for whose, each in changes if whose is not side], gone))
        for side in present:
            side._deliver([each[side.number] for each in mail if side.number in each])

    def _spin(self) -> None:
        if self.sides:
            self._end_round()
        for process in self.processes:
            if process.executor.context.ok():
                process.executor.spin_once(timeout_sec=0.001)

    def end(self) -> None:
        """Let all of them leave, and close what they have."""
        for process in self.processes:
            process.executor.shutdown()
            process.node.destroy_node()
            process.leave()
            process.node.context.try_shutdown()


@contextmanager
def connected(kind: str) -> Iterator[Pair]:
    """A pair until the end of the block; skips the test where Zenoh is missing."""
    if kind in {"zenoh", "queries"}:
        pytest.importorskip("zenoh")
    with tempfile.TemporaryDirectory(dir="/tmp") as folder:  # sockets have short names
        pair = Pair(kind, Path(folder))
        try:
            yield pair
        finally:
            pair.end()
