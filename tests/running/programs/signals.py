"""Prints "ready" and is interrupted from outside; it reacts in the way that its argument names."""

import asyncio
import os
import signal
import sys
import threading
import time

import helper  # noqa: F401
import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.signals import SignalHandlerOptions

how = sys.argv[1]
number = signal.SIGTERM if how.endswith("TERM") else signal.SIGINT
got = []


def ready():
    """Print "ready" once the main thread is where it will stay."""
    main = threading.main_thread().ident

    def place():
        frame = sys._current_frames()[main]
        while frame is not None and frame.f_code.co_filename != __file__:
            frame = frame.f_back
        return frame and (frame.f_code.co_name, frame.f_lasti)

    def watch():
        before, since = place(), time.monotonic()
        while time.monotonic() - since < 0.2:
            time.sleep(0.01)
            if place() != before:
                before, since = place(), time.monotonic()
        print("ready", flush=True)

    threading.Thread(target=watch, daemon=True).start()


def remember(received, frame):
    in_main = threading.current_thread() is threading.main_thread()
    # One write, and before `got`: another thread continues at once, and prints its "end".
    sys.stdout.write(f"handler {received == number} {in_main} {frame is not None}\n")
    got.append(received)


def not_in_a_thread():
    try:
        signal.signal(number, remember)
    except ValueError as error:
        print(error)


def spin(**options):
    rclpy.init(args=sys.argv, **options)
    node = rclpy.create_node("signals")
    node.create_timer(0.05, lambda: None)  # real rclpy does not wake for signals that it does not handle
    ready()
    try:
        rclpy.spin(node)
    except (KeyboardInterrupt, ExternalShutdownException):
        print("spin has ended")
    finally:
        end = time.monotonic() + 20.0
        while not options and rclpy.ok() and time.monotonic() < end:  # the real one ends it on a thread, soon
            time.sleep(0.01)
        print("finally", rclpy.ok())
        node.destroy_node()
        rclpy.try_shutdown()


print(signal.getsignal(signal.SIGINT) is signal.default_int_handler, signal.getsignal(signal.SIGTERM).name)
other = threading.Thread(target=not_in_a_thread)
other.start()
other.join()
if how in {"flag", "flag TERM"}:
    print(signal.signal(number, remember) in (signal.default_int_handler, signal.SIG_DFL))
    print(signal.getsignal(number) is remember)
    ready()
    while not got:
        time.sleep(0.5)
elif how == "busy":
    signal.signal(number, remember)
    print("ready", flush=True)
    while not got:
        sum(range(1000))
elif how == "leaves":

    def leave(received, frame):
        print("leaving")
        sys.exit(6)

    signal.signal(number, leave)
    ready()
    try:
        threading.Event().wait()
    finally:
        print("finally")
elif how == "in spin":

    def leave_spin(received, frame):
        print("leaving", threading.current_thread() is threading.main_thread())
        node.destroy_node()
        rclpy.shutdown()
        sys.exit(0)

    rclpy.init()
    node = rclpy.create_node("in_spin")
    node.create_timer(0.05, lambda: None)
    signal.signal(number, leave_spin)
    ready()
    rclpy.spin(node)
elif how in {"spin", "spin TERM"}:
    spin()
elif how == "spin without handlers":
    spin(signal_handler_options=SignalHandlerOptions.NO)
elif how == "uncaught":
    ready()
    time.sleep(30)
elif how == "uncaught in spin":
    rclpy.init()
    node = rclpy.create_node("uncaught")
    ready()
    rclpy.spin(node)
elif how == "join":
    done = threading.Event()
    thread = threading.Thread(target=done.wait, args=(30,))
    thread.start()
    ready()
    try:
        thread.join()
    except KeyboardInterrupt:
        print("interrupted")
        done.set()
elif how == "asyncio":

    async def main():
        ready()
        try:
            await asyncio.sleep(30)
        except asyncio.CancelledError:
            print("cancelled")
            raise

    try:
        asyncio.run(main())
    except KeyboardInterrupt:
        print("interrupted")
elif how == "loop":
    loop = asyncio.new_event_loop()
    ready()
    try:
        loop.run_forever()
    except KeyboardInterrupt:
        print("interrupted")
    finally:
        loop.close()
elif how == "pause":
    signal.signal(number, remember)
    ready()
    signal.pause()
    print("after", got == [number])
elif how == "to itself":
    signal.signal(signal.SIGUSR1, lambda received, frame: print("SIGUSR1 to itself"))
    os.kill(os.getpid(), signal.SIGUSR1)
    signal.raise_signal(signal.SIGUSR1)
    try:
        os.kill(os.getpid(), signal.SIGINT)
        time.sleep(30)
    except KeyboardInterrupt:
        print("interrupted by itself")
elif how == "TERM":
    ready()
    time.sleep(30)
print("end")
