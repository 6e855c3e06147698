"""Tasks that fill a status, and what runs them and publishes the result."""

from __future__ import annotations

import threading
from collections.abc import Callable, Iterable
from typing import TYPE_CHECKING, Any, overload

from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus

from diagnostic_updater._diagnostic_status_wrapper import DiagnosticStatusWrapper

if TYPE_CHECKING:
    from rclpy.node import Node

_Fill = Callable[[DiagnosticStatusWrapper], DiagnosticStatusWrapper]
_PERIOD, _FULL_NAME = "diagnostic_updater.period", "diagnostic_updater.use_fqn"
_NS_PER_S = 10**9


class DiagnosticTask:
    """A source of one status; derived classes fill it in `run`."""

    def __init__(self, name: str) -> None:
        self.name = name

    def getName(self) -> str:
        """Return the name."""
        return self.name

    def run(self, stat: DiagnosticStatusWrapper) -> DiagnosticStatusWrapper:
        """Fill a status, and return it."""
        return stat


class FunctionDiagnosticTask(DiagnosticTask):
    """A task that a function does: it gets a status, fills it and returns it."""

    def __init__(self, name: str, fn: _Fill) -> None:
        super().__init__(name)
        self.fn = fn

    def run(self, stat: DiagnosticStatusWrapper) -> DiagnosticStatusWrapper:
        """Call the function."""
        return self.fn(stat)


class CompositeDiagnosticTask(DiagnosticTask):
    """Several tasks that fill one status: with the worst of their levels, and with all their values."""

    def __init__(self, name: str) -> None:
        super().__init__(name)
        self.tasks: list[DiagnosticTask] = []

    def addTask(self, t: DiagnosticTask) -> None:
        """Add a task."""
        self.tasks.append(t)

    def run(self, stat: DiagnosticStatusWrapper) -> DiagnosticStatusWrapper:
        """Run the tasks one after the other. Each sees the summary that came in."""
        before, merged = DiagnosticStatusWrapper(), DiagnosticStatusWrapper()
        before.summary(stat)
        for task in self.tasks:
            stat.summary(before)
            stat = _status_of(task.name, task.run(stat))
            merged.mergeSummary(stat)
        stat.summary(merged)
        return stat


class DiagnosticTaskVector:
    """Tasks by name, which any thread may add and remove."""

    class DiagnosticTaskInternal:
        """A name, and the function that fills its status."""

        def __init__(self, name: str, fn: _Fill) -> None:
            self.name = name
            self.fn = fn

        def run(self, stat: DiagnosticStatusWrapper) -> DiagnosticStatusWrapper:
            """Fill a status of this name."""
            stat.name = self.name
            return _status_of(self.name, self.fn(stat))

    def __init__(self) -> None:
        self.tasks: list[DiagnosticTaskVector.DiagnosticTaskInternal] = []
        self.lock = threading.Lock()

    def addedTaskCallback(self, task: DiagnosticTaskInternal) -> None:
        """Do what a new task asks for; derived classes override it."""

    @overload
    def add(self, task: DiagnosticTask, /) -> None: ...
    @overload
    def add(self, name: str, fn: _Fill, /) -> None: ...
    def add(self, *arguments: Any) -> None:
        """Add a task, or a name and a function that fills a status and returns it."""
        if len(arguments) == 1:
            arguments = (arguments[0].getName(), arguments[0].run)
        if len(arguments) != 2 or not callable(arguments[1]):
            raise TypeError("add() takes a DiagnosticTask, or a name and a function")
        task = self.DiagnosticTaskInternal(*arguments)
        with self.lock:
            self.tasks.append(task)
        self.addedTaskCallback(task)

    def removeByName(self, name: str) -> bool:
        """Remove the first task of this name; returns whether there was one."""
        with self.lock:
            for task in self.tasks:
                if task.name == name:
                    self.tasks.remove(task)
                    return True
        return False

    def _current(self) -> list[DiagnosticTaskInternal]:
        """The tasks at this moment: they may add others while they run."""
        with self.lock:
            return list(self.tasks)


