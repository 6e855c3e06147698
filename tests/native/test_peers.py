"""Services and actions between two processes, one with compiled classes and one with ours of the same types."""

from __future__ import annotations

import signal
import subprocess
import sys

import pytest

from .support import PROGRAMS, needs_rclpy, run_python

pytestmark = needs_rclpy
PROGRAM = str(PROGRAMS / "peers.py")


@pytest.mark.parametrize(
    ("server", "client"),
    [("compiled", "ours"), ("ours", "compiled"), ("ours", "ours")],
)
def test_services_and_actions_reach_the_other_kind(server: str, client: str) -> None:
    command = [sys.executable, PROGRAM, "server", server]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as serving:
        try:
            asked = run_python(PROGRAM, "client", client)
        finally:
            serving.send_signal(signal.SIGINT)
            output, errors = serving.communicate(timeout=20)
    assert asked.returncode == 0, asked.stdout + asked.stderr
    assert (serving.returncode, output) == (0, ""), errors
    assert asked.stdout.splitlines() == [
        "switched True läst True",
        "switched False läst False",
        "triggered True triggered",
        "result 4 [0, 1, 1, 2, 3, 5] [[0, 1, 1], [0, 1, 1, 2], [0, 1, 1, 2, 3], [0, 1, 1, 2, 3, 5]]",
        "accepted False",
        "canceling 0 [True]",
    ]
