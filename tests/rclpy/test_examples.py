"""The programs of examples/ print the same on the local transport and on real rclpy."""

from __future__ import annotations

import contextlib
import importlib.util
import os
import re
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from tests.real_rclpy import again_if_crashed

EXAMPLES = Path(__file__).parents[2] / "examples"
LIMIT = 60.0  # [s] for one conversation
MISSING = [name for name in ("rclpy", "ifgen_native") if importlib.util.find_spec(name) is None]

needs_rclpy = pytest.mark.skipif(
    bool(MISSING), reason=f"not installed: {', '.join(MISSING)} (Linux x86_64 only)"
)
local_and_real = pytest.mark.parametrize("transport", ["local", pytest.param("rclpy", marks=needs_rclpy)])
local_and_slowly_real = pytest.mark.parametrize(
    "transport", ["local", pytest.param("rclpy", marks=[needs_rclpy, pytest.mark.slow])]
)


def start(transport: str, *words: str) -> subprocess.Popen[str]:
    """Start programs; both of their output streams arrive in one, unbuffered."""
    environment = {**os.environ, "PYTHONUNBUFFERED": "1", "RCUTILS_LOGGING_USE_STDOUT": "0"}
    programs = [word if word == ":" or not word.endswith(".py") else str(EXAMPLES / word) for word in words]
    return subprocess.Popen(
        [sys.executable, "-m", "ifgen", "run", "--transport", transport, *programs],
        env=environment,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
    )


def messages(output: str) -> list[str]:
    """The log lines of nodes, each as `name: text`."""
    return [f"{name}: {text}" for name, text in re.findall(r"\[INFO\] \[[\d.]+\] \[(\w+)\]: (.*)", output)]


def converse(transport: str, *words: str) -> list[str]:
    """Run programs until the last one ends on its own."""

    def once() -> tuple[int | None, str]:
        with start(transport, *words) as process:
            try:
                output, _ = process.communicate(timeout=LIMIT)
            except subprocess.TimeoutExpired:
                process.kill()
                raise
        return process.returncode, output

    code, output = again_if_crashed(transport, once, lambda ended: ended[0])
    assert code == 0, output
    assert "Traceback" not in output
    return [line for line in messages(output) if "waiting again" not in line]


@local_and_slowly_real
def test_services(transport: str) -> None:
    lines = converse(transport, "services/server.py", ":", "services/client.py", "41", "1")
    assert lines == ["add_two_ints_server: 41 + 1 = 42", "add_two_ints_client: 41 + 1 = 42"]


@local_and_slowly_real
def test_action(transport: str) -> None:
    lines = converse(transport, "action/fibonacci_server.py", ":", "action/fibonacci_client.py", "5")
    *before, last = [line for line in lines if line.startswith("fibonacci_client: ")]
    # The first feedback may arrive before the response that accepts the goal.
    so_far = [f"fibonacci_client: so far {[0, 1, 1, 2, 3, 5][:count]}" for count in range(3, 7)]
    assert sorted(before) == sorted(["fibonacci_client: accepted", *so_far])
    assert last == "fibonacci_client: succeeded: [0, 1, 1, 2, 3, 5]"
    assert [line for line in lines if line.startswith("fibonacci_server: ")] == [
        "fibonacci_server: asked for order 5",
        "fibonacci_server: succeeded",
    ]


@local_and_slowly_real
def test_action_that_is_cancelled(transport: str) -> None:
    lines = converse(transport, "action/fibonacci_server.py", ":", "action/fibonacci_client.py", "40", "2")
    assert "fibonacci_client: so far [0, 1, 1, 2]" in lines
    assert any(line.startswith("fibonacci_client: canceled: [0, 1, 1, 2") for line in lines)
    assert "fibonacci_server: canceled" in lines


@local_and_slowly_real
def test_async_nodes(transport: str) -> None:
    lines = converse(transport, "async_nodes/server.py", ":", "async_nodes/client.py")
    assert [line for line in lines if line.startswith("async_client: ")] == [
        "async_client: sums: [1, 2, 3]",
        "async_client: result: [0, 1, 1, 2, 3, 5]",
        "async_client: enough: 13",
        "async_client: too slow",
    ]
    assert [line for line in lines if line.startswith("async_server: ")] == ["async_server: cancelled"] * 2


@local_and_real
@pytest.mark.skipif(sys.platform == "win32", reason="Windows cannot send Ctrl-C to a process")
def test_topics(transport: str) -> None:
    """A talker and a listener, ended by Ctrl-C as users do."""
    with start(transport, "topics/publisher.py", ":", "topics/subscriber.py") as process:
        assert process.stdout is not None
        output, until = "", time.monotonic() + LIMIT
        while len([line for line in messages(output) if "I heard" in line]) < 3 and time.monotonic() < until:
            output += process.stdout.readline()
        process.send_signal(signal.SIGINT)
        with contextlib.suppress(subprocess.TimeoutExpired):
            output += process.communicate(timeout=LIMIT)[0]
        process.kill()
    assert process.returncode == 0, output
    assert "Traceback" not in output
    said = [line.partition("publishing ")[2] for line in messages(output) if "publishing" in line]
    heard = [line.partition("I heard ")[2] for line in messages(output) if "I heard" in line]
    assert said == [f"'Hello, robot: {number}'" for number in range(len(said))]
    first = int(heard[0].strip("'").rpartition(" ")[2])  # real DDS may take a while to connect them
    assert heard == [f"'Hello, robot: {number}'" for number in range(first, first + len(heard))]
