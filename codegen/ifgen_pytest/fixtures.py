"""The fixtures. rclpy is imported when a test asks for one, and never before."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator
from contextlib import nullcontext
from importlib.util import find_spec
from typing import TYPE_CHECKING, Any

import pytest

from ifgen_pytest.collector import CollectorFactory, NodeFactory
from ifgen_pytest.domains import RANGE, own_domain, private_domain

if TYPE_CHECKING:
    from rclpy.context import Context
    from rclpy.executors import SingleThreadedExecutor

# Late imports: rclpy is imported when a test asks for it, once it is known which one that is.


@pytest.fixture
def ros_context(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> Iterator[Context]:
    """The default context, initialised in its own domain and shut down at the end.

    `rclpy.spin` and nodes that are made without a `context` use it.
    """
    if "ros_virtual_clock" in request.fixturenames:
        request.getfixturevalue("ros_virtual_clock")  # time has to stand still before anything waits in it
    import rclpy
    from rclpy.signals import SignalHandlerOptions

    real = find_spec("rmw_local") is None
    if not real:
        monkeypatch.setenv(RANGE, "OFF")  # a private domain is private only within this process
    elif RANGE not in os.environ:
        monkeypatch.setenv(RANGE, "LOCALHOST")
    with own_domain() if real else nullcontext(private_domain()) as domain:
        # No signal handlers: Ctrl-C is pytest's.
        rclpy.init(args=[], domain_id=domain, signal_handler_options=SignalHandlerOptions.NO)
        yield rclpy.get_default_context()
        rclpy.try_shutdown()


@pytest.fixture
def ros_executor(ros_context: Context) -> Iterator[SingleThreadedExecutor]:
    """A SingleThreadedExecutor of `ros_context`, shut down at the end. The test spins it."""
    from rclpy.executors import SingleThreadedExecutor

    executor = SingleThreadedExecutor(context=ros_context)
    yield executor
    executor.shutdown()


@pytest.fixture
def ros_node(ros_executor: SingleThreadedExecutor) -> Iterator[NodeFactory]:
    """Makes nodes in `ros_executor`, destroyed at the end: `ros_node("name")` or `ros_node(MyNode, ...)`."""
    factory = NodeFactory(ros_executor)
    yield factory
    factory.destroy()


@pytest.fixture
def ros_collect(ros_executor: SingleThreadedExecutor, ros_node: NodeFactory) -> CollectorFactory:
    """Makes collectors of messages: `ros_collect(String, "chatter").wait(3)`."""
    return CollectorFactory(ros_executor, ros_node)


@pytest.fixture
def ros_lockstep() -> Callable[..., Any]:
    """`rmw_local.lockstep.run`: calls functions, each in a process, in one virtual time (local only)."""
    try:
        from rmw_local.lockstep import run
    except ImportError:
        pytest.skip("lockstep needs the local transport: run pytest with --transport local")
    return run


@pytest.fixture
def ros_virtual_clock(request: pytest.FixtureRequest) -> Iterator[Any]:
    """The whole test in virtual time, on the local transport only; the value is its VirtualDriver.

    Parametrise it indirectly with seeds to try other orders of threads.
    """
    try:
        from rmw_local.virtual_time import virtual_time
    except ImportError:
        pytest.skip("virtual time needs the local transport: run pytest with --transport local")
    with virtual_time(seed=getattr(request, "param", 0)) as driver:
        yield driver
