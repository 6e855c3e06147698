"""`ifgen bag play`: publishes the messages of a bag as they were recorded."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Final

from ifgen.command_kit.tool import ToolError

from ifgen_tools.bag.files import reading, say, warn
from ifgen_tools.bag.keys import DOWN, RIGHT, SPACE, UP, keyboard
from ifgen_tools.bag.options import PlayOptions, is_service_event
from ifgen_tools.bag.player import PlayClock, Player, Range, part
from ifgen_tools.bag.services import Requester, requester, wait_for_answers, wait_for_servers
from ifgen_tools.session import Session, open_session

if TYPE_CHECKING:
    from ifgen_runtime.bag import Bag
    from ifgen_runtime.bag.topics import Channel, Definition
    from rclpy.publisher import Publisher

# Late imports: those of rclpy, once the transport has been chosen.

_S: Final = 10**9
_NODE: Final = "rosbag2_player"
_FASTER: Final = 1.1
"""The factor by which a key changes the rate."""


def play(options: PlayOptions) -> int:
    """Play a bag until its end."""
    options.check()
    arguments = ["--ros-args", *(part for rule in options.remap for part in ("--remap", rule))]
    with reading(options.bag_path, unlimited=options.unlimited) as bag:
        if bag.start is None or bag.end is None:
            raise ToolError(f"{bag.path} has no messages", help="`ifgen bag info` shows what is in it")
        span = _span(bag.start, bag.end, options)
        with open_session(options.transport, arguments if options.remap else (), _NODE) as session:
            _Playing(bag, session, options, span).run()
    return 0


@dataclass(frozen=True, slots=True)
class Due:
    """A message on its way out."""

    received: int
    topic: str
    data: bytes
    publish: Callable[[bytes], None]


class _Playing:
    """A bag that is played by the node of a session."""

    def __init__(self, bag: Bag, session: Session, options: PlayOptions, span: Range) -> None:
        from rclpy.clock import Clock, ClockType

        from ifgen_tools.bag.qos import overrides
        from ifgen_tools.bag.services import offer_player_services

        self._bag, self._session, self._options = bag, session, options
        self._choice = options.of_bag()
        self._overrides = overrides(options.qos_overrides)
        steady = Clock(clock_type=ClockType.STEADY_TIME)
        clock = PlayClock(
            lambda: steady.now().nanoseconds, span.start, options.rate, is_paused=options.start_paused
        )
        self._player = Player(self._messages, self._publish, self._wait, clock, span, delay=options.delay)
        self._publishers: dict[tuple[str, Definition], Callable[[bytes], None]] = {}
        self._all: list[Publisher[Any]] = []
        self._requesters: list[Requester] = []
        self._topics = [
            topic for topic in bag.topics.values() if self._is_chosen(topic.name, topic.type_name)
        ]
        self._clock_publisher = self._clock() if options.clock or self._before is not None else None
        if options.request_events is not None:
            session.discover()
        for channel in bag.channels:
            if any(channel.topic == topic.name for topic in self._topics):
                self._open(channel)
        if not self._publishers:
            raise ToolError(f"nothing of {bag.path} is played", help="`ifgen bag info` shows its topics")
        offer_player_services(session.node, self._player)

    @property
    def _before(self) -> frozenset[str] | None:
        """The topics before whose messages /clock is published; None for no topic."""
        if self._options.clock_topics_all:
            return frozenset(topic.name for topic in self._topics)
        return frozenset(self._options.clock_topics) or None

    def run(self) -> None:
        """Play it."""
        player = self._player
        if self._requesters:
            wait_for_servers(self._session, self._requesters)
        actions: dict[str, tuple[str, Callable[[], object]]] = {
            SPACE: ("pause or resume", self._toggle),
            RIGHT: ("next message", self._step),
            UP: ("10 % faster", lambda: self._change_rate(_FASTER)),
            DOWN: ("10 % slower", lambda: self._change_rate(1 / _FASTER)),
        }
        with keyboard(actions, is_wanted=not self._options.disable_keyboard_controls) as self._keyboard:
            if self._keyboard.legend:
                say(self._keyboard.legend)
            player.play(is_looping=self._options.loop)
        wait_for_answers(self._session, self._requesters)
        self._wait_for_acknowledgements()

    def _toggle(self) -> None:
        self._player.toggle()
        at = (self._player.clock.now() - (self._bag.start or 0)) / _S
        say(f"paused at {at:.3f} s" if self._player.clock.is_paused else "playing")

    def _step(self) -> None:
        if not self._player.clock.is_paused:
            say("SPACE pauses: after that, the right arrow publishes the next message")
        self._player.step(1)

    def _change_rate(self, factor: float) -> None:
        self._player.set_rate(self._player.clock.rate * factor)
        say(f"rate {self._player.clock.rate:.2f}")

    def _is_chosen(self, topic: str, type_name: str) -> bool:
        if topic == "/clock" and (
            self._options.clock or self._options.clock_topics or self._options.clock_topics_all
        ):
            return False  # two clocks would contradict each other
        return self._choice.takes(topic, type_name)

    def _open(self, channel: Channel) -> None:
        from ifgen_runtime.bag import BagError

        from ifgen_tools.bag.qos import adapted_offer

        topic = channel.topic
        if (topic, channel.definition) in self._publishers:
            return  # from another file
        offer, disagree = adapted_offer(self._bag.topics[topic].qos)
        if disagree and topic not in self._overrides:
            warn(f"publishers of {topic} had different QoS: the default is used")
        try:
            cls = self._bag.class_for(channel)
        except BagError as error:
            warn(f"{topic} is not played: {error}")
            return
        if self._options.request_events is not None and is_service_event(topic):
            caller = requester(self._session, topic, cls, self._options.request_events)
            if caller is not None:
                self._requesters.append(caller)
                self._publishers[topic, channel.definition] = caller.send
            return
        try:
            publisher = self._session.node.create_publisher(cls, topic, self._overrides.get(topic, offer))
        except (RuntimeError, ValueError) as error:  # another type has this name; RCLError has no public name
            warn(f"{topic} is not played: {error}")
            return
        self._all.append(publisher)
        self._publishers[topic, channel.definition] = publisher.publish

    def _clock(self) -> Publisher[Any]:
        from rclpy.qos import QoSProfile
        from rosgraph_msgs.msg import Clock

        node = self._session.node
        publisher = node.create_publisher(Clock, "/clock", QoSProfile(depth=1))
        if self._options.clock:
            from rclpy.clock import Clock as RosClock
            from rclpy.clock import ClockType

            steady = RosClock(clock_type=ClockType.STEADY_TIME)
            node.create_timer(1 / self._options.clock, self._tell_time, clock=steady)
        return publisher

    def _tell_time(self, now: int | None = None) -> None:
        from rosgraph_msgs.msg import Clock

        assert self._clock_publisher is not None
        message = Clock()
        message.clock.sec, message.clock.nanosec = divmod(
            self._player.clock.now() if now is None else now, _S
        )
        self._clock_publisher.publish(message)

    def _messages(self, start: int) -> Iterator[Due]:
        names = [topic.name for topic in self._topics]
        for received, _, channel, data in self._bag.entries(*names, start=start):
            publish = self._publishers.get((channel.topic, channel.definition))
            if publish is not None:
                yield Due(received, channel.topic, data, publish)

    def _publish(self, due: Due) -> None:
        if (before := self._before) is not None and due.topic in before:
            self._tell_time(due.received)
        due.publish(due.data)

    def _wait(self, seconds: float) -> None:
        self._session.turn(seconds)
        self._keyboard.look()

    def _wait_for_acknowledgements(self) -> None:
        from rclpy.duration import Duration

        timeout = self._options.wait_for_all_acked / 1000
        if timeout:
            limit = Duration(nanoseconds=-1) if timeout < 0 else Duration(seconds=timeout)
            for publisher in self._all:
                publisher.wait_for_all_acked(limit)


def _span(start: int, end: int, options: PlayOptions) -> Range:
    first = start + round(options.start_offset * _S)
    if first > end:
        length = (end - start) / _S
        raise ToolError(
            f"--start-offset {options.start_offset:g} is after the end: the bag is {length:.3f} s long",
            help="name an offset from its start in seconds",
        )
    return part(first, end, options.duration, options.until)
