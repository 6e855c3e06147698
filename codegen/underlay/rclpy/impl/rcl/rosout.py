"""/rosout: the loggers of nodes and their children publish what they log."""

from __future__ import annotations

import threading
from collections.abc import Callable
from functools import partial
from typing import TYPE_CHECKING, Any

from rmw_local.message import message_type
from rmw_local.qos import RELIABLE, TRANSIENT_LOCAL, QosProfile

from rclpy.impl import program
from rclpy.impl.messages import cleaned_text

if TYPE_CHECKING:
    from rmw_local.writer import Writer

    from .node import Node

ROSOUT_TOPIC = "/rosout"
_QOS = QosProfile(depth=1000, reliability=RELIABLE, durability=TRANSIENT_LOCAL, lifespan=10 * 10**9)


class _Registry:
    """The loggers that publish through each writer. Children count their users: each logger object is one."""

    def __init__(self) -> None:
        # Reentrant: a logger or a forgotten node may be collected, and so leave, inside any of these
        # functions.
        self.lock = threading.RLock()
        self.writers: dict[str, Writer] = {}
        self.children: dict[str, int] = {}

    def renew_locks(self) -> None:
        """Free the lock in a fork, where the nodes of the forked process publish nothing."""
        self.lock = threading.RLock()
        self.writers.clear()
        self.children.clear()

    def remove(self, writer: Writer) -> None:
        """Forget all loggers that publish through a writer."""
        with self.lock:
            for logger in [known for known, its in list(self.writers.items()) if its is writer]:
                del self.writers[logger]
                self.children.pop(logger, None)


def _here() -> _Registry:
    here = program.current()
    registry: _Registry | None = here.rosout
    if registry is None:
        registry = here.rosout = _Registry()
    return registry


def rosout_connect(node: Node, qos: QosProfile | None = None) -> Callable[[], None] | None:
    """Let the node's logger publish on /rosout; returns how to end that, None if it is switched off."""
    if not node.context.arguments.rosout_logs:
        return None
    # Imported here: a process without nodes needs no message class.
    from rcl_interfaces.msg import Log

    registry, name, graph_node = _here(), node.logger_name(), node.graph_node
    writer = registry.writers.get(name)
    if writer is not None and writer.node.participant.has_ended:  # its node only waits to be collected
        registry.remove(writer)
        writer = None
    if writer is not None:
        _warn_of_twins(name)
    else:
        writer = graph_node.create_writer(message_type(Log), ROSOUT_TOPIC, qos or _QOS)
        with registry.lock:
            registry.writers[name] = writer
    return partial(_disconnect, registry, writer)


def _disconnect(registry: _Registry, writer: Writer) -> None:
    """End a node's logger. A twin of that name ends it for both, as the warning says."""
    registry.remove(writer)
    writer.node.close_writer(writer)


def rclpy_logging_rosout_add_sublogger(logger_name: str, sublogger_name: str) -> bool:
    """Let a child of a node's logger publish too; False if the parent does not."""
    registry, full_name = _here(), cleaned_text(f"{logger_name}.{sublogger_name}")
    with registry.lock:
        writer = registry.writers.get(logger_name)
        if writer is None:
            return False
        if full_name in registry.writers and full_name not in registry.children:
            return False  # it is a separate node
        registry.writers[full_name] = writer
        registry.children[full_name] = registry.children.get(full_name, 0) + 1
    return True


def rclpy_logging_rosout_remove_sublogger(logger_name: str, sublogger_name: str) -> None:
    """Take back one `rclpy_logging_rosout_add_sublogger`."""
    registry, full_name = _here(), cleaned_text(f"{logger_name}.{sublogger_name}")
    with registry.lock:
        users = registry.children.get(full_name, 0)
        if users > 1:
            registry.children[full_name] = users - 1
        elif users == 1:
            del registry.children[full_name]
            del registry.writers[full_name]


def publish_to_rosout(
    level: int, name: str, message: str, function: str, file: str, line: int, stamp: int
) -> None:
    """Publish one message (stamp: system time [ns]) if its logger is a node's."""
    writer = _here().writers.get(name)
    if writer is None:
        return
    # Generated: imported once there is something to publish.
    from builtin_interfaces.msg import Time
    from rcl_interfaces.msg import Log

    log: Any = Log()
    log.stamp = Time(sec=stamp // 10**9, nanosec=stamp % 10**9)
    log.level, log.name, log.msg, log.function, log.file, log.line = (
        level,
        name,
        message,
        function,
        file,
        line,
    )
    writer.publish(log)


def _warn_of_twins(name: str) -> None:
    from .logging import rclpy_logging_rcutils_log  # imports this module

    rclpy_logging_rcutils_log(
        30,
        "rcl.logging_rosout",
        f"Publisher already registered for node name: '{name}'. If this is due to multiple nodes with the "
        "same name then all logs for the logger named '"
        f"{name}' will go out over the existing publisher. As soon as any node with that name is destructed "
        "it will unregister the publisher, preventing any further logs for that name from being published on "
        "the rosout topic.",
        "",
        "",
        0,
    )
