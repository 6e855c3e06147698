"""API of newer ROS, the profiles that `IFGEN_ROS_DISTRO` chooses, and what is said in that of Jazzy."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
import rclpy
from rclpy.action import ActionClient, ActionServer
from rclpy.clock import ClockType
from rclpy.duration import Duration, Infinite
from rclpy.exceptions import InvalidHandle
from rclpy.executors import SingleThreadedExecutor
from rclpy.impl import distro
from rclpy.impl.distro import Distro
from rclpy.node import Node
from rclpy.publisher import Publisher
from rclpy.qos import QoSProfile
from rclpy.service_introspection import ServiceIntrospectionState
from rclpy.task import Future
from rclpy.time import Time
from std_msgs.msg import String
from std_srvs.srv import Empty
from test_msgs.action import Fibonacci

ROOT = Path(__file__).resolve().parents[3]


@pytest.fixture(autouse=True)
def nothing_said(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(distro, "_reported", set())


@pytest.fixture
def lyrical(monkeypatch: pytest.MonkeyPatch) -> None:
    """The newest profile, as far as it is not chosen when modules are imported."""
    monkeypatch.setattr(distro, "PROFILE", Distro.LYRICAL)
    monkeypatch.setattr(distro, "_followed", set(distro.CHANGES))


@pytest.fixture
def node() -> Iterator[Node]:
    rclpy.init()
    yield rclpy.create_node("n")
    rclpy.try_shutdown()


def run(program: str, profile: str = "") -> subprocess.CompletedProcess[str]:
    """Run a program on the local transport in a process with this profile."""
    path = os.pathsep.join(str(ROOT / each) for each in ("codegen/underlay", "generated", "codegen"))
    return subprocess.run(
        [sys.executable, "-c", program],
        env={**os.environ, "PYTHONPATH": path, distro.VARIABLE: profile},
        capture_output=True,
        text=True,
        timeout=60,
        check=False,
    )


def test_blocks_end_what_they_hold(lyrical: None) -> None:
    with rclpy.init() as started:
        assert started.context is rclpy.get_default_context()
        with rclpy.create_node("n") as node:
            with node.create_publisher(String, "t", 1) as publisher:
                publisher.publish(String())
            with pytest.raises(InvalidHandle):
                publisher.publish(String())
            with node.create_subscription(String, "t", print, 1), node.create_client(Empty, "e"):
                pass
            with node.create_service(Empty, "e", lambda _, response: response), node.create_timer(1.0, print):
                pass
        with pytest.raises(InvalidHandle):
            node.get_name()
        left = rclpy.create_node("left")
    assert not rclpy.ok()
    with pytest.raises(InvalidHandle):
        left.get_name()


def test_jazzy_is_told_once_and_strict_mode_refuses(node: Node, capfd: Any, monkeypatch: Any) -> None:
    for _ in range(2):
        with node.create_publisher(String, "t", 1):
            pass
    said = capfd.readouterr().err.splitlines()
    sentence = "Publisher as a context manager is ROS 2 Kilted's; real Jazzy will refuse it"
    assert said == [f"rmw_local: {sentence} (set IFGEN_ROS_DISTRO=kilted if the program is for that ROS)"]
    monkeypatch.setattr(distro, "strict", True)
    publisher = node.create_publisher(String, "t", 1)
    refusal = f"{re.escape(sentence)}: set IFGEN_ROS_DISTRO=kilted"
    with pytest.raises(distro.NewerApiError, match=refusal), publisher:
        pass


def test_a_name_that_is_missing_names_its_ros(capfd: Any, monkeypatch: Any) -> None:
    newest = list(distro.NAMES.values())[-1]
    monkeypatch.setitem(newest, "rclpy.node", {"NewerNode": ""})  # today none is missing
    assert not hasattr(rclpy.node, "NewerNode")
    assert "NewerNode is ROS 2 Lyrical's; the local transport does not have it" in capfd.readouterr().err


def test_asyncio_has_the_names_of_lyrical(capfd: Any) -> None:
    from rclpy.experimental import AsyncNode
    from rclpy.experimental.async_node import AsyncNode as same
    from rclpy_asyncio import AsyncNode as ours

    assert AsyncNode is same is ours
    assert "AsyncNode is ROS 2 Lyrical's; real Jazzy will refuse it" in capfd.readouterr().err


def test_each_name_of_the_tables_can_be_imported(lyrical: None) -> None:
    import importlib

    for modules in distro.NAMES.values():
        for module, names in modules.items():
            for name, home in names.items():
                assert hasattr(importlib.import_module(module), name) is bool(home), f"{module}.{name}"


def test_classes_take_type_arguments(lyrical: None) -> None:
    from rclpy.client import Client

    assert repr(Client[int, str]) == "rclpy.client.Client[int, str]"
    assert Future[int]().done() is False
    with pytest.raises(TypeError, match=r"Too few arguments .* actual 1, expected 2"):
        Client[int]
    with pytest.raises(TypeError):
        isinstance(None, Publisher[String])

    class Mine(Publisher[String]):
        pass

    assert issubclass(Mine, Publisher)


def test_durations_add_and_multiply(lyrical: None) -> None:
    second = Duration(seconds=1)
    assert second + second == Duration(seconds=2)
    assert second - second * 2.5 == Duration(nanoseconds=-1_500_000_000)
    assert second * float("inf") == Infinite
    with pytest.raises(OverflowError):
        Infinite + second
    with pytest.raises(ValueError, match="nan"):
        second * float("-inf")
    for wrong in (lambda: 2 * second, lambda: second / 2, lambda: second + 1, lambda: -second):  # type: ignore[operator]
        with pytest.raises(TypeError):
            wrong()
    assert Time(seconds=86400).to_datetime().timestamp() == 86400
    with pytest.raises(TypeError):
        Time(seconds=1, clock_type=ClockType.STEADY_TIME).to_datetime()


def test_a_timer_passes_its_times_by_annotation(node: Node, lyrical: None) -> None:
    from rclpy.timer import TimerInfo

    heard: list[Any] = []

    def with_info(info: Any) -> None:
        heard.append(info)

    with_info.__annotations__["info"] = TimerInfo
    timer = node.create_timer(0.001, with_info)
    while not heard:
        rclpy.spin_once(node, timeout_sec=1)
    assert heard[0].actual_call_time >= heard[0].expected_call_time
    assert heard[0].actual_call_time.clock_type == ClockType.ROS_TIME
    timer.callback = lambda: heard.append("plain")
    while "plain" not in heard:
        rclpy.spin_once(node, timeout_sec=1)
    timer.cancel()
    with pytest.raises(rclpy.exceptions.TimerCancelledError):
        timer.handle.call_timer_with_info()


def test_profiles_of_qos_and_messages(node: Node, lyrical: None) -> None:
    assert QoSProfile(None, 3).depth == 3
    with pytest.raises(TypeError, match="unexpected keyword argument 'lifetime'"):
        QoSProfile(depth=1, lifetime=1)
    quiet = rclpy.create_node("quiet", rosout_qos_profile=7)
    (end,) = [
        each for each in node.get_publishers_info_by_topic("/rosout") if each.node_name == quiet.get_name()
    ]
    assert end.qos_profile.lifespan == Duration(seconds=10)
    infos: list[Any] = []
    node.create_subscription(String, "t", lambda _, info: infos.append(info), 1)
    publisher = node.create_publisher(String, "t", 1)
    publisher.publish(String())
    rclpy.spin_once(node, timeout_sec=1)
    (described,) = node.get_publishers_info_by_topic("t")
    assert list(infos[0]["publisher_gid"]["data"]) == described.endpoint_gid


def test_the_graph_of_services_and_actions(node: Node, lyrical: None) -> None:
    from rclpy.endpoint_info import EndpointTypeEnum

    server = node.create_service(Empty, "e", lambda _, response: response)
    node.create_client(Empty, "e")
    for query, kind in (
        (node.get_servers_info_by_service, EndpointTypeEnum.SERVER),
        (node.get_clients_info_by_service, EndpointTypeEnum.CLIENT),
    ):
        (info,) = query("e")
        assert (info.node_name, info.service_type, info.endpoint_type) == ("n", "std_srvs/srv/Empty", kind)
        assert str(info.service_type_hash).startswith("RIHS01_")
        assert f"Endpoint type: {kind.name}" in str(info)
        assert query("nobody") == []
    assert server.handle is not None
    action_server = ActionServer(node, Fibonacci, "f", lambda _: Fibonacci.Result())
    client = ActionClient(node, Fibonacci, "f", enable_feedback_msg_optimization=True)
    named = [("/f", ["test_msgs/action/Fibonacci"])]
    assert node.get_action_names_and_types() == named
    assert node.get_action_client_names_and_types_by_node("n", "/") == named
    assert node.get_action_server_names_and_types_by_node("n", "/") == named
    for end in (action_server, client):
        end.configure_introspection(node.get_clock(), QoSProfile(depth=1), ServiceIntrospectionState.METADATA)
    topics = {name for name, _ in node.get_topic_names_and_types()}
    events = {f"/f/_action/{part}/_service_event" for part in ("send_goal", "cancel_goal", "get_result")}
    assert events <= topics


def test_a_call_without_response_raises_in_newer_profiles(node: Node, lyrical: None) -> None:
    client = node.create_client(Empty, "nobody")
    with pytest.raises(TimeoutError):
        client.call(Empty.Request(), timeout_sec=0.01)


@pytest.mark.parametrize(("profile", "order"), [(Distro.JAZZY, [2, 1, 0]), (Distro.KILTED, [0, 1, 2])])
def test_the_order_of_tasks(profile: Distro, order: list[int], node: Node, monkeypatch: Any) -> None:
    monkeypatch.setattr(
        distro, "_followed", {name for name, change in distro.CHANGES.items() if change.since <= profile}
    )
    executor, done = SingleThreadedExecutor(), []
    executor.add_node(node)
    for number in range(3):
        executor.create_task(done.append, number)
    while len(done) < 3:
        executor.spin_once(timeout_sec=1)
    assert done == order


_IMPORTED = """
import inspect, rclpy
from rclpy.action import ActionServer
from rclpy.parameter import Parameter
from rclpy.qos import InvalidQoSProfileException, QoSPresetProfiles
from rclpy.lifecycle import LifecycleNode
print(Parameter.Type.INTEGER, inspect.signature(ActionServer).parameters["result_timeout"].default)
print(InvalidQoSProfileException("text"), hasattr(QoSPresetProfiles, "ROSOUT_DEFAULT"))
rclpy.init()
try:
    print(LifecycleNode("n").trigger_activate())
