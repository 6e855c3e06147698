"""Construct, read, compare, copy and import messages: ours beside rosidl's classes.

    python benchmarks/classes.py [--rounds N] [TYPE...]

Both sets of classes are in one process and take turns; the figures are process CPU time, medians over the
rounds, garbage collection off, checks off unless a row says otherwise. Imports run in fresh processes, from
cached bytecode. Needs the reference wheels.
"""

from __future__ import annotations

import argparse
import copy
import gc
import importlib
import math
import os
import statistics
import subprocess
import sys
import tempfile
import tracemalloc
from collections.abc import Callable, Iterator, Sequence
from typing import Any

from codec import ROOT, _calls, _time, messages, our_types

Operation = Callable[[], Any]
OPERATIONS = ("default", "keywords", "==", "deepcopy", "repr")
IMPORTS = {
    "import geometry_msgs.msg": "import geometry_msgs.msg",
    "import sensor_msgs.msg": "import sensor_msgs.msg",
    "ten packages": "import "
    + ", ".join(
        f"{name}_msgs.msg"
        for name in (
            *("std", "geometry", "sensor", "nav", "diagnostic"),
            *("shape", "stereo", "trajectory", "visualization", "action"),
        )
    ),
    "from sensor_msgs.msg import Imu": "from sensor_msgs.msg import Imu",
    "Twist()": "from geometry_msgs.msg import Twist; Twist()",
    "Imu() (needs numpy)": "from sensor_msgs.msg import Imu; Imu()",
}
CHILD = "import time; start = time.process_time(); exec({code!r}); print(time.process_time() - start)"


def codec_name() -> str:
    """`C` or `Python`: what our classes use here."""
    return str(importlib.import_module("ifgen_runtime.codec.choice").chosen().name)


def rosidl_types(name: str) -> Any:
    """A class of the wheels, by type name; a dict stands in for those of tf2_msgs, which has no wheel."""
    package, folder, cls = name.split("/")
    if package == "tf2_msgs":
        return dict
    return getattr(importlib.import_module(f"{package}.{folder}"), cls)


def operations(message: Any) -> dict[str, Operation]:
    """The operations to measure with a filled message."""
    cls, same = type(message), copy.deepcopy(message)
    fields = {name: getattr(message, name) for name in cls.get_fields_and_field_types()}
    return {
        "default": cls,
        "keywords": lambda: cls(**fields),
        "==": lambda: message == same,
        "copy": lambda: copy.copy(message),
        "deepcopy": lambda: copy.deepcopy(message),
        "repr": lambda: repr(message),
    }


def attribute_operations(types: Callable[[str], Any]) -> Iterator[tuple[str, Operation]]:
    """Operations that read and write fields, with and without checks."""
    twist, vector, joints = (
        types(name)
        for name in ("geometry_msgs/msg/Twist", "geometry_msgs/msg/Vector3", "sensor_msgs/msg/JointState")
    )
    for label, checks in (("", False), (", checks on", True)):
        v, t, j = vector(check_fields=checks), twist(check_fields=checks), joints(check_fields=checks)
        for text, names in (
            ("v.x", {"v": v}),
            ("v.x = 1.5", {"v": v}),
            ("t.linear.x", {"t": t}),
            ("t.linear.x = 1.5", {"t": t}),
            ("j.position", {"j": j}),
            ("j.position = values", {"j": j, "values": [0.5] * 30}),
        ):
            yield text + label, looped(text, names)
        yield (
            f"Vector3(x=1.0, y=2.0, z=3.0){label}",
            looped(
                f"V(x=1.0, y=2.0, z=3.0, check_fields={checks})" if checks else "V(x=1.0, y=2.0, z=3.0)",
                {"V": vector},
            ),
        )


def looped(statement: str, names: dict[str, Any]) -> Operation:
    """A function that runs a statement a hundred times, so that the cost of the call is negligible."""
    scope: dict[str, Any] = {}
    body = "".join(f"    {statement}\n" for _ in range(100))
    exec(f"def run({', '.join(names)}):\n{body}", scope)
    run, values = scope["run"], tuple(names.values())
    return lambda: run(*values)


def interleaved(ours: Operation, rosidl: Operation, rounds: int) -> tuple[float, float]:
    """Median seconds per call of both."""
    our_time, their_time = in_turn([ours, rosidl], rounds)
    return our_time, their_time


def in_turn(functions: Sequence[Operation], rounds: int) -> list[float]:
    """Median seconds per call of functions that take turns."""
    calls = [_calls(function) for function in functions]
    times: list[list[float]] = [[] for _ in functions]
    for _ in range(rounds):
        for function, count, values in zip(functions, calls, times, strict=True):
            values.append(_time(function, count))
    return [statistics.median(values) for values in times]


def memory(cls: Any) -> float:
    """Size of one default object in bytes."""
    tracemalloc.start()
    kept = [cls() for _ in range(1000)]
    size = tracemalloc.get_traced_memory()[0] / len(kept)
    tracemalloc.stop()
    return size


def import_seconds(code: str, ours: bool, repeats: int = 11) -> float:
    """Median CPU seconds of some code in a fresh process."""
    path = [str(ROOT / "generated"), str(ROOT / "codegen")] if ours else []
    command = [sys.executable, "-c", CHILD.format(code=code)]
    with tempfile.TemporaryDirectory() as cache:
        environment = {**os.environ, "PYTHONPATH": os.pathsep.join(path), "PYTHONPYCACHEPREFIX": cache}
        environment.pop("PYTHONDONTWRITEBYTECODE", None)
        times = [
            float(subprocess.run(command, env=environment, capture_output=True, text=True, check=True).stdout)
            for _ in range(repeats + 1)
        ]
    return statistics.median(times[1:])  # the first writes the bytecode


