"""A process that has children while it publishes: `forking.py HOW`.

HOW is `os`, `fork`, `forkserver` or `spawn`; `early`: `os.fork` before it has met anybody; or `volley`: forks while
the first child rings, and the parent opens its session. Each child makes a context of its own, and prints whom it meets
there.
"""

import multiprocessing
import os
import sys
import threading
import time
import warnings
from contextlib import suppress

import rclpy
from rclpy.context import Context
from rclpy.executors import ExternalShutdownException, SingleThreadedExecutor
from std_msgs.msg import Int64

CHILDREN = 3


def be_a_child(number: int, company: int) -> None:
    """Meet so many others, in a context of one's own."""
    context = Context()
    context.init()
    node = rclpy.create_node(f"child{number}", context=context)
    executor = SingleThreadedExecutor(context=context)
    executor.add_node(node)
    heard: list[int] = []
    node.create_subscription(Int64, "count", lambda message: heard.append(message.data), 10)
    publisher = node.create_publisher(Int64, "count", 10)
    end = time.monotonic() + 30.0
    while company and not (heard and publisher.get_subscription_count() >= company):
        executor.spin_once(timeout_sec=0.01)
        assert time.monotonic() < end
    for _ in range(20):  # somebody's queue may be full of what the parent publishes
        publisher.publish(Int64(data=1000 * number))
        time.sleep(0.01)
    print("child", number, "sees", *sorted(node.get_node_names()), flush=True)
    executor.shutdown()
    node.destroy_node()
    context.shutdown()


def publish() -> None:
    """Be in the middle of something whenever there is a fork."""
    number = 1
    while rclpy.ok():
        publisher.publish(Int64(data=number))
        number += 10
        time.sleep(0.0005)


def spin() -> None:
    with suppress(ExternalShutdownException):
        rclpy.spin(node)


if __name__ == "__main__":
    # From Python 3.12 on, it warns of forks where there are threads: that is what this is for.
    warnings.simplefilter("ignore", DeprecationWarning)
    how = sys.argv[1]
    rclpy.init()
    node = rclpy.create_node("parent")
    publisher = node.create_publisher(Int64, "count", 10)
    threading.Thread(target=publish, daemon=True).start()
    threading.Thread(target=spin, daemon=True).start()
    if how == "volley":
        fork = multiprocessing.get_context("fork")
        children = [fork.Process(target=be_a_child, args=(number, 0)) for number in range(6)]
        for child in children:
            child.start()
            time.sleep(0.02)
        for child in children:
            child.join(20.0)
            if child.is_alive():
                child.kill()
        print("codes", *(child.exitcode for child in children), flush=True)
        sys.exit(0)
    while how != "early" and not publisher.get_subscription_count():
        time.sleep(0.01)
    for number in range(1, 2 if how == "early" else CHILDREN + 1):
        if how in {"os", "early"}:
            child = os.fork()
            if not child:
                be_a_child(number, 1 if how == "early" else 0)
                os._exit(0)
            code = os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])
        else:
            process = multiprocessing.get_context(how).Process(
                target=be_a_child, args=(number, 0 if how == "fork" else 2)
            )
            process.start()
            process.join()
            code = process.exitcode
        print("code", code, flush=True)
    end = time.monotonic() + 5.0  # the word that a child has left may come after its end
    while any(name.startswith("child") for name in node.get_node_names()) and time.monotonic() < end:
        time.sleep(0.01)
    print("nodes", *sorted(node.get_node_names()), flush=True)
    rclpy.shutdown()
