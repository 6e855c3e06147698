"""Runs `ifgen demo` as users do, for benchmarks of the humanoid."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from collections.abc import Iterable
from typing import NamedTuple

_DOMAIN = "93"


class Run(NamedTuple):
    """How a run ended, and the rows of its summary."""

    code: int
    rows: dict[str, str]

    def number(self, row: str) -> float | None:
        """The number with which a row begins; None if there is no such row."""
        text = self.rows.get(row)
        return None if text is None else float(text.split()[0])


def play(*words: str) -> Run:
    """Run a demo without a window, in a domain of its own."""
    environment = {**os.environ, "ROS_DOMAIN_ID": _DOMAIN, "ROS_AUTOMATIC_DISCOVERY_RANGE": "LOCALHOST"}
    command = [sys.executable, "-m", "ifgen", "demo", "--headless", *words]
    done = subprocess.run(command, env=environment, capture_output=True, text=True, timeout=600, check=False)
    rows = re.findall(r"^  (\S.*?)  +(\S.*)$", done.stdout.partition("\n\n")[2], re.MULTILINE)
    return Run(done.returncode, dict(rows) or {"outcome": done.stderr.strip()})


def span(runs: Iterable[Run], row: str) -> str:
    """From the smallest to the largest number with which a row begins; empty if no run has it."""
    values = sorted(value for run in runs if (value := run.number(row)) is not None)
    return f"{values[0]:g} to {values[-1]:g}" if values else ""
