"""Two processes on the local transport beside two on real rclpy: latency, throughput, discovery, cost.

python benchmarks/processes.py [--rounds N]

A process asks, another one echoes. The peers take turns in one run, and are stopped while it is not theirs.
Wall time from `publish` to the callback that gets the echo, medians over the rounds of each round's p50 and
p99. Real rclpy runs with its defaults, and with 64 MB of shared memory, without which it copies large
messages over UDP. Without the ROS wheels only ours is measured. `asked` is the target of the ratio to the
better one. Then come messages of several sizes through sockets and through shared memory, and what a process
needs beside one that has everybody in it.
"""

from __future__ import annotations

import argparse
import importlib.util
import json
import os
import signal
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parent.parent
UNDERLAY = (ROOT / "codegen" / "underlay", ROOT / "generated", ROOT / "codegen")
LIMIT = 30.0  # [s] for one message, or one conversation

# name, messages a round, targets of ours / rclpy for p50 and p99
LATENCIES = (
    ("String", 300, "<= 0.7", "<= 1"),
    ("JointState(30)", 300, "<= 0.7", "<= 1"),
    ("Image 0.9 MB", 40, "<= 0.5", ""),
    ("Image 6.2 MB", 10, "<= 0.5", ""),
    ("service", 100, "<= 0.7", ""),
    ("action goal to result", 10, "<= 0.7", ""),
)
SIZES = ("Image 16 kB", "Image 64 kB", "Image 128 kB", "Image 256 kB", "Image 0.9 MB", "Image 6.2 MB")
BURST = 5000  # messages
STARTS = 5
IDLE = 3.0  # [s]

_PATIENCE = "transport/link/tx/lease=600000"  # [ms]
_PROFILE = """<profiles xmlns="http://www.eprosima.com/XMLSchemas/fastRTPS_Profiles">
<transport_descriptors><transport_descriptor><transport_id>shm</transport_id><type>SHM</type>
<segment_size>67108864</segment_size></transport_descriptor></transport_descriptors>
<participant profile_name="tuned" is_default_profile="true"><rtps>
<userTransports><transport_id>shm</transport_id></userTransports>
<useBuiltinTransports>false</useBuiltinTransports></rtps></participant></profiles>
"""

# A node that is started to be seen, and says when its making began.
_NEWCOMER = """
import sys, time, rclpy
rclpy.init()
begin = time.monotonic_ns()
node = rclpy.create_node("newcomer")
print(begin, flush=True)
sys.stdin.read()
"""


# ---- in the measured processes


def _messages() -> dict[str, Any]:
    from sensor_msgs.msg import Image, JointState
    from std_msgs.msg import String

    joints = [0.1] * 30
    return {
        "String": String(data="x" * 32),
        "JointState(30)": JointState(
            name=[f"joint_{number}" for number in range(30)], position=joints, velocity=joints, effort=joints
        ),
        "Image 16 kB": Image(height=64, width=256, step=256, encoding="mono8", data=bytes(16_384)),
        "Image 64 kB": Image(height=256, width=256, step=256, encoding="mono8", data=bytes(65_536)),
        "Image 128 kB": Image(height=256, width=512, step=512, encoding="mono8", data=bytes(131_072)),
        "Image 256 kB": Image(height=512, width=512, step=512, encoding="mono8", data=bytes(262_144)),
        "Image 0.9 MB": Image(height=480, width=640, step=1920, encoding="rgb8", data=bytes(921_600)),
        "Image 6.2 MB": Image(height=1080, width=1920, step=5760, encoding="rgb8", data=bytes(6_220_800)),
    }


def _topic(name: str) -> str:
    return name.partition(".")[0].replace(" ", "_").replace("(", "").replace(")", "").lower() + str(len(name))


def echo() -> None:
    """Answer everything, until the end of the input."""
    answer()
    print("ready", flush=True)
    sys.stdin.read()
    os._exit(0)  # an orderly end is not worth the time


