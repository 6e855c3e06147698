"""Which node has which definition of a type, as the graph of a running system tells it: nobody is asked.

Nothing of rclpy is imported: a node is asked through its own methods.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, replace
from types import MappingProxyType
from typing import Any, Final, NamedTuple

from ifgen.graph.model import Kind
from ifgen.observing.running_graph import endpoints, hidden, join

_ACTION: Final = re.compile(r"(?P<name>/.+)/_action/\w+")
_PART_OF_SERVICE: Final = re.compile(r"(?P<prefix>rq|rr)(?P<name>/.+)(?:Request|Reply)")
_DDS_TYPE: Final = re.compile(r"(\w+)::(\w+)::dds_::(\w+)_")
_PARTS: Final = re.compile(
    r"(_SendGoal|_GetResult)?_(Request|Response)$|_(SendGoal|GetResult|FeedbackMessage)$"
)
_WITH_HASH: Final = "RIHS01_"


@dataclass(frozen=True, slots=True)
class User:
    """A node's end of a topic, a service or an action, with the type that it has there.

    Services and actions have several parts, each with a type of its own. `channel` names the topic of one of
    these. `type_hash` is empty if the node does not say, as before ROS 2 Iron, and None if the middleware
    does not.
    """

    node: str
    role: str
    kind: Kind
    name: str
    channel: str
    type_name: str
    type_hash: str | None


class Version(NamedTuple):
    """A definition of a type, or nothing but its name."""

    type_name: str
    type_hash: str | None


@dataclass(frozen=True, slots=True)
class Disagreement:
    """A topic, a service or an action of which nodes have different definitions, with those who have each."""

    kind: Kind
    name: str
    versions: dict[Version, list[User]]

    @property
    def type_names(self) -> list[str]:
        """The types, services and actions as a whole: one if nothing but its definition differs."""
        return list(dict.fromkeys(whole(version.type_name) for version in self.versions))


def whole(type_name: str) -> str:
    """The service or the action that a part belongs to; of a message its own name."""
    return type_name if "/msg/" in type_name else _PARTS.sub("", type_name)


def users(
    node: Any, service_hashes: Mapping[tuple[int, ...], str] = MappingProxyType({})
) -> tuple[tuple[str, ...], tuple[User, ...]]:
    """The other nodes, hidden ones left out, and what they use.

    `service_hashes` are those of whole services by gid, for a middleware that may not tell those of parts.
    """
    nodes, seen = endpoints(node)
    found = [*_on_topics(node), *_of_services(node, service_hashes)]
    known = {(user.kind, user.name) for user in found}
    for endpoint in seen:  # where services are no topics, such as on rmw_zenoh
        kind = endpoint.category.folder
        if kind == "srv" and ("service", endpoint.name) not in known:
            role = endpoint.category.singular
            found.append(User(endpoint.node, role, "service", endpoint.name, "", endpoint.type_name, None))
    return nodes, tuple(dict.fromkeys(user for user in found if user.node in nodes))


def disagreements(found: Iterable[User]) -> list[Disagreement]:
    """The disagreements among nodes, sorted by name."""
    channels: dict[tuple[str, str, str], dict[Version, list[User]]] = {}
    for user in found:
        if user.type_hash != "":
            versions = channels.setdefault((user.kind, user.name, user.channel), {})
            versions.setdefault(Version(user.type_name, user.type_hash), []).append(user)
    differing = [
        Disagreement(next(iter(versions.values()))[0].kind, name, versions)
        for (_, name, _), versions in sorted(channels.items())
        if len(versions) > 1
    ]
    # Different types have different parts: one of them is enough to say so.
    other_types: dict[object, Disagreement] = {}
    for each in differing:
        key = (each.kind, each.name) if len(each.type_names) > 1 else id(each)
        other_types.setdefault(key, each)
    return list(other_types.values())


def without_hash(found: Iterable[User]) -> list[str]:
    """The nodes that do not say which definitions they have."""
    return sorted({user.node for user in found if user.type_hash == ""})


def _on_topics(node: Any) -> Iterator[User]:
    for topic, _ in node.get_topic_names_and_types():
        action = _ACTION.fullmatch(topic)
        kind: Kind = "action" if action else "topic"
        name = action["name"] if action else topic
        if hidden(name):
            continue
        roles = ("action server", "action client") if action else ("publisher", "subscription")
        for role, infos in zip(roles, _infos(node, topic, no_mangle=False), strict=True):
            yield from (_user(info, role, kind, name, topic, info.topic_type) for info in infos)


def _of_services(node: Any, service_hashes: Mapping[tuple[int, ...], str]) -> Iterator[User]:
    """The users of services by their parts; by whole services where somebody's parts have no hash."""
    parts: dict[str, dict[User, str | None]] = {}
    for service, user, gid in _of_parts(node):
        parts.setdefault(service, {})[user] = service_hashes.get(gid)
    for service, found in parts.items():
        if all(user.type_hash for user in found) or not all(found.values()):
            yield from found
            continue
        for user, type_hash in found.items():
            type_name = user.type_name.removesuffix("_Request").removesuffix("_Response")
            yield replace(user, channel=service, type_name=type_name, type_hash=type_hash)


def _of_parts(node: Any) -> Iterator[tuple[str, User, tuple[int, ...]]]:
    """Each user of requests or responses, after its service, and before its gid."""
    for channel, _ in node.get_topic_names_and_types(no_demangle=True):
        part = _PART_OF_SERVICE.fullmatch(channel)
        if part is None:
            continue
        action = _ACTION.fullmatch(part["name"])
        kind: Kind = "action" if action else "service"
        name = action["name"] if action else part["name"]
        if hidden(name):
            continue
        roles = (f"{kind} client", f"{kind} server")
        roles = roles if part["prefix"] == "rq" else roles[::-1]
        for role, infos in zip(roles, _infos(node, channel, no_mangle=True), strict=True):
            for info in infos:
                type_name = _DDS_TYPE.sub(r"\1/\2/\3", info.topic_type)
                user = _user(info, role, kind, name, channel, type_name)
                yield part["name"], user, tuple(info.endpoint_gid)


def _infos(node: Any, topic: str, *, no_mangle: bool) -> tuple[list[Any], list[Any]]:
    """The writers of a topic, and its readers."""
    writers = node.get_publishers_info_by_topic(topic, no_mangle=no_mangle)
    return writers, node.get_subscriptions_info_by_topic(topic, no_mangle=no_mangle)


def _user(info: Any, role: str, kind: Kind, name: str, channel: str, type_name: str) -> User:
    type_hash = str(info.topic_type_hash)
    known = type_hash if type_hash.startswith(_WITH_HASH) else ""
    return User(join(info.node_namespace, info.node_name), role, kind, name, channel, type_name, known)
