"""`ifgen doctor --graph` says the rules of systems about nodes that run, on both transports."""

from __future__ import annotations

import importlib.util
import os
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest
from ifgen_pytest.domains import own_domain

NODES = """
import rclpy
from rclpy.node import Node
from rclpy.qos import QoSProfile, ReliabilityPolicy
from std_msgs.msg import String
from std_srvs.srv import Trigger

rclpy.init()
one, other = Node("one"), Node("other")
one.create_publisher(String, "/status", 10)
other.create_subscription(String, "/statsu", print, 10)
one.create_publisher(String, "/news", QoSProfile(depth=1, reliability=ReliabilityPolicy.BEST_EFFORT))
other.create_subscription(String, "/news", print, 10)
one.create_service(Trigger, "/reset", print)
other.create_service(Trigger, "/reset", print)
one.create_client(Trigger, "/rseet")
executor = rclpy.executors.SingleThreadedExecutor()
executor.add_node(one)
executor.add_node(other)
executor.spin()
"""
TRANSPORTS = [
    "local",
    pytest.param(
        "rclpy",
        marks=pytest.mark.skipif(
            importlib.util.find_spec("rpyutils") is None, reason="real rclpy is not installed"
        ),
    ),
]


@pytest.fixture
def domain() -> Iterator[dict[str, str]]:
    with own_domain() as number:
        yield {"ROS_DOMAIN_ID": str(number), "ROS_AUTOMATIC_DISCOVERY_RANGE": "LOCALHOST"}


@pytest.mark.slow
@pytest.mark.parametrize("transport", TRANSPORTS)
def test_doctor_says_the_rules_about_what_runs(
    tmp_path: Path, domain: dict[str, str], transport: str
) -> None:
    program = tmp_path / "nodes.py"
    program.write_text(NODES)
    done = subprocess.run(
        [sys.executable, "-m", "ifgen", "doctor", "--graph", "--transport", transport, "--run", str(program)],
        capture_output=True,
        text=True,
        timeout=120,
        check=False,
        cwd=tmp_path,
        env={**os.environ, **domain, "COLUMNS": "200"},
    )
    assert done.returncode == 1, done.stderr
    for rule in ("system-qos", "system-two-servers", "system-near-name", "system-no-server"):
        assert f"[{rule}]" in done.stdout, rule