def answer() -> None:
    """Answer everything, in another thread."""
    import threading

    import rclpy
    from rclpy.action import ActionServer
    from rclpy.executors import SingleThreadedExecutor
    from rclpy.qos import HistoryPolicy, QoSProfile
    from std_msgs.msg import Int64
    from std_srvs.srv import SetBool
    from test_msgs.action import Fibonacci

    rclpy.init()
    node = rclpy.create_node("echo")
    kept: list[Any] = []
    for name, message in _messages().items():
        back = node.create_publisher(type(message), f"{_topic(name)}_back", 10)
        kept += [back, node.create_subscription(type(message), _topic(name), back.publish, 10)]
    kept.append(node.create_service(SetBool, "switch", lambda _, response: response))

    def execute(goal: Any) -> Any:
        goal.succeed()
        return Fibonacci.Result(sequence=[0, 1, 1])

    kept.append(ActionServer(node, Fibonacci, "compute", execute))
    everything = QoSProfile(history=HistoryPolicy.KEEP_ALL)
    done = node.create_publisher(Int64, "counted", 10)
    counted = [0]

    def count(_: Any) -> None:
        counted[0] += 1
        if counted[0] == BURST:
            counted[0] = 0
            done.publish(Int64(data=time.monotonic_ns()))

    kept.append(node.create_subscription(Int64, "burst", count, everything))
    executor = SingleThreadedExecutor()
    executor.add_node(node)
    threading.Thread(target=executor.spin, daemon=True).start()


