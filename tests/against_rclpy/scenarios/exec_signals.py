"""SIGINT and SIGTERM while an executor spins, and who handles them."""

from __future__ import annotations

import os
import signal
import threading

import rclpy
from rclpy.context import Context
from rclpy.executors import (
    Executor,
    ExternalShutdownException,
    MultiThreadedExecutor,
    SingleThreadedExecutor,
)
from rclpy.signals import (
    SignalHandlerGuardCondition,
    SignalHandlerOptions,
    get_current_signal_handlers_options,
    install_signal_handlers,
    uninstall_signal_handlers,
)
from transcript import attempt, until


def kill_soon(number: int, delay: float = 0.2) -> None:
    threading.Timer(delay, lambda: os.kill(os.getpid(), number)).start()


def spin(executor: Executor) -> None:
    """Spin. The real one notices in one place or another that its context has gone."""
    try:
        executor.spin()
    except Exception as error:
        if "the given context is not valid" in str(error):
            raise ExternalShutdownException from None
        raise


def main() -> None:
    """Print it all."""
    print(
        get_current_signal_handlers_options(),
        SignalHandlerOptions.ALL == 3,
        int(SignalHandlerOptions.SIGTERM),
    )
    for options in (None, SignalHandlerOptions.NO, SignalHandlerOptions.SIGTERM):
        rclpy.init(signal_handler_options=options)
        print(get_current_signal_handlers_options())
        rclpy.shutdown(uninstall_handlers=options is None)
        print(get_current_signal_handlers_options())
        uninstall_signal_handlers()
    install_signal_handlers()
    install_signal_handlers(SignalHandlerOptions.SIGINT)
    print(get_current_signal_handlers_options(), repr(SignalHandlerOptions(1)))
    uninstall_signal_handlers()
    for number in (signal.SIGINT, signal.SIGTERM):
        for kind in (SingleThreadedExecutor, MultiThreadedExecutor):
            other = Context()
            other.init()
            rclpy.init()
            node, executor = rclpy.create_node("n"), kind()
            guard = SignalHandlerGuardCondition()
            executor.add_node(node)
            kill_soon(number)
            attempt(f"{number.name} {kind.__name__} spin", lambda: spin(executor))
            until(lambda: not (rclpy.ok() or other.ok()))
            print(rclpy.ok(), other.ok(), get_current_signal_handlers_options())
            attempt("shutdown", rclpy.shutdown)
            attempt("try_shutdown", rclpy.try_shutdown)
            attempt("destroy", node.destroy_node)
            guard.destroy()
            uninstall_signal_handlers()
    # A program's own handler is left out: with one, the real rclpy sometimes spins for ever on a busy machine.
