"""At run time rclpy's classes take no parameters, neither ours nor those of Jazzy."""

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


@pytest.mark.parametrize("ours", [True, False])
def test_no_class_can_be_subscripted(ours: bool) -> None:
    if not ours and importlib.util.find_spec("rclpy") is None:
        pytest.skip("the real rclpy is not installed (Linux x86_64 only)")
    ended = subprocess.run(
        [sys.executable, "-c", PROGRAM],
        env={**os.environ, "PYTHONPATH": os.pathsep.join(map(str, UNDERLAY)) if ours else ""},
        capture_output=True,
        text=True,
        timeout=60,
        check=False,
    )
    assert (ended.stdout, ended.returncode) == ("", 0), ended.stderr
