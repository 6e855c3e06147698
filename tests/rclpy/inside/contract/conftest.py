"""The same contract over each transport, and where there is none."""

from __future__ import annotations

from collections.abc import Iterator

import pytest
from rclpy.node import Node

from tests.rclpy.inside.contract.processes import ACROSS, BY_QUERIES, IN_ROUNDS, WITHIN, Pair, connected

# These look for what has come before they spin the pair.
AT_ONCE = (
    "test_what_was_answered_before_the_server_went_is_received",
    "test_all_have_what_was_published_before",
    "test_only_the_newest_messages_wait_for_a_slow_subscription",
)


ABOUT_SERVICES = ("test_requests", "test_gone_servers")


def pytest_generate_tests(metafunc: pytest.Metafunc) -> None:
    if "pair" in metafunc.fixturenames:
        queries = BY_QUERIES if metafunc.module.__name__.endswith(ABOUT_SERVICES) else ()
        metafunc.parametrize("pair", [*WITHIN, *ACROSS, *queries, *IN_ROUNDS], indirect=True)


@pytest.fixture
def pair(request: pytest.FixtureRequest) -> Iterator[Pair]:
    """Over everything."""
    if request.param in IN_ROUNDS and request.node.originalname in AT_ONCE:
        pytest.skip("in lockstep, nothing comes before the round ends")
    with connected(request.param) as made:
        yield made


@pytest.fixture
def two(pair: Pair) -> tuple[Pair, Node, Node]:
    return pair, pair.process("one").node, pair.process("two").node
