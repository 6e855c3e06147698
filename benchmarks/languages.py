"""Generate a package of 262 messages, the size of px4_msgs, in each other language.

    python benchmarks/languages.py [--rounds N]

Whole commands in processes of their own, interpreter start included, without caches and outputs: seconds of
CPU, medians. The messages are made up: flat, with constants, comments and units, as those of PX4 are.
"""

from __future__ import annotations

import argparse
import os
import random
import statistics
import subprocess
import sys
import tempfile
from pathlib import Path

COUNT = 262
ASKED = 1.5
LANGUAGES = ("typescript", "cpp", "c", "rust")
TYPES = (
    *("float32", "float64", "uint8", "uint16", "uint32", "uint64", "int32", "int8", "bool"),
    *("float32[3]", "float32[4]", "uint8[16]", "float32[16]", "char[40]"),
)


def write(folder: Path) -> None:
    """Write the package: one message in seven has an array of another."""
    source = random.Random("px4")
    folder.mkdir(parents=True)
    for index in range(COUNT):
        lines = ["uint64 timestamp # time since system start (microseconds)"]
        lines += [f"uint8 STATE_{i} = {i} # a state" for i in range(source.randrange(8))]
        lines += [f"{source.choice(TYPES)} value_{i} # [m/s]" for i in range(source.randrange(4, 26))]
        lines += [f"Topic{source.randrange(20)}[4] parts"] if index >= 20 and source.random() < 1 / 7 else []
        (folder / f"Topic{index}.msg").write_text("".join(f"{line}\n" for line in lines))


def seconds(package: Path, language: str) -> float:
    """CPU of one run in an empty folder."""
    with tempfile.TemporaryDirectory() as folder:
        target = f'[tool.ifgen.generate.code]\nuse = "{language}"\nout = "out"\n'
        config = f'[tool.ifgen]\npaths = ["{package}"]\npython = false\n{target}'
        Path(folder, "pyproject.toml").write_text(config)
        command = [sys.executable, "-m", "ifgen", "generate", "--quiet"]
        environment = {**os.environ, "XDG_CACHE_HOME": folder}
        before = os.times()
        subprocess.run(command, cwd=folder, env=environment, check=True)
        after = os.times()
    return (after.children_user - before.children_user) + (after.children_system - before.children_system)


def main() -> None:
    """Measure in turns, and print the table."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("--rounds", type=int, default=5)
    rounds = parser.parse_args().rounds
    with tempfile.TemporaryDirectory() as folder:
        write(package := Path(folder, "topic_msgs", "msg"))
        runs = [{name: seconds(package.parent, name) for name in LANGUAGES} for _ in range(rounds)]
    print("| language | CPU [s] | asked [s] |\n|---|---:|---:|")
    for name in LANGUAGES:
        print(f"| {name} | {statistics.median(run[name] for run in runs):.2f} | {ASKED} |")


if __name__ == "__main__":
    main()
