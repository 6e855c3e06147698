"""diagnostic_updater on either rclpy: what is published, tasks about events and topics, mistakes."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import pytest
import rclpy
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus
from diagnostic_updater import (
    CompositeDiagnosticTask,
    DiagnosedPublisher,
    DiagnosticStatusWrapper,
    DiagnosticTask,
    FrequencyStatus,
    FrequencyStatusParam,
    FunctionDiagnosticTask,
    HeaderlessTopicDiagnostic,
    Heartbeat,
    TimeStampStatus,
    TimeStampStatusParam,
    Updater,
)
from geometry_msgs.msg import PointStamped
from rclpy.clock import Clock, ClockType
from rclpy.duration import Duration
from rclpy.node import Node
from rclpy.parameter import Parameter
from rclpy.time import Time
from std_msgs.msg import Header

OK, WARN, ERROR = DiagnosticStatus.OK, DiagnosticStatus.WARN, DiagnosticStatus.ERROR


@pytest.fixture
def node() -> Iterator[Node]:
    rclpy.init()
    node = rclpy.create_node("driver", namespace="/arm")
    yield node
    node.destroy_node()
    rclpy.shutdown()


class Heard:
    """The statuses that come on /diagnostics."""

    def __init__(self, node: Node) -> None:
        self.node = node
        self.statuses: list[Any] = []
        node.create_subscription(DiagnosticArray, "/diagnostics", self._keep, 100)

    def _keep(self, array: Any) -> None:
        self.statuses += array.status

    def next(self, count: int = 1) -> list[tuple[str, bytes, str]]:
        """Wait for so many statuses: their names, levels and messages."""
        while len(self.statuses) < count:
            rclpy.spin_once(self.node, timeout_sec=5)
        taken, self.statuses = self.statuses[:count], self.statuses[count:]
        return [(each.name, each.level, each.message) for each in taken]


def level_of(task: DiagnosticTask) -> tuple[bytes, str]:
    status = task.run(DiagnosticStatusWrapper())
    return status.level, status.message


def test_what_an_updater_publishes(node: Node) -> None:
    heard, updater = Heard(node), Updater(node, period=100)
    updater.setHardwareID("none")
    while updater.publisher.get_subscription_count() == 0:
        rclpy.spin_once(node, timeout_sec=0.1)

    def hot(stat: Any) -> Any:
        stat.summary(WARN, "hot")
        stat.add("temperature", 90.5)
        return stat

    updater.add("motor", hot)
    assert heard.next() == [("driver: motor", OK, "Node starting up")]
    updater.add(Heartbeat())
    updater.add("silent", lambda stat: stat)
    heard.next(2)
    updater.force_update()
    assert heard.next(3) == [
        ("driver: motor", WARN, "hot"),
        ("driver: Heartbeat", OK, "Alive"),
        ("driver: silent", ERROR, "No message was set"),
    ]
    assert updater.removeByName("silent") and not updater.removeByName("silent")
    updater.broadcast(ERROR, "going down")
    assert heard.next(2)[1] == ("driver: Heartbeat", ERROR, "going down")
    updater.use_fqn = True
    updater.publish(DiagnosticStatus(name="by hand", hardware_id="7"))
    assert heard.next()[0][0] == "/arm/driver: by hand"
    updater.update()
    assert not heard.statuses


def test_parameters_and_the_period(node: Node) -> None:
    node.declare_parameter("diagnostic_updater.period", 0.01)
    node.set_parameters([Parameter("diagnostic_updater.period", value=0.02)])
    updater, heard = Updater(node), Heard(node)
    assert (updater.period, node.get_parameter("diagnostic_updater.use_fqn").value) == (0.02, False)
    updater.add(Heartbeat())
    heard.next(2)
    updater.period = 0.5
    assert updater.timer.timer_period_ns == 500_000_000
    assert Updater(node).period == 0.02


def test_summaries_merge() -> None:
    status = DiagnosticStatusWrapper()
    status.summary(WARN, "low")
    status.mergeSummary(OK, "fine")
    assert (status.level, status.message) == (WARN, "low")
    status.mergeSummary(ERROR, "gone")
    assert (status.level, status.message) == (ERROR, "low; gone")
    other = DiagnosticStatusWrapper()
    other.mergeSummary(status)
    assert (other.level, other.message) == (ERROR, "low; gone")
    other.clearSummary()
    assert (other.level, other.message) == (OK, "")
    other.add("pi", 3.5)
    assert [(each.key, each.value) for each in other.values] == [("pi", "3.5")]


def test_a_composite_keeps_the_worst() -> None:
    def task(level: bytes, text: str) -> FunctionDiagnosticTask:
        def fill(stat: Any) -> Any:
            stat.summary(level, text)
            stat.add(text, 1)
            return stat

        return FunctionDiagnosticTask(text, fill)

    composite = CompositeDiagnosticTask("all")
    for each in (task(OK, "a"), task(WARN, "b"), task(ERROR, "c")):
        composite.addTask(each)
    status = composite.run(DiagnosticStatusWrapper())
    assert (status.level, status.message, len(status.values)) == (ERROR, "b; c", 3)


@pytest.mark.parametrize(
    ("ticks", "seconds", "expected"),
    [
        (0, 1.0, (ERROR, "No events recorded.")),
        (1, 0.02, (WARN, "Frequency too high.")),
        (1, 0.1, (OK, "Desired frequency met")),
        (1, 0.5, (WARN, "Frequency too low.")),
    ],
)
def test_frequencies(ticks: int, seconds: float, expected: tuple[bytes, str]) -> None:
    status = FrequencyStatus(FrequencyStatusParam({"min": 10, "max": 20}, 0.5, 2))
    for _ in range(ticks):
        status.tick()
    before = Clock(clock_type=ClockType.STEADY_TIME).now() - Duration(seconds=seconds)
    status.times = [before] * 2
    assert level_of(status) == expected
    status.clear()
    assert level_of(status)[0] == ERROR


@pytest.mark.parametrize(
    ("age", "expected"),
    [
        (None, (WARN, "No data since last update.")),
        (-3.0, (ERROR, "Timestamps too far in future seen.")),
        (0.0, (OK, "Timestamps are reasonable.")),
        (4.0, (OK, "Timestamps are reasonable.")),
        (60.0, (ERROR, "Timestamps too far in past seen.")),
    ],
)
def test_ages_of_stamps(age: float | None, expected: tuple[bytes, str]) -> None:
    status = TimeStampStatus()
    if age is not None:
        now = Clock(clock_type=ClockType.ROS_TIME).now()
        status.tick(now.nanoseconds * 1e-9 - age)
        status.tick(now - Duration(seconds=age))
        status.tick((now - Duration(seconds=age)).to_msg())
    assert level_of(status) == expected
    status.tick(0.0)
    assert level_of(status) == (ERROR, "Zero timestamp seen.")


def test_topics_and_publishers(node: Node) -> None:
    heard, updater = Heard(node), Updater(node, period=100)
    frequency = FrequencyStatusParam({"min": 0, "max": 1e9})
    publisher = node.create_publisher(PointStamped, "points", 1)
    diagnosed = DiagnosedPublisher(publisher, updater, frequency, TimeStampStatusParam())
    plain = HeaderlessTopicDiagnostic("plain", updater, frequency)
    plain.tick()
    diagnosed.publish(PointStamped(header=Header(stamp=node.get_clock().now().to_msg())))
    heard.next(2)
    updater.force_update()
    assert heard.next(2) == [
        ("driver: /arm/points topic status", OK, "Desired frequency met; Timestamps are reasonable."),
        ("driver: plain topic status", OK, "Desired frequency met"),
    ]
    plain.clear_window()
    diagnosed.tick(Time())
    updater.force_update()
    assert [each[1:] for each in heard.next(2)] == [
        (ERROR, "Zero timestamp seen."),
        (ERROR, "No events recorded."),
    ]


def test_mistakes_name_the_task(node: Node) -> None:
    updater = Updater(node, period=100)
    updater.add("forgetful", lambda stat: None)  # type: ignore[arg-type,return-value]
    with pytest.raises(TypeError, match="task 'forgetful' returned None: it has to return the status"):
        updater.force_update()
    with pytest.raises(TypeError, match="a DiagnosticTask, or a name and a function"):
        updater.add("name", 3)  # type: ignore[arg-type]
    with pytest.raises(TypeError, match=r"a byte such as DiagnosticStatus.WARN, not 2"):
        DiagnosticStatusWrapper().summary(2, "text")  # type: ignore[arg-type]
