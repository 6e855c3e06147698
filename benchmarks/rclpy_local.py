"""The local transport beside real rclpy: topics, services, actions, many entities, memory, start-up.

python benchmarks/rclpy_local.py [--rounds N] [--messages N]

Each implementation runs in a process of its own that measures itself on request, so both take turns in one
run. Process CPU time in microseconds, all threads included, medians over the rounds, garbage collection off.
Without the ROS wheels only ours is measured. `target` is the target of a ratio or figure.
"""

from __future__ import annotations

import argparse
import gc
import importlib.util
import json
import os
import signal
import statistics
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parent.parent
UNDERLAY = (ROOT / "codegen" / "underlay", ROOT / "generated", ROOT / "codegen")
LIMIT = 20.0  # [s] for one conversation

# name, calls per round, the smallest ratio rclpy / ours
MEASURED = (
    ("String, one thread", 500, 20),
    ("Twist, one thread", 500, 20),
    ("JointState(30), one thread", 300, 20),
    ("Image 0.9 MB, one thread", 30, 20),
    ("service round trip", 200, 10),
    ("action goal to result", 5, 10),
    ("String, across threads", 500, 5),
)
CROWDS = ("alone", "1,000 timers", "1,000 topics", "100 nodes")
CROWD_CALLS = 5000
STARTS = 5

_START = """
import rclpy
rclpy.init()
from std_msgs.msg import String
node = rclpy.create_node("start")
heard = []
subscription = node.create_subscription(String, "first", heard.append, 10)
publisher = node.create_publisher(String, "first", 10)
while not heard:
    publisher.publish(String(data="first"))
    rclpy.spin_once(node, timeout_sec=0.1)
import time
print(time.process_time() * 1e3)
"""


# ---- in the measured process


