"""Terminals in which a command of ifgen runs."""

from __future__ import annotations

import os
import queue
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Sequence
from pathlib import Path

LIMIT = 60.0  # [s]
PEER = str(Path(__file__).parent / "peers/peer.py")


class Command:
    """`ifgen` with these words, and the lines that it prints."""

    def __init__(self, environment: dict[str, str], *words: str, before: Sequence[str] = ()) -> None:
        self.process = subprocess.Popen(
            [*before, sys.executable, "-m", "ifgen", *words],
            env=environment,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
        )
        self.lines: list[str] = []
        self._new: queue.Queue[str] = queue.Queue()
        self._reader = threading.Thread(target=self._read, daemon=True)
        self._reader.start()

    def _read(self) -> None:
        assert self.process.stdout is not None
        for line in self.process.stdout:
            self._new.put(line.rstrip("\n"))

    def until(self, beginning: str, limit: float = LIMIT) -> str:
        """Wait for a line that begins so."""
        end = time.monotonic() + limit
        while True:
            try:
                line = self._new.get(timeout=max(end - time.monotonic(), 0.001))
            except queue.Empty:
                raise AssertionError(f"no line {beginning!r}, only {self.lines}") from None
            self.lines.append(line)
            if line.startswith(beginning):
                return line

    def until_all(self, *beginnings: str) -> None:
        """Wait for lines that begin so, in any order."""
        left = set(beginnings)
        while left:
            line = self.until("")
            left = {beginning for beginning in left if not line.startswith(beginning)}

    def end(self) -> int:
        """Press Ctrl-C."""
        self.process.send_signal(signal.SIGINT)
        code = self.process.wait(LIMIT)
        self.rest()
        return code

    def rest(self) -> list[str]:
        """Return all lines, those until the end included."""
        self._reader.join(LIMIT)
        return self.so_far()

    def so_far(self) -> list[str]:
        """Return the lines until now."""
        while not self._new.empty():
            self.lines.append(self._new.get())
        return self.lines


class Terminal(Command):
    """A program on the local transport."""

    def __init__(self, environment: dict[str, str], *arguments: str, before: Sequence[str] = ()) -> None:
        super().__init__(environment, "run", "--transport", "local", *arguments, before=before)


class Machine:
    """Terminals of one user, in a domain of their own."""

    def __init__(self, domain: int, folder: Path) -> None:
        self.folder = Path(f"/tmp/ifgen-{os.getuid()}/{domain}")
        self.environment = {
            **os.environ,
            "ROS_DOMAIN_ID": str(domain),
            "ROS_AUTOMATIC_DISCOVERY_RANGE": "LOCALHOST",
            "ROS_LOG_DIR": str(folder),
            "PYTHONUNBUFFERED": "1",
        }
        self.terminals: list[Terminal] = []
        self._clean()  # other tests kill programs, and had this domain before

    def run(
        self, *arguments: str, program: str = PEER, before: Sequence[str] = (), **environment: str
    ) -> Terminal:
        """Open a terminal, and run a program there."""
        terminal = Terminal(self.environment | environment, program, *arguments, before=before)
        self.terminals.append(terminal)
        return terminal

    def close(self) -> None:
        for terminal in self.terminals:
            terminal.process.send_signal(signal.SIGCONT)
            terminal.process.kill()
            terminal.process.wait()
        self._clean()

    def _clean(self) -> None:
        for left in self.folder.glob("*"):
            left.unlink()
