"""What it costs a process to be looked at: callbacks while nobody asks, and while somebody does.

python benchmarks/observing.py [--rounds N]

One process publishes to itself and runs the callbacks, on the local transport. Both states take turns in it;
process CPU time in microseconds per message, medians over the rounds, garbage collection off. Besides, the
time and the size of one answer, of a process with this many topics.
"""

from __future__ import annotations

import argparse
import json
import os
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
UNDERLAY = (ROOT / "codegen" / "underlay", ROOT / "generated", ROOT / "codegen")
MESSAGES = 20_000
TOPICS = 100

_WORK = f"""
import gc, json, statistics, sys, time
import rclpy
from rclpy.executors import SingleThreadedExecutor
from rmw_local import statistics as measured
from std_msgs.msg import String

rclpy.init()
node = rclpy.create_node("bench")
node.create_subscription(String, "word", lambda message: None, 10)
publisher, message = node.create_publisher(String, "word", 10), String(data="x" * 50)
executor = SingleThreadedExecutor()
executor.add_node(node)
measured._FRESH = 0.0
process = measured.of(node.handle.graph_node.participant.domain)

def cost():
    start = time.process_time()
    for _ in range({MESSAGES}):
        publisher.publish(message)
        executor.spin_once(0)
    return (time.process_time() - start) / {MESSAGES} * 1e6

gc.disable()
cost()
quiet, asked = [], []
for _ in range(int(sys.argv[1])):
    process._measure(is_wanted=False)
    quiet.append(cost())
    process.answer()
    asked.append(cost())
for number in range({TOPICS}):
    node.create_subscription(String, f"topic_{{number}}", lambda message: None, 10)
    node.create_publisher(String, f"topic_{{number}}", 10)
start = time.process_time()
size = len([process.answer() for _ in range(20)][-1])
took = (time.process_time() - start) / 20 * 1e3
print(json.dumps([statistics.median(quiet), statistics.median(asked), took, size]))
"""


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--rounds", type=int, default=7)
    rounds = parser.parse_args().rounds
    environment = {name: value for name, value in os.environ.items() if not name.startswith("PYTHON")}
    environment |= {
        "ROS_AUTOMATIC_DISCOVERY_RANGE": "OFF",
        "PYTHONPATH": os.pathsep.join(map(str, UNDERLAY)),
    }
    command = [sys.executable, "-c", _WORK, str(rounds)]
    done = subprocess.run(
        command, env=environment, stdout=subprocess.PIPE, text=True, check=True, timeout=300
    )
    quiet, asked, took, size = json.loads(done.stdout)
    print("| what | measured | ratio |\n|---|---:|---:|")
    print(f"| a message and its callback, nobody asks | {quiet:.2f} us | 1 |")
    print(f"| the same while somebody asks | {asked:.2f} us | {asked / quiet:.2f} |")
    print(f"| an answer, {TOPICS + 1} topics | {took:.1f} ms, {size / 1000:.0f} kB | |")


if __name__ == "__main__":
    main()
