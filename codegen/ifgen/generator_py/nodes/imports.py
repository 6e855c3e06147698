"""What a node's modules import, and what they call it."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable
from typing import Final

from ifgen.generator_py.scope import statements
from ifgen.nodl.model import NodeDescription

_HOME: Final = {
    "ABC": "abc",
    "abstractmethod": "abc",
    "Callable": "collections.abc",
    "ExitStack": "contextlib",
    "dataclass": "dataclasses",
    "sys": "",
    "Any": "typing",
    "rclpy": "",
    "FloatingPointRange": "rcl_interfaces.msg",
    "IntegerRange": "rcl_interfaces.msg",
    "ParameterDescriptor": "rcl_interfaces.msg",
    "SetParametersResult": "rcl_interfaces.msg",
    "ActionClient": "rclpy.action",
    "ActionServer": "rclpy.action",
    "CancelResponse": "rclpy.action",
    "GoalResponse": "rclpy.action",
    "ServerGoalHandle": "rclpy.action.server",
    "MutuallyExclusiveCallbackGroup": "rclpy.callback_groups",
    "ReentrantCallbackGroup": "rclpy.callback_groups",
    "Client": "rclpy.client",
    "Clock": "rclpy.clock",
    "ClockType": "rclpy.clock_type",
    "Duration": "rclpy.duration",
    "InvalidParameterTypeException": "rclpy.exceptions",
    "InvalidParameterValueException": "rclpy.exceptions",
    "ExternalShutdownException": "rclpy.executors",
    "MultiThreadedExecutor": "rclpy.executors",
    "LifecycleNode": "rclpy.lifecycle",
    "LifecyclePublisher": "rclpy.lifecycle",
    "LifecycleState": "rclpy.lifecycle",
    "TransitionCallbackReturn": "rclpy.lifecycle",
    "Node": "rclpy.node",
    "Parameter": "rclpy.parameter",
    "Publisher": "rclpy.publisher",
    "DurabilityPolicy": "rclpy.qos",
    "HistoryPolicy": "rclpy.qos",
    "LivelinessPolicy": "rclpy.qos",
    "QoSProfile": "rclpy.qos",
    "ReliabilityPolicy": "rclpy.qos",
    "Service": "rclpy.service",
    "Subscription": "rclpy.subscription",
    "Future": "rclpy.task",
    "Timer": "rclpy.timer",
}
_OURS: Final = {"KeyboardInterrupt", "ParametersError", "RunningGoal"}
"""Other names that modules use; those of interfaces begin with a capital letter too."""


class Imports:
    """The names that one module uses: asking for one has it imported.

    An interface's class is called as it is, or `pkg_msg_Name` where another one of the node's interfaces, or
    something that its modules need, is called so too.
    """

    def __init__(self, node: NodeDescription) -> None:
        self._package = node.package
        self._used: set[tuple[str, str, str]] = set()
        self._references = references(node)
        self._modules: dict[str, str] = {}

    def __call__(self, name: str) -> str:
        """Something of Python's or of rclpy's."""
        self._used.add((_HOME[name], name, name))
        return name

    def interface(self, type_name: str) -> str:
        """The class of an interface."""
        package, folder, name = type_name.split("/")
        self._used.add((f"{package}.{folder}", name, self._references[type_name]))
        return self._references[type_name]

    def own(self, module: str, *names: str) -> None:
        """Import from another module of the package."""
        self._used.update((f"{self._package}.{module}", name, name) for name in names)

    def function(self, path: str) -> str:
        """A function by its dotted path, with its module's name in front: others may be called as it is."""
        module, _, name = path.rpartition(".")
        parent, _, last = module.rpartition(".")
        known = self._modules.setdefault(last, module)
        reference = last if known == module and last not in _HOME else module.replace(".", "_")
        self._used.add((parent, last, reference))
        return f"{reference}.{name}"

    @property
    def lines(self) -> tuple[str, ...]:
        """The import statements, as ruff sorts them."""
        return statements(self._used, self._package)


def references(node: NodeDescription) -> dict[str, str]:
    """What the modules of a node call the classes of its interfaces, by type name."""
    types = dict.fromkeys(endpoint.type_name for endpoint in node.endpoints)
    names = Counter(type_name.rpartition("/")[2] for type_name in types)
    taken = {*_HOME, *_OURS, node.node_class, *_own_classes(node)}
    return {
        type_name: type_name.replace("/", "_") if names[name] > 1 or name in taken else name
        for type_name in types
        for name in (type_name.rpartition("/")[2],)
    }


def _own_classes(node: NodeDescription) -> Iterable[str]:
    return (f"{node.node_class}Base", f"{node.node_class}Parameters")