class Work:
    """The measured work, on whichever rclpy this process has."""

    def __init__(self) -> None:
        import rclpy
        from rclpy.executors import SingleThreadedExecutor

        rclpy.init()
        self.node = rclpy.create_node("bench")
        self.executor = SingleThreadedExecutor()
        self.executor.add_node(self.node)
        self.keep: list[Any] = []
        self.calls: dict[str, Callable[[int], None]] = {}
        for name, message in self._messages():
            self.calls[name] = self._topic(name, message)
        self.calls["service round trip"] = self._service()
        self.calls["action goal to result"] = self._action()
        self.calls["alone"] = self.calls["String, one thread"]

    def measure(self, name: str, count: int) -> float:
        """CPU time [us] of one call."""
        call = self.calls.get(name) or self.calls.setdefault(name, self._prepare(name))
        call(min(count, 20))  # warm up
        start = time.process_time_ns()
        call(count)
        return (time.process_time_ns() - start) / count / 1e3

    def resident(self) -> float:
        """Memory of this process that is in RAM [MB]."""
        pages = int(Path("/proc/self/statm").read_text().split()[1])
        return pages * os.sysconf("SC_PAGE_SIZE") / 1e6

    def _messages(self) -> Iterator[tuple[str, Any]]:
        from geometry_msgs.msg import Twist, Vector3
        from sensor_msgs.msg import Image, JointState
        from std_msgs.msg import String

        yield "String, one thread", String(data="hello world")
        yield "Twist, one thread", Twist(linear=Vector3(x=1.0, y=2.0, z=3.0), angular=Vector3(z=0.5))
        numbers = [index * 0.1 for index in range(30)]
        names = [f"left_arm_joint_{index}" for index in range(30)]
        joints = JointState(name=names, position=numbers, velocity=numbers, effort=numbers)
        yield "JointState(30), one thread", joints
        pixels = bytes(range(256)) * 3600
        yield (
            "Image 0.9 MB, one thread",
            Image(height=480, width=640, encoding="rgb8", step=1920, data=pixels),
        )

    def _topic(self, name: str, message: Any) -> Callable[[int], None]:
        """Publish, and spin until the callback has the message, the given number of times."""
        topic = "topic_" + "".join(filter(str.isalnum, name))
        heard = 0

        def on_message(_: Any) -> None:
            nonlocal heard
            heard += 1

        self.keep.append(self.node.create_subscription(type(message), topic, on_message, 10))
        publisher = self.node.create_publisher(type(message), topic, 10)
        self._until(lambda: publisher.get_subscription_count() > 0)
        spin, publish = self.executor.spin_once, publisher.publish

        def call(count: int) -> None:
            until = heard + count
            while heard < until:
                before = heard
                publish(message)
                while heard == before:
                    spin()

        return call

    def _service(self) -> Callable[[int], None]:
        from std_srvs.srv import SetBool

        def answer(request: Any, response: Any) -> Any:
            response.success = request.data
            return response

        self.keep.append(self.node.create_service(SetBool, "set", answer))
        client = self.node.create_client(SetBool, "set")
        assert client.wait_for_service(LIMIT)

        def call(count: int) -> None:
            for _ in range(count):
                future = client.call_async(SetBool.Request(data=True))
                self._spin_until_done(future)
                assert future.result().success

        return call

    def _action(self) -> Callable[[int], None]:
        from rclpy.action import ActionClient, ActionServer
        from test_msgs.action import Fibonacci

        def execute(goal_handle: Any) -> Any:
            goal_handle.publish_feedback(Fibonacci.Feedback(sequence=[0, 1]))
            goal_handle.succeed()
            return Fibonacci.Result(sequence=[0, 1, 1])

        # On both, the cost of a goal grows with the kept results: benchmarks/actions.py measures that.
        server = ActionServer(self.node, Fibonacci, "count", execute)
        client = ActionClient(self.node, Fibonacci, "count")
        self.keep += [server, client]
        assert client.wait_for_server(LIMIT)

        def call(count: int) -> None:
            for _ in range(count):
                sent = client.send_goal_async(Fibonacci.Goal(order=2), lambda _: None)
                self._spin_until_done(sent)
                ended = sent.result().get_result_async()
                self._spin_until_done(ended)
                assert list(ended.result().result.sequence) == [0, 1, 1]

        return call

    def _prepare(self, name: str) -> Callable[[int], None]:
        """Prepare what stays, so it comes last: a thread, or a crowd of entities next to the active ones."""
        from std_msgs.msg import String

        if name == "String, across threads":
            return self._across_threads(String)
        if name == "1,000 timers":
            self.keep += [self.node.create_timer(3600.0, lambda: None) for _ in range(1000)]
        elif name == "1,000 topics":
            for index in range(1000):
                self.keep.append(self.node.create_publisher(String, f"crowd_{index}", 10))
                self.keep.append(self.node.create_subscription(String, f"crowd_{index}", lambda _: None, 10))
        elif name == "100 nodes":
            import rclpy

            nodes = [rclpy.create_node(f"crowd_{index}") for index in range(100)]
            self.keep += nodes
            for node in nodes:
                self.executor.add_node(node)
        return self.calls["alone"]

    def _across_threads(self, message_type: type[Any]) -> Callable[[int], None]:
        """A thread spins a node of its own; this one publishes and waits until the callback has run."""
        import rclpy
        from rclpy.executors import SingleThreadedExecutor

        node = rclpy.create_node("listener")
        heard = (
            threading.Lock()
        )  # locked until the callback has run; a Semaphore would cost more than everything else
        heard.acquire()
        self.keep.append(node.create_subscription(message_type, "across", lambda _: heard.release(), 10))
        publisher = self.node.create_publisher(message_type, "across", 10)
        executor = SingleThreadedExecutor()
        executor.add_node(node)
        threading.Thread(target=executor.spin, daemon=True).start()
        message = message_type(data="hello world")
        while publisher.get_subscription_count() == 0:
            time.sleep(0.01)

        def call(count: int) -> None:
            for _ in range(count):
                publisher.publish(message)
                assert heard.acquire(timeout=LIMIT)

        return call

    def _spin_until_done(self, future: Any) -> None:
        # spin_until_future_complete of real rclpy makes one task per round, and each task causes a new round:
        # called again and again, it is ten times slower than this.
        while not future.done():
            self.executor.spin_once()

    def _until(self, condition: Callable[[], bool]) -> None:
        until = time.monotonic() + LIMIT
        while not condition():
            assert time.monotonic() < until, "they did not meet"
            time.sleep(0.01)


def serve() -> None:
    """Measure what each line of the input requests, and print the figure."""
    work = Work()
    gc.collect()
    gc.disable()
    for line in sys.stdin:
        name, count = json.loads(line)
        print(json.dumps(work.resident() if name == "memory" else work.measure(name, count)), flush=True)
    os._exit(0)  # an orderly end is not worth the time


# ---- in the process that asks


