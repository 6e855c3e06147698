"""The language server as an editor meets it, in a workspace of 277 packages.

The workspace holds the packages that come with ifgen several times under other names.
"""

from __future__ import annotations

import argparse
import shutil
import statistics
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT))

from tests.language_server.client import Client, editing  # noqa: E402 - found by the line above

ASKED = {"keystroke to diagnostics": 50, "hover": 20, "rename of a type used 201 times": 300}


def main() -> None:
    """Make a workspace, ask, and print a table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--copies", type=int, default=6, help="how often the packages are there (default: 6)")
    parser.add_argument("--rounds", type=int, default=50, help="requests of each kind (default: 50)")
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        packages = workspace(Path(folder), options.copies)
        started = time.perf_counter()
        with editing(Path(folder)) as editor:
            name = "robot_msgs/msg/Walk.msg"
            editor.open(name)
            editor.pull(name)
            first = time.perf_counter() - started
            rows = measured(editor, name, options.rounds)
            memory = peak_memory(editor.process.pid)
    print(f"{packages} packages, {memory:.0f} MB at most (asked: 150).\n")
    print("| what | median [ms] | 95 % [ms] | asked [ms] |\n|---|---:|---:|---:|")
    print(f"| start to first diagnostics | {first * 1e3:.0f} | | 700 |")
    for row, times in rows.items():
        nearly_all = sorted(times)[int(len(times) * 0.95)]
        print(f"| {row} | {statistics.median(times):.1f} | {nearly_all:.1f} | {ASKED.get(row, '')} |")


def workspace(folder: Path, copies: int) -> int:
    """Write the packages; returns their number. One has a type that 200 fields use."""
    for number in range(copies):
        for package in sorted((ROOT / "interfaces").iterdir()):
            if package.is_dir():
                shutil.copytree(package, folder / f"copy_{number}" / f"{package.name}_{number}")
    own = folder / "robot_msgs/msg"
    own.mkdir(parents=True)
    (own / "Step.msg").write_text("float64 x  # [m]\n")
    (own / "Walk.msg").write_text("Step step\n")
    for number in range(200):
        (own / f"User{number}.msg").write_text("Step step\n")
    return len(list(folder.glob("copy_*/*"))) + 1


def measured(editor: Client, name: str, rounds: int) -> dict[str, list[float]]:
    """The times of requests [ms], by what they are."""

    def keystroke(number: int) -> None:
        editor.change(name, f"Step step\nfloat64 x{number}\n")
        editor.pull(name)

    kinds: dict[str, Callable[[int], object]] = {
        "keystroke to diagnostics": keystroke,
        "hover": lambda _: editor.request("textDocument/hover", **editor.at(name, 0, 1)),
        "completion": lambda _: editor.request("textDocument/completion", **editor.at(name, 0, 2)),
        "references of a type": lambda _: editor.request(
            "textDocument/references", **editor.at(name, 0, 1, context={"includeDeclaration": True})
        ),
        "rename of a type used 201 times": lambda number: editor.request(
            "textDocument/rename", **editor.at(name, 0, 1, newName=f"Stride{number}")
        ),
    }
    found: dict[str, list[float]] = {}
    for kind, ask in kinds.items():
        ask(0)
        times: list[float] = []
        for number in range(rounds):
            begin = time.perf_counter()
            ask(number)
            times.append((time.perf_counter() - begin) * 1e3)
        found[kind] = times
    return found


def peak_memory(process: int) -> float:
    """The largest memory of a process so far [MB]; Linux only."""
    for line in Path(f"/proc/{process}/status").read_text().splitlines():
        if line.startswith("VmHWM"):
            return int(line.split()[1]) / 1024
    return 0.0


if __name__ == "__main__":
    main()
