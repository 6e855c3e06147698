"""Generate: everything bundled, sets of 100 to 20,000 interfaces, and rosidl's own generator beside ours.

    python benchmarks/generate.py [--largest N] [--rounds N]

Whole commands in processes of their own, interpreter start included: seconds of CPU and of wall clock,
medians. "cold" has neither ifgen's cache folder nor outputs; "unchanged" is the same command again. rosidl is
measured where its wheels are installed, on the same messages, interleaved with ours.
"""

from __future__ import annotations

import argparse
import importlib.util
import os
import resource
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from typing import Literal, NamedTuple

ROOT = Path(__file__).resolve().parent.parent
SIZES = (100, 1_000, 10_000, 20_000)
PER_PACKAGE = 50
ROSIDL_MESSAGES = 40
ROSIDL = """
import contextlib, io, json, pathlib, sys
from rosidl_adapter import convert_to_idl
from rosidl_generator_py import generate_py
import rosidl_generator_py
package, source, out, share = sys.argv[1], *map(pathlib.Path, sys.argv[2:5])
files = sorted((source / package / 'msg').glob('*.msg'))
with contextlib.redirect_stdout(io.StringIO()):
    for file in files:
        convert_to_idl(source / package, package, pathlib.Path('msg') / file.name, out / 'idl')
    arguments = {
        'package_name': package, 'output_dir': str(out / 'py'),
        'idl_tuples': [f"{out / 'idl'}:msg/{file.stem}.idl" for file in files],
        'template_dir': str(share / 'rosidl_generator_py' / 'resource'), 'target_dependencies': [],
        'ros_interface_dependencies': [],
        'include_paths': [f'{p.name}:{p}' for p in share.iterdir() if p.is_dir()],
    }
    (out / 'arguments.json').write_text(json.dumps(arguments))
    generate_py(str(out / 'arguments.json'), [])
"""


class Cost(NamedTuple):
    """Seconds that a process took, and the most memory of any process so far [MB]."""

    cpu: float
    wall: float
    peak: float


