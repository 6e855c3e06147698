"""Behaviour that only threads show; every test ends after a fixed number of steps."""

from __future__ import annotations

import contextlib
import errno
import gc
import os
import random
import signal
import sys
import threading
from collections.abc import Callable, Iterator

import pytest
import rclpy
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.exceptions import InvalidHandle
from rclpy.executors import ExternalShutdownException, MultiThreadedExecutor, SingleThreadedExecutor
from rclpy.node import Node
from rclpy.qos import QoSProfile
from rmw_local import timing
from std_msgs.msg import Int64, String
from std_srvs.srv import SetBool


@pytest.fixture(autouse=True)
def _often_switching() -> Iterator[None]:
    """Let threads interleave at nearly every bytecode."""
    interval = sys.getswitchinterval()
    sys.setswitchinterval(1e-6)
    rclpy.init()
    yield
    rclpy.try_shutdown()
    sys.setswitchinterval(interval)


def in_threads(*works: Callable[[], None]) -> None:
    """Run each in a thread of its own; raise what any of them raised."""
    errors: list[BaseException] = []

    def guarded(work: Callable[[], None]) -> None:
        try:
            work()
        except BaseException as error:
            errors.append(error)

    threads = [threading.Thread(target=guarded, args=(work,), daemon=True) for work in works]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join(40)
        assert not thread.is_alive(), "a thread hangs"
    if errors:
        raise errors[0]


