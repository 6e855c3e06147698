"""Topics by their names: the full one, the class, and a subscription with QoS that loses nothing."""

from __future__ import annotations

import sys
from collections.abc import Callable
from typing import TYPE_CHECKING, Any, Final

from ifgen_runtime.field_types import type_name

from ifgen_tools import qos
from ifgen_tools.errors import ToolError
from ifgen_tools.session import Session
from ifgen_tools.types import class_with_hash, interface_class, message_name, topic_class, topic_types

if TYPE_CHECKING:
    from rclpy.qos import QoSProfile

# Late imports: rclpy is found once the session is open.

_LOOK_EVERY: Final = 1.0
"""Seconds between two looks at the types of a topic that is listened to."""

_DEPTH: Final = 1000
"""Messages that wait for a tool unless the user says how many: those of a second, where they are small."""


def full_topic(session: Session, name: str) -> str:
    """The full name of a topic that a user wrote. Raises ToolError if it can be none."""
    from rclpy.exceptions import InvalidTopicNameException
    from rclpy.expand_topic_name import expand_topic_name
    from rclpy.validate_full_topic_name import validate_full_topic_name

    node = session.node
    try:
        validate_full_topic_name(expand_topic_name(name, node.get_name(), node.get_namespace()))
    except (InvalidTopicNameException, ValueError) as error:
        reason = str(error).partition("\n")[0].removeprefix("Invalid topic name: ").rstrip(":")
        raise ToolError(f"{name!r} can be no topic: {reason}", "write it such as /robot/odometry") from None
    return node.resolve_topic_name(name)


def find_topic(session: Session, name: str, spin_time: float | None, *, must_exist: bool = True) -> str:
    """Wait until the graph is known, and for a topic that must exist; return its full name in any case."""
    topic = full_topic(session, name)
    session.discover(spin_time, until=lambda: not must_exist or bool(topic_types(session.node, topic)))
    return topic


def class_on(session: Session, topic: str, named: str | None) -> type[Any]:
    """The class of a topic, of the type that the user named if there is a name.

    If the topic has that type, its own definition of it counts. Raises ToolError.
    """
    if named is None:
        return topic_class(session.node, topic)
    written = message_name(named)
    if (found := _class_in_use(session, topic, written)) is not None:
        return found
    try:
        return interface_class(written)
    except ToolError:  # whoever has it may be late
        session.discover(until=lambda: bool(topic_types(session.node, topic)))
        if (found := _class_in_use(session, topic, written)) is not None:
            return found
        raise


def _class_in_use(session: Session, topic: str, name: str) -> type[Any] | None:
    known = [each for each in topic_types(session.node, topic) if each.name == name]
    return class_with_hash(session.node, topic, known[0]) if known else None


def refuse_other_types(session: Session, topic: str, cls: type[Any]) -> None:
    """Raise ToolError if a topic is there, and is of other types than the class."""
    found = {each.name for each in topic_types(session.node, topic)}
    if found and type_name(cls) not in found:
        raise _of_other_types(topic, found, type_name(cls))


def _of_other_types(topic: str, found: set[str], name: str) -> ToolError:
    return ToolError(
        f"the topic {topic!r} has the type {' and '.join(sorted(found))}, not {name}",
        f"see `ifgen topic type {topic}`",
    )


def wait_for_topic(session: Session, topic: str) -> type[Any]:
    """The class of a topic, once somebody has it; says so if nobody has it yet. Raises ToolError.

    If several types are on it, that of its publishers counts.
    """
    if not topic_types(session.node, topic):
        print(f"WARNING: topic [{topic}] does not appear to be published yet", file=sys.stderr, flush=True)
        session.lookout.tell_of_other()
        session.wait_for(lambda: bool(topic_types(session.node, topic)))
    published = {info.topic_type for info in session.node.get_publishers_info_by_topic(topic)}
    types = topic_types(session.node, topic)
    if len(published) > 1 or (not published and len({each.name for each in types}) > 1):
        names = ", ".join(sorted(published or {each.name for each in types}))
        raise ToolError(
            f"the topic {topic!r} has more than one type: {names}", f"see `ifgen topic info -v {topic}`"
        )
    if published:
        return class_with_hash(session.node, topic, next(each for each in types if each.name in published))
    return topic_class(session.node, topic)


def _profile_for(session: Session, topic: str, chosen: qos.QosChoice) -> QoSProfile:
    """The profile to listen with: what the user chose, else one that fits all publishers."""
    publishers = session.node.get_publishers_info_by_topic(topic)
    profile = qos.profile_of(chosen, "sensor_data")
    if not chosen.has_policies:
        for remark in qos.fitting(profile, publishers):
            print(remark, file=sys.stderr, flush=True)
        if chosen.profile is None:
            profile.depth = _DEPTH
    return profile


def listen(
    session: Session,
    topic: str,
    cls: type[Any],
    hear: Callable[..., None],
    chosen: qos.QosChoice,
    *,
    raw: bool = False,
    on_lost: Callable[[Any], None] | None = None,
    is_named: bool = False,
) -> None:
    """Subscribe, and say on stderr which publishers do not match what the user chose.

    Where the user named the type, spinning raises ToolError once the topic is published as others only.
    """
    from rclpy.event_handler import SubscriptionEventCallbacks, UnsupportedEventTypeError

    profile = _profile_for(session, topic, chosen)
    on_obstacle = qos.teller_of_obstacles(session.node, topic, profile, publishes=False)
    subscribe: Any = session.node.create_subscription  # its overloads know no `raw` that is decided here
    events = SubscriptionEventCallbacks(message_lost=on_lost, incompatible_qos=on_obstacle)
    try:
        subscribe(cls, topic, hear, profile, raw=raw, event_callbacks=events)
    except UnsupportedEventTypeError:  # this middleware does not tell
        subscribe(cls, topic, hear, profile, raw=raw)
    _watch_types(session, topic, type_name(cls), is_named)
    if not session.node.count_publishers(topic):
        session.lookout.tell_of_other()


def _watch_types(session: Session, topic: str, name: str, is_named: bool) -> None:
    """Say or raise it once if a topic is published as other types only: nothing would be heard."""
    from rclpy.clock import Clock, ClockType

    def check() -> None:
        published = {info.topic_type for info in session.node.get_publishers_info_by_topic(topic)}
        if published and name not in published:
            timer.cancel()
            if is_named:  # discovery was too late for `refuse_other_types`
                raise _of_other_types(topic, published, name)
            others = ", ".join(sorted(published))
            print(f"WARNING: {topic} is published as {others}, not as {name}", file=sys.stderr, flush=True)

    timer = session.node.create_timer(_LOOK_EVERY, check, clock=Clock(clock_type=ClockType.STEADY_TIME))
