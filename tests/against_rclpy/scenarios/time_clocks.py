"""Time, durations, clocks, jumps, timers on every clock, rates, and simulated time by parameter and /clock."""

from __future__ import annotations

import threading
import time
from typing import Any

import rclpy
from builtin_interfaces.msg import Duration as DurationMessage
from builtin_interfaces.msg import Time as TimeMessage
from rclpy.clock import Clock, ClockChange, JumpHandle, JumpThreshold, ROSClock, TimeJump
from rclpy.clock_type import ClockType
from rclpy.duration import Duration, Infinite
from rclpy.executors import SingleThreadedExecutor
from rclpy.impl.implementation_singleton import rclpy_implementation as _rclpy
from rclpy.parameter import Parameter
from rclpy.time import Time
from rclpy.time_source import CLOCK_TOPIC, USE_SIM_TIME_NAME, TimeSource
from rclpy.timer import Timer
from rosgraph_msgs.msg import Clock as ClockMessage
from transcript import attempt, until

SECOND = 10**9


def arithmetic() -> None:
    times = [Time(seconds=1), Time(nanoseconds=2.7), Time(seconds=1, clock_type=ClockType.ROS_TIME)]
    durations = [Duration(seconds=1.5), Duration(nanoseconds=-3), Infinite]
    print(times, durations, [str(each) for each in durations])
    for label, call in {
        "negative seconds": lambda: Time(seconds=-1),
        "negative nanoseconds": lambda: Time(nanoseconds=-1),
        "too large": lambda: Time(nanoseconds=2**63),
        "largest": lambda: Time(nanoseconds=2**63 - 1),
        "no clock type": lambda: Time(clock_type=1),
        "seam's clock type": lambda: Time(clock_type=_rclpy.ClockType.STEADY_TIME),
        "duration too large": lambda: Duration(nanoseconds=2**63),
        "duration too small": lambda: Duration(nanoseconds=-(2**63) - 1),
        "text": lambda: Time(seconds="1"),
        "sum": lambda: times[0] + durations[0],
        "reversed sum": lambda: durations[0] + times[0],
        "overflow": lambda: Time(nanoseconds=2**63 - 1) + Duration(nanoseconds=1),
        "difference": lambda: times[0] - times[1],
        "negative difference": lambda: times[1] - times[0],
        "earlier": lambda: times[0] - Duration(seconds=0.25),
        "too early": lambda: times[1] - durations[0],
        "later by minus": lambda: times[0] - durations[1],
        "other clock": lambda: times[0] - times[2],
        "other clock equal": lambda: times[0] == times[2],
        "other clock less": lambda: times[0] < times[2],
        "other clock unequal": lambda: times[0] != times[2],
        "equal": lambda: (
            times[0] == Time(seconds=1),
            times[0] != times[1],
            times[0] > times[1],
            times[0] <= times[1],
        ),
        "with a number": lambda: (times[0] == 1, times[0] != 1, durations[0] == 1),
        "less than a number": lambda: times[0] < 1,
        "duration less than a number": lambda: durations[0] < 1,
        "add a number": lambda: times[0] + 1,
        "subtract a number": lambda: times[0] - 1,
        "durations": lambda: (
            durations[0] > durations[1],
            durations[0] >= durations[0],
            durations[1] <= durations[0],
        ),
        "hash": lambda: hash(times[0]),
        "hash of duration": lambda: hash(durations[0]),
        "parts": lambda: Time(seconds=3, nanoseconds=5).seconds_nanoseconds(),
        "message": lambda: Time(seconds=3, nanoseconds=5).to_msg(),
        "from message": lambda: Time.from_msg(TimeMessage(sec=3, nanosec=5)),
        "from message, clock": lambda: Time.from_msg(TimeMessage(sec=3), ClockType.STEADY_TIME),
        "from something": lambda: Time.from_msg(3),
        "duration message": lambda: (Duration(nanoseconds=-1).to_msg(), Duration(seconds=2).to_msg()),
        "duration from message": lambda: Duration.from_msg(DurationMessage(sec=-1, nanosec=5)),
        "duration from something": lambda: Duration.from_msg(3),
        "handle": lambda: (
            durations[0].get_c_duration().nanoseconds,
            times[0].clock_type,
            times[2].clock_type,
        ),
        "clock type": lambda: (times[0].clock_type == ClockType.SYSTEM_TIME, repr(ClockType.ROS_TIME)),
    }.items():
        attempt(label, call)


