"""What publishers keep for subscriptions that come late."""

from __future__ import annotations

import pytest
from rclpy.duration import Duration
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, HistoryPolicy, QoSProfile
from std_msgs.msg import Float64

from tests.rclpy.inside.contract.processes import DURABLE, Pair, connected


def test_late_subscriptions_get_what_durable_publishers_have_kept(two: tuple[Pair, Node, Node]) -> None:
    pair, one, other = two
    publisher = one.create_publisher(Float64, "state", DURABLE)
    for number in range(5):
        publisher.publish(Float64(data=number + 0.1))
    one.create_publisher(Float64, "later", 1)
    pair.until(lambda: other.count_publishers("later"))
    pair.settle()  # nothing is on its way any more
    late: list[float] = []
    volatile: list[float] = []
    other.create_subscription(Float64, "state", lambda message: late.append(message.data), DURABLE)
    other.create_subscription(Float64, "state", lambda message: volatile.append(message.data), 10)
    pair.until(lambda: len(late) == 3 and publisher.get_subscription_count() == 2)
    publisher.publish(Float64(data=9.5))
    pair.until(lambda: len(late) == 4 and volatile)
    pair.settle()
    assert late == [2.1, 3.1, 4.1, 9.5]
    assert volatile == [9.5]


def test_a_late_subscription_of_the_publishers_own_process_gets_it_once(two: tuple[Pair, Node, Node]) -> None:
    """The middleware asks every publisher for what it kept, those of this process too."""
    pair, one, other = two
    publisher = one.create_publisher(Float64, "state", DURABLE)
    heard: list[float] = []
    other.create_subscription(Float64, "state", lambda message: heard.append(message.data), DURABLE)
    publisher.publish(Float64(data=0.1))
    pair.until(lambda: heard)  # both processes are linked
    late: list[float] = []
    one.create_subscription(Float64, "state", lambda message: late.append(message.data), DURABLE)
    pair.until(lambda: late)
    pair.settle()
    publisher.publish(Float64(data=0.2))
    pair.until(lambda: late[-1] == 0.2)
    pair.settle()
    assert late == [0.1, 0.2]


def test_a_process_that_comes_later_gets_what_was_kept_before_there_was_a_link(across: Pair) -> None:
    pair, process = across, across.process("one")
    one = process.node
    publisher = one.create_publisher(Float64, "state", DURABLE)
    process.leave()
    publisher.publish(Float64(data=0.1))
    pair.join(process)
    other = pair.process("two").node
    late: list[float] = []
    other.create_subscription(Float64, "state", lambda message: late.append(message.data), DURABLE)
    pair.until(lambda: late)
    assert late == [0.1]


def test_keep_all_is_kept(two: tuple[Pair, Node, Node]) -> None:
    pair, one, other = two
    everything = QoSProfile(history=HistoryPolicy.KEEP_ALL, durability=DurabilityPolicy.TRANSIENT_LOCAL)
    publisher = one.create_publisher(Float64, "all", everything)
    for number in range(300):
        publisher.publish(Float64(data=float(number)))
    heard: list[float] = []
    other.create_subscription(Float64, "all", lambda message: heard.append(message.data), everything)
    pair.until(lambda: len(heard) == 300)
    assert heard == [float(number) for number in range(300)]


@pytest.mark.parametrize("durability", [DurabilityPolicy.VOLATILE, DurabilityPolicy.TRANSIENT_LOCAL])
@pytest.mark.parametrize("lifespan", [0, 3600])
def test_very_much_that_waits_is_said_once(
    durability: DurabilityPolicy, lifespan: int, capfd: pytest.CaptureFixture[str]
) -> None:
    """And only of a subscription that keeps all. It has everything, where Fast DDS has 5,000 messages."""
    with connected("inside") as pair:
        process = pair.process("one")
        profiles = [
            QoSProfile(history=history, depth=10, durability=durability, lifespan=Duration(seconds=lifespan))
            for history in (HistoryPolicy.KEEP_ALL, HistoryPolicy.KEEP_LAST)
        ]
        heard: list[list[float]] = [[], []]
        for kept, profile in zip(heard, profiles, strict=True):
            process.node.create_subscription(
                Float64, "all", lambda message, kept=kept: kept.append(message.data), profile
            )
        publisher = process.node.create_publisher(Float64, "all", profiles[1])
        for _ in range(5000):
            publisher.publish(Float64(data=0.1))
        assert not capfd.readouterr().err
        for _ in range(3):
            publisher.publish(Float64(data=0.2))
        (line,) = capfd.readouterr().err.splitlines()
        assert "5000 messages wait for a subscription of /one to '/all', which keeps all" in line
        pair.until(lambda: len(heard[0]) == 5003)
        assert len(heard[1]) == 10
