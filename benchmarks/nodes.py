"""Nodes: generating the packages of interfaces/ that have some, and their tests.

    python benchmarks/nodes.py [--rounds N]

Whole commands in processes of their own, interpreter start included: seconds of CPU and of wall clock,
medians. "cold" has neither ifgen's cache folder nor outputs, "warm" has the cache but no outputs, "one
changed" follows an edit of one description, and "unchanged" is the same command again. We know of nothing
else that makes node packages with tests from NoDL, so there is no peer beside it.
"""

from __future__ import annotations

import argparse
import os
import resource
import shutil
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from typing import NamedTuple

INTERFACES = Path(__file__).resolve().parent.parent / "interfaces"


class Cost(NamedTuple):
    """Seconds that a process took."""

    cpu: float
    wall: float


def main() -> None:
    """Measure and print a table."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--rounds", type=int, default=5)
    rounds = parser.parse_args().rounds
    costs: dict[str, list[Cost]] = {"cold": [], "warm": [], "one changed": [], "unchanged": []}
    with tempfile.TemporaryDirectory() as folder:
        packages = [path.parent for path in sorted(INTERFACES.glob("*/nodl"))]
        sources = Path(folder) / "ws"
        for package in packages:
            shutil.copytree(package, sources / package.name)
        for index in range(rounds):
            cache, out = Path(folder) / f"cache{index}", Path(folder) / f"out{index}"
            costs["cold"].append(generate(cache, sources, out))
            costs["unchanged"].append(generate(cache, sources, out))
            [edited, *_] = sorted(sources.glob("*/nodl/*.nodl.yaml"))
            edited.write_text(edited.read_text() + "# Edited.\n")
            costs["one changed"].append(generate(cache, sources, out))
            shutil.rmtree(out)
            costs["warm"].append(generate(cache, sources, out))
    print(
        f"| {len(packages)} packages of nodes | CPU [s] | wall [s] | each [ms of CPU] |\n|---|---:|---:|---:|"
    )
    for name, measured in costs.items():
        cpu, wall = (statistics.median(figures) for figures in zip(*measured, strict=True))
        print(f"| {name} | {cpu:.2f} | {wall:.2f} | {cpu / len(packages) * 1000:.0f} |")


def generate(cache: Path, sources: Path, out: Path) -> Cost:
    """Run `ifgen generate` with a cache folder of its own."""
    command = [sys.executable, "-m", "ifgen", "generate", str(sources), "-o", str(out), "-I", str(INTERFACES)]
    before, started = resource.getrusage(resource.RUSAGE_CHILDREN), time.perf_counter()
    environment = {**os.environ, "XDG_CACHE_HOME": str(cache)}
    subprocess.run(command, env=environment, stdout=subprocess.DEVNULL, check=True)
    wall, after = time.perf_counter() - started, resource.getrusage(resource.RUSAGE_CHILDREN)
    return Cost(after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime, wall)


if __name__ == "__main__":
    main()
