"""A tool's own node, on the transport that the user chose, in the process of the tool."""

from __future__ import annotations

import os
import sys
import time
from collections.abc import Callable, Generator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final, Literal

from ifgen.command_kit.tool import Absent, ToolError, did_you_mean

from ifgen_tools import discovery
from ifgen_tools.lookout import Lookout
from ifgen_tools.ros_graph import View, node_names, read
from ifgen_tools.verbs import TransportChoice

if TYPE_CHECKING:
    from rclpy.context import Context
    from rclpy.executors import SingleThreadedExecutor
    from rclpy.node import Node

# Late imports: rclpy takes long to import, and is found once the transport has been chosen.

Transport = Literal["local", "rclpy"]

_PATIENCE_FOR_NODE: Final = 5.0
"""Seconds that a named node may take to be discovered."""

_TURN: Final = 0.1
"""Seconds between two looks at a condition, if nothing happens meanwhile."""

_LOOK: Final = 0.01
"""Seconds between two looks at the graph while it is discovered."""

_QUIET: Final = 0.5
"""Seconds without a change after which the graph of a real rclpy is known."""

_PATIENCE_LOCALLY: Final = 6.0
"""Seconds for processes that are there, but do not answer: one on a busy machine, or one without Zenoh."""

_PATIENCE: Final = 3.0
"""Seconds after which a graph is taken as it is: those of DDS may need them on a busy machine."""


@dataclass(frozen=True, slots=True)
class Session:
    """A hidden node with its context and an executor that has this node.

    `transport` is the one that was chosen: "local" or "rclpy", never "auto".
    """

    transport: Transport
    context: Context
    node: Node
    executor: SingleThreadedExecutor
    lookout: Lookout

    def wait_for(
        self, condition: Callable[[], bool], timeout: float | None = None, turn: float = _TURN
    ) -> bool:
        """Spin until a condition holds, up to `timeout` [s] (None: for ever); returns whether it does.

        It is looked at after each callback, and every `turn` [s].
        """
        end = None if timeout is None else time.monotonic() + timeout
        while not condition():
            left = turn if end is None else min(turn, end - time.monotonic())
            if left <= 0:
                return False
            self.turn(left)
        return True

    def turn(self, seconds: float = _TURN) -> None:
        """Spin once, for a moment at most: without an end, real rclpy would not hear Ctrl-C."""
        self.executor.spin_once(timeout_sec=seconds)
        self.lookout.look()

    def now(self) -> int:
        """The time of the node's clock [ns]; 0 while a simulated time has not come."""
        return int(self.node.get_clock().now().nanoseconds)

    def discover(self, spin_time: float | None = None, until: Callable[[], bool] | None = None) -> None:
        """Wait until the graph is known, or for `spin_time` [s] if that is given.

        The local transport knows when it is. For real rclpy, it is known when nothing has changed for a
        while, and somebody else is there at all, or what the tool looks for: when `until` holds.
        """
        if spin_time is not None:
            self.wait_for(until or (lambda: False), spin_time)
        elif self.transport == "local":
            self.wait_for(self._knows_everybody, _PATIENCE_LOCALLY, _LOOK)
        else:
            self.settle(self._names, until or self._is_in_company)
        self.lookout.look_around()

    def settle(
        self,
        look: Callable[[], object],
        enough: Callable[[], bool],
        *,
        quiet: float = _QUIET,
        patience: float = _PATIENCE,
    ) -> None:
        """Wait until `enough` holds, and what `look` returns has not changed for `quiet` [s].

        Not longer than `patience` [s].
        """
        seen, started = look(), time.monotonic()
        since = started
        while (now := time.monotonic()) - started < patience:
            if now - since > quiet and enough():
                return
            self.turn(_LOOK)
            if (found := look()) != seen:
                seen, since = found, time.monotonic()

    def graph(self) -> View:
        """The graph of the others, with all that the transport knows of it."""
        is_local = self.transport == "local"
        return read(self.node, discovery.queues(self.context.get_domain_id()) if is_local else {})

    def _is_in_company(self) -> bool:
        return len(self.node.get_node_names()) > 1

    def _knows_everybody(self) -> bool:
        return discovery.knows_everybody(self.context.get_domain_id())

    def _names(self) -> tuple[object, ...]:
        node = self.node
        return (
            node.get_node_names_and_namespaces(),
            node.get_topic_names_and_types(),
            node.get_service_names_and_types(),
        )


