"""Nodes on asyncio beside nodes on an executor, both of ours.

python benchmarks/asyncio_nodes.py [--rounds N]

* message: from publishing to the next step of a coroutine, which publishes the next message; on one thread.
* across threads: the same, published by another thread, that waits until the coroutine has had it.
* call: a coroutine awaits a service of the same node.
* goal: a coroutine awaits an action of the same node, from the goal to the result, with one feedback message.

The two take turns, each time in a new process; process CPU time in microseconds, medians over the rounds,
garbage collection off.
"""

from __future__ import annotations

import argparse
import json
import os
import statistics
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
FOLDERS = ("codegen/underlay", "codegen/libraries", "generated", "codegen")
ASKED = 1.3
WORK = ("message", "across threads", "call", "goal")

_COMMON = """
import asyncio, gc, json, threading, time
import rclpy
from example_interfaces.action import Fibonacci
from example_interfaces.srv import AddTwoInts
from std_msgs.msg import Int32

figures = {}
gc.disable()

def measured(name, count, begin):
    figures[name] = (time.process_time() - begin) / count * 1e6

def add(request, response):
    response.sum = request.a + request.b
    return response

async def execute(goal):
    goal.publish_feedback(Fibonacci.Feedback(sequence=[0, 1]))
    goal.succeed()
    return Fibonacci.Result(sequence=[0, 1, 1])
"""

_EXECUTOR = """
from rclpy.action import ActionClient, ActionServer
from rclpy.executors import SingleThreadedExecutor

rclpy.init()
node = rclpy.create_node("bench")
executor = SingleThreadedExecutor()
executor.add_node(node)
publisher = node.create_publisher(Int32, "chain", 10)
left, done, taken = 0, None, threading.Semaphore(0)

async def chain(message):
    global left
    left -= 1
    if left:
        publisher.publish(message)
    else:
        done.set_result(None)

async def take(message):
    taken.release()

node.create_subscription(Int32, "chain", chain, 10)
node.create_subscription(Int32, "far", take, 10)
node.create_service(AddTwoInts, "add", add)
client = node.create_client(AddTwoInts, "add")
server = ActionServer(node, Fibonacci, "fib", execute, result_timeout=0)
actions = ActionClient(node, Fibonacci, "fib")

def messages(count):
    global left, done
    left, done = count, executor.create_future()
    publisher.publish(Int32(data=1))
    executor.spin_until_future_complete(done)

async def calls(count):
    for _ in range(count):
        await client.call_async(AddTwoInts.Request(a=1, b=2))

async def goals(count):
    for _ in range(count):
        handle = await actions.send_goal_async(Fibonacci.Goal(order=3), lambda message: None)
        await handle.get_result_async()

def far(count):
    publisher = node.create_publisher(Int32, "far", 10)
    ended = executor.create_future()
    def publish():
        for _ in range(count):
            publisher.publish(Int32(data=1))
            taken.acquire()
        ended.set_result(None)
    thread = threading.Thread(target=publish)
    thread.start()
    executor.spin_until_future_complete(ended)
    thread.join()

def run(function):
    def work(count):
        executor.spin_until_future_complete(executor.create_task(function, count))
    return work

WORK = (
    ("message", messages, 20000),
    ("across threads", far, 3000),
    ("call", run(calls), 3000),
    ("goal", run(goals), 400),
)
for name, work, count in WORK:
    work(count // 10)
    begin = time.process_time()
    work(count)
    measured(name, count, begin)
print(json.dumps(figures))
"""

_ASYNCIO = """
from rclpy_asyncio import AsyncNode

rclpy.init()
left, done, taken = 0, None, threading.Semaphore(0)

async def main():
    global left, done
    async with AsyncNode("bench") as node:
        publisher = node.create_publisher(Int32, "chain", 10)

        async def chain(message):
            global left
            left -= 1
            if left:
                publisher.publish(message)
            else:
                done.set()

        async def take(message):
            taken.release()

        node.create_subscription(Int32, "chain", chain, 10)
        node.create_subscription(Int32, "far", take, 10)
        node.create_service(AddTwoInts, "add", add)
        client = node.create_client(AddTwoInts, "add")
        node.create_action_server(Fibonacci, "fib", execute, result_timeout=0)
        actions = node.create_action_client(Fibonacci, "fib")
        await actions.wait_for_server()

        async def messages(count):
            global left, done
            left, done = count, asyncio.Event()
            publisher.publish(Int32(data=1))
            await done.wait()

        async def calls(count):
            for _ in range(count):
                await client.call(AddTwoInts.Request(a=1, b=2))

        async def goals(count):
            for _ in range(count):
                await actions.send_goal(Fibonacci.Goal(order=3), feedback_callback=lambda message: None)

        async def far(count):
            publisher = node.create_publisher(Int32, "far", 10)
            def publish():
                for _ in range(count):
                    publisher.publish(Int32(data=1))
                    taken.acquire()
            await asyncio.to_thread(publish)

        all_work = (
            ("message", messages, 20000),
            ("across threads", far, 3000),
            ("call", calls, 3000),
            ("goal", goals, 400),
        )
        for name, work, count in all_work:
            await work(count // 10)
            begin = time.process_time()
            await work(count)
            measured(name, count, begin)

asyncio.run(main())
print(json.dumps(figures))
"""


def measure(work: str) -> dict[str, float]:
    """Run once in a new process; returns the CPU time [us] of each kind of work."""
    environment = {name: value for name, value in os.environ.items() if not name.startswith("PYTHON")}
    environment |= {"ROS_DOMAIN_ID": str(20 + os.getpid() % 80), "ROS_AUTOMATIC_DISCOVERY_RANGE": "LOCALHOST"}
    environment["PYTHONPATH"] = os.pathsep.join(str(ROOT / each) for each in FOLDERS)
    command = [sys.executable, "-c", _COMMON + work]
    done = subprocess.run(
        command, env=environment, stdout=subprocess.PIPE, text=True, check=True, timeout=300
    )
    figures: dict[str, float] = json.loads(done.stdout)
    return figures


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--rounds", type=int, default=5)
    rounds = [(measure(_EXECUTOR), measure(_ASYNCIO)) for _ in range(parser.parse_args().rounds)]
    print("| what | executor [us] | asyncio [us] | asyncio / executor | asked |")
    print("|---|---:|---:|---:|---:|")
    for name in WORK:
        executor = statistics.median(each[name] for each, _ in rounds)
        asyncio = statistics.median(each[name] for _, each in rounds)
        print(f"| {name} | {executor:.1f} | {asyncio:.1f} | {asyncio / executor:.2f} | {ASKED} |")


if __name__ == "__main__":
    main()
