"""Strict mode: every silent failure is found, and ordinary tests pass."""

from __future__ import annotations

import pytest

from .support import needs_rclpy

pytest_plugins = ("pytester",)

RAISING = """
import threading

import pytest
import rclpy
from action_msgs.msg import GoalStatus
from example_interfaces.action import Fibonacci
from rclpy.action import ActionClient, ActionServer
from rclpy.executors import MultiThreadedExecutor, SingleThreadedExecutor
from std_msgs.msg import String


def boom(*_):
    raise ValueError("boom")


def test_in_a_thread_that_spins(ros_node, ros_executor):
    timer = ros_node("node").create_timer(0.001, boom)
    thread = threading.Thread(target=ros_executor.spin_once, args=(5.0,))
    thread.start()
    thread.join()


def test_in_a_pool(ros_context):
    executor = MultiThreadedExecutor(2, context=ros_context)
    node = rclpy.create_node("node")
    handed_out = threading.Event()
    def fail():
        handed_out.wait(5)
        boom()
    node.create_timer(0.001, fail)
    executor.add_node(node)
    executor.spin_once(timeout_sec=5.0)
    handed_out.set()
    executor._executor.shutdown(wait=True)
    executor.shutdown()
    node.destroy_node()


def test_in_a_task_of_a_pool_that_nobody_asks(ros_context):
    executor = MultiThreadedExecutor(2, context=ros_context)
    handed_out = threading.Event()
    executor.create_task(lambda: handed_out.wait(5) and boom())
    executor.spin_once(timeout_sec=5.0)
    handed_out.set()
    executor._executor.shutdown(wait=True)
    executor.shutdown()


def test_in_a_goal(ros_node, ros_executor):
    node = ros_node("node")
    server = ActionServer(node, Fibonacci, "count", boom)
    client = ActionClient(node, Fibonacci, "count")
    assert client.wait_for_server(10)
    accepted = client.send_goal_async(Fibonacci.Goal(order=1))
    ros_executor.spin_until_future_complete(accepted, 10)
    result = accepted.result().get_result_async()
    ros_executor.spin_until_future_complete(result, 10)
    assert result.result().status == GoalStatus.STATUS_ABORTED
    client.destroy()
    server.destroy()


def test_in_a_plain_thread():
    thread = threading.Thread(target=boom)
    thread.start()
    thread.join()
"""

EXPECTED = """
import pytest
import rclpy
from rclpy.executors import ExternalShutdownException, MultiThreadedExecutor
import threading


def boom(*_):
    raise ValueError("boom")


def test_expected_exceptions(ros_node, ros_executor):
    ros_node("node").create_timer(0.001, boom)
    with pytest.raises(ValueError):
        ros_executor.spin_once(5.0)


def test_looked_at(ros_executor):
    task = ros_executor.create_task(boom)
    with pytest.raises(ValueError):
        ros_executor.spin_until_future_complete(task, 5)
    assert isinstance(task.exception(), ValueError)


def test_ends_with_the_context(ros_node, ros_executor):
    threading.Thread(target=ros_executor.spin).start()
"""


@pytest.mark.parametrize("transport", ["local", pytest.param("rclpy", marks=(needs_rclpy, pytest.mark.slow))])
def test_exceptions_fail_the_test(pytester: pytest.Pytester, transport: str) -> None:
    pytester.makepyfile(test_raising=RAISING, test_expected=EXPECTED)
    result = pytester.runpytest_subprocess("--transport", transport, "--ros-strict", "-p", "no:cacheprovider")
    result.assert_outcomes(passed=3, failed=5)
    result.stdout.fnmatch_lines(
        [
            "ros_strict: thread * raised",
            "ros_strict: a callback raised",
            "ros_strict: a callback raised",
            "ros_strict: a goal's execution raised",
            "ros_strict: thread * raised",
        ]
    )
    relaxed = pytester.runpytest_subprocess("--transport", transport, "-p", "no:cacheprovider")
    relaxed.assert_outcomes(passed=8, warnings=relaxed.parseoutcomes().get("warnings", 0))


