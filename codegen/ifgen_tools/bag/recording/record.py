"""`ifgen bag record`: writes what is published into a bag."""

from __future__ import annotations

import signal
import time
from collections import deque
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from datetime import datetime
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final, Literal

from ifgen.signals import Interrupt, defer_interrupt
from ifgen_runtime.bag.writer import BagWriter, Format, Limits, storage_of

from ifgen_tools.bag.keys import SPACE, keyboard
from ifgen_tools.bag.output import require_new, telling
from ifgen_tools.bag.saying import say, warn
from ifgen_tools.bag.selection import Selection
from ifgen_tools.errors import ToolError
from ifgen_tools.session import Session, open_session

if TYPE_CHECKING:
    from ifgen_runtime.bag.topics import Channel
    from rclpy.qos import QoSProfile

    from ifgen_tools.bag.recording.recorder import Write

# Late imports: those of rclpy, once the transport has been chosen.

_LOOK: Final = 0.1
"""Seconds between two looks at the keys."""

_ON_ITS_WAY: Final = 0.1
"""Seconds after a signal within which what was published before it arrives."""

_PATIENCE: Final = {signal.SIGINT: 60.0, signal.SIGTERM: 5.0}
"""Seconds at most for writing what waits after a signal. After SIGTERM, SIGKILL may follow in 10 s."""


@dataclass(frozen=True, slots=True)
class RecordCommand:
    """The topics to record, and where to write them."""

    choice: Selection
    output: Path | None = None
    format: Format = field(default_factory=Format)
    limits: Limits = field(default_factory=Limits)
    qos_overrides: Path | None = None
    include_unpublished: bool = False
    ignore_leaves: bool = False
    has_discovery: bool = True
    interval: float = 0.1
    """Seconds between two looks at the graph."""
    use_sim_time: bool = False
    is_paused: bool = False
    snapshot_size: int = 0
    """Bytes of messages that are kept until somebody asks for a snapshot; 0 records at once."""
    custom_data: Mapping[str, str] = field(default_factory=dict[str, str])
    has_keys: bool = True
    node_name: str = "rosbag2_recorder"
    most_waiting: int = 2**30
    """Bytes of messages that may wait for the disk."""


def record(
    transport: Literal["local", "rclpy", "auto"],
    command: RecordCommand,
    is_done: Callable[[Recording], bool] = lambda _: False,
) -> int:
    """Record until somebody interrupts it, or until `is_done`; the bag is complete then."""
    output = command.output or Path(datetime.now().strftime("rosbag2_%Y_%m_%d-%H_%M_%S"))
    is_folder = storage_of(output) is None
    limits = command.limits
    if not is_folder and (limits.size or limits.duration or command.format.outer):
        raise ToolError(
            f"{output} is a single file, and cannot be split or compressed as a whole",
            help=f"name a folder with -o, such as {output.stem}",
        )
    require_new(output)
    session = open_session(transport, (), command.node_name, use_sim_time=command.use_sim_time)
    with session as opened, telling(output):
        Recording(opened, command, output, is_folder).run(is_done)
    return 0


