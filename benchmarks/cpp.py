"""C++: messages of the generator `cpp` beside rosidl's with Fast CDR.

    python benchmarks/cpp.py [--rounds N]

Both programs are cpp_peer.cpp, compiled with `-O2` and the headers of ifgen, or with those of the ROS wheels.
They take turns; the figures are process CPU time, medians over the rounds. "Again" reuses the vector and the
message.
"""

from __future__ import annotations

import argparse
import os
import shutil
import statistics
import subprocess
import sys
import tempfile
from collections.abc import Sequence
from pathlib import Path

from ifgen import resources

HERE = Path(__file__).parent
WHEELS = Path(sys.prefix)
PACKAGES = ("diagnostic_msgs", "geometry_msgs", "nav_msgs", "sensor_msgs", "std_msgs", "visualization_msgs")
CONFIG = """\
[tool.ifgen]
paths = [{paths}]
python = false
[tool.ifgen.generate.code]
use = "{generator}"
out = "{out}"
with_deps = true
"""
Figures = dict[str, list[float]]


def generate(folder: Path, generator: str) -> Path:
    """The folder with what a generator writes for the messages."""
    paths = ", ".join(f'"{resources.bundled_interfaces() / package}"' for package in PACKAGES)
    (folder / "pyproject.toml").write_text(CONFIG.format(paths=paths, generator=generator, out=generator))
    subprocess.run([sys.executable, "-m", "ifgen", "generate", "--quiet"], cwd=folder, check=True)
    return folder / generator


def ours(folder: Path) -> Path:
    """The program with headers of ifgen."""
    return built(folder / "ours", [f"-I{generate(folder, 'cpp')}"])


def theirs(folder: Path) -> Path:
    """The program with headers of rosidl and Fast CDR."""
    includes = [WHEELS / "include", *sorted((WHEELS / "include").glob("*/"))]
    libraries = [f"-l{package}__rosidl_typesupport_fastrtps_cpp" for package in PACKAGES]
    options = ["-DROSIDL", *(f"-isystem{path}" for path in includes), f"-L{WHEELS / 'lib'}"]
    return built(folder / "theirs", options, [*libraries, "-lfastcdr", "-Wl,--allow-shlib-undefined"])


def built(program: Path, options: list[str], libraries: list[str] | None = None) -> Path:
    """The program, compiled."""
    source = str(HERE / "cpp_peer.cpp")
    subprocess.run(
        ["g++", "-std=c++17", "-O2", *options, source, "-o", str(program), *(libraries or [])], check=True
    )
    return program


def figures(program: Path) -> Figures:
    """Bytes and nanoseconds for each message."""
    environment = {**os.environ, "LD_LIBRARY_PATH": str(WHEELS / "lib")}
    done = subprocess.run([str(program)], env=environment, stdout=subprocess.PIPE, text=True, check=True)
    rows = (line.split() for line in done.stdout.splitlines())
    return {name: [float(figure) for figure in rest] for name, *rest in rows}


def is_ready(compiler: str) -> bool:
    """Whether this machine has the compiler, g++ and the headers of ROS; prints what to install if not."""
    if shutil.which(compiler) and shutil.which("g++") and (WHEELS / "include" / "fastcdr").is_dir():
        return True
    print(f"{compiler}, g++ or the headers of ROS are not installed")
    return False


def compare(ours: Path, theirs: Path, columns: Sequence[str], asked: str) -> None:
    """Measure two programs in turns, and print the table."""
    parser = argparse.ArgumentParser(description="beside rosidl and Fast CDR")
    parser.add_argument("--rounds", type=int, default=3)
    runs = [(figures(ours), figures(theirs)) for _ in range(parser.parse_args().rounds)]
    print("Fast CDR's time divided by ours; in brackets our nanoseconds.\n")
    print(f"| message | bytes | {' | '.join(columns)} |\n|---|---:|{'---:|' * len(columns)}")
    ratios: list[list[float]] = [[] for _ in columns]
    for name, (size, *_) in runs[0][0].items():
        cells = []
        for column, of in enumerate(ratios, 1):
            of.append(statistics.median(their[name][column] / our[name][column] for our, their in runs))
            mine = statistics.median(our[name][column] for our, _ in runs)
            cells.append(f"{of[-1]:.1f} ({mine:,.0f})")
        print(f"| {name} | {size:,.0f} | {' | '.join(cells)} |")
    means = [f"**{statistics.geometric_mean(of):.1f}**" for of in ratios]
    print(f"| geometric mean (asked: {asked}) | | {' | '.join(means)} |")


def main() -> None:
    """Compile, measure in turns, print the table."""
    if is_ready("g++"):
        with tempfile.TemporaryDirectory() as folder:
            columns = ("encode", "encode again", "decode", "decode again")
            compare(ours(Path(folder)), theirs(Path(folder)), columns, "2.5, 2.5, 1.5, 1.5")


if __name__ == "__main__":
    main()