def test_two_publishers_on_one_topic_neither_lose_nor_duplicate() -> None:
    """Each publisher's messages arrive completely and in its order, whoever else publishes."""
    count = 1500
    node = Node("stress")
    heard: list[int] = []
    node.create_subscription(Int64, "numbers", lambda m: heard.append(m.data), QoSProfile(history=2, depth=0))
    publishers = [node.create_publisher(Int64, "numbers", 10) for _ in range(2)]

    def publish(index: int) -> None:
        for number in range(count):
            publishers[index].publish(Int64(data=index * 1_000_000 + number))

    def spin() -> None:
        executor = SingleThreadedExecutor()
        executor.add_node(node)
        while len(heard) < 2 * count:
            executor.spin_once(timeout_sec=5)

    in_threads(lambda: publish(0), lambda: publish(1), spin)
    for index in range(2):
        mine = [number - index * 1_000_000 for number in heard if number // 1_000_000 == index]
        assert mine == list(range(count))


def test_one_publisher_from_many_threads() -> None:
    """One publisher is used by four threads; a transient local late joiner finds the last messages."""
    count = 500
    node = Node("stress")
    publisher = node.create_publisher(Int64, "shared", QoSProfile(depth=3, durability=1))
    numbers: list[int] = []
    node.create_subscription(
        Int64,
        "shared",
        lambda _, info: numbers.append(info["publication_sequence_number"]),
        QoSProfile(history=2, depth=0, durability=1),
    )

    def publish() -> None:
        for number in range(count):
            publisher.publish(Int64(data=number))

    in_threads(*[publish] * 4)
    late: list[int] = []
    node.create_subscription(
        Int64,
        "shared",
        lambda _, info: late.append(info["publication_sequence_number"]),
        QoSProfile(depth=10, durability=1),
    )
    executor = SingleThreadedExecutor()
    executor.add_node(node)
    while len(numbers) < 4 * count or len(late) < 3:
        executor.spin_once(timeout_sec=5)
    assert numbers == list(range(1, 4 * count + 1))
    assert late == numbers[-3:]


def test_late_joiners_during_publishing_miss_nothing() -> None:
    """Whoever joins a transient local topic in mid-stream receives history and stream without gaps or duplicates."""
    node = Node("stress")
    publisher = node.create_publisher(Int64, "stream", QoSProfile(history=2, depth=0, durability=1))
    heard: list[list[int]] = []
    profile = QoSProfile(history=2, depth=0, durability=1)
    count = 400

    def publish() -> None:
        for number in range(count):
            publisher.publish(Int64(data=number))

    def join() -> None:
        for _ in range(15):
            mine: list[int] = []
            heard.append(mine)
            node.create_subscription(Int64, "stream", lambda m, mine=mine: mine.append(m.data), profile)

    in_threads(publish, join, join)
    executor = SingleThreadedExecutor()
    executor.add_node(node)
    while any(len(mine) < count for mine in heard):
        executor.spin_once(timeout_sec=5)
    assert all(mine == list(range(count)) for mine in heard)


def test_create_and_destroy_while_spinning() -> None:
    """Entities and nodes come and go in two threads while a third spins and a fourth publishes."""
    node = Node("stress")
    executor = MultiThreadedExecutor(num_threads=2)
    executor.add_node(node)
    done = threading.Event()
    steady = node.create_publisher(String, "churn", 10)

    def churn(seed: int) -> None:
        rng = random.Random(seed)
        for step in range(60):
            kind = rng.randrange(5)
            if kind == 0:
                publisher = node.create_publisher(String, "churn", 1)
                publisher.publish(String(data=str(step)))
                node.destroy_publisher(publisher)
            elif kind == 1:
                node.destroy_subscription(node.create_subscription(String, "churn", lambda _: None, 1))
            elif kind == 2:
                service = node.create_service(SetBool, "churn_srv", lambda _, response: response)
                client = node.create_client(SetBool, "churn_srv")
                client.call_async(SetBool.Request())
                node.destroy_client(client)
                node.destroy_service(service)
            elif kind == 3:
                node.destroy_timer(node.create_timer(0.0005, lambda: None))
            else:
                short = Node(f"short_{seed}_{step}", start_parameter_services=False)
                executor.add_node(short)
                short.create_subscription(String, "churn", lambda _: None, 1)
                executor.remove_node(short)
                short.destroy_node()

    def churn_all() -> None:
        try:
            in_threads(lambda: churn(1), lambda: churn(2))
        finally:
            done.set()

    def publish() -> None:
        while not done.is_set():
            steady.publish(String(data="steady"))
            node.get_topic_names_and_types()
            done.wait(0.001)

    def spin() -> None:
        while not done.is_set():
            # As with the real one: a service destroyed between a request and its answer raises out of spin.
            with contextlib.suppress(InvalidHandle):
                executor.spin_once(timeout_sec=0.05)

    in_threads(churn_all, publish, spin)
    executor.shutdown()
    node.destroy_node()
    assert steady.handle.pointer == 0


def test_shutdown_from_a_callback() -> None:
    """A callback shuts the context down while others publish: spin ends, publishers are refused, nobody hangs."""
    node = Node("stress")
    refused: list[str] = []
    node.create_subscription(Int64, "end", lambda m: m.data == 50 and rclpy.shutdown(), 10)
    publisher = node.create_publisher(Int64, "end", 10)

    def publish() -> None:
        number = 0
        while True:
            try:
                publisher.publish(Int64(data=number))
            except RuntimeError as error:
                refused.append(str(error))
                return
            # Every number is received before the next, so that 50 is not overwritten.
            number = min(number + 1, 50)

    def spin() -> None:
        with contextlib.suppress(ExternalShutdownException):
            rclpy.spin(node)

    in_threads(spin, publish, publish)
    assert refused == ["Failed to publish: publisher's context is invalid"] * 2


def test_calls_between_threads() -> None:
    """Synchronous calls from three threads to one service each get their own answer."""
    node = Node("stress")
    group = ReentrantCallbackGroup()

    def serve(request: SetBool.Request, response: SetBool.Response) -> SetBool.Response:
        response.success = request.data
        return response

    node.create_service(SetBool, "ask", serve, callback_group=group)
    clients = [node.create_client(SetBool, "ask", callback_group=group) for _ in range(3)]
    done = threading.Event()
    ended: list[int] = []

    def ask(index: int) -> None:
        for number in range(60):
            answer = clients[index].call(SetBool.Request(data=bool(number % 2)), timeout_sec=20)
            assert answer is not None
            assert answer.success == bool(number % 2)
        ended.append(index)
        if len(ended) == 3:
            done.set()

    executor = MultiThreadedExecutor(num_threads=3)
    executor.add_node(node)

    def spin() -> None:
        while not done.is_set():
            executor.spin_once(timeout_sec=0.05)

    in_threads(spin, *[lambda index=index: ask(index) for index in range(3)])
    executor.shutdown()


def test_events_of_endpoints_that_come_and_go() -> None:
    """The count of matches is right after two threads have created and destroyed subscriptions."""
    node = Node("stress")
    publisher = node.create_publisher(String, "events", 10)

    def churn() -> None:
        for _ in range(50):
            node.destroy_subscription(node.create_subscription(String, "events", lambda _: None, 1))

    def publish() -> None:
        for _ in range(300):
            publisher.publish(String())

    in_threads(churn, churn, publish)
    matched = publisher.handle.writer.matched
    assert (matched.total, matched.current) == (100, 0)
    assert publisher.get_subscription_count() == 0


@pytest.mark.parametrize("make_waker", [timing.Waker, lambda: timing.SYSTEM.waker(lasting=True)])
def test_a_waker_ends_the_present_wait_or_the_next_one_once(make_waker: Callable[[], timing.Waker]) -> None:
    waker = make_waker()
    soon = timing.monotonic_ns() + 1_000_000
    assert not timing.wait(waker, soon)
    assert timing.monotonic_ns() >= soon
    waker.wake()
    waker.wake()
    assert timing.wait(waker, soon)  # although it is later by now
    assert not timing.wait(waker, soon)
    there, back = make_waker(), make_waker()

    def answer() -> None:
        for _ in range(300):
            assert timing.wait(there, None)
            back.wake()

    def ask() -> None:
        for _ in range(300):
            there.wake()
            assert timing.wait(back, timing.monotonic_ns() + 20 * 10**9)

    in_threads(ask, answer)


@pytest.mark.skipif(not hasattr(signal, "setitimer"), reason="this system has no alarms to interrupt with")
@pytest.mark.parametrize("make_waker", [timing.Waker, lambda: timing.SYSTEM.waker(lasting=True)])
def test_a_signal_ends_no_wait_but_its_handler_may(make_waker: Callable[[], timing.Waker]) -> None:
    waker = make_waker()
    signals: list[int] = []

    def handle(number: int, _: object) -> None:
        signals.append(number)
        if len(signals) == 5:
            waker.wake()

    before = signal.signal(signal.SIGALRM, handle)
    signal.setitimer(signal.ITIMER_REAL, 0.002, 0.002)
    try:
        assert timing.wait(waker, None)
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0)
        signal.signal(signal.SIGALRM, before)
    assert len(signals) >= 5


