"""Actions: from sending a goal to having its result, on one thread.

python benchmarks/actions.py [--rounds N]

Server, client and executor share a thread; each goal sends one feedback message. Servers keep the results of
goals that have ended (900 s by default) and publish the states of all of them at each change. So the cost of
a goal grows with the number of kept goals. The implementations take turns, each time in a new process;
process CPU time in microseconds per goal, medians over the rounds, garbage collection off. Without the ROS
wheels only ours is measured.
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
KEPT = (10, 50, 200)  # goals that have ended and are kept
COUNTED = 20  # goals measured at each of these points

_WORK = f"""
import gc, json, time
import rclpy
from rclpy.action import ActionClient, ActionServer
from rclpy.executors import SingleThreadedExecutor
from test_msgs.action import Fibonacci

def execute(handle):
    handle.publish_feedback(Fibonacci.Feedback(sequence=[0, 1]))
    handle.succeed()
    return Fibonacci.Result(sequence=[0, 1, 1, 2])

rclpy.init()
node = rclpy.create_node("bench")
executor = SingleThreadedExecutor()
executor.add_node(node)
server = ActionServer(node, Fibonacci, "fibonacci", execute)
client = ActionClient(node, Fibonacci, "fibonacci")
assert client.wait_for_server(20.0)

def goal():
    sent = client.send_goal_async(Fibonacci.Goal(order=3), lambda message: None)
    executor.spin_until_future_complete(sent, 20.0)
    ended = sent.result().get_result_async()
    executor.spin_until_future_complete(ended, 20.0)
    assert list(ended.result().result.sequence) == [0, 1, 1, 2]

gc.disable()
figures, sent = [], 0
for kept in {KEPT!r}:
    while sent < kept:
        goal()
        sent += 1
    start = time.process_time()
    for _ in range({COUNTED}):
        goal()
    figures.append((time.process_time() - start) / {COUNTED} * 1e6)
    sent += {COUNTED}
print(json.dumps(figures))
"""


def measure(*, ours: bool) -> list[float]:
    """Run once in a new process; returns the CPU time [us] per goal at each number of kept goals."""
    environment = {name: value for name, value in os.environ.items() if not name.startswith("PYTHON")}
    environment |= {"ROS_DOMAIN_ID": str(20 + os.getpid() % 80), "ROS_AUTOMATIC_DISCOVERY_RANGE": "LOCALHOST"}
    # Otherwise numpy's threads, which wait busily for work when it is imported, would be counted too.
    environment["OPENBLAS_NUM_THREADS"] = "1"
    if ours:
        environment["PYTHONPATH"] = os.pathsep.join(map(str, UNDERLAY))
    command = [sys.executable, "-c", _WORK]
    done = subprocess.run(
        command, env=environment, stdout=subprocess.PIPE, text=True, check=True, timeout=300
    )
    figures: list[float] = json.loads(done.stdout)
    return figures


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--rounds", type=int, default=3)
    rounds = parser.parse_args().rounds
    compare = importlib.util.find_spec("rclpy") is not None
    ours, real = [], []
    for _ in range(rounds):
        ours.append(measure(ours=True))
        if compare:
            real.append(measure(ours=False))
    print("| goals kept | rclpy [us] | ours [us] | rclpy / ours |")
    print("|---:|---:|---:|---:|")
    for index, kept in enumerate(KEPT):
        mine = statistics.median(figures[index] for figures in ours)
        theirs = statistics.median(figures[index] for figures in real) if real else None
        peer = (f"{theirs:.0f}", f"{theirs / mine:.1f}") if theirs is not None else ("-", "-")
        print(f"| {kept} | {peer[0]} | {mine:.0f} | {peer[1]} |")


if __name__ == "__main__":
    main()