SLOPPY = """
import threading

import pytest
import rclpy
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.qos import QoSProfile, ReliabilityPolicy
from example_interfaces.srv import AddTwoInts
from std_msgs.msg import String

pytestmark = pytest.mark.ros_strict


def test_leaked_node(ros_context):
    globals()["kept"] = rclpy.create_node("forgotten")


def test_nobody_listens(ros_node):
    ros_node("talker").create_publisher(String, "void", 10).publish(String())


def test_nobody_reads(ros_node, ros_executor):
    node = ros_node("both")
    subscription = node.create_subscription(String, "full", print, 2)
    publisher = node.create_publisher(String, "full", 10)
    for _ in range(3):
        publisher.publish(String())


def test_qos(ros_node):
    best_effort = QoSProfile(depth=1, reliability=ReliabilityPolicy.BEST_EFFORT)
    ros_node("offers").create_publisher(String, "mixed", best_effort)
    ros_node("requests").create_subscription(String, "mixed", print, 1)


def test_synchronous_call(ros_node, ros_executor):
    node = ros_node("caller")
    service = node.create_service(AddTwoInts, "add", lambda request, response: response)
    client = node.create_client(AddTwoInts, "add")
    node.create_timer(0.001, lambda: client.call(AddTwoInts.Request()))
    ros_executor.spin_once(5.0)


def test_clean(ros_node, ros_collect):
    publisher = ros_node("talker").create_publisher(String, "chatter", 10)
    heard = ros_collect(String, "chatter")
    publisher.publish(String())
    heard.wait()
"""


def test_what_the_local_transport_sees(pytester: pytest.Pytester) -> None:
    pytester.makepyfile(SLOPPY)
    result = pytester.runpytest_subprocess("--transport=local")
    result.assert_outcomes(passed=5, failed=1, errors=4)
    result.stdout.fnmatch_lines(
        [
            "ros_strict: node /forgotten was not destroyed",
            "ros_strict: 1 undelivered on /void: published while no subscription was matched",
            "ros_strict: 1 undelivered on /full: overwritten before it was read",
            "ros_strict: 2 undelivered on /full: never read",
            "ros_strict: incompatible QoS on /mixed: /offers does not offer the RELIABILITY that /requests requests",
            "*SynchronousCallError: The call of service 'add' would block for ever*",
        ]
    )


def test_setting_and_projects_without_ros(pytester: pytest.Pytester) -> None:
    pytester.makepyprojecttoml("[tool.pytest.ini_options]\nros_strict = true")
    pytester.makepyfile(
        """
        import threading

        def test_thread():
            thread = threading.Thread(target=lambda: 1 / 0)
            thread.start()
            thread.join()

        def test_nothing():
            pass
        """
    )
    result = pytester.runpytest_subprocess()
    result.assert_outcomes(passed=1, failed=1)
    result.stdout.fnmatch_lines(["ros_strict: thread * raised", "*ZeroDivisionError*"])


DIFFERING = """
import pytest
from ifgen_runtime.mismatch.reporting import WarningLimit
from ifgen_runtime.mismatch.reporting import Mismatch, Side, report


@pytest.mark.parametrize("policy", ["warn", "adapt"])
def test_definitions(ros_node, policy):
    mine, theirs = (Side(f"/{role}", role, f"RIHS01_{role}") for role in ("subscription", "publisher"))
    met = Mismatch("topic", "/path", "acme_msgs/msg/Path", policy, mine, theirs)
    report(met, WarningLimit(), lambda explanation: "")
"""


@pytest.mark.parametrize("transport", ["local", pytest.param("rclpy", marks=(needs_rclpy, pytest.mark.slow))])
def test_definitions_that_differ_unless_they_are_adapted(pytester: pytest.Pytester, transport: str) -> None:
    pytester.makepyfile(DIFFERING)
    result = pytester.runpytest_subprocess(f"--transport={transport}", "--ros-strict")
    result.assert_outcomes(passed=2, errors=1)
    result.stdout.fnmatch_lines(["ros_strict: *'/path'*"])


LIVE = """
import pytest
from ifgen.dynamic import class_from_text
from rclpy.parameter import Parameter


@pytest.mark.parametrize("policy", ["warn", "refuse"])
def test_a_pair(ros_node, policy):
    one, other = (class_from_text("acme_msgs/msg/Speed", f"float{bits} value") for bits in (32, 64))
    override = Parameter("on_type_mismatch", value=policy)
    ros_node("receiver", parameter_overrides=[override]).create_subscription(one, "speed", print, 1)
    ros_node("sender").create_publisher(other, "speed", 1)
"""


def test_a_pair_whose_definitions_differ(pytester: pytest.Pytester) -> None:
    pytester.makepyfile(LIVE)
    result = pytester.runpytest_subprocess("--transport=local", "--ros-strict")
    result.assert_outcomes(passed=2, errors=2)
    result.stdout.fnmatch_lines(["ros_strict: topic '/speed': /sender (publisher)*"] * 2)
