"""The rights of each node of a system: all that its document declares and that every node has, no more."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Final

from ifgen.definition.interfaces import Registry
from ifgen.definition.type_description import TypeHashes, described_types
from ifgen.nodl.load import registry_of
from ifgen.nodl.model import Category
from ifgen.nodl.syntax.tree import ScalarNode
from ifgen.reading.search_path import SearchPath

from ifgen_tools.system.model import Endpoint, NodeInstance, System

_TYPE_DESCRIPTION: Final = "type_description_interfaces/srv/GetTypeDescription"
_CLOCK: Final = "rosgraph_msgs/msg/Clock"
_CANCEL: Final = "action_msgs/srv/CancelGoal"
_STATUS: Final = "action_msgs/msg/GoalStatusArray"
_OF_ROS: Final = (_TYPE_DESCRIPTION, _CLOCK, _CANCEL, _STATUS)


@dataclass(frozen=True, slots=True)
class Grant:
    """A node's end of a topic, a service or an action that it may have.

    `is_kept` is true if messages are kept for late subscriptions, or asked for by one. `type_hash` is empty
    where the definition cannot be found.
    """

    category: Category
    name: str
    type_name: str
    type_hash: str = ""
    is_kept: bool = False


@dataclass(frozen=True, slots=True)
class Grants:
    """All that a node of this full name may do. Its process has the identity `enclave`.

    `parts` are the same, but with the services and topics of actions in place of actions.
    """

    node: str
    enclave: str
    grants: tuple[Grant, ...]
    parts: tuple[Grant, ...]


def of_system(system: System, registry: Registry) -> list[Grants]:
    """The grants of each node, in the order of their names. Nodes without a document have none.

    `registry` has the definitions of what the documents name.
    """
    described = (node for node in system.nodes if node.endpoints)
    hashes = {**_hashes(registry_of(_OF_ROS, SearchPath())), **_hashes(registry)}
    return [_of_node(node, hashes) for node in sorted(described, key=lambda node: node.name)]


def _hashes(registry: Registry) -> dict[str, str]:
    """The hash of each type, and of those that services and actions consist of."""
    hashes = TypeHashes(registry)
    return {each.type_name: hashes.of(each) for interface in registry for each in described_types(interface)}


def _of_node(node: NodeInstance, hashes: Mapping[str, str]) -> Grants:
    def known(found: Iterable[Grant]) -> tuple[Grant, ...]:
        return tuple(dict.fromkeys(replace(g, type_hash=hashes.get(g.type_name, "")) for g in found))

    grants = [*map(_grant, node.endpoints), *_of_every_node(node)]
    parts = (part for grant in grants for part in _parts(grant))
    return Grants(node.name, _enclave(node), known(grants), known(parts))


def _grant(end: Endpoint) -> Grant:
    is_kept = end.qos is not None and end.qos.durability not in {None, "VOLATILE"}
    return Grant(end.category, end.name, end.type_name, is_kept=is_kept or end.name == "/rosout")


def _of_every_node(node: NodeInstance) -> Iterator[Grant]:
    """The ends that rclpy and rclcpp add beyond the official base documents."""
    yield Grant(Category.SERVICE_SERVER, f"{node.name}/get_type_description", _TYPE_DESCRIPTION)
    simulated = node.value("use_sim_time")
    # A value that only the launch knows may be true.
    if simulated and (not isinstance(simulated.value, ScalarNode) or simulated.value.value is True):
        yield Grant(Category.SUBSCRIPTION, "/clock", _CLOCK)


def _enclave(node: NodeInstance) -> str:
    """The enclave that the node's arguments name, else one of its own name."""
    words: Sequence[str] = node.arguments
    return next((value for flag, value in pairwise(words) if flag in {"-e", "--enclave"}), node.name)


def _parts(grant: Grant) -> Iterator[Grant]:
    if grant.category.folder != "action":
        yield grant
        return
    is_server = grant.category is Category.ACTION_SERVER
    service = Category.SERVICE_SERVER if is_server else Category.SERVICE_CLIENT
    topic = Category.PUBLISHER if is_server else Category.SUBSCRIPTION
    hidden = f"{grant.name}/_action"
    yield Grant(service, f"{hidden}/send_goal", f"{grant.type_name}_SendGoal")
    yield Grant(service, f"{hidden}/get_result", f"{grant.type_name}_GetResult")
    yield Grant(service, f"{hidden}/cancel_goal", _CANCEL)
    yield Grant(topic, f"{hidden}/feedback", f"{grant.type_name}_FeedbackMessage")
    yield Grant(topic, f"{hidden}/status", _STATUS, is_kept=True)