class Recording:
    """A bag that is recorded by the node of a session."""

    def __init__(self, session: Session, command: RecordCommand, output: Path, is_folder: bool) -> None:
        from ifgen_tools.bag.qos import overrides
        from ifgen_tools.bag.recording.recorder import RecordOptions, TopicRecorder
        from ifgen_tools.bag.recording.services import offer_services

        self._session, self._command, self._output = session, command, output
        options = RecordOptions(
            command.choice,
            overrides(command.qos_overrides),
            command.include_unpublished,
            command.ignore_leaves,
            command.use_sim_time,
            command.most_waiting,
        )
        self.topics = TopicRecorder(session.node, options, self._open)
        self.topics.is_paused = command.is_paused
        self.writer = BagWriter(
            output, command.format, is_folder, command.limits, command.custom_data, on_split=_tell_split
        )
        self._kept: deque[tuple[Channel, int, int, bytes]] = deque()
        self._kept_size = 0
        offer_services(session.node, self)

    def run(self, is_done: Callable[[Recording], bool]) -> None:
        """Record, and complete the bag whatever ends it."""
        command = self._command
        with (
            defer_interrupt(patience=2) as interrupt,  # a write that is cut short leaves half a record
            keyboard({SPACE: ("pause or resume", self.toggle)}, is_wanted=command.has_keys) as keys,
        ):
            try:
                legend = f" ({keys.legend})" if keys.legend else ""
                say(f"Recording to {self._output}. Press Ctrl-C to stop{legend}")
                say("Listening for topics...")  # launch files and tests wait for these words of rosbag2
                self._session.discover()
                self.topics.look()
                if not self.topics.is_paused:
                    say("Recording...")  # and for these
                if command.has_discovery:
                    self._look_again(self._session.node, command.interval)
                while self._session.context.ok() and not interrupt.number and not is_done(self):
                    self._session.turn(0.0 if self.topics.has_waiting else _LOOK)
                    self.topics.record_some()
                    self.writer.flush_old()
                    keys.look()
                if interrupt.number:
                    self._take_what_came(interrupt)
            except Exception:
                self.topics.leave(time.time_ns())
                raise
            finally:
                self.topics.close()
                try:
                    self.writer.close()
                finally:
                    self._summarise()
        interrupt.raise_again()

    def _take_what_came(self, interrupt: Interrupt) -> None:
        """Record what has come, or was on its way; count what cannot be recorded in time."""
        until = time.time_ns() + round(_ON_ITS_WAY * 1e9)
        while (left := until - time.time_ns()) > 0:
            self._session.executor.spin_once(timeout_sec=left / 1e9)
        begin = time.monotonic()
        asides = ["Writing what came before. Press Ctrl-C again to leave it out"]

        def may_go_on() -> bool:
            passed = time.monotonic() - begin
            if passed > 1 and asides:
                say(asides.pop())
            return passed < _PATIENCE[signal.Signals(interrupt.number)] and interrupt.count == 1

        self.topics.drain(until, may_go_on)
        self.topics.leave(until)

    def _look_again(self, node: Any, interval: float) -> None:
        from rclpy.clock import Clock, ClockType

        node.create_timer(interval, self.topics.look, clock=Clock(clock_type=ClockType.STEADY_TIME))

    def toggle(self) -> None:
        """Pause, or go on."""
        self.topics.is_paused = not self.topics.is_paused
        say("Recording paused" if self.topics.is_paused else "Recording resumed")

    def snapshot(self) -> bool:
        """Write what has been kept; returns whether there was anything."""
        kept, self._kept, self._kept_size = self._kept, deque(), 0
        for message in kept:
            self.writer.write(*message)
        return bool(kept)

    def _open(self, topic: str, cls: type[Any], offers: list[QoSProfile]) -> Write:
        from ifgen_runtime.bag.definitions import definition_of
        from ifgen_runtime.bag.qos import offered
        from ifgen_runtime.bag.topics import Channel

        channel = Channel(topic, definition_of(cls), tuple(dict.fromkeys(map(offered, offers))))
        self.writer.add(channel)
        write: Callable[[Channel, int, int, bytes], None] = self.writer.write
        if self._command.snapshot_size:
            write = self._keep

        def writes(data: bytes, received: int, published: int) -> None:
            write(channel, received, published, data)

        return writes

    def _keep(self, channel: Channel, received: int, published: int, data: bytes) -> None:
        """Keep a message for a snapshot, and forget the oldest ones."""
        self._kept.append((channel, received, published, data))
        self._kept_size += len(data)
        while self._kept_size > self._command.snapshot_size:
            self._kept_size -= len(self._kept.popleft()[3])

    def _summarise(self) -> None:
        count = self.writer.count
        say(f"Recorded {count:,} message{'s' * (count != 1)} to {self._output}")
        for topic, lost in self.topics.lost.items():
            warn(f"on the way here, {_messages(lost, topic)} lost")
        for topic, left in sorted((+self.topics.left).items()):
            warn(f"{_messages(left, topic)} received, and not recorded: the disk was too slow")


def _messages(count: int, topic: str) -> str:
    return f"1 message of {topic} was" if count == 1 else f"{count:,} messages of {topic} were"


def _tell_split(closed: Path, opened: Path) -> None:
    say(f"{closed.name} is full, going on in {opened.name}")
