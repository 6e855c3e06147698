"""`ifgen topic pub`."""

from __future__ import annotations

import sys
from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Final

import click

from ifgen_tools import qos
from ifgen_tools.errors import ToolError
from ifgen_tools.session import Session, open_session
from ifgen_tools.texts import filling
from ifgen_tools.texts.field_types import type_name
from ifgen_tools.topic import listening
from ifgen_tools.types import topic_types

if TYPE_CHECKING:
    from rclpy.publisher import Publisher
    from rclpy.qos import QoSProfile

# Late imports: rclpy is found once the session is open.

_EVERY: Final = 1.0
"""Seconds between two lines that say what is waited for."""


@dataclass(frozen=True, slots=True)
class Plan:
    """How often something is published: at a rate [Hz], N times (0: for ever), every n-th one printed.

    `subscriptions` are waited for before, for `patience` [s] at most (None: for ever). Afterwards the node
    stays for `keep_alive` [s].
    """

    rate: float
    times: int
    print_every: int
    subscriptions: int
    patience: float | None
    keep_alive: float


def pub(
    *,
    topic_name: str,
    message_type: str,
    values: str | None,
    stdin: bool,
    once: bool,
    times: int | None,
    rate: float,
    print_every: int,
    wait_matching: int | None,
    max_wait: float | None,
    keep_alive: float,
    node_name: str | None,
    transport: Any,
    spin_time: float | None,
    use_sim_time: bool,
    **options: Any,
) -> int:
    """Publish a message, once or again and again."""
    if once and times is not None:
        raise click.UsageError("--once and --times exclude each other: leave out one")
    if stdin and values is not None:
        raise click.UsageError("--stdin reads the values: leave out VALUES")
    times = 1 if once else times or 0
    waited = int(times > 0) if wait_matching is None else wait_matching
    if max_wait is not None and not waited:
        raise click.UsageError("--max-wait-time-secs needs --wait-matching-subscriptions, --once or --times")
    document = filling.read_yaml(sys.stdin.read() if stdin else values or "{}")
    chosen = qos.chosen_qos(options)
    with open_session(transport, name=node_name, use_sim_time=use_sim_time) as session:
        topic = listening.find_topic(session, topic_name, spin_time, must_exist=False)
        cls = listening.class_on(session, topic, message_type)
        message = cls()
        stamps = filling.fill(message, document)
        _tell_of_other_types(session, topic, type_name(cls))
        profile = qos.profile_of(chosen, "default")
        publisher = _publisher(session, cls, topic, profile)
        _publish(
            session,
            publisher,
            message,
            stamps,
            Plan(rate, times, print_every, waited, max_wait, keep_alive),
        )
    return 0


def _publish(
    session: Session,
    publisher: Publisher[Any],
    message: Any,
    stamps: list[filling.SetStamp],
    plan: Plan,
) -> None:
    _wait_for_subscriptions(session, publisher, plan)
    print("publisher: beginning loop", flush=True)
    count = 0

    def send() -> None:
        nonlocal count
        stamp = session.node.get_clock().now().to_msg()
        for set_stamp in stamps:
            set_stamp(stamp)
        count += 1
        if plan.print_every and count % plan.print_every == 0:
            print(f"publishing #{count}: {message!r}\n", flush=True)
        publisher.publish(message)

    send()
    if plan.times != 1:
        timer = session.node.create_timer(1 / plan.rate, send)
        session.wait_for(lambda: 0 < plan.times <= count)
        timer.cancel()
    session.wait_for(lambda: False, plan.keep_alive)  # the last message is on its way


def _wait_for_subscriptions(session: Session, publisher: Publisher[Any], plan: Plan) -> None:
    wanted, waited = plan.subscriptions, 0.0
    enough: Callable[[], bool] = lambda: publisher.get_subscription_count() >= wanted  # noqa: E731
    while not enough():
        print(f"Waiting for at least {wanted} matching subscription(s)...", flush=True)
        session.lookout.tell_of_other()
        left = _EVERY if plan.patience is None else min(_EVERY, plan.patience - waited)
        if session.wait_for(enough, left):
            return
        waited += left
        if plan.patience is not None and waited >= plan.patience:
            found = publisher.get_subscription_count()
            raise ToolError(
                f"{found} of {wanted} subscriptions have come within {plan.patience:g} s",
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
