"""Classes made at run time: how long that takes, and their codec beside that of generated classes.

    python benchmarks/dynamic.py [--rounds N]

Making a class includes the classes of all types that it contains. Each class is made from nothing, everything
else is warm; CPU time, medians over the rounds. The codec is made at its first use. Ratios are dynamic to
generated, best of the rounds, in turns.
"""

from __future__ import annotations

import argparse
import copy
import gc
import statistics
import sys
import time
from collections.abc import Callable
from importlib import import_module
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT / "generated"))

import ifgen.dynamic  # noqa: E402 - the generated classes are beside the programs
from ifgen.dynamic import making  # noqa: E402
from ifgen_runtime.codec import deserialize, serialize  # noqa: E402
from ifgen_runtime.type_description import describe  # noqa: E402

TYPES = (
    *("std_msgs/msg/String", "geometry_msgs/msg/PoseStamped", "sensor_msgs/msg/JointState"),
    *("nav_msgs/msg/Odometry", "sensor_msgs/msg/PointCloud2", "visualization_msgs/msg/MarkerArray"),
)
CALLS = 2_000


def main() -> None:
    """Measure and print the tables."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--rounds", type=int, default=25)
    rounds: int = parser.parse_args().rounds
    print("| type | types in it | class [ms] | and codec [ms] | again [ms] |")
    print("|---|---:|---:|---:|---:|")
    for name in TYPES:
        print(f"| {name} | {' | '.join(made(generated(name), rounds))} |", flush=True)
    print("\n| dynamic / generated | serialise | deserialise | copy |\n|---|---:|---:|---:|")
    for name in TYPES:
        ratios = (f"{ratio:.2f}" for ratio in compared(generated(name), rounds))
        print(f"| {name} | {' | '.join(ratios)} |", flush=True)


def generated(name: str) -> type[Any]:
    """The generated class of a type."""
    package, folder, stem = name.split("/")
    cls: type[Any] = getattr(import_module(f"{package}.{folder}"), stem)
    return cls


def made(cls: type[Any], rounds: int) -> list[str]:
    """The number of types, and the times of a new class, of that with its codec, and of one that is known."""
    document = describe(cls)
    times: tuple[list[float], ...] = ([], [], [])
    for _ in range(rounds):
        making._classes.clear()
        gc.collect()  # nobody else has thrown away classes
        start = time.process_time()
        dynamic = ifgen.dynamic.class_of(document)
        times[0].append(time.process_time() - start)
        assert dynamic.__serialize__
        times[1].append(time.process_time() - start)
        start = time.process_time()
        assert ifgen.dynamic.class_of(document) is dynamic
        times[2].append(time.process_time() - start)
    count = 1 + len(document["referenced_type_descriptions"])
    return [str(count), *(f"{1e3 * statistics.median(measured):.1f}" for measured in times)]


def compared(cls: type[Any], rounds: int) -> list[float]:
    """The ratios of serialising, deserialising and copying."""
    dynamic = ifgen.dynamic.class_of(describe(cls))
    one, other = cls(), dynamic()
    data = serialize(one)
    assert serialize(other) == data
    pairs: tuple[tuple[Callable[[], object], Callable[[], object]], ...] = (
        (lambda: serialize(other), lambda: serialize(one)),
        (lambda: deserialize(data, dynamic), lambda: deserialize(data, cls)),
        (lambda: copy.deepcopy(other), lambda: copy.deepcopy(one)),
    )
    found: list[float] = []
    for ours, theirs in pairs:
        best = [float("inf"), float("inf")]
        for _ in range(rounds):
            for which, function in enumerate((ours, theirs)):
                best[which] = min(best[which], duration(function))
        found.append(best[0] / best[1])
    return found


def duration(function: Callable[[], object]) -> float:
    """The time of many calls."""
    start = time.perf_counter()
    for _ in range(CALLS):
        function()
    return time.perf_counter() - start


if __name__ == "__main__":
    main()
