"""Read interfaces: text to validated model, ours beside rosidl's and rosbags' readers.

    python benchmarks/parse.py [--rounds N]

The files are the messages of common_interfaces, text in memory. Readers take turns; the figures are process
CPU time, medians over the rounds, garbage collection off, everything warm. A reader that is not installed
shows as '-'.
"""

from __future__ import annotations

import argparse
import contextlib
import gc
import io
import statistics
import sys
import tempfile
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

from ifgen import resources
from ifgen.definition import build
from ifgen.definition.problems import FileProblems
from ifgen.definition.resolve import resolve
from ifgen.diagnostics import Source
from ifgen.reading.packages import find_packages
from ifgen.reading.search_path import SearchPath

COMMON = (
    *("actionlib_msgs", "diagnostic_msgs", "geometry_msgs", "nav_msgs", "sensor_msgs", "shape_msgs"),
    *("std_msgs", "std_srvs", "stereo_msgs", "trajectory_msgs", "visualization_msgs"),
)
SIZES = (100, 1_000, 10_000)


@dataclass(frozen=True)
class File:
    """One file in memory."""

    package: str
    kind: str
    name: str
    source: Source


Reader = Callable[[Sequence[File]], object]


def common_interfaces() -> list[File]:
    """The wheels' files if they are installed, for their authors' comments; otherwise the bundled ones."""
    share = Path(sys.prefix) / "share"
    root = share if (share / "sensor_msgs" / "msg").is_dir() else resources.bundled_interfaces()
    packages = find_packages([root / name for name in COMMON])
    return [
        File(package.name, file.kind, file.name, file.read())
        for package in packages
        for file in package.files
    ]


def as_idl(files: Sequence[File]) -> list[File]:
    """The same messages as rosidl_adapter writes them; nothing if it is not installed."""
    try:
        from rosidl_adapter import convert_to_idl
    except ImportError:
        return []
    found: list[File] = []
    with tempfile.TemporaryDirectory() as folder, contextlib.redirect_stdout(io.StringIO()):
        for file in files:
            root = Path(folder) / file.package
            path = Path("msg") / f"{file.name}.msg"
            (root / "msg").mkdir(parents=True, exist_ok=True)
            (root / path).write_text(file.source.text, encoding="utf-8")
            written = Path(convert_to_idl(root, file.package, path, root / "idl"))
            found.append(File(file.package, "msg", file.name, Source(written, written.read_text("utf-8"))))
    return found


def ours(files: Sequence[File]) -> None:
    """Text to validated model, comments, units and warnings included."""
    for file in files:
        problems = FileProblems(file.source)
        build.interface(file.source, file.package, file.kind, file.name, problems)  # type: ignore[arg-type]
        assert not problems


def rosbags() -> Reader:
    """The reader of rosbags keeps types, names and constants."""
    from rosbags.typesys import get_types_from_msg

    def read(files: Sequence[File]) -> None:
        for file in files:
            get_types_from_msg(file.source.text, f"{file.package}/msg/{file.name}")

    return read


def rosidl_adapter() -> Reader:
    """The text stage of rosidl alone, which is followed by .idl files and their parser."""
    from rosidl_adapter.parser import parse_message_string

    def read(files: Sequence[File]) -> None:
        for file in files:
            parse_message_string(file.package, file.name, file.source.text)

    return read


def rosidl() -> Reader:
    """All of rosidl's reading: rosidl_adapter writes .idl files, rosidl_parser reads them."""
    from rosidl_adapter import convert_to_idl
    from rosidl_parser.definition import IdlLocator
    from rosidl_parser.parser import parse_idl_file

    def read(files: Sequence[File]) -> None:
        with tempfile.TemporaryDirectory() as folder, contextlib.redirect_stdout(io.StringIO()):
            for file in files:
                root = Path(folder) / file.package
                path = Path("msg") / f"{file.name}.msg"
                (root / "msg").mkdir(parents=True, exist_ok=True)
                (root / path).write_text(file.source.text, encoding="utf-8")
                convert_to_idl(root, file.package, path, root / "idl")
                parse_idl_file(IdlLocator(root / "idl", path.with_suffix(".idl")))

    return read