class Asking:
    """The process that measures."""

    def __init__(self) -> None:
        import rclpy
        from rclpy.action import ActionClient
        from rclpy.executors import SingleThreadedExecutor
        from rclpy.qos import HistoryPolicy, QoSProfile
        from std_msgs.msg import Int64
        from std_srvs.srv import SetBool
        from test_msgs.action import Fibonacci

        if not rclpy.ok():
            rclpy.init()
        self.node = rclpy.create_node("asking")
        self.executor = SingleThreadedExecutor()
        self.executor.add_node(self.node)
        self.calls: dict[str, Callable[[], object]] = {}
        topics = {name: self._round_trip(name, message) for name, message in _messages().items()}
        client = self.node.create_client(SetBool, "switch")
        actions = ActionClient(self.node, Fibonacci, "compute")
        everything = QoSProfile(history=HistoryPolicy.KEEP_ALL)
        self.burst = self.node.create_publisher(Int64, "burst", everything)
        self.counted: list[int] = []
        self.node.create_subscription(Int64, "counted", lambda message: self.counted.append(message.data), 10)
        self.until(client.service_is_ready)
        self.until(actions.server_is_ready)
        self.until(lambda: all(publisher.get_subscription_count() for publisher in topics.values()))
        self.until(self.burst.get_subscription_count)
        self.until(lambda: self.node.count_publishers("counted"))

        def serve() -> None:
            future = client.call_async(SetBool.Request())
            self.until(future.done)

        def act() -> None:
            sent = actions.send_goal_async(Fibonacci.Goal(order=2))
            self.until(sent.done)
            result = sent.result().get_result_async()
            self.until(result.done)

        self.calls |= {"service": serve, "action goal to result": act}

    def until(self, condition: Callable[[], object]) -> None:
        """Spin until it is so."""
        end = time.monotonic() + LIMIT
        while not condition():
            assert time.monotonic() < end, "it did not happen in time"
            self.executor.spin_once(timeout_sec=0.1)

    def _round_trip(self, name: str, message: Any) -> Any:
        heard: list[Any] = []
        publisher = self.node.create_publisher(type(message), _topic(name), 10)
        self.node.create_subscription(type(message), f"{_topic(name)}_back", heard.append, 10)

        def call() -> None:
            heard.clear()
            publisher.publish(message)
            self.until(lambda: heard)

        self.calls[name] = call
        return publisher

    def measure(self, name: str, count: int) -> list[float]:
        """Return p50 and p99 [us], or a single figure."""
        if name == "throughput":
            return [self._throughput()]
        if name == "seen":
            return [self._seen()]
        if name == "idle":
            begin = time.process_time()
            time.sleep(IDLE)
            return [(time.process_time() - begin) / IDLE * 1e3]
        if name == "memory":
            resident = Path("/proc/self/statm").read_text().split()[1]
            return [int(resident) * os.sysconf("SC_PAGE_SIZE") / 1e6]
        times: list[float] = []
        for _ in range(count + 3):
            begin = time.perf_counter()
            self.calls[name]()
            times.append((time.perf_counter() - begin) * 1e6)
        times = sorted(times[3:])
        return [times[len(times) // 2], times[min(int(len(times) * 0.99), len(times) - 1)]]

    def _throughput(self) -> float:
        from std_msgs.msg import Int64

        self.counted.clear()
        begin = time.monotonic_ns()
        for _ in range(BURST):
            self.burst.publish(Int64())
        self.until(lambda: self.counted)
        return BURST / (self.counted[0] - begin) * 1e9

    def _seen(self) -> float:
        """Return the time [ms] from the making of a node in a new process until it is seen here."""
        newcomer = subprocess.Popen(
            [sys.executable, "-c", _NEWCOMER], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
        )
        assert newcomer.stdin is not None and newcomer.stdout is not None
        end = time.monotonic() + LIMIT
        while "newcomer" not in self.node.get_node_names():
            assert time.monotonic() < end
            time.sleep(0.0005)
        seen = time.monotonic_ns()
        begin = int(newcomer.stdout.readline())
        newcomer.stdin.close()
        newcomer.wait()
        while "newcomer" in self.node.get_node_names() and time.monotonic() < end:
            time.sleep(0.01)
        return (seen - begin) / 1e6


def ask() -> None:
    """Measure what each line of the input requests, and print the figures."""
    asking = Asking()
    print(json.dumps([]), flush=True)
    for line in sys.stdin:
        print(json.dumps(asking.measure(*json.loads(line))), flush=True)
    os._exit(0)


# ---- in the process that asks them


class Peer:
    """Processes with one implementation, stopped while it is not their turn. The last one measures."""

    def __init__(self, environment: dict[str, str], *roles: str) -> None:
        self._processes = [
            subprocess.Popen(
                [sys.executable, __file__, role],
                env=environment,
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
                text=True,
            )
            for role in roles or ("--echo", "--ask")
        ]
        self._read()
        self._signal(signal.SIGSTOP)

    def measure(self, name: str, count: int = 0) -> list[float]:
        """Request figures."""
        self._signal(signal.SIGCONT)
        asking = self._processes[-1]
        assert asking.stdin is not None
        asking.stdin.write(json.dumps([name, count]) + "\n")
        asking.stdin.flush()
        found = self._read()
        self._signal(signal.SIGSTOP)
        return found

    def end(self) -> None:
        """End them."""
        for process in self._processes:
            process.kill()
            process.wait()

    def _read(self) -> list[float]:
        asking = self._processes[-1]
        assert asking.stdout is not None
        line = asking.stdout.readline()
        if not line:
            raise RuntimeError("a measured process ended")
        found: list[float] = json.loads(line)
        return found

    def _signal(self, number: signal.Signals) -> None:
        for process in self._processes:
            process.send_signal(number)


def _environments(folder: Path) -> list[dict[str, str]]:
    """Ours, and if there is a real rclpy, its defaults and its tuned profile; each in a domain of its own."""
    base = {name: value for name, value in os.environ.items() if not name.startswith(("PYTHON", "ROS_"))}
    base |= {"ROS_AUTOMATIC_DISCOVERY_RANGE": "LOCALHOST", "OPENBLAS_NUM_THREADS": "1"}
    # Who is stopped for longer than Zenoh's lease is taken for dead, and loses what comes then.
    found = [base | {"PYTHONPATH": os.pathsep.join(map(str, UNDERLAY)), "ZENOH_CONFIG_OVERRIDE": _PATIENCE}]
    if importlib.util.find_spec("rclpy"):
        profile = folder / "profile.xml"
        profile.write_text(_PROFILE)
        found += [base, base | {"FASTRTPS_DEFAULT_PROFILES_FILE": str(profile)}]
    first = 1 + os.getpid() % 90
    return [each | {"ROS_DOMAIN_ID": str(first + number)} for number, each in enumerate(found)]


def _in_turns(peers: list[Peer], rounds: int, name: str, count: int = 0) -> list[list[float]]:
    """The medians of each peer's figures."""
    figures: list[list[list[float]]] = [[] for _ in peers]
    for _ in range(rounds):
        for peer, found in zip(peers, figures, strict=True):
            found.append(peer.measure(name, count))
    return [[statistics.median(column) for column in zip(*found, strict=True)] for found in figures]


def _row(name: str, unit: str, figures: list[float], asked: str, best: Callable[[list[float]], float]) -> str:
    ours, *theirs = (f"{figure:,.1f}" if figure < 100 else f"{figure:,.0f}" for figure in figures)
    ratio = f"{figures[0] / best(figures[1:]):.2f}" if theirs else "-"
    cells = [*theirs, "-", "-"][:2]
    return f"| {name} [{unit}] | {cells[0]} | {cells[1]} | {ours} | {ratio} | {asked} |"


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--rounds", type=int, default=5)
    parser.add_argument("--echo", action="store_true", help=argparse.SUPPRESS)
    parser.add_argument("--ask", action="store_true", help=argparse.SUPPRESS)
    parser.add_argument("--alone", action="store_true", help=argparse.SUPPRESS)
    parser.add_argument("--only-memory", action="store_true", help="without rclpy")
    options = parser.parse_args()
    if options.alone:
        answer()
    if options.echo or options.ask or options.alone:
        (echo if options.echo else ask)()
        return
    with tempfile.TemporaryDirectory() as folder:
        environments = _environments(Path(folder))
        if not options.only_memory:
            with _running([Peer(environment) for environment in environments]) as peers:
                show(peers, options.rounds)
        ours = environments[0]
        sockets = ours | {"ZENOH_SHM_ALLOC_SIZE": "0", "ROS_DOMAIN_ID": str(int(ours["ROS_DOMAIN_ID"]) + 3)}
        shared = ours | {"ZENOH_SHM_MESSAGE_SIZE_THRESHOLD": "1"}
        alone = ours | {"ROS_AUTOMATIC_DISCOVERY_RANGE": "OFF"}
        with _running([Peer(sockets), Peer(shared), Peer(alone, "--alone")]) as peers:
            show_memory(peers, options.rounds)


@contextmanager
def _running(peers: list[Peer]) -> Iterator[list[Peer]]:
    try:
        yield peers
    finally:
        for peer in peers:
            peer.end()


def show(peers: list[Peer], rounds: int) -> None:
    """Print the table row by row."""
    print("| across two processes | rclpy | rclpy, 64 MB SHM | ours | ratio | asked |")
    print("|---|---|---|---|---|---|")
    for name, count, *asked in LATENCIES:
        found = _in_turns(peers, rounds, name, count)
        for number, what in enumerate(("p50", "p99")):
            if number == 0 or asked[1]:
                figures = [each[number] for each in found]
                print(_row(f"{name}, {what}", "us", figures, asked[number], min), flush=True)
    for name, label, unit, asked_ratio, best in (
        ("throughput", "small messages, keep all", "1/s", ">= 2", max),
        ("seen", "a new node is seen", "ms", "100 ms", min),
        ("idle", "CPU of an idle process", "ms/s", "", min),
        ("memory", "resident memory", "MB", "", min),
    ):
        found = _in_turns(peers, STARTS if name == "seen" else min(rounds, 3), name)
        figures = [each[0] for each in found]
        print(_row(label, unit, figures, asked_ratio, best), flush=True)


def show_memory(peers: list[Peer], rounds: int) -> None:
    """Print what shared memory is good for, and what it costs: sockets, shared memory, and one process."""
    before = [peer.measure("memory")[0] for peer in peers]
    print()
    print("| there and back, p50 [us] | sockets | shared memory | ratio |")
    print("|---|---|---|---|")
    for name in SIZES:
        sockets, shared = (each[0] for each in _in_turns(peers[:2], rounds, name, 40))
        print(f"| {name} | {sockets:,.0f} | {shared:,.0f} | {shared / sockets:.2f} |", flush=True)
    for name in SIZES:
        peers[2].measure(name, 40)
    after = [peer.measure("memory")[0] for peer in peers]
    print()
    print("| resident memory [MB] | one process | sockets | shared memory | more, at most | asked |")
    print("|---|---|---|---|---|---|")
    for what, (sockets, shared, alone) in (("no message yet", before), ("after these messages", after)):
        more = max(sockets, shared) - alone
        print(f"| {what} | {alone:.0f} | {sockets:.0f} | {shared:.0f} | {more:.0f} | <= 20 |", flush=True)


if __name__ == "__main__":
    main()
