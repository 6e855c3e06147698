"""What numpy made goes over both transports, with our classes and with rosidl's."""

from __future__ import annotations

from pathlib import Path

import pytest

from ...native.support import needs_rclpy, never_compiled, run_python
from .conftest import PACKAGES

PROGRAM = Path(__file__).with_name("exchange.py")
VIEWS = Path(__file__).with_name("exchange_views.py")


@pytest.mark.parametrize(
    ("transport", "classes"),
    [
        ("local", "ours"),
        pytest.param("rclpy", "ours", marks=needs_rclpy),
        pytest.param("rclpy", "compiled", marks=needs_rclpy),
    ],
)
def test_messages_arrive_as_they_were_made(tmp_path: Path, transport: str, classes: str) -> None:
    ours = never_compiled(tmp_path / "ours", set(PACKAGES) - {"builtin_interfaces"})
    environment = {"PYTHONPATH": str(ours)} if (transport, classes) == ("rclpy", "ours") else {}
    done = run_python(str(PROGRAM), transport, environment=environment)
    assert done.returncode == 0, done.stderr
    names = ("Image", "PointCloud2", "OccupancyGrid", "LaserScan", "TransformStamped")
    assert done.stdout.splitlines() == [*(f"{name} True True" for name in names), classes]


@pytest.mark.parametrize(
    ("transport", "classes"),
    [
        ("local", "ours"),
        pytest.param("rclpy", "ours", marks=needs_rclpy),
        pytest.param("rclpy", "compiled", marks=needs_rclpy),
    ],
)
def test_raw_bytes_can_be_viewed_on_both_transports(tmp_path: Path, transport: str, classes: str) -> None:
    ours = never_compiled(tmp_path / "ours", set(PACKAGES) - {"builtin_interfaces"})
    environment = {"PYTHONPATH": str(ours)} if (transport, classes) == ("rclpy", "ours") else {}
    done = run_python(str(VIEWS), transport, environment=environment)
    assert done.returncode == 0, done.stderr
    lines = done.stdout.splitlines()
    assert lines[:2] == ["SequenceView False True [21, 22, 23]", "[99, 1, 2]"]
    if transport == "rclpy":
        assert "unexpected keyword argument 'views'" in lines[2]
