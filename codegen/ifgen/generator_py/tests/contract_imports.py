"""What a module of tests of a node imports."""

from __future__ import annotations

from collections.abc import Iterator
from sys import stdlib_module_names
from typing import Final

from ifgen.generator_py.imports import statements
from ifgen.generator_py.tests.context import NodeTests

HOME: Final = {
    "GoalStatus": "action_msgs.msg",
    "array": "array",
    "Callable": "collections.abc",
    "Iterator": "collections.abc",
    "suppress": "contextlib",
    "deepcopy": "copy",
    "dataclass": "dataclasses",
    "partial": "functools",
    "find_spec": "importlib.util",
    "pairwise": "itertools",
    "attrgetter": "operator",
    "os": "",
    "Path": "pathlib",
    "re": "",
    "tempfile": "",
    "time": "",
    "Any": "typing",
    "TypeAlias": "typing",
    "HealthCheck": "hypothesis",
    "Phase": "hypothesis",
    "configuration": "hypothesis",
    "given": "hypothesis",
    "settings": "hypothesis",
    "Transition": "lifecycle_msgs.msg",
    "ChangeState": "lifecycle_msgs.srv",
    "GetState": "lifecycle_msgs.srv",
    "SetParametersAtomically": "rcl_interfaces.srv",
    "ActionClient": "rclpy.action",
    "CancelResponse": "rclpy.action",
    "GoalResponse": "rclpy.action",
    "get_action_client_names_and_types_by_node": "rclpy.action",
    "get_action_server_names_and_types_by_node": "rclpy.action",
    "Duration": "rclpy.duration",
    "Parameter": "rclpy.parameter",
    "DurabilityPolicy": "rclpy.qos",
    "HistoryPolicy": "rclpy.qos",
    "LivelinessPolicy": "rclpy.qos",
    "QoSProfile": "rclpy.qos",
    "ReliabilityPolicy": "rclpy.qos",
    "Future": "rclpy.task",
}
# What the module calls its own.
OWN: Final = {
    "NodeBase",
    "Topic",
    "ServiceCase",
    "ActionCase",
    "ParameterCase",
    "TimerCase",
    "Goals",
    "Strategy",
}


class TestImports:
    """The names that the module uses, and where they come from."""

    def __init__(self) -> None:
        self._used: set[tuple[str, str, str]] = set()

    def __call__(self, *names: str) -> str:
        """Import something of Python's, hypothesis' or rclpy's; returns the last name."""
        self._used.update((HOME[name], name, name) for name in names)
        return names[-1]

    def add(self, module: str, name: str, spelling: str) -> None:
        """Import a name of another module, as `spelling`."""
        self._used.add((module, name, spelling))

    def statements(self, *, standard: bool) -> tuple[str, ...]:
        """The import statements of the standard library, or the others."""
        return statements(
            (module, name, spelling)
            for module, name, spelling in self._used
            if ((module or name).partition(".")[0] in stdlib_module_names) == standard
        )


def names_used(tests: NodeTests) -> Iterator[tuple[object, tuple[str, ...]]]:
    """What the templates of tests use, behind what it depends on."""
    topics = tests.publishers or tests.subscriptions
    services = tests.services or tests.clients
    actions = tests.action_servers or tests.action_clients
    yield True, ("Any", "Parameter")
    yield tests.profiles, ("Duration",)
    yield tests.profiles or tests.asked_services, ("QoSProfile",)
    yield tests.strategies, ("HealthCheck", "Phase", "configuration", "settings")
    yield tests.strategies, ("Iterator", "Path", "TypeAlias", "os", "tempfile")
    yield topics or services, ("Callable", "dataclass")
    yield tests.exercises_topics and topics, ("given", "partial")
    yield tests.exercises_services and services, ("given",)
    yield actions, ("Callable", "dataclass")
    yield tests.action_servers, ("get_action_server_names_and_types_by_node",)
    yield tests.action_clients, ("get_action_client_names_and_types_by_node",)
    if tests.exercises_actions:
        yield actions, ("CancelResponse", "Future", "GoalResponse", "GoalStatus", "given")
        yield tests.action_servers, ("ActionClient",)
    yield tests.parameters, ("SetParametersAtomically", "array", "attrgetter", "dataclass", "re")
    yield tests.timers, ("Callable", "QoSProfile", "dataclass", "find_spec", "pairwise", "partial", "time")
    yield tests.notes, ("deepcopy", "suppress")
    yield tests.accepts_goals, ("GoalResponse",)
    yield tests.is_managed, ("ChangeState", "Transition")
    yield tests.has_lifecycle, ("GetState",)
    yield tests.has_lifecycle and tests.publishers, ("partial",)