def rosidl_parser() -> Reader:
    """The reader of .idl files of rosidl, to its own model."""
    from rosidl_parser.parser import parse_idl_string

    def read(files: Sequence[File]) -> None:
        for file in files:
            parse_idl_string(file.source.text)

    return read


def cpu_time(reader: Reader, files: Sequence[File]) -> float:
    """Seconds of CPU that reading takes."""
    started = time.process_time()
    reader(files)
    return time.process_time() - started


def print_readers(rounds: int) -> None:
    """The first table: files per second, and the time relative to ours."""
    files = common_interfaces()
    messages = [file for file in files if file.kind == "msg"]
    few = messages[:: len(messages) // 12]
    idl = as_idl(messages)
    few_idl = idl[:: max(len(idl) // 12, 1)]
    candidates = {
        "ifgen, messages, services and actions": (lambda: ours, files),
        "ifgen, messages": (lambda: ours, messages),
        "ifgen, the same messages as .idl files": (lambda: ours, idl),
        "rosbags, messages": (rosbags, messages),
        "rosidl_adapter.parser alone, messages": (rosidl_adapter, messages),
        f"rosidl, text to rosidl_parser's model, {len(few)} messages": (rosidl, few),
        f"rosidl_parser, {len(few_idl)} of the .idl files": (rosidl_parser, few_idl),
    }
    seconds: dict[str, list[float]] = {name: [] for name in candidates}
    readers = {}
    for name, (make, files_read) in candidates.items():
        with contextlib.suppress(ImportError):
            if files_read:
                readers[name] = make()
    for turn in range(rounds + 1):
        for name, reader in readers.items():
            taken = cpu_time(reader, candidates[name][1])
            if turn:  # the first round warms up
                seconds[name].append(taken / len(candidates[name][1]))
    base = statistics.median(seconds["ifgen, messages"])
    print("| reader | files/s | time, ifgen = 1 |\n|---|---:|---:|")
    for name, taken in seconds.items():
        if taken:
            median = statistics.median(taken)
            print(f"| {name} | {1 / median:,.0f} | {median / base:,.1f} |")
        else:
            print(f"| {name} | - | - |")


def write_interfaces(root: Path, count: int) -> None:
    """Write packages of a hundred interfaces; each message has a field of an earlier one."""
    for number in range(count):
        package = root / f"p{number // 100}_msgs"
        kind = "srv" if number % 10 == 9 else "msg"
        used = number - number % 100 if number % 10 else max(number - 100, 0)
        held = "builtin_interfaces/Time" if used == number else f"p{used // 100}_msgs/M{used}"
        text = f"# Number {number}.\n\nuint8 KIND=1\n{held} held\nfloat64[3] x  # where [m]\nstring name\n"
        path = package / kind / f"M{number}.{kind}"
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text + "---\nbool success\n" if kind == "srv" else text)


def print_sizes(rounds: int) -> None:
    """The second table: folders of files to a registry, whose cost must be linear."""
    print("\n| interfaces, from files to a registry | seconds | us an interface |\n|---:|---:|---:|")
    for count in SIZES:
        with tempfile.TemporaryDirectory() as folder:
            write_interfaces(Path(folder), count)
            taken = []
            for _ in range(rounds):
                started = time.process_time()
                packages = find_packages([folder])
                resolve(packages, SearchPath(packages))
                taken.append(time.process_time() - started)
        median = statistics.median(taken)
        print(f"| {count:,} | {median:.3f} | {median / count * 1e6:.0f} |")


def main() -> None:
    """Print both tables."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--rounds", type=int, default=9)
    rounds = parser.parse_args().rounds
    gc.disable()
    print_readers(rounds)
    print_sizes(min(rounds, 3))


if __name__ == "__main__":
    main()
