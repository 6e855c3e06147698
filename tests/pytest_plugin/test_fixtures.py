"""The fixtures on both transports, as tests of a project use them."""

from __future__ import annotations

from pathlib import Path

import pytest

from .support import needs_rclpy

pytest_plugins = ("pytester",)

COLLECTING = """
import pytest
import rclpy
from rclpy.node import Node
from std_msgs.msg import String


class Talker(Node):
    def __init__(self, text):
        super().__init__("talker")
        self.publisher = self.create_publisher(String, "chatter", 10)
        self.create_timer(0.02, lambda: self.publisher.publish(String(data=text)))


def test_messages_of_a_node(ros_node, ros_collect, ros_context):
    heard = ros_collect(String, "chatter")
    talker = ros_node(Talker, "hello")
    assert talker.context is ros_context
    messages = heard.wait(3, timeout=10)
    assert [message.data for message in messages[:3]] == ["hello"] * 3
    heard.clear()
    talker.destroy_node()  # the fixture does not mind


def test_nothing_of_the_test_before_is_left(ros_collect, ros_node, ros_executor):
    heard = ros_collect(String, "chatter")
    heard.expect_none(0.1)
    publisher = ros_node("late").create_publisher(String, "chatter", 10)
    heard.wait_for_publishers()
    publisher.publish(String(data="one"))
    assert [message.data for message in heard.wait()] == ["one"]
    names = {node.get_name() for node in ros_executor.get_nodes()}
    assert names == {"ros_collect", "late"}


def test_too_few(ros_collect):
    ros_collect(String, "silence").wait(2, timeout=0.1)


def test_too_many(ros_node, ros_collect):
    ros_node(Talker, "noise")
    ros_collect(String, "chatter").expect_none(10)


def test_no_publisher(ros_collect):
    ros_collect(String, "silence").wait_for_publishers(timeout=0.1)


def test_context_ends():
    assert not rclpy.ok()
"""


@pytest.mark.parametrize("transport", ["local", pytest.param("rclpy", marks=(needs_rclpy, pytest.mark.slow))])
def test_collecting(pytester: pytest.Pytester, transport: str) -> None:
    pytester.makepyfile(COLLECTING)
    result = pytester.runpytest_subprocess("--transport", transport)
    result.assert_outcomes(passed=3, failed=3)
    result.stdout.fnmatch_lines(
        [
            "*expected 2 message(s) on /silence within 0.1 s, got none",
            "*expected no message on /chatter, got [[]*data='noise'*",
            "*expected 1 publisher(s) on /silence within 0.1 s, got 0",
        ]
    )


VIRTUAL = """
import threading
import time

import pytest
import rclpy
from std_msgs.msg import String


def test_an_hour(ros_virtual_clock, ros_node, ros_collect):
    begin = time.monotonic()
    publisher = ros_node("talker").create_publisher(String, "chatter", 10)
    ros_node("other").create_timer(600.0, lambda: publisher.publish(String()))
    assert len(ros_collect(String, "chatter").wait(6, timeout=3601)) == 6
    assert time.monotonic() - begin == 3600


def test_clock_is_asked_for_last(ros_node, ros_virtual_clock):
    begin = ros_node("sleeper").get_clock().now()
    time.sleep(1000)
    assert (ros_node("other").get_clock().now() - begin).nanoseconds == 1000 * 10**9


@pytest.mark.parametrize("ros_virtual_clock", [1, 2, 3], indirect=True)
def test_seeds(ros_virtual_clock):
    order = []
    threads = [threading.Thread(target=lambda name=name: (time.sleep(1), order.append(name))) for name in "abcdef"]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    print("order", "".join(order))
    assert sorted(order) == list("abcdef")
"""


def test_virtual_clock(pytester: pytest.Pytester) -> None:
    pytester.makepyfile(VIRTUAL)
    results = [pytester.runpytest_subprocess("-s", "--transport=local") for _ in range(2)]
    orders = [
        [line for line in result.stdout.str().splitlines() if "order " in line and "passed" not in line]
        for result in results
    ]
    results[0].assert_outcomes(passed=5)
    assert orders[0] == orders[1]
    assert len({line.partition("order ")[2] for line in orders[0]}) > 1, "seeds change nothing"


@needs_rclpy
def test_virtual_clock_is_local(pytester: pytest.Pytester) -> None:
    pytester.makepyfile(VIRTUAL)
    result = pytester.runpytest_subprocess("-rs", "--transport=rclpy")
    result.assert_outcomes(skipped=5)
    result.stdout.fnmatch_lines(
        ["*virtual time needs the local transport: run pytest with --transport local*"]
    )


def test_lockstep(pytester: pytest.Pytester) -> None:
    page = (Path(__file__).parents[2] / "docs/testing.md").read_text()
    example = page.partition("## Lockstep")[2].partition("```python\n")[2].partition("```")[0]
    pytester.makepyfile(example)
    pytester.runpytest_subprocess("--transport=local").assert_outcomes(passed=1)