class Measured:
    """A process with one of the two implementations. It is stopped while it has no request.

    Otherwise real rclpy's threads would continue (a thousand topics keep them busy for seconds) and slow the
    other.
    """

    def __init__(self, *, ours: bool) -> None:
        self.environment = environment(ours=ours)
        self.process = subprocess.Popen(
            [sys.executable, __file__, "--serve"],
            env=self.environment,
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
        )
        self.ask("memory")  # it is ready when it answers

    def ask(self, name: str, count: int = 0) -> float:
        """Request one figure; raises RuntimeError if the process has died."""
        assert self.process.stdin is not None and self.process.stdout is not None
        self.process.send_signal(signal.SIGCONT)
        self.process.stdin.write(json.dumps([name, count]) + "\n")
        self.process.stdin.flush()
        line = self.process.stdout.readline()
        if not line:
            raise RuntimeError(f"the measured process ended while it was asked for {name!r}")
        self.process.send_signal(signal.SIGSTOP)
        return float(json.loads(line))

    def start_up(self) -> float:
        """CPU time [ms] of a new process from its beginning to its first message."""
        done = subprocess.run(
            [sys.executable, "-c", _START],
            env=self.environment | {"ROS_DOMAIN_ID": "101"},  # where it is alone
            stdout=subprocess.PIPE,
            text=True,
            check=True,
            timeout=LIMIT,
        )
        return float(done.stdout)


def environment(*, ours: bool) -> dict[str, str]:
    """The environment of a measured process."""
    found = {name: value for name, value in os.environ.items() if not name.startswith("PYTHON")}
    found |= {"ROS_DOMAIN_ID": str(1 + os.getpid() % 100), "ROS_AUTOMATIC_DISCOVERY_RANGE": "LOCALHOST"}
    # Otherwise numpy's threads, which wait busily for work when it is imported, would be counted too.
    found["OPENBLAS_NUM_THREADS"] = "1"
    if ours:
        found["PYTHONPATH"] = os.pathsep.join(map(str, UNDERLAY))
    return found


def in_turns(peers: list[Measured], rounds: int, ask: Callable[[Measured], float]) -> list[float]:
    """Ask each peer in each round; returns the median of each."""
    figures: list[list[float]] = [[] for _ in peers]
    for _ in range(rounds):
        for peer, values in zip(peers, figures, strict=True):
            values.append(ask(peer))
    return [statistics.median(values) for values in figures]


def row(name: str, figures: list[float], target: str, unit: str = "us") -> str:
    """A line of the table: rclpy, ours, their ratio, the target."""
    ours, theirs = figures[0], figures[1] if len(figures) > 1 else None
    peer = ("-", "-") if theirs is None else (f"{theirs:.1f}", f"{theirs / ours:.1f}")
    return f"| {name} [{unit}] | {peer[0]} | {ours:.1f} | {peer[1]} | {target} |"


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--rounds", type=int, default=7)
    parser.add_argument("--messages", type=int, default=1_000_000, help="so many show whether memory is flat")
    parser.add_argument("--serve", action="store_true", help=argparse.SUPPRESS)
    arguments = parser.parse_args()
    if arguments.serve:
        serve()
    peers = [Measured(ours=True)]
    if importlib.util.find_spec("rclpy") is not None:
        peers.append(Measured(ours=False))
    print("| | rclpy | ours | rclpy / ours | target |\n|---|---:|---:|---:|---:|")
    for name, count, target in MEASURED:
        figures = in_turns(peers, arguments.rounds, lambda peer, n=name, c=count: peer.ask(n, c))  # type: ignore[misc]
        print(row(name, figures, f">= {target}"), flush=True)
    starts = in_turns(peers, STARTS, Measured.start_up)
    print(row("import and init to first message", starts, "ours <= 100", "ms"), flush=True)
    ours = peers[0]
    ours.ask("alone", 10_000)  # objects kept for reuse exist by now
    before = ours.ask("memory")
    ours.ask("alone", arguments.messages)
    grown = ours.ask("memory") - before
    print(f"| memory over {arguments.messages:,} messages [MB] | - | {grown:+.1f} | - | flat |", flush=True)
    print("\nA String, one thread, beside others; each crowd comes on top of the ones before.\n")
    print("| beside | rclpy [us] | ours [us] | ours / alone | target |\n|---|---:|---:|---:|---:|")
    alone = None
    for crowd in CROWDS:
        # Real rclpy builds a wait set of everything for each message: a few calls are enough.
        figures = in_turns(
            peers,
            3,
            lambda peer, c=crowd: peer.ask(c, CROWD_CALLS if peer is ours else 20),  # type: ignore[misc]
        )
        alone = alone or figures[0]
        theirs = f"{figures[1]:.0f}" if len(figures) > 1 else "-"
        print(f"| {crowd} | {theirs} | {figures[0]:.1f} | {figures[0] / alone:.2f} | flat |", flush=True)
    for peer in peers:
        peer.process.kill()


if __name__ == "__main__":
    main()