def jumps() -> None:
    clock = Clock(clock_type=ClockType.ROS_TIME)
    print(repr(clock), isinstance(clock, ROSClock), repr(Clock()), repr(ROSClock()))
    attempt("clock type", lambda: Clock(clock_type=1))
    for arguments in (
        (0, None, True),
        (None, 0, True),
        (-1, None, True),
        (None, 1, True),
        (None, None, False),
    ):
        forward, backward, change = arguments
        attempt(
            str(arguments),
            lambda: (
                JumpThreshold(
                    min_forward=None if forward is None else Duration(nanoseconds=forward),
                    min_backward=None if backward is None else Duration(nanoseconds=backward),
                    on_clock_change=change,
                )
                and "made"
            ),
        )
    threshold = JumpThreshold(min_forward=Duration(seconds=2), min_backward=Duration(seconds=-2))
    attempt("no callbacks", lambda: clock.create_jump_callback(threshold))
    attempt("pre", lambda: clock.create_jump_callback(threshold, pre_callback=3))
    attempt("post", lambda: clock.create_jump_callback(threshold, post_callback=3))
    attempt("time jump", lambda: TimeJump(3, Duration()))
    print(TimeJump(ClockChange.ROS_TIME_ACTIVATED, Duration(seconds=1)).delta)
    seen: list[Any] = []

    def after(name: str) -> Any:
        return lambda jump: seen.append(
            (name, str(jump.clock_change), jump.delta.nanoseconds / SECOND, clock.now())
        )

    both = clock.create_jump_callback(
        threshold, pre_callback=lambda: seen.append("pre"), post_callback=after("both")
    )
    only_change = clock.create_jump_callback(
        JumpThreshold(min_forward=None, min_backward=None, on_clock_change=True),
        post_callback=after("change"),
    )
    print(isinstance(both, JumpHandle))

    def at(seconds: float) -> None:
        clock.set_ros_time_override(Time(seconds=seconds, clock_type=ClockType.ROS_TIME))

    with clock.create_jump_callback(
        JumpThreshold(min_forward=Duration(nanoseconds=1), min_backward=None, on_clock_change=False),
        post_callback=after("forward"),
    ):
        at(5)
        print(seen, clock.ros_time_is_active)
        clock._set_ros_time_is_active(True)
        for seconds in (6, 8, 7, 1, 1):
            at(seconds)
        clock._set_ros_time_is_active(True)
    for each in seen:
        print(each)
    seen.clear()
    both.unregister()
    both.unregister()
    at(100)
    only_change.unregister()
    clock._set_ros_time_is_active(False)
    print(seen, clock.now() > Time(seconds=10**9, clock_type=ClockType.ROS_TIME))
    attempt("override", lambda: clock.set_ros_time_override(3))
    system = Clock().handle
    attempt("enable", lambda: system.set_ros_time_override_is_enabled(True))
    attempt("enabled", system.get_ros_time_override_is_enabled)
    attempt("set", lambda: system.set_ros_time_override(Time(seconds=2)._time_handle))


def timers_in_ros_time() -> None:
    clock, context = ROSClock(), rclpy.get_default_context()

    def at(seconds: float) -> None:
        clock.set_ros_time_override(Time(seconds=seconds, clock_type=ClockType.ROS_TIME))

    clock._set_ros_time_is_active(True)
    at(100)
    timer = Timer(print, None, 10 * SECOND, clock, context=context)

    def show(label: Any) -> None:
        since = round(timer.time_since_last_call(), -8)  # the clock does not stay stopped
        print(label, timer.time_until_next_call(), since, timer.is_ready(), timer.is_canceled())

    def call() -> None:
        timer.handle.call_timer()
        show("called")

    for seconds in (104, 98, 107, 108):
        at(seconds)
        show(seconds)
    call()
    for seconds in (150, 152, 158):
        at(seconds)
        show(seconds)
        call()
    for seconds in (153, 100):
        at(seconds)
        show(seconds)
    timer.timer_period_ns = 4 * SECOND
    show(timer.timer_period_ns)
    at(111)
    call()
    at(0)
    show("0")
    clock._set_ros_time_is_active(False)
    clock._set_ros_time_is_active(True)
    show("again at 0")
    at(3)
    clock._set_ros_time_is_active(False)
    print(round(timer.time_until_next_call() / SECOND, 1), round(timer.time_since_last_call() / SECOND, 1))
    clock._set_ros_time_is_active(True)
    print(round(timer.time_until_next_call() / SECOND, 1), round(timer.time_since_last_call() / SECOND, 1))
    timer.cancel()
    show("cancelled")
    attempt("call", call)
    timer.reset()
    show("reset")
    timer = Timer(print, None, 0, clock, context=context, autostart=False)
    show("not started")
    timer.reset()
    show("period 0")
    call()
    attempt("negative", lambda: Timer(print, None, -1, clock, context=context))
    timer.destroy()
    attempt("destroyed", timer.is_ready)
    attempt("destroyed", lambda: timer.timer_period_ns)


