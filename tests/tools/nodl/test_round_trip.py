"""Nodes with the endpoints of the official examples of rclpy: described, generated in both styles, and run."""

from __future__ import annotations

from pathlib import Path

import pytest
from ifgen import generate

from .test_describe import TRANSPORTS, ifgen_nodl

EXAMPLES = {
    "minimal_publisher": ["node.create_publisher(String, 'topic', 10)"],
    "minimal_subscriber": ["node.create_subscription(String, 'topic', print, 10)"],
    "minimal_service": [
        "node.create_service(AddTwoInts, 'add_two_ints', lambda request, response: response)"
    ],
    "minimal_client": ["node.create_client(AddTwoInts, 'add_two_ints')"],
    "fibonacci_action_server": [
        "ActionServer(node, Fibonacci, 'fibonacci', lambda goal: Fibonacci.Result())"
    ],
    "fibonacci_action_client": ["ActionClient(node, Fibonacci, 'fibonacci')"],
    "talker_listener": [
        "node.create_publisher(String, 'chatter', 10)",
        "node.create_subscription(String, 'chatter', print, 10)",
    ],
    "estop": ["node.create_publisher(Bool, 'estop', QoSProfile(depth=1, durability=KEPT))"],
    "pointcloud_publisher": ["node.create_publisher(PointCloud2, 'test_cloud', 10)"],
    "minimal_parameters": ["node.declare_parameter('my_parameter', 'world')"],
    "sensor_listener": ["node.create_subscription(Imu, 'imu', print, qos_profile_sensor_data)"],
}
PROGRAM = """\
import rclpy
from example_interfaces.action import Fibonacci
from example_interfaces.srv import AddTwoInts
from rclpy.action import ActionClient, ActionServer
from rclpy.qos import DurabilityPolicy, QoSProfile, qos_profile_sensor_data
from sensor_msgs.msg import Imu, PointCloud2
from std_msgs.msg import Bool, String

KEPT = DurabilityPolicy.TRANSIENT_LOCAL
rclpy.init()
node = rclpy.create_node({name!r})
kept = [{ends}]
rclpy.spin(node)
"""


@pytest.mark.slow
@pytest.mark.parametrize("transport", TRANSPORTS)
@pytest.mark.parametrize("name", EXAMPLES)
def test_an_example(tmp_path: Path, name: str, transport: str) -> None:
    program = tmp_path / f"{name}.py"
    program.write_text(PROGRAM.format(name=name, ends=", ".join(EXAMPLES[name])))
    described = ifgen_nodl(tmp_path, "describe", "--transport", transport, "--", str(program))
    assert described.returncode == 0, described.stderr
    for style in ("callbacks", "nodl"):
        document = tmp_path / f"in/of_{style}/nodl/{name}.nodl.yaml"
        document.parent.mkdir(parents=True)
        document.write_text(f"{described.stdout}codegen: {{ifgen: {{style: {style}}}}}\n")
    generate(tmp_path / "in", output=tmp_path / "out")
    for style in ("callbacks", "nodl"):
        node = tmp_path / f"out/of_{style}/of_{style}/{name}.py"
        words = ("--file", f"in/of_{style}/nodl/{name}.nodl.yaml", "--transport", transport, "--", str(node))
        done = ifgen_nodl(tmp_path, "conform", *words)
        assert done.stdout.endswith(f"/{name}: conforms\n"), done.stdout + done.stderr
    base = (tmp_path / f"out/of_nodl/of_nodl/_{name}_base.py").read_text()
    assert any(mark in base for mark in ("pub_", "sub_", "srv_", "cli_", "action_", "params_"))
