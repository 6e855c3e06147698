"""Compare two versions of 1,000 interfaces: `ifgen breaking` against a revision, a folder and a lock file.

    python benchmarks/breaking.py [--rounds N]

Whole commands in processes of their own, interpreter start included: seconds of CPU and of wall clock,
medians, without ifgen's cache folder. The commands take turns. `ifgen check` reads one version only.
"""

from __future__ import annotations

import argparse
import os
import shutil
import subprocess
import tempfile
from pathlib import Path

from generate import ROOT, Cost, ifgen, median, synthesise

COUNT = 1_000
EDITED = 10
ASKED = 1.0
"""Seconds that a comparison may take."""


def main() -> None:
    """Measure and print a table."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--rounds", type=int, default=5)
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        measure(Path(folder), options.rounds)


def measure(folder: Path, rounds: int) -> None:
    """The costs against each kind of earlier version, with no difference and with some."""
    project = folder / "project"
    synthesise(project, COUNT)
    shutil.copytree(project, folder / "earlier")
    git(project, "init", "--quiet")
    git(project, "add", "--all")
    git(project, "-c", "user.name=me", "-c", "user.email=me@example.org", "commit", "--quiet", "--message=x")
    os.chdir(project)
    ifgen(folder / "cache", "lock", ".", "-I", ROOT / "interfaces")
    runs = {
        "`ifgen check`": ("check", "."),
        "a git revision": ("breaking", ".", "--against", "HEAD"),
        "a folder": ("breaking", ".", "--against", folder / "earlier"),
        "the lock file": ("breaking", ".", "--against", "ifgen.lock"),
    }
    print("| against | edited interfaces | CPU [s] | wall [s] | asked [s] |\n|---|---:|---:|---:|---:|")
    for edited in (0, EDITED):
        edit(project, edited)
        costs: dict[str, list[Cost]] = {name: [] for name in runs}
        for _ in range(rounds):
            for name, command in runs.items():
                cache = Path(tempfile.mkdtemp(dir=folder))
                code = int(edited > 0 and command[0] == "breaking")
                costs[name].append(ifgen(cache, *command, code=code))
        for name, measured in costs.items():
            asked = "" if "check" in name else f"{ASKED:.1f}"
            figures = f"{median(measured, 'cpu'):.2f} | {median(measured, 'wall'):.2f}"
            print(f"| {name} | {edited} | {figures} | {asked} |")


def edit(project: Path, count: int) -> None:
    """Give this number of messages another type of field."""
    for path in sorted(project.rglob("*.msg"))[:count]:
        path.write_text(path.read_text(encoding="utf-8").replace("float64 value0", "float32 value0"))


def git(folder: Path, *arguments: str) -> None:
    """Run git in a folder."""
    subprocess.run(["git", *arguments], cwd=folder, check=True)


if __name__ == "__main__":
    main()
