"""`ifgen topic list`, `info`, `type` and `find`: the topics in the graph."""

from __future__ import annotations

import json
from collections.abc import Iterable
from dataclasses import asdict, dataclass
from typing import TYPE_CHECKING, Any

from ifgen.command_kit.tool import Absent, did_you_mean

from ifgen_tools.ros_graph import full_name, is_hidden
from ifgen_tools.session import open_session
from ifgen_tools.topic.topics import find_topic
from ifgen_tools.types import message_name
from ifgen_tools.verbs import FindOptions, ListOptions, NameOptions

if TYPE_CHECKING:
    from rclpy.node import Node
    from rclpy.topic_endpoint_info import TopicEndpointInfo


@dataclass(frozen=True, slots=True)
class Topic:
    """A topic with its types, and how many publish and subscribe."""

    name: str
    types: list[str]
    publishers: int
    subscribers: int


def list_topics(chosen: ListOptions) -> int:
    """Print the topics."""
    with open_session(chosen.transport, use_sim_time=chosen.use_sim_time) as session:
        session.discover(chosen.spin_time)
        found = topics(session.node, chosen.include_hidden)
    if chosen.count:
        print(len(found))
    elif chosen.as_json:
        print(json.dumps([asdict(each) for each in found], indent=2))
    elif chosen.verbose and found:
        print("\n".join((_counted(found, "Published"), _counted(found, "Subscribed"))))
    else:
        for each in found:
            print(f"{each.name} [{', '.join(each.types)}]" if chosen.show_types else each.name)
    return 0


def topics(node: Node, include_hidden: bool) -> list[Topic]:
    """The topics that a node sees, sorted by name."""
    found = (
        Topic(name, list(types), node.count_publishers(name), node.count_subscribers(name))
        for name, types in node.get_topic_names_and_types()
    )
    return sorted((t for t in found if include_hidden or not is_hidden(t.name)), key=lambda t: t.name)


def _counted(found: Iterable[Topic], role: str) -> str:
    lines = [f"{role} topics:"]
    noun = "publisher" if role == "Published" else "subscriber"
    for each in found:
        count = each.publishers if role == "Published" else each.subscribers
        if count:
            lines.append(f" * {each.name} [{', '.join(each.types)}] {count} {noun}{'s' if count > 1 else ''}")
    return "\n".join(lines) + "\n"


def info(chosen: NameOptions) -> int:
    """Print the type of a topic, and who is on it."""
    with open_session(chosen.transport, use_sim_time=chosen.use_sim_time) as session:
        node, name = session.node, find_topic(session, chosen.name, chosen.spin_time)
        types = _types(node, name)
        sides = {
            "Publisher": node.get_publishers_info_by_topic(name),
            "Subscription": node.get_subscriptions_info_by_topic(name),
        }
    if chosen.as_json:
        ends = {f"{side.lower()}s": [_plain(each) for each in infos] for side, infos in sides.items()}
        print(json.dumps({"name": name, "types": types, **ends}, indent=2))
        return 0
    end = "\n\n" if chosen.verbose else "\n"
    print(f"Type: {types[0] if len(types) == 1 else types}", end=end)
    for side, infos in sides.items():
        print(f"{side} count: {len(infos)}", end=end)
        for each in infos if chosen.verbose else ():
            print(each, end=end)
    return 0


def _plain(endpoint: TopicEndpointInfo) -> dict[str, Any]:
    profile = endpoint.qos_profile
    return {
        "node": full_name(endpoint.node_name, endpoint.node_namespace),
        "type": endpoint.topic_type,
        "hash": str(endpoint.topic_type_hash),
        "gid": bytes(endpoint.endpoint_gid).hex(),
        "qos": {
            **{
                p: getattr(profile, p).short_key
                for p in ("history", "reliability", "durability", "liveliness")
            },
            "depth": profile.depth,
            **{
                p: getattr(profile, p).nanoseconds / 1e9
                for p in ("deadline", "lifespan", "liveliness_lease_duration")
            },
        },
    }


def type_(chosen: NameOptions) -> int:
    """Print the types of a topic."""
    with open_session(chosen.transport, use_sim_time=chosen.use_sim_time) as session:
        types = _types(session.node, find_topic(session, chosen.name, chosen.spin_time))
    print(json.dumps(types) if chosen.as_json else "\n".join(types))
    return 0


def find(chosen: FindOptions) -> int:
    """Print the topics of a type."""
    with open_session(chosen.transport, use_sim_time=chosen.use_sim_time) as session:
        session.discover(chosen.spin_time)
        wanted = message_name(chosen.type_name)
        found = [each.name for each in topics(session.node, chosen.include_hidden) if wanted in each.types]
    if chosen.count:
        print(len(found))
    elif chosen.as_json:
        print(json.dumps(found))
    else:
        print("".join(f"{name}\n" for name in found), end="")
    return 0


def _types(node: Node, topic: str) -> list[str]:
    known = dict(node.get_topic_names_and_types())
    if topic not in known:
        help = did_you_mean(topic, sorted(known)) or "see `ifgen topic list`"
        raise Absent(f"there is no topic {topic!r}", help)
    return list(known[topic])
