"""`ifgen topic pub`."""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING, Any, Final

import click
from ifgen.command_kit.tool import ToolError
from ifgen_runtime.field_types import type_name

from ifgen_tools import qos
from ifgen_tools.session import Session, open_session
from ifgen_tools.texts.set_fields import read_yaml, set_fields
from ifgen_tools.topic import topics
from ifgen_tools.topic.options import PubOptions
from ifgen_tools.types import topic_types

if TYPE_CHECKING:
    from rclpy.publisher import Publisher
    from rclpy.qos import QoSProfile

# Late imports: rclpy is found once the session is open.

_EVERY: Final = 1.0
"""Seconds between two lines that say what is waited for."""


def pub(chosen: PubOptions) -> int:
    """Publish a message, once or again and again."""
    if chosen.once and chosen.times is not None:
        raise click.UsageError("--once and --times exclude each other: leave out one")
    if chosen.stdin and chosen.values is not None:
        raise click.UsageError("--stdin reads the values: leave out VALUES")
    times = 1 if chosen.once else chosen.times or 0  # 0 is for ever
    wanted = int(times > 0) if chosen.wait_matching is None else chosen.wait_matching
    if chosen.max_wait is not None and not wanted:
        raise click.UsageError("--max-wait-time-secs needs --wait-matching-subscriptions, --once or --times")
    values = read_yaml(sys.stdin.read() if chosen.stdin else chosen.values or "{}")
    with open_session(chosen.transport, name=chosen.node_name, use_sim_time=chosen.use_sim_time) as session:
        topic = topics.find_topic(session, chosen.name, chosen.spin_time, must_exist=False)
        cls = topics.class_on(session, topic, chosen.message_type)
        message = cls()
        stamps = set_fields(message, values)
        _tell_of_other_types(session, topic, type_name(cls))
        publisher = _publisher(session, cls, topic, qos.profile_of(chosen.qos, "default"))
        _wait_for_subscriptions(session, publisher, wanted, chosen.max_wait)
        print("publisher: beginning loop", flush=True)
        count = 0

        def send() -> None:
            nonlocal count
            now = session.node.get_clock().now().to_msg()
            for set_stamp in stamps:
                set_stamp(now)
            count += 1
            if chosen.print_every and count % chosen.print_every == 0:
                print(f"publishing #{count}: {message!r}\n", flush=True)
            publisher.publish(message)

        send()
        if times != 1:
            timer = session.node.create_timer(1 / chosen.rate, send)
            session.wait_for(lambda: 0 < times <= count)
            timer.cancel()
        session.wait_for(lambda: False, chosen.keep_alive)  # the last message is on its way
    return 0


def _wait_for_subscriptions(
    session: Session, publisher: Publisher[Any], wanted: int, patience: float | None
) -> None:
    """Wait for ever without a `patience` [s]. Raises ToolError after it."""
    waited = 0.0

    def are_enough() -> bool:
        return publisher.get_subscription_count() >= wanted

    while not are_enough():
        print(f"Waiting for at least {wanted} matching subscription(s)...", flush=True)
        session.lookout.tell_of_other()
        left = _EVERY if patience is None else min(_EVERY, patience - waited)
        if session.wait_for(are_enough, left):
            return
        waited += left
        if patience is not None and waited >= patience:
            raise ToolError(
                f"{publisher.get_subscription_count()} of {wanted} subscriptions have come within "
                f"{patience:g} s",
                "see `ifgen topic info -v` for who is on the topic",
            )


def _publisher(session: Session, cls: type[Any], topic: str, profile: QoSProfile) -> Publisher[Any]:
    """A publisher that says on stderr which subscriptions do not match."""
    from rclpy.event_handler import PublisherEventCallbacks, UnsupportedEventTypeError

    on_obstacle = qos.teller_of_obstacles(session.node, topic, profile, publishes=True)
    try:
        events = PublisherEventCallbacks(incompatible_qos=on_obstacle)
        return session.node.create_publisher(cls, topic, profile, event_callbacks=events)
    except UnsupportedEventTypeError:  # this middleware does not tell
        return session.node.create_publisher(cls, topic, profile)


def _tell_of_other_types(session: Session, topic: str, name: str) -> None:
    others = {known.name for known in topic_types(session.node, topic)} - {name}
    if others:
        print(f"warning: {topic} has the type {', '.join(sorted(others))} too", file=sys.stderr, flush=True)
