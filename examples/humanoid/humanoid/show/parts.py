"""The processes of the robot on real rclpy: how they begin, and how they end."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
from collections.abc import Iterable

_ENDING = 5.0  # s that a process has to end
# A part that is interrupted while it imports says nothing: it has nothing to end yet.
_PART = """
import os, signal
signal.signal(signal.SIGINT, lambda *_: os._exit(130))
from humanoid.show.crew import main
main()
"""


def start(arguments: Iterable[str]) -> subprocess.Popen[bytes]:
    """Start a process with the paths of this one; `arguments` are those of `crew.main`."""
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(filter(None, sys.path))}
    command = [sys.executable, "-c", _PART, *arguments]
    # A process begins with the signals ignored that its parent ignores: Python cannot handle them yet.
    before = signal.signal(signal.SIGINT, signal.SIG_IGN)
    try:
        # Its stdin ends when this process ends, however that happens.
        return subprocess.Popen(command, env=environment, stdin=subprocess.PIPE)
    finally:
        signal.signal(signal.SIGINT, before)


def end(processes: Iterable[subprocess.Popen[bytes]]) -> None:
    """End processes together, and wait for that."""
    running = list(processes)
    for process in running:
        if process.poll() is None:
            process.send_signal(signal.SIGINT)
        if process.stdin is not None:
            process.stdin.close()  # ends a process, too, that has not heard the signal
    for process in running:
        try:
            process.wait(_ENDING)
        except subprocess.TimeoutExpired:
            process.kill()
