"""The tools of every day: what they cost, and what they measure, beside the truth.

A publisher in another process counts what it sends. The real rclpy is measured where it is installed.
"""

from __future__ import annotations

import os
import re
import resource
import signal
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from importlib.util import find_spec
from pathlib import Path
from typing import Final

IFGEN: Final = [sys.executable, "-m", "ifgen"]
SECONDS: Final = 6.0
REPEATS: Final = 5

PUBLISHER: Final = """
import sys, time
import rclpy
from sensor_msgs.msg import Imu

rclpy.init()
node = rclpy.create_node("imu_driver")
publisher = node.create_publisher(Imu, "imu", 100)
message = Imu()
message.header.frame_id = "base_link"
period = 1 / float(sys.argv[1])
sent, next_time, told = 0, time.monotonic(), 0.0
print("ready", flush=True)
try:
    while True:
        if next_time - told > 0.5:
            told = next_time
            print(time.monotonic(), sent, flush=True)
        sent += 1
        message.header.stamp.sec = sent
        publisher.publish(message)
        next_time += period
        time.sleep(max(next_time - time.monotonic(), 0))
except BaseException:
    pass
"""


def main() -> None:
    """Measure, and print."""
    # Shells let background programs ignore Ctrl-C, which would never end what is measured.
    signal.signal(signal.SIGINT, signal.default_int_handler)
    os.environ["ROS_AUTOMATIC_DISCOVERY_RANGE"] = "LOCALHOST"
    os.environ["ROS_DOMAIN_ID"] = "93"
    transports = ["local", *(["rclpy"] if _has_rclpy() else [])]
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "publisher.py"
        file.write_text(PUBLISHER)
        print("### What a command costs, with one node to be seen (median of 5)\n")
        print(table(("command", "transport", "CPU (s)", "time (s)"), list(_costs(file, transports))))
        print("\n### Listening to sensor_msgs/msg/Imu at 1 kHz for 6 s\n")
        heads = ("command", "transport", "messages", "lost")
        print(table(heads, list(_losses(file, transports))))
        print("\n### Rates that `ifgen topic hz` says, beside those by the publisher's own count\n")
        heads = ("transport", "published (Hz)", "hz says (Hz)", "off by")
        print(table(heads, list(_rates(file, transports))))


def table(heads: tuple[str, ...], rows: list[tuple[object, ...]]) -> str:
    """Rows as Markdown."""
    lines = [heads, tuple("---" for _ in heads), *rows]
    return "\n".join(f"| {' | '.join(map(str, line))} |" for line in lines)


def _has_rclpy() -> bool:
    found = find_spec("rclpy")
    return found is not None and "underlay" not in str(found.origin)


@dataclass
class Publisher:
    """A publisher that counts: its notes are times [s] with how many messages there were."""

    notes: list[tuple[float, int]] = field(default_factory=list)

    def rate(self, start: float, end: float) -> float:
        """What it really published between two times, in Hz."""
        noted = [note for note in self.notes if start <= note[0] <= end]
        return (noted[-1][1] - noted[0][1]) / (noted[-1][0] - noted[0][0])


@contextmanager
def _publishing(file: Path, transport: str, rate: float) -> Iterator[Publisher]:
    command = [*IFGEN, "run", "--transport", transport, str(file), str(rate)]
    publisher = Publisher()
    with (
        tempfile.TemporaryFile("w+") as notes,
        subprocess.Popen(command, stdout=notes, stderr=subprocess.DEVNULL) as program,
    ):
        while not os.fstat(notes.fileno()).st_size:
            time.sleep(0.05)
        yield publisher
        program.kill()
        program.wait()
        notes.seek(0)
        lines = [line.split() for line in notes.read().splitlines()[1:]]
        publisher.notes += [(float(moment), int(count)) for moment, count in lines]


def _costs(file: Path, transports: list[str]) -> Iterator[tuple[object, ...]]:
    for transport in transports:
        with _publishing(file, transport, 10):
            for words in (["list"], ["type", "/imu"], ["echo", "/imu", "--once"]):
                runs = [_run([*IFGEN, "topic", *words, "--transport", transport]) for _ in range(REPEATS)]
                cpu, wall = (statistics.median(each) for each in zip(*runs, strict=True))
                yield f"`ifgen topic {' '.join(words)}`", transport, f"{cpu:.2f}", f"{wall:.2f}"


def _run(command: list[str]) -> tuple[float, float]:
    """The CPU and the time [s] that a command takes."""
    before, started = resource.getrusage(resource.RUSAGE_CHILDREN), time.monotonic()
    subprocess.run(command, stdout=subprocess.DEVNULL, check=True, timeout=60)
    wall, after = time.monotonic() - started, resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime, wall


def _losses(file: Path, transports: list[str]) -> Iterator[tuple[object, ...]]:
    for transport in transports:
        for words in ([], ["--csv"], ["--field", "header.stamp.sec"]):
            with _publishing(file, transport, 1000):
                text = _interrupted(["echo", "/imu", *words], transport)
            pattern = (
                r"^    sec: (\d+)$" if not words else r"^(\d+),0,base" if words == ["--csv"] else r"^(\d+)$"
            )
            numbers = [int(found) for found in re.findall(pattern, text, re.MULTILINE)]
            lost = numbers[-1] - numbers[0] + 1 - len(numbers)
            yield f"`{' '.join(('echo', *words))}`", transport, len(numbers), lost


def _rates(file: Path, transports: list[str]) -> Iterator[tuple[object, ...]]:
    for transport in transports:
        for rate in (10, 100, 1000):
            with _publishing(file, transport, rate) as publisher:
                start = time.monotonic() + 1  # until it listens
                text = _interrupted(["hz", "/imu"], transport)
                end = time.monotonic()
            said = float(re.findall(r"average rate: ([\d.]+)", text)[-1])
            truth = publisher.rate(start, end)
            yield transport, f"{truth:.2f}", f"{said:.2f}", f"{abs(said / truth - 1) * 100:.2f} %"


def _interrupted(words: list[str], transport: str) -> str:
    """The output of a command that is interrupted after a while."""
    command = [*IFGEN, "topic", *words, "--transport", transport]
    with tempfile.TemporaryFile("w+") as output:  # a pipe would be full before
        with subprocess.Popen(command, stdout=output) as program:
            time.sleep(SECONDS + 1)
            program.send_signal(signal.SIGINT)
        output.seek(0)
        return output.read()


if __name__ == "__main__":
    main()
