"""A program that looks which nodes have different definitions of a type, asks for these, and writes all down.

`ifgen doctor --graph` runs it after the other programs, so that they end with it. It imports rclpy by name,
because the toolkit does not depend on rclpy: it uses the chosen transport.
"""

from __future__ import annotations

import sys
from collections.abc import Iterable, Iterator
from importlib import import_module
from importlib.util import find_spec
from pathlib import Path
from typing import Any, Final

from ifgen.dynamic.asking import Endpoint
from ifgen.dynamic.describing import answers
from ifgen.observing import definitions_observation
from ifgen.observing.definitions_observation import Definition, Seen
from ifgen.observing.definitions_seen import Disagreement, User, disagreements, users
from ifgen.observing.graph_observer import settled

_PATIENCE: Final = 2.0
"""Seconds for all answers: a node that is silent costs no more than that."""

_ASKED: Final = 3
"""Nodes that are asked for the same definition: the first ones may be too busy to answer."""

_MOST: Final = 100
"""Questions in all."""


def main() -> None:
    """Look, ask, and write."""
    file, expected = sys.argv[1:]
    rclpy: Any = import_module("rclpy")
    rclpy.init(args=[])
    # Hidden, as the command line tools of ROS are.
    node = rclpy.create_node("_ifgen_definitions", start_parameter_services=False, enable_rosout=False)
    # Somebody else's node may take a while to be discovered; the local transport is faster.
    is_real = find_spec("rmw_local") is None
    settled(rclpy, node, int(expected) or int(is_real))
    nodes, found = users(node, {} if is_real else _service_hashes(node))
    definitions = _definitions(node, disagreements(found))
    definitions_observation.write(Path(file), Seen(nodes, found, definitions))
    node.destroy_node()
    rclpy.try_shutdown()


def _service_hashes(node: Any) -> dict[tuple[int, ...], str]:
    with node.handle:
        known: dict[tuple[int, ...], str] = import_module("rclpy.impl.rcl.graph").service_hashes(node.handle)
    return known


def _definitions(node: Any, found: Iterable[Disagreement]) -> dict[str, Definition]:
    """The definitions that nodes send, by type hash."""
    questions = list(dict.fromkeys(_questions(found)))[:_MOST]
    if not questions:
        return {}
    return {
        asked.type_hash: Definition(asked.node, said.document, said.sources)
        for asked, said in answers(node, questions, _PATIENCE).items()
    }


def _questions(found: Iterable[Disagreement]) -> Iterator[Endpoint]:
    """The questions to nodes, none of them twice."""
    for disagreement in found:
        if len(disagreement.type_names) > 1:
            continue  # the names say it all
        for version, having in disagreement.versions.items():
            asked: dict[str, User] = {user.node: user for user in having}
            for name in list(asked)[:_ASKED]:
                if version.type_hash:
                    yield Endpoint(name, version.type_name, version.type_hash)


if __name__ == "__main__":
    main()
