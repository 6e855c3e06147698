"""No member of an endpoint hides an attribute that every node has."""

from __future__ import annotations

import json
import subprocess
import sys

import pytest
from ifgen.generator_py.nodes.members import RESERVED, members_of
from ifgen.nodl.model import Category, Endpoint, NodeDescription

from tests.nodes.conftest import TRANSPORTS

ATTRIBUTES = """
import sys, json, ifgen
ifgen.activate(sys.argv[1])
import rclpy
from rclpy.lifecycle import LifecycleNode
rclpy.init()
node = LifecycleNode("node", enable_logger_service=True)
print(json.dumps(sorted({*dir(node), *vars(node)})))
"""


def node_with(*endpoints: Endpoint) -> NodeDescription:
    of = {category: tuple(e for e in endpoints if e.category == category) for category in Category}
    return NodeDescription(
        package="p",
        name="n",
        description="",
        style="lifecycle",
        node_class="N",
        business_file="n.py",
        parameters=(),
        publishers=of[Category.PUBLISHER],
        subscriptions=of[Category.SUBSCRIPTION],
        service_servers=of[Category.SERVICE_SERVER],
        service_clients=of[Category.SERVICE_CLIENT],
        action_servers=of[Category.ACTION_SERVER],
        action_clients=of[Category.ACTION_CLIENT],
    )


@pytest.mark.parametrize("transport", TRANSPORTS)
def test_everything_that_rclpy_has_is_reserved(transport: str) -> None:
    """Endpoints named like any part of an attribute's name, in every category."""
    command = [sys.executable, "-c", ATTRIBUTES, transport]
    done = subprocess.run(command, capture_output=True, text=True, timeout=60, check=True)
    attributes = set(json.loads(done.stdout.splitlines()[-1]))
    words = {
        name[start:]
        for name in attributes
        for start in range(len(name))
        if start < 1 or name[start - 1] == "_"
    }
    stems = {
        word[: len(word) - end]
        for word in words
        for end in range(len(word))
        if end < 1 or word[-end - 1] == "_"
    }
    for category in Category:
        for stem in sorted(stems | {stem.rstrip("_") for stem in stems}):
            if not stem.strip("_"):
                continue
            endpoint = Endpoint(category, f"~/{stem}", "std_msgs/msg/String")
            members = members_of(node_with(endpoint)).of(endpoint)
            assert attributes.isdisjoint({members.attribute, *members.methods}), (category, stem, members)


def test_names_meet_whatever_they_are_made_of() -> None:
    endpoints = [
        Endpoint(category, name, "std_msgs/msg/String")
        for category in Category
        for name in ("/a/b", "~/a_b", "a_b_subscription", "a_b_publisher", "A/B", "~/parameters_changed")
    ]
    node = members_of(node_with(*endpoints))
    members = [node.of(endpoint) for endpoint in endpoints]
    names = [name for m in members for name in (m.attribute, *m.methods, m.constant)]
    assert len(names) == len(set(names))
    assert RESERVED.isdisjoint(names)
