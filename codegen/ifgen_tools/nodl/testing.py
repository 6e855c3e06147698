"""Conformance in pytest: `from ifgen_tools.nodl.testing import nodl_conforms` in a conftest.py."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING, Final

import pytest

from ifgen_tools import discovery, ros_graph
from ifgen_tools.nodl import contract
from ifgen_tools.nodl.conformance import Choices, Report, compare, side_of_node
from ifgen_tools.nodl.parameters import RunningParameter, running_parameter

if TYPE_CHECKING:
    from rclpy.node import Node

# Late imports: rclpy is that of the chosen transport.

_TURN: Final = 0.05
"""Seconds between two looks at a graph that does not fit yet."""


@pytest.fixture
def nodl_conforms(request: pytest.FixtureRequest) -> Callable[..., Report]:
    """Compares a node of the test with a document beside it: `nodl_conforms(node, "talker.nodl.yaml")`.

    It is `assert_conforms` with a path relative to the test's file.
    """

    def conforms(node: Node, document: Path | str, **options: object) -> Report:
        return assert_conforms(node, request.path.parent / document, **options)  # type: ignore[arg-type]

    return conforms


def assert_conforms(
    node: Node,
    document: Path | str,
    *,
    compatible: bool = False,
    defaults: bool = True,
    ignore: Sequence[str] = (),
    remaps: Sequence[tuple[str, str]] = (),
    include: Sequence[Path] = (),
    timeout: float = 5.0,
) -> Report:
    """Fail unless a node of this process keeps to its document, as `ifgen nodl conform` has it.

    Waits up to `timeout` [s] until the graph knows the node. Returns the report, for what is not verifiable
    and what was ignored. Raises InputError for a document that is wrong, AssertionError with all differences.
    """
    import rclpy
    from rclpy.executors import SingleThreadedExecutor

    expected = contract.read(Path(document), include)
    choices = Choices(compatible, defaults, tuple(ignore))
    name = node.get_fully_qualified_name()
    side = expected.side(name, remaps)
    peer = rclpy.create_node(
        "_nodl_conformance", context=node.context, start_parameter_services=False, enable_rosout=False
    )
    executor = SingleThreadedExecutor(context=node.context)
    executor.add_node(peer)
    end = time.monotonic() + timeout
    try:
        while True:
            domain = None if find_spec("rmw_local") is None else node.context.get_domain_id()
            queues = {} if domain is None else discovery.queues(domain)
            parts = contract.service_definitions(peer, name, domain)
            seen = side_of_node(name, ros_graph.read(peer, queues).endpoints, _parameters(node), parts)
            report = compare(side, seen, choices)
            if not report.failures or time.monotonic() > end:
                break
            executor.spin_once(timeout_sec=_TURN)
    finally:
        executor.shutdown()
        peer.destroy_node()
    assert not report.failures, "\n".join(map(str, report.failures))
    return report


def _parameters(node: Node) -> tuple[RunningParameter, ...]:
    return tuple(
        running_parameter(node.describe_parameter(name), parameter.to_parameter_msg().value)
        for name, parameter in sorted(node.get_parameters_by_prefix("").items())
    )
