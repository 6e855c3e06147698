"""Virtual time: hours pass at once, one thread runs at a time, the same seed repeats the same order."""

from __future__ import annotations

import _thread
import asyncio
import os
import queue
import subprocess
import sys
import threading
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

import pytest
import rclpy
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.duration import Duration
from rclpy.executors import MultiThreadedExecutor, SingleThreadedExecutor
from rclpy.impl.rcl.log_outputs import LogFile
from rmw_local.virtual_time import START, DeadlockError, virtual_time
from std_msgs.msg import String
from std_srvs.srv import Empty


def test_an_hour_of_a_timer_takes_no_time() -> None:
    began = time.process_time()
    with virtual_time():
        rclpy.init()
        node = rclpy.create_node("n")
        calls: list[float] = []
        node.create_timer(1.0, lambda: calls.append(time.monotonic()))
        executor = SingleThreadedExecutor()
        executor.add_node(node)
        while time.monotonic() < 3600:
            executor.spin_once(timeout_sec=3600 - time.monotonic())
        rclpy.shutdown()
    assert calls == [float(second) for second in range(1, 3601)]
    assert time.process_time() - began < 5


def test_every_clock_moves_together() -> None:
    with virtual_time():
        rclpy.init()
        node = rclpy.create_node("n")
        assert time.time_ns() == START
        assert node.get_clock().now().nanoseconds == START
        assert node.get_clock().sleep_for(Duration(seconds=86400))
        time.sleep(0.5)
        assert node.get_clock().now().nanoseconds == time.time_ns() == START + 86_400_500_000_000
        rclpy.shutdown()


def order_of_events(seed: int) -> list[Any]:
    """The order of events in a process with a pool of callbacks, three publishing threads, a service and a rate."""
    events: list[Any] = []
    with virtual_time(seed):
        rclpy.init()
        node = rclpy.create_node("n")
        group = ReentrantCallbackGroup()
        executor = MultiThreadedExecutor(num_threads=3)
        executor.add_node(node)

        def work(name: str) -> None:
            events.append((name, "begins", time.monotonic()))
            time.sleep(0.3)
            events.append((name, "ends", time.monotonic()))

        for number in range(4):
            node.create_timer(0.5, lambda number=number: work(f"timer {number}"), callback_group=group)
        node.create_subscription(String, "t", lambda m: events.append((m.data, time.monotonic())), 10)
        node.create_service(Empty, "e", lambda _, response: response, callback_group=group)
        client = node.create_client(Empty, "e", callback_group=group)
        spinner = threading.Thread(target=executor.spin)
        spinner.start()
        publisher = node.create_publisher(String, "t", 10)

        def publish(name: str) -> None:
            for number in range(3):
                time.sleep(0.25)
                publisher.publish(String(data=f"{name}.{number}"))

        threads = [threading.Thread(target=publish, args=(name,)) for name in "abc"]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        events.append(("answer", client.call(Empty.Request()), time.monotonic()))
        rate = node.create_rate(10)
        for _ in range(3):
            rate.sleep()
            events.append(("rate", time.monotonic()))
        rclpy.shutdown()
        spinner.join()
        # Later is no part of it: a callback that still sleeps ends after virtual time.
        return list(events)


def test_the_same_seed_gives_the_same_order() -> None:
    orders = [order_of_events(seed) for seed in (1, 1, 2, 3)]
    assert orders[0] == orders[1]
    assert len({str(order) for order in orders}) > 1, "no seed makes a difference"
    assert len(orders[0]) > 20


def test_the_standard_library_waits_in_virtual_time() -> None:
    with virtual_time():
        box: queue.Queue[int] = queue.Queue()
        event = threading.Event()
        threading.Timer(100, event.set).start()
        threading.Thread(target=lambda: (time.sleep(50), box.put(1))).start()
        assert (box.get(), time.monotonic()) == (1, 50)
        with pytest.raises(queue.Empty):
            box.get(timeout=25)
        assert event.wait(1000)
        assert time.monotonic() == 100
        with ThreadPoolExecutor(2) as pool:
            assert list(pool.map(lambda seconds: time.sleep(seconds) or time.monotonic(), [3, 2, 2])) == [
                103,
                102,
                104,
            ]
        condition = threading.Condition()
        with condition:
            assert not condition.wait_for(lambda: False, timeout=6)
        assert time.monotonic() == 110


def test_a_loop_that_polls_the_clock_ends() -> None:
    with virtual_time():
        end = time.monotonic() + 1
        while time.monotonic() < end:
            pass


def test_a_deadlock_is_explained() -> None:
    with virtual_time():
        first, second = threading.Lock(), threading.Lock()

        def cross() -> None:
            with second:
                time.sleep(1)
                first.acquire()

        with first:
            threading.Thread(target=cross, name="crosser", daemon=True).start()
            time.sleep(0.5)
            with pytest.raises(DeadlockError, match=r"Nothing will ever happen again: .* main, crosser"):
                second.acquire()