class Updater(DiagnosticTaskVector):
    """Runs tasks with a period [s], and publishes what they say on /diagnostics.

    The parameter `diagnostic_updater.period` replaces the period. With `diagnostic_updater.use_fqn` names
    begin with the node's full name.
    """

    def __init__(self, node: Node, period: float = 1.0) -> None:
        super().__init__()
        self.node = node
        self.clock = node.get_clock()
        self.publisher = node.create_publisher(DiagnosticArray, "/diagnostics", 1)
        self.hwid = ""
        self.verbose = False
        self.warn_nohwid_done = False
        self.last_time = self.clock.now()
        self.__period = float(_parameter(node, _PERIOD, float(period)))
        self.use_fqn = bool(_parameter(node, _FULL_NAME, False))
        self.timer = node.create_timer(self.__period, self.force_update)

    @property
    def period(self) -> float:
        """The period [s]; a new one counts after the next update."""
        return self.__period

    @period.setter
    def period(self, value: float) -> None:
        self.__period = float(value)
        self.timer.timer_period_ns = int(self.__period * _NS_PER_S)

    def setHardwareID(self, hwid: str) -> None:
        """Name the device that all tasks are about: `none` if there is none."""
        self.hwid = hwid

    def update(self) -> None:
        """Update if the last update is a period ago."""
        if (self.clock.now() - self.last_time).nanoseconds >= self.__period * _NS_PER_S:
            self.force_update()

    def force_update(self) -> None:
        """Run all tasks now, and publish what they say."""
        self.last_time = self.clock.now()
        statuses = [self.__run(task) for task in self._current()]
        all_well = all(status.level == DiagnosticStatus.OK for status in statuses)
        if statuses and all_well and not self.hwid and not self.warn_nohwid_done:
            self.warn_nohwid_done = True
            self.node.get_logger().warning(
                "diagnostic_updater: the hardware has no id: call setHardwareID, with 'none' if there is none"
            )
        self.publish(statuses)

    def __run(self, task: DiagnosticTaskVector.DiagnosticTaskInternal) -> DiagnosticStatusWrapper:
        status = DiagnosticStatusWrapper(name=task.name, hardware_id=self.hwid)
        status.summary(DiagnosticStatus.ERROR, "No message was set")
        status = task.run(status)
        if self.verbose and status.level != DiagnosticStatus.OK:
            self.node.get_logger().warning(
                f"Non-zero diagnostic status. Name: '{status.name}', status {status.level[0]}: "
                f"'{status.message}'"
            )
        return status

    def broadcast(self, level: bytes, message: str) -> None:
        """Publish the same level and message for all tasks, without running them."""
        statuses: list[DiagnosticStatus] = []
        for task in self._current():
            status = DiagnosticStatusWrapper(name=task.name, hardware_id=self.hwid)
            status.summary(level, message)
            statuses.append(status)
        self.publish(statuses)

    def publish(self, status: DiagnosticStatus | Iterable[DiagnosticStatus]) -> None:
        """Publish one status, or several in one message; their names get the node's in front."""
        statuses = [status] if isinstance(status, DiagnosticStatus) else list(status)
        node = self.node.get_fully_qualified_name() if self.use_fqn else self.node.get_name()
        array: Any = DiagnosticArray()
        array.header.stamp = self.clock.now().to_msg()
        # Copies: real rclpy takes objects of no derived class.
        array.status = [
            DiagnosticStatus(
                level=each.level,
                name=f"{node}: {each.name}",
                message=each.message,
                hardware_id=each.hardware_id,
                values=each.values,
            )
            for each in statuses
        ]
        self.publisher.publish(array)

    def addedTaskCallback(self, task: DiagnosticTaskVector.DiagnosticTaskInternal) -> None:
        """Say of a new task that the node is starting."""
        status = DiagnosticStatusWrapper(name=task.name, hardware_id=self.hwid)
        status.summary(DiagnosticStatus.OK, "Node starting up")
        self.publish(status)


def _parameter(node: Node, name: str, default: Any) -> Any:
    """Declare a parameter unless it is there, as with a second updater; return its value."""
    declared = node.get_parameter(name) if node.has_parameter(name) else node.declare_parameter(name, default)
    return declared.value


def _status_of(task: str, status: object) -> DiagnosticStatusWrapper:
    """The status that a task has returned. Raises TypeError for anything else."""
    if isinstance(status, DiagnosticStatusWrapper):
        return status
    raise TypeError(f"diagnostic task '{task}' returned {status!r}: it has to return the status that it got")