def steady_timers(node: Any, executor: Any) -> None:
    """A late timer does not make up for missed periods."""
    seen: list[float] = []
    started = time.monotonic()
    timer = node.create_timer(0.1, lambda: seen.append(time.monotonic() - started))
    time.sleep(0.55)
    until(lambda: len(seen) >= 4, executor)
    print(seen[0] >= 0.55, len(seen) <= 2 + (seen[-1] - 0.5) / 0.1)
    seen.clear()
    timer.cancel()
    executor.spin_once(timeout_sec=0.2)
    print(seen, timer.time_until_next_call())
    timer.reset()
    until(lambda: seen, executor)
    print(len(seen))
    node.destroy_timer(timer)
    attempt("period", lambda: node.create_timer(-0.1, print))


def sleeps(node: Any) -> None:
    for kind in (ClockType.SYSTEM_TIME, ClockType.STEADY_TIME, ClockType.ROS_TIME):
        clock = Clock(clock_type=kind)
        started = time.monotonic()
        print(clock.sleep_for(Duration(seconds=0.1)), clock.sleep_until(clock.now() - Duration(seconds=90)))
        print(0.09 < time.monotonic() - started < 60)
        attempt("kind", lambda: clock.sleep_until(Time(clock_type=ClockType(kind % 3 + 1))))
    clock = ROSClock()
    clock._set_ros_time_is_active(True)
    for label, wake in {
        "reached": lambda: clock.set_ros_time_override(Time(seconds=11, clock_type=ClockType.ROS_TIME)),
        "switched": lambda: clock._set_ros_time_is_active(False),
    }.items():
        threading.Timer(0.1, wake).start()
        print(label, clock.sleep_until(clock.now() + Duration(seconds=10)))
    attempt("no context", lambda: clock.sleep_for(Duration(seconds=0.1), context=rclpy.Context()))


def rates(node: Any, executor: Any) -> None:
    for frequency in (0, -1):
        attempt(f"rate {frequency}", lambda: node.create_rate(frequency))
    stop = threading.Event()

    def spin() -> None:
        while not stop.is_set():
            executor.spin_once(timeout_sec=0.05)

    thread = threading.Thread(target=spin)
    thread.start()
    rate = node.create_rate(20)
    started = time.monotonic()
    for _ in range(4):
        rate.sleep()
    print(time.monotonic() - started > 0.14)  # the first sleep ends with the present period
    print(node.destroy_rate(rate))
    attempt("destroyed", rate.sleep)
    rate = node.create_rate(0.01)
    threading.Timer(0.1, rate.destroy).start()
    attempt("destroyed while it sleeps", rate.sleep)
    stop.set()
    thread.join()


def simulated_time(node: Any, executor: Any) -> None:
    clock = node.get_clock()
    print(CLOCK_TOPIC, USE_SIM_TIME_NAME, clock.ros_time_is_active)
    fired: list[Any] = []
    timer = node.create_timer(10.0, lambda: fired.append(clock.now().nanoseconds // SECOND), clock=clock)
    wrong = node.set_parameters([Parameter(USE_SIM_TIME_NAME, value=3)])[0]
    print(wrong.successful, wrong.reason)
    print(node.set_parameters([Parameter(USE_SIM_TIME_NAME, value=True)])[0].successful)
    print(clock.ros_time_is_active, clock.now(), len(list(node.subscriptions)))
    publisher = node.create_publisher(ClockMessage, CLOCK_TOPIC, 1)
    until(publisher.get_subscription_count, executor)
    for seconds in (100, 105, 111, 140, 145, 151, 120, 125, 131):
        publisher.publish(ClockMessage(clock=TimeMessage(sec=seconds)))
        until(lambda: clock.now().nanoseconds == seconds * SECOND, executor, seconds=5)
        for _ in range(5):
            executor.spin_once(timeout_sec=0.02)
        print(seconds, fired, timer.time_until_next_call())
    other = ROSClock()
    source = TimeSource(node=node)
    source.attach_clock(other)
    print(other.now(), source.ros_time_is_active)
    attempt("attach", lambda: source.attach_clock(Clock()))
    attempt("attach", lambda: source.attach_node(3))
    source.detach_node()
    print(node.set_parameters([Parameter(USE_SIM_TIME_NAME, value=False)])[0].successful)
    print(clock.ros_time_is_active, clock.now() > Time(seconds=10**9, clock_type=ClockType.ROS_TIME))
    print(len(list(node.subscriptions)))
    node.destroy_timer(timer)


def main() -> None:
    """Print it all."""
    arithmetic()
    jumps()
    rclpy.init()
    timers_in_ros_time()
    node, executor = rclpy.create_node("n"), SingleThreadedExecutor()
    executor.add_node(node)
    steady_timers(node, executor)
    sleeps(node)
    rates(node, executor)
    simulated_time(node, executor)
    rclpy.shutdown()
