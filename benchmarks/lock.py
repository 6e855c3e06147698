"""The lock file: writing and reading it, and the cost of `ifgen generate --locked`.

    python benchmarks/lock.py [--rounds N]

A project of 1,000 messages, each with ten fields and two constants, in ten packages. CPU time, medians over
the rounds, in turns. `--locked` is compared with the same run without it: when nothing has changed, and after
one file has changed.
"""

from __future__ import annotations

import argparse
import os
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path

from ifgen.diagnostics import Source
from ifgen.evolution.lock import comparison
from ifgen.evolution.lock import file as lock_file
from ifgen.evolution.lock import text as lock_text
from ifgen.pipeline import stages

PACKAGES, MESSAGES = 10, 100


def main() -> None:
    """Measure and print the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--rounds", type=int, default=5)
    rounds: int = parser.parse_args().rounds
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        project(folder)
        registry = stages.load(folder / "interfaces")
        text = lock_text.text([registry])
        path = folder / "ifgen.lock"
        path.write_text(text)
        lock = lock_file.read(path)
        print(f"{len(text.splitlines()):,} lines, {len(text) / 1024:.0f} KiB\n")
        print("| step | CPU [ms] |\n|---|---:|")
        for what, function in (
            ("text of the lock file from definitions", lambda: lock_text.text([registry])),
            ("read it, hashes included", lambda: lock_file.parse(Source(path, text))),
            ("compare it with the project", lambda: comparison.check(lock, [registry])),
        ):
            print(f"| {what} | {1e3 * timed(function, rounds):.0f} |", flush=True)
        print("\n| `ifgen generate` | without [ms] | `--locked` [ms] |\n|---|---:|---:|")
        for what, touched in (("nothing has changed", False), ("one comment has changed", True)):
            times = runs(folder, rounds, touched=touched)
            print(f"| {what} | {1e3 * times[0]:.0f} | {1e3 * times[1]:.0f} |", flush=True)


def project(folder: Path) -> None:
    """A project with many messages, which contain those of the package before."""
    (folder / "pyproject.toml").write_text('[tool.ifgen]\npaths = ["interfaces"]\ntests = false\n')
    for package in range(PACKAGES):
        for message in range(MESSAGES):
            path = folder / f"interfaces/made{package}_msgs/msg/M{message}.msg"
            path.parent.mkdir(parents=True, exist_ok=True)
            nested = f"made{package - 1}_msgs/M{message}[<=3] nested\n" if package else "float32 nested\n"
            fields = "".join(f"float64 x{number} 0.{number}\n" for number in range(9))
            path.write_text(f"{nested}{fields}uint8 FAST=1\nstring NAME='a name'\n")


def timed(function: Callable[[], object], rounds: int) -> float:
    """The median CPU time of a call."""
    times: list[float] = []
    for _ in range(rounds):
        start = time.process_time()
        function()
        times.append(time.process_time() - start)
    return statistics.median(times)


def runs(folder: Path, rounds: int, *, touched: bool) -> list[float]:
    """The CPU times of whole commands, without and with `--locked`."""
    edited = folder / "interfaces/made9_msgs/msg/M7.msg"
    before = edited.read_text()
    times: tuple[list[float], list[float]] = ([], [])
    for options in ([], ["--locked"]):
        command(folder, *options)
    for number in range(rounds):
        for which, options in enumerate(([], ["--locked"])):
            if touched:
                edited.write_text(f"# {number}.{which}\n{before}")
            times[which].append(command(folder, *options))
    edited.write_text(before)
    return [statistics.median(measured) for measured in times]


def command(folder: Path, *options: str) -> float:
    """Run `ifgen generate` in a process of its own; its CPU time."""
    start = os.times()
    subprocess.run([sys.executable, "-m", "ifgen", "generate", "-q", *options], cwd=folder, check=True)
    end = os.times()
    return end.children_user - start.children_user + end.children_system - start.children_system


if __name__ == "__main__":
    main()
