"""At run time Jazzy's classes take no parameters; ours take those that Kilted's do, and say so once."""

from __future__ import annotations

import importlib.util
import os
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parent.parent.parent
UNDERLAY = (ROOT / "codegen" / "underlay", ROOT / "generated", ROOT / "codegen")
PROGRAM = """
from rclpy.action import ActionClient, ActionServer
from rclpy.action.client import ClientGoalHandle
from rclpy.action.server import ServerGoalHandle
from rclpy.client import Client
from rclpy.lifecycle import LifecyclePublisher
from rclpy.publisher import Publisher
from rclpy.service import Service
from rclpy.subscription import Subscription
from rclpy.task import Future, Task

for cls in (
    ActionClient, ActionServer, Client, ClientGoalHandle, Future, LifecyclePublisher, Publisher, ServerGoalHandle,
    Service, Subscription, Task,
):
    try:
        cls[int]
    except TypeError as error:
        continue
    print(cls.__name__)
"""


def subscripted(path: str) -> subprocess.CompletedProcess[str]:
    ended = subprocess.run(
        [sys.executable, "-c", PROGRAM],
        env={**os.environ, "PYTHONPATH": path},
        capture_output=True,
        text=True,
        timeout=60,
        check=False,
    )
    assert ended.returncode == 0, ended.stderr
    return ended


@pytest.mark.skipif(importlib.util.find_spec("rclpy") is None, reason="no real rclpy (Linux x86_64 only)")
def test_no_class_of_jazzy_can_be_subscripted() -> None:
    assert subscripted("").stdout == ""


def test_classes_that_kilted_subscripts() -> None:
    ended = subscripted(os.pathsep.join(map(str, UNDERLAY)))
    assert ended.stdout.split() == ["Future", "LifecyclePublisher", "Publisher", "Subscription", "Task"]
    assert len(ended.stderr.splitlines()) == 1
    assert "such as Publisher[String], is ROS 2 Kilted's" in ended.stderr
