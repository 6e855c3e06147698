"""Which node has which definition of a type: what the graph says, and what nodes answer that are asked."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, replace
from types import MappingProxyType
from typing import TYPE_CHECKING, Final, NamedTuple

from ifgen.nodl.model import Category
from ifgen_runtime.mismatch.type_description_client import Question, worth_asking

from ifgen_tools.graph.connections import Kind
from ifgen_tools.ros_graph import Gid, ServicePart, View, is_hidden
from ifgen_tools.type_descriptions import answers

if TYPE_CHECKING:
    from ifgen.dynamic import TypeDescription
    from rclpy.node import Node

_ACTION: Final = re.compile(r"(?P<name>/.+)/_action/\w+")
_PARTS: Final = re.compile(
    r"(_SendGoal|_GetResult)?_(Request|Response)$|_(SendGoal|GetResult|FeedbackMessage)$"
)

_PATIENCE: Final = 2.0
"""Seconds for all answers: a node that is silent costs no more than that."""

_MOST: Final = 100
"""Questions in all."""


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
    view: View,
    parts: Iterable[ServicePart],
    service_hashes: Mapping[Gid, str] = MappingProxyType({}),
) -> tuple[User, ...]:
    """The types that nodes use, without hidden nodes and names.

    `service_hashes` are those of whole services by gid, for a middleware that may not tell those of parts.
    """
    found = [*_on_topics(view), *_of_services(parts, service_hashes)]
    known = {(user.kind, user.name) for user in found}
    for end in view.of_authors().endpoints:  # where services are no topics, such as on rmw_zenoh
        if end.category.folder == "srv" and ("service", end.name) not in known:
            found.append(User(end.node, end.category.singular, "service", end.name, "", end.type_name, None))
    nodes = view.visible().nodes
    return tuple(dict.fromkeys(user for user in found if user.node in nodes))


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


def descriptions(node: Node, found: Iterable[Disagreement]) -> dict[str, TypeDescription]:
    """The definitions that nodes send, by type hash. Nobody has checked them."""
    questions = worth_asking(_questions(found))[:_MOST]
    if not questions:
        return {}
    return {asked.type_hash: answer for asked, answer in answers(node, questions, _PATIENCE).items()}


def _questions(found: Iterable[Disagreement]) -> Iterator[Question]:
    for disagreement in found:
        if len(disagreement.type_names) > 1:
            continue  # the names say it all
        for version, having in disagreement.versions.items():
            for user in having:
                yield Question(user.node, version.type_name, version.type_hash or "")


def _on_topics(view: View) -> Iterator[User]:
    for end in view.endpoints:
        if end.category.folder != "msg":
            continue
        is_publisher = end.category == Category.PUBLISHER
        action = _ACTION.fullmatch(end.name)
        name = action["name"] if action else end.name
        if is_hidden(name):
            continue
        kind: Kind = "action" if action else "topic"
        role = ("action server" if is_publisher else "action client") if action else end.category.singular
        yield User(end.node, role, kind, name, end.name, end.type_name, end.type_hash)


def _of_services(parts: Iterable[ServicePart], service_hashes: Mapping[Gid, str]) -> Iterator[User]:
    """The users of services by their parts; by whole services where somebody's parts have no hash."""
    found: dict[str, dict[User, str | None]] = {}
    for part in parts:
        action = _ACTION.fullmatch(part.service)
        kind: Kind = "action" if action else "service"
        name = action["name"] if action else part.service
        if not is_hidden(name):
            role = f"{kind} {'server' if part.is_server else 'client'}"
            user = User(part.node, role, kind, name, part.channel, part.type_name, part.type_hash)
            found.setdefault(part.service, {})[user] = service_hashes.get(part.gid)
    for service, hashes in found.items():
        if all(user.type_hash for user in hashes) or not all(hashes.values()):
            yield from hashes
            continue
        for user, type_hash in hashes.items():
            type_name = user.type_name.removesuffix("_Request").removesuffix("_Response")
            yield replace(user, channel=service, type_name=type_name, type_hash=type_hash)
