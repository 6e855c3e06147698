"""The price of comparing definitions where endpoints meet on the local transport: none is wanted.

python benchmarks/discovery.py [--against CHECKOUT] [--rounds N] [--topics N ...]

Each round is a process of its own; checkouts take turns. CPU time in microseconds of one endpoint (1,000, in
pairs on 500 topics), of one message and of one request with its response, medians over the rounds. Pairs with
other definitions are measured here only: `warn` looks for bytes that are left over, `adapt` converts.

Before that, one process has publishers on many topics and another one subscriptions: the CPU time of each,
and the wall time until all have met. Without rounds, that is all.
"""

from __future__ import annotations

import argparse
import json
import os
import statistics
import subprocess
import sys
from pathlib import Path

HERE = Path(__file__).resolve().parent.parent

EQUAL = """
import gc, json, rclpy, time
from std_msgs.msg import String
from std_srvs.srv import SetBool

gc.disable()
rclpy.init()
node = rclpy.create_node("node")
executor = rclpy.executors.SingleThreadedExecutor()
executor.add_node(node)

def cpu(count, work):
    begin = time.process_time()
    for index in range(count):
        work(index)
    return (time.process_time() - begin) / count * 1e6

def pair(index):
    publisher = node.create_publisher(String, f"topic{index}", 10)
    kept.append((publisher, node.create_subscription(String, f"topic{index}", lambda _: None, 10)))

def message(_):
    publisher.publish(text)
    executor.spin_once(timeout_sec=0)

def call(_):
    future = client.call_async(request)
    while not future.done():
        executor.spin_once(timeout_sec=0)

kept = []
found = {"endpoint": cpu(500, pair) / 2}
for publisher, subscription in kept:
    node.destroy_publisher(publisher)
    node.destroy_subscription(subscription)
publisher, text = node.create_publisher(String, "words", 10), String(data="words")
node.create_subscription(String, "words", lambda _: None, 10)
service = node.create_service(SetBool, "set", lambda request, response: response)
client, request = node.create_client(SetBool, "set"), SetBool.Request()
message(0), call(0)
found["message"] = cpu(5000, message)
found["request"] = cpu(1000, call)
print(json.dumps(found))
"""

DIFFERENT = """
import gc, json, rclpy, sys, time
from ifgen.dynamic import class_from_text
from ifgen_runtime.adapters import Adapter, register
from rclpy.parameter import Parameter

gc.disable()
rclpy.init(args=["--ros-args", "--log-level", "fatal"])
Old, New = (class_from_text("demo_msgs/msg/Speed", text) for text in ("float32 v", "float64 v\\nstring s"))
Same = class_from_text("demo_msgs/msg/Speed", "float32 v\\nuint8[] s")
register(Adapter(Old, New, lambda old: New(v=old.v)))
found = {}
for name, sent, policy in (("equal", New, "warn"), ("warn", Same, "warn"), ("adapt", Old, "adapt")):
    node = rclpy.create_node(name, parameter_overrides=[Parameter("on_type_mismatch", value=policy)])
    executor = rclpy.executors.SingleThreadedExecutor()
    executor.add_node(node)
    publisher = node.create_publisher(sent, name, 10)
    heard = []
    node.create_subscription(Old if name == "warn" else New, name, heard.append, 10)
    begin = time.process_time()
    for number in range(5000):
        publisher.publish(sent())
        while len(heard) <= number:
            executor.spin_once(timeout_sec=0)
    found[name] = (time.process_time() - begin) / 5000 * 1e6
print(json.dumps(found))
"""


MANY = """
import json, rclpy, sys, time
from std_msgs.msg import String

role, count = sys.argv[1], int(sys.argv[2])
rclpy.init()
node = rclpy.create_node(role)
begin, cpu = time.monotonic(), time.process_time()
for number in range(count):
    if role == "publishers":
        node.create_publisher(String, f"topic_{number}", 10)
    else:
        node.create_subscription(String, f"topic_{number}", lambda _: None, 10)
while True:
    if role == "publishers":
        met = all(each.get_subscription_count() for each in node.publishers if "/topic_" in each.topic_name)
    else:
        met = all(each.get_publisher_count() for each in node.subscriptions)
    if met or time.monotonic() - begin > 150:
        break
    time.sleep(0.1)
wall = time.monotonic() - begin if met else float("inf")
print(json.dumps({"cpu": time.process_time() - cpu, "wall": wall}), flush=True)
sys.stdin.read()
"""


def environment_of(checkout: Path) -> dict[str, str]:
    """The variables of a process with the transport of a checkout."""
    folders = [checkout / "codegen" / "underlay", checkout / "generated", checkout / "codegen"]
    return {**os.environ, "PYTHONPATH": os.pathsep.join(map(str, folders))}


def measure(checkout: Path, program: str) -> dict[str, float]:
    """Run a program with the transport of a checkout."""
    environment, command = environment_of(checkout), [sys.executable, "-c", program]
    run = subprocess.run(command, env=environment, capture_output=True, text=True, check=True, timeout=120)
    found: dict[str, float] = json.loads(run.stdout)
    return found


def meet(checkout: Path, topics: int) -> str:
    """Let two processes meet on many topics; returns the row of a table."""
    environment = environment_of(checkout) | {"ROS_AUTOMATIC_DISCOVERY_RANGE": "LOCALHOST"}
    sides = [
        subprocess.Popen(
            [sys.executable, "-c", MANY, role, str(topics)],
            env=environment,
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
        )
        for role in ("publishers", "subscriptions")
    ]
    found = [json.loads(each.stdout.readline()) for each in sides if each.stdout is not None]
    for each in sides:
        each.kill()
        each.wait()
    cells = [f"{each['cpu']:.2f}" for each in found]
    return f"| {topics:,} | {' | '.join(cells)} | {max(each['wall'] for each in found):.1f} |"


def medians(rounds: list[dict[str, float]]) -> dict[str, float]:
    """The median of each figure."""
    return {name: statistics.median(each[name] for each in rounds) for name in rounds[0]}


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--against", type=Path, help="another checkout, such as one from before a change")
    parser.add_argument("--rounds", type=int, default=7)
    parser.add_argument("--topics", type=int, nargs="*", default=[1000, 4000, 10_000])
    options = parser.parse_args()
    print("| topics | CPU of the publishers [s] | of the subscriptions [s] | all have met after [s] |")
    print("|---|---|---|---|")
    for topics in options.topics:
        print(meet(HERE, topics), flush=True)
    if not options.rounds:
        return
    print()
    here: list[dict[str, float]] = []
    there: list[dict[str, float]] = []
    for _ in range(options.rounds):
        here.append(measure(HERE, EQUAL))
        if options.against:
            there.append(measure(options.against, EQUAL))
    print("| [us] | here | other checkout | ratio |\n|---|---|---|---|")
    before = medians(there) if there else {}
    for name, figure in medians(here).items():
        other = before.get(name)
        print(f"| {name} | {figure:.2f} |" + (f" {other:.2f} | {figure / other:.3f} |" if other else " | |"))
    print("\n| definitions [us a message] | |\n|---|---|")
    for name, figure in medians([measure(HERE, DIFFERENT) for _ in range(options.rounds)]).items():
        print(f"| {name} | {figure:.2f} |")


if __name__ == "__main__":
    main()