@contextmanager
def open_session(
    transport: TransportChoice = "auto",
    arguments: Sequence[str] = (),
    name: str | None = None,
    *,
    use_sim_time: bool = False,
) -> Generator[Session]:
    """A session, until the block ends.

    `arguments` are those of rclpy.init, such as `["--ros-args", "-r", "..."]`. The node is called
    `_ifgen_PID` if it has no `name`. It has no services and no /rosout, and a name that begins with `_` hides
    it from others. If nobody is here, its lookout says who is elsewhere. Raises ToolError if there is no such
    transport.
    """
    chosen = activate(transport)
    if chosen == "rclpy":
        _hush_half_made_tasks()
    from ifgen.signals import delay_interrupt

    with delay_interrupt(""):  # Ctrl-C in the import of a module in C may be lost
        import rclpy
        from rclpy.executors import SingleThreadedExecutor
        from rclpy.parameter import Parameter

    context = rclpy.Context()
    rclpy.init(
        args=list(arguments),
        context=context,
        signal_handler_options=rclpy.SignalHandlerOptions.NO,
    )
    overrides = [Parameter("use_sim_time", value=True)] if use_sim_time else []
    node = rclpy.create_node(
        name or f"_ifgen_{os.getpid()}",
        context=context,
        start_parameter_services=False,
        enable_rosout=False,
        parameter_overrides=overrides,
    )
    executor = SingleThreadedExecutor(context=context)
    try:
        executor.add_node(node)
        if chosen == "local" and discovery.lacks_zenoh(context.get_domain_id()):
            from ifgen_runtime.installation import add_runtime

            note = f"note: other processes are not reached without Zenoh. Install it: {add_runtime()}"
            print(note, file=sys.stderr)
        lookout = Lookout(chosen, node)
        try:
            yield Session(chosen, context, node, executor, lookout)
        except Absent as error:
            raise ToolError(error.message, "; ".join(filter(None, (error.help, lookout.advice())))) from None
        lookout.look_back()
    finally:
        executor.shutdown(timeout_sec=0)
        node.destroy_node()
        context.try_shutdown()


def _hush_half_made_tasks() -> None:
    """Say nothing of tasks of real rclpy whose making Ctrl-C has interrupted: their end fails."""
    tell = sys.unraisablehook

    def tell_of_others(failure: sys.UnraisableHookArgs) -> None:
        if getattr(failure.object, "__qualname__", "") != "Future.__del__":
            tell(failure)

    sys.unraisablehook = tell_of_others


def activate(transport: TransportChoice) -> Transport:
    """Let imports find the packages of a transport, as `ifgen run` does, and return which one it is.

    Raises ToolError if that is not possible.
    """
    from ifgen.activation import ActivationError, put_on_path
    from ifgen.config.settings import settle

    try:
        return put_on_path(transport, settle().output)
    except ActivationError as error:
        raise ToolError(str(error)) from None


def find_node(session: Session, name: str, spin_time: float | None = None) -> str:
    """The full name of a node that the user named, once it is there.

    A hidden one, too: a user who names it wants it. If several have the name, it says so on stderr.
    Raises ToolError if it is not there after `spin_time` [s].
    """
    wanted = name if name.startswith("/") else f"/{name}"
    domain = session.context.get_domain_id()

    def is_there() -> bool:
        return wanted in node_names(session.node, True)

    def is_known() -> bool:
        return is_there() or (session.transport == "local" and discovery.knows_everybody(domain))

    session.wait_for(is_known, _PATIENCE_FOR_NODE if spin_time is None else spin_time)
    if is_there():
        if (number := node_names(session.node, True).count(wanted)) > 1:
            print(
                f"warning: {number} nodes are called {wanted}: what they have is shown together, or that of "
                "one of them only",
                file=sys.stderr,
            )
        return wanted
    others = node_names(session.node)
    advice = did_you_mean(wanted, others) or (
        "see `ifgen node list`" if others else "no node is running, or none that this process can see"
    )
    raise Absent(f"there is no node {wanted!r}", advice)