def test_whoever_logs_outside_stops_nobody(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The log file belongs to the process: a thread left over from an earlier virtual time may be writing to it."""
    writing, real_write, real_sleep = _thread.allocate_lock(), os.write, time.sleep

    def slow_write(descriptor: int, data: bytes) -> int:
        writing.release()
        real_sleep(0.1)
        return real_write(descriptor, data)

    writing.acquire()
    with virtual_time():
        file = LogFile(str(tmp_path), "program")
        with monkeypatch.context() as patch:
            patch.setattr(os, "write", slow_write)
            _thread.start_new_thread(file.write_line, ("left over",))
            writing.acquire()
            file.close()
    [path] = tmp_path.iterdir()
    assert path.read_text() == "left over\n"


def test_what_was_made_before_is_refused() -> None:
    rclpy.init()
    executor = SingleThreadedExecutor()
    with virtual_time(), pytest.raises(RuntimeError, match="made before the virtual clock"):
        executor.spin_once(timeout_sec=1)
    rclpy.shutdown()


def test_real_time_is_back_afterwards() -> None:
    with virtual_time():
        lock = threading.Lock()
        thread = threading.Thread(target=lambda: time.sleep(10**6), daemon=True)
        thread.start()
    began = time.perf_counter()
    time.sleep(0.01)
    assert time.perf_counter() - began >= 0.01
    assert time.time_ns() > START
    with lock:
        assert not lock.acquire(timeout=0.01)
    assert thread.is_alive()


def order_of_tasks(seed: int) -> list[Any]:
    """The order of tasks in two event loops, a pool and a node."""
    events: list[Any] = []

    async def tasks(name: str) -> None:
        loop = asyncio.get_running_loop()
        begun = asyncio.Event()
        threading.Timer(0.1, loop.call_soon_threadsafe, [begun.set]).start()
        await begun.wait()
        events.append((name, await asyncio.gather(*(asyncio.sleep(0.1 * n, n) for n in range(3)))))
        await asyncio.to_thread(time.sleep, 3600)
        try:
            await asyncio.wait_for(asyncio.Event().wait(), 50)
        except TimeoutError:
            events.append((name, round(time.monotonic(), 3)))

    with virtual_time(seed):
        rclpy.init()
        node = rclpy.create_node("n")
        node.create_timer(1000.0, lambda: events.append(("timer", time.monotonic())))
        other = threading.Thread(target=lambda: asyncio.run(tasks("other")))
        other.start()
        spinning = threading.Thread(target=rclpy.spin, args=(node,))
        spinning.start()
        asyncio.run(tasks("main"))
        other.join()
        rclpy.shutdown()
        spinning.join()
    return events


def test_event_loops_take_part() -> None:
    events = order_of_tasks(seed=1)
    assert events == order_of_tasks(seed=1)
    assert sorted(map(str, events)) == [
        "('main', 3650.3)",
        "('main', [0, 1, 2])",
        "('other', 3650.3)",
        "('other', [0, 1, 2])",
        *(f"('timer', {n}000.0)" for n in (1, 2, 3)),
    ]


def test_event_loop_that_waits_for_nobody() -> None:
    async def forever() -> None:
        await asyncio.Event().wait()

    with virtual_time(), pytest.raises(DeadlockError, match="main"):
        asyncio.run(forever())


def test_event_loop_that_waits_for_another_process() -> None:
    async def read() -> bytes:
        command = [sys.executable, "-c", "print('hello')"]
        process = await asyncio.create_subprocess_exec(*command, stdout=subprocess.PIPE)
        return (await process.communicate())[0]

    with virtual_time():
        assert asyncio.run(read()).split() == [b"hello"]


def test_a_thread_from_outside_takes_part_and_leaves_when_it_ends() -> None:
    begin = _thread.allocate_lock()
    begin.acquire()
    slept: list[float] = []

    def visit() -> None:
        with begin:
            time.sleep(1)
        slept.append(time.monotonic())

    thread = threading.Thread(target=visit)
    thread.start()
    with virtual_time():
        begin.release()
        while not slept:
            time.sleep(0.25)
        time.sleep(10)  # it has the turn when it ends, and would otherwise keep it
    thread.join()
    assert slept[0] >= 1


def test_a_thread_that_is_left_over_takes_no_part_in_the_next_virtual_time() -> None:
    turns: list[bool] = []
    enough = False

    def beat() -> None:
        while not enough:
            time.sleep(0.001)
            turns.append(enough)

    with virtual_time():
        thread = threading.Thread(target=beat, daemon=True)
        thread.start()
        time.sleep(0.01)
    with virtual_time():
        turns.clear()
        time.sleep(3600)
        assert len(turns) < 100_000  # in its own virtual time, not in this one
        enough = True
    thread.join(60)
    assert not thread.is_alive()
