"""Asking for what others have announced, when that is a lot."""

from __future__ import annotations

import pytest
from std_msgs.msg import String

from tests.rclpy.inside.contract.processes import connected

MANY = 300  # more than any channel for answers held before


@pytest.mark.timeout(60)
def test_all_come_and_nobody_waits_for_ever() -> None:
    with connected("zenoh") as pair:
        one, other = pair.process("one"), pair.process("two")
        for number in range(MANY):
            other.node.create_publisher(String, f"word_{number}", 1)
        pair.until(lambda: one.node.count_publishers(f"/word_{MANY - 1}"))
        assert one.link is not None
        found = one.link._transport.announced(1)  # type: ignore[attr-defined]  # Zenoh's alone has it
        assert found is not None
        assert len(found) > MANY


@pytest.mark.timeout(60)
def test_who_still_announces_is_waited_for() -> None:
    """A tool that looks at the graph of a busy process in the middle of that would miss a topic."""
    with connected("zenoh") as pair:
        one, other = (pair.process(name).link._transport for name in ("one", "two"))  # type: ignore[union-attr]
        pair.until(lambda: one.announced(1) is not None)  # type: ignore[attr-defined]
        other._followed.pop().undeclare()  # type: ignore[attr-defined]  # as if it had not settled yet
        pair.until(lambda: one.announced(1) is None)  # type: ignore[attr-defined]
        other.settle()
        pair.until(lambda: one.announced(1) is not None)  # type: ignore[attr-defined]