def test_the_main_thread_waits_in_short_steps(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(timing, "_LONGEST_OF_MAIN", 0.25)
    steps: list[float] = []

    class Sleeper(timing.Waker):
        def sleep(self, timeout: float) -> bool:
            steps.append(timeout)
            return len(steps) == 4

    system = timing.SystemDriver()
    monkeypatch.setattr(system, "monotonic_ns", lambda: int(sum(steps) * 1e9))
    assert system.wait(Sleeper(), None)
    assert steps == [0.25] * 4
    steps.clear()
    assert not system.wait(Sleeper(), 375_000_000)
    assert steps == [0.25, 0.125]


@pytest.mark.skipif(not hasattr(signal, "pthread_kill"), reason="this system sends no signals to threads")
@pytest.mark.parametrize("make_waker", [timing.Waker, lambda: timing.SYSTEM.waker(lasting=True)])
def test_a_signal_that_interrupts_no_wait_is_heard_soon(make_waker: Callable[[], timing.Waker]) -> None:
    """As one that comes in the moment before the wait: it reaches another thread here."""
    waker = make_waker()
    before = signal.signal(signal.SIGUSR1, lambda *_: waker.wake())

    def send() -> None:
        signal.pthread_kill(threading.get_ident(), signal.SIGUSR1)

    timer = threading.Timer(0.05, send)
    timer.start()
    try:
        assert timing.wait(waker, timing.monotonic_ns() + 20 * 10**9)
    finally:
        timer.join()
        signal.signal(signal.SIGUSR1, before)


@pytest.mark.skipif(not hasattr(os, "eventfd"), reason="executors have file descriptors on Linux only")
def test_executors_give_their_descriptors_back_and_do_without(monkeypatch: pytest.MonkeyPatch) -> None:
    opened: list[int] = []
    monkeypatch.setattr(
        os, "eventfd", lambda value, real=os.eventfd: opened.append(real(value)) or opened[-1]
    )
    executor = SingleThreadedExecutor()
    assert len(opened) == 1
    del executor
    gc.collect()
    with pytest.raises(OSError, match="Bad file descriptor"):
        os.fstat(opened[0])

    def none_left(value: int) -> int:
        raise OSError(errno.EMFILE, "Too many open files")

    monkeypatch.setattr(os, "eventfd", none_left)
    executor = SingleThreadedExecutor()
    node = Node("late")
    executor.add_node(node)
    heard: list[str] = []
    node.create_subscription(String, "talk", lambda m: heard.append(m.data), 10)
    publisher = node.create_publisher(String, "talk", 10)
    in_threads(lambda: executor.spin_once(20), lambda: publisher.publish(String(data="x")))
    assert heard == ["x"]