def main() -> None:
    """Measure and print three tables."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--largest", type=int, default=SIZES[-1], help="leave out sets larger than this")
    parser.add_argument("--rounds", type=int, default=5)
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        print("### Everything bundled\n")
        bundled(Path(folder), options.rounds)
        print("\n### Linear in the number of interfaces\n")
        sizes(Path(folder), [size for size in SIZES if size <= options.largest])
        print("\n### Beside rosidl\n")
        beside_rosidl(Path(folder), options.rounds)


def bundled(folder: Path, rounds: int) -> None:
    """Cold and unchanged runs over interfaces/."""
    cold: list[Cost] = []
    unchanged: list[Cost] = []
    for index in range(rounds):
        out, cache = folder / f"bundled{index}", folder / f"cache{index}"
        cold.append(ifgen(cache, "generate", ROOT / "interfaces", "-o", out))
        unchanged.append(ifgen(cache, "generate", ROOT / "interfaces", "-o", out))
    count = sum(1 for _ in (ROOT / "interfaces").rglob("*.*") if _.suffix in {".msg", ".srv", ".action"})
    print(f"| {count} interfaces | CPU [s] | wall [s] |\n|---|---|---|")
    for name, costs in (("cold", cold), ("unchanged", unchanged)):
        print(f"| {name} | {median(costs, 'cpu'):.2f} | {median(costs, 'wall'):.2f} |")


def sizes(folder: Path, counts: list[int]) -> None:
    """Cost for each interface as their number grows by tens."""
    print("| interfaces | cold CPU [s] | each [ms] | peak [MB] | unchanged CPU [s] | each [ms] |")
    print("|---|---|---|---|---|---|")
    for count in counts:
        source, out, cache = (folder / f"{kind}{count}" for kind in ("many", "many_out", "many_cache"))
        synthesise(source, count)
        cold = ifgen(cache, "generate", source, "-o", out)
        unchanged = ifgen(cache, "generate", source, "-o", out)
        figures = [cold.cpu, cold.cpu / count * 1000, cold.peak]
        figures += [unchanged.cpu, unchanged.cpu / count * 1000]
        print(f"| {count:,} | " + " | ".join(f"{figure:.2f}" for figure in figures) + " |")


def beside_rosidl(folder: Path, rounds: int) -> None:
    """The same messages through ifgen and through rosidl_adapter and rosidl_generator_py."""
    synthesise(folder / "pair", ROSIDL_MESSAGES, services=False)
    runs: dict[str, Callable[[int], Cost]] = {
        "ifgen": lambda i: ifgen(
            folder / f"pair_cache{i}", "generate", folder / "pair", "-o", folder / f"pair_out{i}"
        )
    }
    if importlib.util.find_spec("rosidl_generator_py"):
        runs["rosidl_adapter + rosidl_generator_py"] = lambda i: rosidl(
            folder / "pair", folder / f"rosidl{i}"
        )
    costs: dict[str, list[Cost]] = {name: [] for name in runs}
    for index in range(max(rounds // 2, 1)):
        for name, run in runs.items():
            costs[name].append(run(index))
    ours = median(costs["ifgen"], "cpu")
    print(f"| {ROSIDL_MESSAGES} messages | CPU [s] | messages/s | ratio to ifgen |\n|---|---|---|---|")
    for name, measured_costs in costs.items():
        cpu = median(measured_costs, "cpu")
        print(f"| {name} | {cpu:.2f} | {ROSIDL_MESSAGES / cpu:.1f} | {cpu / ours:.1f} |")
    if len(runs) == 1:
        print("\nrosidl_generator_py is not installed here.")


def synthesise(folder: Path, count: int, services: bool = True) -> None:
    """Write this number of interfaces: ten fields each, some of other packages, every fifth a service."""
    for index in range(count):
        package, name = f"bench{index // PER_PACKAGE}_msgs", f"Type{index}"
        lines = [
            "# Made for a benchmark.",
            "std_msgs/Header header",
            "geometry_msgs/Pose[] poses # where",
            "uint8 KIND=1",
        ]
        lines += [f"float64 value{i} # [m]" for i in range(4)]
        lines += ["string<=64 name", "uint8[16] id", "bool[<=8] flags", "string text"]
        text = "\n".join(lines) + "\n"
        is_service = services and index % 5 == 4
        path = (
            folder
            / package
            / ("srv" if is_service else "msg")
            / (f"{name}.srv" if is_service else f"{name}.msg")
        )
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text + ("---\nbool ok\n" if is_service else ""))


def ifgen(cache: Path, *arguments: Path | str, code: int = 0) -> Cost:
    """Run an ifgen command, which exits with this code, with a cache folder of its own."""
    return measured([sys.executable, "-m", "ifgen", *map(str, arguments)], code, XDG_CACHE_HOME=str(cache))


def rosidl(source: Path, out: Path) -> Cost:
    """Run rosidl's generators on the first package of a folder."""
    out.mkdir()
    share = Path(sys.prefix) / "share"
    return measured([sys.executable, "-c", ROSIDL, "bench0_msgs", str(source), str(out), str(share)])


def measured(command: list[str], code: int = 0, **environment: str) -> Cost:
    """Run a command to its end."""
    before, started = resource.getrusage(resource.RUSAGE_CHILDREN), time.perf_counter()
    done = subprocess.run(command, env={**os.environ, **environment}, stdout=subprocess.DEVNULL, check=False)
    assert done.returncode == code, command
    wall, after = time.perf_counter() - started, resource.getrusage(resource.RUSAGE_CHILDREN)
    cpu = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    return Cost(cpu, wall, after.ru_maxrss / 1000)


def median(costs: list[Cost], which: Literal["cpu", "wall"]) -> float:
    """The median of one figure."""
    return statistics.median(cost.cpu if which == "cpu" else cost.wall for cost in costs)


if __name__ == "__main__":
    main()
