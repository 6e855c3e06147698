"""Every verb that reads YAML takes every kind of value, or says in one sentence why not."""

from __future__ import annotations

import threading
from collections.abc import Iterator
from pathlib import Path

import pytest
import rclpy
from example_interfaces.action import Fibonacci
from example_interfaces.srv import AddTwoInts
from rclpy.action import ActionServer, GoalResponse
from rclpy.executors import SingleThreadedExecutor
from rclpy.lifecycle import LifecycleNode
from rclpy.node import Node

from tests.cli.conftest import Run

VALUES = [
    "",
    "text",
    "5",
    "-1",
    "1e400",
    "9" * 30,
    "9" * 5000,
    "0.5",
    ".nan",
    "-.inf",
    "true",
    "null",
    "~",
    "2026-01-31",
    "2026-01-31 10:00:00",
    "12:30:45",
    "{}",
    "a: b",
    "{a: b}",
    "{data:5}",
    "[]",
    "[1, a]",
    "[[1]]",
    "[{}]",
    "[null]",
    "? [a]\n: b",
    "[1",
    '"',
    '"a\\0b"',
    '"\\ud800"',
    "\ud800",
    "\udcff",
    "a" * 300,
    f"[{'1, ' * 300}1]",
    "[" * 200,
    "*a",
    "&a [*a]",
    "!!binary AQ==",
    "!!set {a}",
    "!!python/object:os.system x",
    "!!int x",
    "!!timestamp x",
    "\t",
    "%",
    "@",
    "- a\n- b",
    "'é'",
    "\x07",
]
PUB = "topic pub -1 -w 0 -p 0 --keep-alive 0.001"
VERBS = [
    ("param set /all s", "V"),
    ("param set /all --atomic numbers", "V"),
    ("param load /all", "/all:\n  ros__parameters:\n    s: V\n"),
    (f"{PUB} /text std_msgs/msg/String", "V"),
    (f"{PUB} /text std_msgs/msg/String", "{data: V}"),
    (f"{PUB} /flag std_msgs/msg/Bool", "{data: V}"),
    (f"{PUB} /joints sensor_msgs/msg/JointState", "{position: V}"),
    (f"{PUB} /joints sensor_msgs/msg/JointState", "{name: V}"),
    (f"{PUB} /joints sensor_msgs/msg/JointState", "{header: V}"),
    (f"{PUB} /pose geometry_msgs/msg/Pose", "{position: {x: V}}"),
    (f"{PUB} /field type_description_interfaces/msg/FieldType", "{nested_type_name: V}"),
    (f"{PUB} /image sensor_msgs/msg/Image", "{data: V}"),
    (f"{PUB} /cell nav_msgs/msg/OccupancyGrid", "{data: V}"),
    (f"{PUB} /battery sensor_msgs/msg/BatteryState", "{power_supply_status: V}"),
    ("service call /add example_interfaces/srv/AddTwoInts", "V"),
    ("service call /add example_interfaces/srv/AddTwoInts", "{a: V}"),
    ("service call /all/set_parameters rcl_interfaces/srv/SetParameters", "{parameters: V}"),
    ("action send_goal /count example_interfaces/action/Fibonacci", "V"),
    ("action send_goal /count example_interfaces/action/Fibonacci", "{order: V}"),
    ("lifecycle set /managed", "V"),
]


@pytest.fixture(scope="module")
def nodes() -> Iterator[None]:
    rclpy.init(args=[], signal_handler_options=rclpy.SignalHandlerOptions.NO)
    node = Node("all", enable_rosout=False)
    node.declare_parameter("s", "x")
    node.declare_parameter("numbers", [0.1])
    node.create_service(AddTwoInts, "add", lambda _, response: response)
    server = ActionServer(
        node, Fibonacci, "count", lambda _: Fibonacci.Result(), goal_callback=lambda _: GoalResponse.REJECT
    )
    managed = LifecycleNode("managed", enable_rosout=False)
    executor = SingleThreadedExecutor()
    executor.add_node(node)
    executor.add_node(managed)
    thread = threading.Thread(target=executor.spin)
    thread.start()
    yield
    executor.shutdown()
    thread.join(10.0)
    server.destroy()
    for each in (node, managed):
        each.destroy_node()
    rclpy.try_shutdown()


def check(ifgen: Run, verb: str, template: str, value: str) -> None:
    """Run a verb; `ifgen` fails at a traceback."""
    text = template.replace("V", value)
    if "load" in verb:
        Path("p.yaml").write_bytes(text.encode(errors="surrogatepass"))
        text = "p.yaml"
    if text.startswith("-") and "param" not in verb:
        text = f" {text}"  # which is no option
    done = ifgen(*verb.split(), text)
    # The node that is asked runs in this process: it logs that it refuses.
    lines = [line for line in done.err.splitlines() if not line.startswith(("  = help: ", "[WARN] "))]
    assert done.code in (0, 1, 2), (verb, text, done)
    assert len(lines) <= 1, (verb, text, done.err)
    assert all(len(line) < 300 for line in lines), (verb, text, done.err)
    if done.code and verb != "lifecycle set /managed" and "send_goal" not in verb:
        assert lines, (verb, text, done)
        assert lines[0].startswith(("error: ", "Set parameter", "Setting parameter")), (verb, text, lines)


@pytest.mark.parametrize("number", range(len(VALUES)), ids=[ascii(value)[:20] for value in VALUES])
def test_a_value(ifgen: Run, nodes: None, number: int) -> None:
    for verb, template in (VERBS[(number * 7) % len(VERBS)], VERBS[(number * 7 + 4) % len(VERBS)]):
        check(ifgen, verb, template, VALUES[number])


@pytest.mark.slow
@pytest.mark.parametrize(("verb", "template"), VERBS)
def test_a_verb(ifgen: Run, nodes: None, verb: str, template: str) -> None:
    for value in VALUES:
        check(ifgen, verb, template, value)