except Exception as error:
    print(type(error).__name__)
try:
    import rclpy.qos_event
    print("there")
except ModuleNotFoundError:
    print("gone")
"""


def test_what_a_profile_decides_at_import() -> None:
    of = {profile: run(_IMPORTED, profile) for profile in ("", "kilted", "lyrical")}
    first = {profile: ended.stdout.splitlines() for profile, ended in of.items()}
    assert first[""] == [
        "Type.INTEGER 900",
        "('Invalid QoSProfile', 'text') False",
        "RCLError",
        "there",
    ], of[""].stderr
    assert first["kilted"] == ["2 10", "text True", "TransitionCallbackReturn.ERROR", "there"] or first[
        "kilted"
    ][2].endswith("ERROR")
    assert first["lyrical"][3] == "gone"
    assert "Unable to start transition 3 from current state (1, 'unconfigured')" in of["kilted"].stderr
    assert "jazzy, kilted or lyrical" in run("import rclpy", "foxy").stderr


def table() -> list[str]:
    """The rows of the manual: each API and each behaviour, since which ROS, and what each profile does."""
    rows = []
    for api in distro.API.values():
        since = api.since.title + (f" {api.release}" if api.release else "")
        cells = ["works, and says so" if api.since > profile else "works" for profile in Distro]
        rows.append(f"| {api.subject} | {since} | {' | '.join(cells)} |")
    for change in distro.CHANGES.values():
        cells = [change.before if change.since > profile else change.after for profile in Distro]
        rows.append(f"| {change.subject} | {change.since.title} | {' | '.join(cells)} |")
    return rows


def test_the_manual_has_the_table() -> None:
    text = (ROOT / "docs" / "local-transport.md").read_text(encoding="utf-8")
    head = "| API or behaviour | since | jazzy | kilted | lyrical |\n|---|---|---|---|---|\n"
    _, _, rest = text.partition(head)
    assert rest.partition("\n\n")[0].splitlines() == table()


def _context_ends_what_it_holds(node: Node) -> bool:
    context = rclpy.Context()
    with rclpy.init(context=context) as started:
        tracked = rclpy.create_node("tracked", context=context)
        context.untrack_node(tracked)
        context.track_node(tracked)
    rclpy.try_shutdown(context=context, uninstall_handlers=False)
    return started.context is context and not context.ok()


def _arrivals_are_counted(node: Node) -> bool:
    counts: list[tuple[str, int]] = []
    subscription = node.create_subscription(String, "t", print, 10)
    publisher = node.create_publisher(String, "t", 10)
    client, timer = node.create_client(Empty, "e"), node.create_timer(9.0, print)
    service = node.create_service(Empty, "e", lambda _, response: response)
    publisher.publish(String())
    publisher.publish(String())
    subscription.handle.set_on_new_message_callback(lambda count: counts.append(("message", count)))
    publisher.publish(String())
    subscription.handle.clear_on_new_message_callback()
    publisher.publish(String())
    service.handle.set_on_new_request_callback(lambda count: counts.append(("request", count)))
    client.handle.set_on_new_response_callback(lambda count: counts.append(("response", count)))
    timer.handle.set_on_reset_callback(lambda count: counts.append(("reset", count)))
    timer.reset()
    timer.handle.clear_on_reset_callback()
    timer.reset()
    future = client.call_async(Empty.Request())
    rclpy.spin_until_future_complete(node, future, timeout_sec=10)
    service.handle.clear_on_new_request_callback()
    client.handle.clear_on_new_response_callback()
    with pytest.raises(TypeError):
        subscription.handle.set_on_new_message_callback(3)
    expected = [("message", 2), ("message", 1), ("reset", 1), ("request", 1), ("response", 1)]
    return counts == expected


def _an_entity_leaves_its_node(node: Node) -> bool:
    made = (
        node.create_publisher(String, "t", 1),
        node.create_subscription(String, "t", print, 1),
        node.create_client(Empty, "e"),
        node.create_service(Empty, "e", print),
        node.create_timer(1.0, print),
    )
    for entity in made:
        entity.destroy()
    left = {*node.publishers, *node.subscriptions, *node.clients, *node.services, *node.timers}
    return not left & set(made) and not node.destroy_publisher(made[0])


def _bases_are_shared(node: Node) -> bool:
    import importlib

    pairs = ("node.BaseNode", "publisher.BasePublisher", "subscription.BaseSubscription")
    pairs += ("client.BaseClient", "service.BaseService", "timer.BaseTimer", "clock.BaseClock")
    for pair in pairs:
        module, name = pair.split(".")
        home = importlib.import_module(f"rclpy.{module}")
        base = getattr(home, name)
        derived = getattr(home, name.removeprefix("Base"))
        if not issubclass(derived, base) or base is derived:
            return False
    entities = ("executor", "create_rate", "create_guard_condition", "add_waitable", "default_callback_group")
    from rclpy.node import BaseNode

    return isinstance(node, BaseNode) and not any(hasattr(BaseNode, name) for name in entities)


def _logs_under_another_name(node: Node) -> bool:
    from rclpy.logging import LoggingSeverity

    return node.get_logger().log("text", LoggingSeverity.INFO, name="other")


def _lifecycle_publishers_have_a_class(node: Node) -> bool:
    from rclpy.lifecycle import LifecycleNode, LifecyclePublisher

    class Mine(LifecyclePublisher):
        pass

    managed = LifecycleNode("managed")
    return isinstance(managed.create_lifecycle_publisher(String, "t", 1, publisher_class=Mine), Mine)


def _names_to_annotate_with(node: Node) -> bool:
    from rclpy import type_support

    names = "Msg MsgT Srv SrvT SrvRequestT SrvResponseT Action ActionT GoalT ResultT FeedbackT EventMessage"
    names += " PyCapsule CommonMsgSrvMetaClass MsgMetaClass SendGoalService SendGoalServiceRequest"
    names += " SendGoalServiceResponse GetResultService GetResultServiceRequest GetResultServiceResponse"
    return all(hasattr(type_support, name) for name in [*names.split(), "FeedbackMessage"])


def _every_clock_knows_of_ros_time(node: Node) -> bool:
    from rclpy.clock import Clock

    clock = Clock(clock_type=ClockType.ROS_TIME)
    assert isinstance(clock.ros_time_is_active, bool)
    clock.set_ros_time_override(Time(seconds=1, clock_type=ClockType.ROS_TIME))
    return hasattr(Clock, "ros_time_is_active") and hasattr(Clock, "set_ros_time_override")


def _rosout_has_a_profile(node: Node) -> bool:
    from rclpy.qos import qos_profile_rosout_default as profile

    return (profile.depth, profile.lifespan) == (1000, Duration(seconds=10))


# The rows of facts/rclpy-today.md 2.1 that no other test of this file has.
_ROWS: dict[str, tuple[Distro, Any]] = {
    "contexts": (Distro.KILTED, _context_ends_what_it_holds),
    "log(name=)": (Distro.KILTED, _logs_under_another_name),
    "type_support": (Distro.KILTED, _names_to_annotate_with),
    "rosout": (Distro.KILTED, _rosout_has_a_profile),
    "set_on_new_...": (Distro.LYRICAL, _arrivals_are_counted),
    "destroy()": (Distro.LYRICAL, _an_entity_leaves_its_node),
    "bases": (Distro.LYRICAL, _bases_are_shared),
    "publisher_class": (Distro.LYRICAL, _lifecycle_publishers_have_a_class),
    "clocks": (Distro.LYRICAL, _every_clock_knows_of_ros_time),
}


@pytest.mark.parametrize("row", _ROWS)
def test_rows_of_the_facts(row: str, node: Node, lyrical: None) -> None:
    _, behaves = _ROWS[row]
    assert behaves(node)


_PLAIN = {"log(name=)", "clocks", "destroy()"}  # Jazzy has the name, too, or its behaviour is another one


@pytest.mark.parametrize("row", sorted(_ROWS.keys() - _PLAIN))
def test_strict_jazzy_refuses_each_row(row: str, node: Node, monkeypatch: Any) -> None:
    since, behaves = _ROWS[row]
    monkeypatch.setattr(distro, "strict", True)
    with pytest.raises(distro.NewerApiError, match=f"is ROS 2 {since.title}'s; real Jazzy will refuse it"):
        behaves(node)
