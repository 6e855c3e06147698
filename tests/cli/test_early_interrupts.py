"""Ctrl-C at any moment of a start: one exit code for each kind of command, and no traceback of imports."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

# Sends Ctrl-C when Python has called the given number of functions, since no other moment is the same each time.
STARTER = """
import signal, sys
left = int(sys.argv.pop(1))
def count(frame, event, argument):
    global left
    if event == "call":
        left -= 1
        if not left:
            sys.setprofile(None)
            signal.raise_signal(signal.SIGINT)
from ifgen.__main__ import main
if left:
    sys.setprofile(count)
sys.exit(main())
"""
PROGRAM = """
import rclpy
from rclpy.executors import ExternalShutdownException
from std_msgs.msg import String
rclpy.init()
node = rclpy.create_node("early")
node.create_publisher(String, "word", 1)
node.create_timer(0.2, rclpy.shutdown)
try:
    rclpy.spin(node)
except (KeyboardInterrupt, ExternalShutdownException):
    pass
"""
MOMENTS = [3, 20, 200, *range(500, 24_000, 1_600)]  # from the first line of main on


def interrupted(calls: int, *words: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [sys.executable, "-c", STARTER, str(calls), *words],
        capture_output=True,
        text=True,
        timeout=60,
        check=False,
    )


@pytest.mark.slow
def test_a_program(tmp_path: Path) -> None:
    program = tmp_path / "early.py"
    program.write_text(PROGRAM)
    outcomes = [interrupted(calls, "run", "--transport", "local", str(program)) for calls in MOMENTS]
    assert {done.returncode for done in outcomes} <= {130, 0}  # 0: the program has caught it, or was faster
    assert outcomes[0].returncode == 130
    assert {done.stderr for done in outcomes} <= {"", "interrupted\n"}


@pytest.mark.slow
def test_a_tool() -> None:
    outcomes = [interrupted(calls, "node", "list", "--transport", "local") for calls in MOMENTS]
    assert {done.returncode for done in outcomes} <= {2, 0}
    assert outcomes[0].returncode == 2
    assert {done.stderr for done in outcomes} <= {""}


@pytest.mark.parametrize(
    ("words", "code"), [(["node", "list"], 2), (["check"], 130), (["run", "early.py"], 130), (["nodes"], 130)]
)
def test_before_the_command_is_known(words: list[str], code: int) -> None:
    assert interrupted(2, *words).returncode == code
