"""Asking for what others have announced, when that is a lot."""

from __future__ import annotations

from typing import Any

import pytest
from std_msgs.msg import Float64, String

from tests.rclpy.inside.contract.processes import DURABLE, connected

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


@pytest.mark.parametrize("most", [0, 3], ids=["all of them", "most of them"])
def test_who_is_one_of_many_talks_like_others(most: int, monkeypatch: pytest.MonkeyPatch) -> None:
    """Beyond some, endpoints share subscribers, and have tokens with other keys."""
    crowds = pytest.importorskip("rmw_local.transports.zenoh.presence")
    monkeypatch.setattr(crowds, "_MOST", most)
    with connected("zenoh") as pair:
        one, other = pair.process("one"), pair.process("other")
        names = [f"number_{number}" for number in range(8)]
        heard: dict[str, list[float]] = {name: [] for name in names}
        twice: list[float] = []
        for name in names:
            other.node.create_subscription(Float64, name, lambda m, n=name: heard[n].append(m.data), DURABLE)
            other.node.create_subscription(Float64, name, lambda m, n=name: heard[n].append(m.data), 10)
        further = other.node.create_subscription(Float64, names[0], lambda m: twice.append(m.data), 10)
        publishers: list[Any] = [one.node.create_publisher(Float64, name, 10) for name in names[:4]]
        publishers += [one.node.create_publisher(Float64, name, DURABLE) for name in names[4:]]
        pair.until(lambda: [each.get_subscription_count() for each in publishers] == [2, *[1] * 3, *[2] * 4])
        unwanted = one.node.create_publisher(Float64, "unwanted", 10)
        for publisher in (unwanted, *publishers):
            publisher.publish(Float64(data=0.1))
            publisher.publish(Float64(data=0.2))
        pair.until(lambda: sum(map(len, [twice, *heard.values()])) == 2 + 4 * 2 + 4 * 4)
        assert twice == heard[names[0]] == [0.1, 0.2]
        assert other.node.destroy_subscription(further)
        publishers[0].publish(Float64(data=0.3))
        pair.until(lambda: heard[names[0]][2:] == [0.3])
        assert publishers[0].wait_for_all_acked()
        late = pair.process("late")
        pair.until(lambda: [late.node.count_subscribers(name) for name in names] == [2] * 8)
        assert late.link is not None
        pair.until(lambda: len(late.link._transport.announced(2) or ()) > 2 * 8)  # type: ignore[union-attr, attr-defined]
        pair.settle()
        assert len(twice) == 2
        other.leave()
        pair.until(lambda: not any(late.node.count_subscribers(name) for name in names))
