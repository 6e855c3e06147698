"""Adapters: small messages of another version, converted and read.

    python benchmarks/adapters.py [--rounds N]

The adapters are those that `ifgen adapt` writes. `deserialize` reads bytes of today's version, `decode` those
of the other one and converts the message; `chain` goes over a version in between. Thousands of messages a
second of CPU time on one thread, best of the rounds, in turns.
"""

from __future__ import annotations

import argparse
import os
import sys
import tempfile
import time
from collections.abc import Callable
from contextlib import redirect_stdout
from importlib import import_module, invalidate_caches
from io import StringIO
from pathlib import Path
from types import ModuleType
from typing import Any

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT / "generated"))

import ifgen as toolkit  # noqa: E402 - the generated classes are beside the programs
from ifgen.cli import main as command_line  # noqa: E402
from ifgen_runtime.adapters import decode  # noqa: E402
from ifgen_runtime.codec import deserialize, serialize  # noqa: E402

CALLS = 20_000
ASKED = 200
"""Thousands of messages a second."""

POSE = "std_msgs/Header header\n{0} x\n{0} y\n{0} z\ngeometry_msgs/Quaternion orientation\n"
BATTERY = (
    "std_msgs/Header header\nfloat32 voltage\nfloat32 temperature\n{}float32 charge\nuint8 {}\nbool present\n"
    "float32[] cell_voltage\nstring location\nstring serial_number\n"
)
VERSIONS = {
    "Pose": [POSE.format("float32"), POSE.format("float64"), POSE.format("float64") + 'string map "map"\n'],
    "Battery": [
        BATTERY.format("", "status"),
        BATTERY.format("float32 current 0.1\n", "status"),
        BATTERY.format("float32 current 0.1\n", "level"),
    ],
}
"""Three versions of each type, which need no decisions."""


def main() -> None:
    """Measure and print the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--rounds", type=int, default=9)
    rounds: int = parser.parse_args().rounds
    with tempfile.TemporaryDirectory() as folder:
        os.chdir(folder)
        sys.path[:0] = [folder, f"{folder}/generated"]
        adapters = {name: written(name, versions) for name, versions in VERSIONS.items()}
        toolkit.generate("now", output="generated")
        print("| thousands a second | asked | deserialize | upgrade | decode | chain |")
        print("|---|---:|---:|---:|---:|---:|")
        for name, modules in adapters.items():
            rates = " | ".join(f"{rate / 1e3:.0f}" for rate in measured(name, modules, rounds))
            print(f"| {name} | {ASKED} | {rates} |", flush=True)
        os.chdir(ROOT)


def written(name: str, versions: list[str]) -> list[str]:
    """The names of the modules of adapters from the first and from the second version, chained."""
    for folder, text in zip(("first", "second", "now"), versions, strict=True):
        path = Path(folder, f"bench_msgs/msg/{name}.msg")
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)
    modules: list[str] = []
    for old, new in (("first", "second"), ("second", "now")):
        Path("pyproject.toml").write_text(f'[tool.ifgen]\npaths = ["{new}"]\n')
        with redirect_stdout(StringIO()) as said:
            assert command_line.main(["adapt", f"bench_msgs/msg/{name}", "--from", old]) == 0
        assert "left to you" not in said.getvalue()
        modules.append(said.getvalue().split()[1].removesuffix(".py").replace("/", "."))
    first, second = modules
    path = Path(f"{first.replace('.', '/')}.py")
    frozen = f"from ._{second.partition('.')[2]} import {name}"
    path.write_text(path.read_text().replace(f"from bench_msgs.msg import {name}\n", f"{frozen}\n"))
    invalidate_caches()
    return modules


def measured(name: str, modules: list[str], rounds: int) -> list[float]:
    """Messages a second of CPU time: deserialize, upgrade, decode, and decode over a version in between."""
    first, second = (frozen(name, module) for module in modules)
    adapter: Any = import_module(modules[1])
    new: type[Any] = getattr(adapter, name)
    header = import_module("std_msgs.msg").Header(frame_id="base_link")
    known = {"location": "slot 1", "serial_number": "A-0042", "cell_voltage": [3.5] * 4}
    fields = known if name == "Battery" else {}
    messages = [cls(header=header, **fields) for cls in (first, second, new)]
    data = [serialize(message) for message in messages]
    hashes = [cls.__type_hash__ for cls in (first, second, new)]
    works: list[Callable[[], object]] = [
        lambda: deserialize(data[2], new),
        lambda: adapter.upgrade(messages[1]),
        lambda: decode(data[1], hashes[1], new),
        lambda: decode(data[0], hashes[0], new),
    ]
    best = [float("inf")] * len(works)
    for _ in range(rounds):
        for index, work in enumerate(works):
            start = time.process_time()
            for _ in range(CALLS):
                work()
            best[index] = min(best[index], time.process_time() - start)
    return [CALLS / seconds for seconds in best]


def frozen(name: str, module: str) -> type[Any]:
    """The frozen class that a module of adapters converts."""
    package, _, stem = module.partition(".")
    found: ModuleType = import_module(f"{package}._{stem}")
    cls: type[Any] = getattr(found, name)
    return cls


if __name__ == "__main__":
    main()
