"""What a start costs: processes that meet another one, and processes that stay alone.

python benchmarks/starting.py [--rounds N]

CPU time from the start of Python to the first message, which a talker sends and a listener hears, and the
resident memory then. Who is alone sends to itself, where others could be met and where the discovery range is
OFF. "Across" is the price of another process: the listener's memory over that of a process that is alone.
Medians of interleaved rounds, real rclpy by its defaults.
"""

from __future__ import annotations

import argparse
import importlib.util
import json
import os
import statistics
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
UNDERLAY = (ROOT / "codegen" / "underlay", ROOT / "generated", ROOT / "codegen")
LIMIT = 30.0  # [s] for one process
REPEATS = 2000  # messages of a process that is alone

_PROGRAM = """
import sys
import rclpy
from std_msgs.msg import String

role = sys.argv[1]
rclpy.init()
node = rclpy.create_node(role)
executor = rclpy.executors.SingleThreadedExecutor()
executor.add_node(node)
heard = []
if role != "talk":
    node.create_subscription(String, "words", heard.append, 10)
if role == "listen":
    print("ready", flush=True)
else:
    publisher = node.create_publisher(String, "words", 10)
    while not publisher.get_subscription_count():
        executor.spin_once(timeout_sec=0.01)
    publisher.publish(String(data="word"))
while role != "talk" and not heard:
    executor.spin_once(timeout_sec=1)
import json, os, time
cpu = time.process_time() * 1e3
with open("/proc/self/statm") as file:
    memory = int(file.read().split()[1]) * os.sysconf("SC_PAGE_SIZE") / 1e6
each = 0.0
if role == "alone":
    begin = time.process_time()
    for _ in range(REPEATS):
        publisher.publish(String(data="word"))
        executor.spin_once(timeout_sec=1)
    each = (time.process_time() - begin) / REPEATS * 1e6
print(json.dumps([cpu, memory, each]), flush=True)
sys.stdin.read()
os._exit(0)
""".replace("REPEATS", str(REPEATS))


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--rounds", type=int, default=7)
    rounds = parser.parse_args().rounds
    ours, *theirs = _environments()
    off = {"ROS_AUTOMATIC_DISCOVERY_RANGE": "OFF"}
    columns = [
        {
            **_pair(environment),
            "alone": _one(environment, "alone"),
            "off": _one(environment | off, "alone"),
        }
        for _ in range(rounds)
        for environment in (ours, *theirs)
    ]
    step = 1 + len(theirs)
    _show([_medians(columns[number::step]) for number in range(step)])


def _environments() -> list[dict[str, str]]:
    """Ours, and the real rclpy's if there is one; each in a domain of its own."""
    base = {name: value for name, value in os.environ.items() if not name.startswith(("PYTHON", "ROS_"))}
    if "PYTHONPYCACHEPREFIX" in os.environ:
        base["PYTHONPYCACHEPREFIX"] = os.environ["PYTHONPYCACHEPREFIX"]
    base |= {"ROS_AUTOMATIC_DISCOVERY_RANGE": "LOCALHOST", "OPENBLAS_NUM_THREADS": "1"}
    found = [base | {"PYTHONPATH": os.pathsep.join(map(str, UNDERLAY))}]
    if importlib.util.find_spec("rclpy"):
        found.append(base)
    first = 1 + os.getpid() % 90
    return [each | {"ROS_DOMAIN_ID": str(first + number)} for number, each in enumerate(found)]


def _start(environment: dict[str, str], role: str) -> subprocess.Popen[str]:
    return subprocess.Popen(
        [sys.executable, "-c", _PROGRAM, role],
        env=environment,
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        text=True,
    )


def _figures(process: subprocess.Popen[str]) -> list[float]:
    assert process.stdout is not None
    figures: list[float] = json.loads(process.stdout.readline())
    return figures


def _one(environment: dict[str, str], role: str) -> list[float]:
    with _start(environment, role) as process:
        found = _figures(process)
        process.communicate(timeout=LIMIT)
    return found


def _pair(environment: dict[str, str]) -> dict[str, list[float]]:
    with _start(environment, "listen") as listener, _start(environment, "talk") as talker:
        assert listener.stdout is not None
        listener.stdout.readline()
        found = {"talk": _figures(talker), "listen": _figures(listener)}
        for process in (talker, listener):
            process.communicate(timeout=LIMIT)
    return found


def _medians(columns: list[dict[str, list[float]]]) -> dict[str, list[float]]:
    return {
        role: [statistics.median(values) for values in zip(*(each[role] for each in columns), strict=True)]
        for role in columns[0]
    }


def _show(found: list[dict[str, list[float]]]) -> None:
    print("| | rclpy | ours | asked |\n|---|---:|---:|---:|")
    for name, role, number, asked in (
        ("to the first message that a talker sends [ms of CPU]", "talk", 0, "<= 150"),
        ("to the first message that a listener hears [ms of CPU]", "listen", 0, "<= 150"),
        ("the same, alone [ms of CPU]", "alone", 0, ""),
        ("the same, alone, range OFF [ms of CPU]", "off", 0, ""),
        ("a message to itself, alone [us of CPU]", "alone", 2, "within the noise of OFF"),
        ("a message to itself, alone, range OFF [us of CPU]", "off", 2, ""),
        ("memory of a listener [MB]", "listen", 1, ""),
    ):
        ours, *theirs = (each[role][number] for each in found)
        print(_row(name, theirs, ours, asked))
    ours, *theirs = (each["listen"][1] - each["alone"][1] for each in found)
    print(_row("across: memory over a process that is alone [MB]", theirs, ours, "<= 20"))


def _row(name: str, theirs: list[float], ours: float, asked: str) -> str:
    return (
        f"| {name} | {theirs[0]:.1f} | {ours:.1f} | {asked} |"
        if theirs
        else f"| {name} | - | {ours:.1f} | {asked} |"
    )


if __name__ == "__main__":
    main()