def table(head: list[str], rows: list[list[str]]) -> str:
    """A Markdown table."""
    lines = [head, ["---", *["---:"] * (len(head) - 1)], *rows]
    return "\n".join(f"| {' | '.join(line)} |" for line in lines)


def operation_table(our_class: Callable[[str], Any], words: list[str], rounds: int) -> str:
    """Construction, equality, copies and texts of the benchmark set."""
    rows: list[list[str]] = []
    ratios: dict[str, list[float]] = {name: [] for name in OPERATIONS}
    rosidl = dict(messages(rosidl_types))
    for name, message in messages(our_class):
        if isinstance(rosidl[name], dict) or (words and not any(word in name for word in words)):
            continue
        ours, theirs = operations(message), operations(rosidl[name])
        row = [name.rpartition("/")[2]]
        for operation in OPERATIONS:
            our_time, their_time = interleaved(ours[operation], theirs[operation], rounds)
            ratios[operation].append(their_time / our_time)
            row.append(f"{our_time * 1e6:.2f} / {their_time * 1e6:.2f} ({their_time / our_time:.1f}x)")
        rows.append(row)
    means = [math.exp(statistics.fmean(map(math.log, values))) for values in ratios.values()]
    rows.append(["**geometric mean**", *(f"**{mean:.1f}x**" for mean in means)])
    return table(["type", *OPERATIONS], rows)


def in_python(cls: Any) -> None:
    """Let a class and those inside it compare and copy as without ifgen-ros-native: by generated methods."""
    for name in ("eq", "deepcopy", "copy"):
        setattr(cls, f"__{name}__", getattr(cls, f"__generated_{name}__"))
    for nested in cls.__nested__:
        in_python(nested)


def copies_table(sets: Sequence[Callable[[str], Any]], words: list[str], rounds: int) -> str:
    """Equality and copies of several sets of classes, which take turns."""
    columns = ("==", "copy", "deepcopy")
    rows: list[list[str]] = []
    ratios: dict[tuple[str, int], list[float]] = {}
    filled = [dict(messages(types)) for types in sets]
    for name, message in filled[0].items():
        if isinstance(filled[-1][name], dict) or (words and not any(word in name for word in words)):
            continue
        each = [operations(message), *(operations(others[name]) for others in filled[1:])]
        row = [name.rpartition("/")[2]]
        for column in columns:
            times = in_turn([of_set[column] for of_set in each], rounds)
            for index, time in enumerate(times[1:], 1):
                ratios.setdefault((column, index), []).append(time / times[0])
            row.append(" / ".join(f"{time * 1e6:.2f}" for time in times))
        rows.append(row)
    means = {key: math.exp(statistics.fmean(map(math.log, values))) for key, values in ratios.items()}
    others = range(1, len(sets))
    rows.append(
        [
            "**geometric mean of ratios**",
            *(" / ".join(["**1", *(f"{means[c, i]:.1f}x" for i in others)]) + "**" for c in columns),
        ]
    )
    return table(["type", *columns], rows)


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--rounds", type=int, default=11)
    parser.add_argument("types", nargs="*", help="only types whose name holds one of these words")
    arguments = parser.parse_args()
    gc.disable()
    our_class = our_types()
    in_turns = [our_class]
    if codec_name() == "C":
        in_turns.append(our_types())
        for name, _ in messages(in_turns[1]):
            in_python(in_turns[1](name))
    print("### Whole messages, ours / rosidl (µs)\n")
    print(operation_table(our_class, arguments.types, arguments.rounds))
    if len(in_turns) > 1:
        print("\n### Copies and equality, in C / generated in Python / rosidl (µs)\n")
        print(copies_table([*in_turns, rosidl_types], arguments.types, arguments.rounds))
    if arguments.types:
        return
    rows = []
    reference = dict(attribute_operations(rosidl_types))
    for label, operation in attribute_operations(our_class):
        ours, theirs = interleaved(operation, reference[label], arguments.rounds)
        rows.append([f"`{label}`", f"{ours * 1e7:.0f}", f"{theirs * 1e7:.0f}", f"{theirs / ours:.1f}x"])
    print("\n### Fields (ns)\n")
    print(table(["statement", "ours", "rosidl", "rosidl / ours"], rows))
    rows = []
    for name in ("geometry_msgs/msg/Twist", "sensor_msgs/msg/Imu", "sensor_msgs/msg/JointState"):
        ours, theirs = memory(our_class(name)), memory(rosidl_types(name))
        rows.append([name, f"{ours:.0f}", f"{theirs:.0f}", f"{ours / theirs:.2f}x"])
    print("\n### Memory of one default message (bytes)\n")
    print(table(["type", "ours", "rosidl", "ours / rosidl"], rows))
    rows = []
    for label, code in IMPORTS.items():
        ours, theirs = import_seconds(code, ours=True), import_seconds(code, ours=False)
        rows.append([f"`{label}`", f"{ours * 1e3:.1f}", f"{theirs * 1e3:.1f}", f"{theirs / ours:.0f}x"])
    print("\n### Imports in a fresh process (CPU ms)\n")
    print(table(["code", "ours", "rosidl", "rosidl / ours"], rows))


if __name__ == "__main__":
    main()
