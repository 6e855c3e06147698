"""The imports of a node's modules, and their names there."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable
from typing import Final

from ifgen.generator_py.imports import IN_NODES, Names
from ifgen.nodl.model import BaseClass, NodeDescription

TAKEN: Final = {
    *IN_NODES,
    *("Any", "Clock", "ClockType", "ExitStack", "ExternalShutdownException", "LifecycleState"),
    *("InvalidParameterTypeException", "InvalidParameterValueException", "KeyboardInterrupt"),
    *("MultiThreadedExecutor", "MutuallyExclusiveCallbackGroup", "ParametersError", "ReentrantCallbackGroup"),
    *("RunningGoal", "SetParametersResult", "TransitionCallbackReturn"),
    *("abstractmethod", "dataclass", "rclpy", "sys"),
}
"""Names that modules of nodes have a use for: those that are asked for, and those that templates write."""


class Imports(Names):
    """The names that one module of a node uses.

    The name of an interface's class is its own, or `pkg_msg_Name` if another of the node's interfaces, or a
    name that its modules need, is the same.
    """

    def __init__(self, node: NodeDescription) -> None:
        super().__init__(IN_NODES, node.package)
        self._references = references(node)
        self._modules: dict[str, str] = {}

    def interface(self, type_name: str) -> str:
        """The class of an interface."""
        package, folder, name = type_name.split("/")
        self.add(f"{package}.{folder}", name, self._references[type_name])
        return self._references[type_name]

    def base(self, base: BaseClass) -> str:
        """The class to derive from, with its module's name in front: others may share its own."""
        reference = f"{base.module.replace('.', '_')}_{base.name}"
        self.add(base.module, base.name, reference)
        return reference

    def own(self, module: str, name: str) -> str:
        """A name of another module of the package."""
        self.add(f"{self._own_package}.{module}", name)
        return name

    def function(self, path: str) -> str:
        """A function by its dotted path, with its module's name in front, since others may share its name."""
        module, _, name = path.rpartition(".")
        parent, _, last = module.rpartition(".")
        known = self._modules.setdefault(last, module)
        reference = last if known == module and last not in TAKEN else module.replace(".", "_")
        self.add(parent, last, reference)
        return f"{reference}.{name}"


def references(node: NodeDescription) -> dict[str, str]:
    """The names of interface classes in the modules of a node, by type name."""
    types = dict.fromkeys(endpoint.type_name for endpoint in node.endpoints)
    names = Counter(type_name.rpartition("/")[2] for type_name in types)
    taken = {*TAKEN, node.node_class, *_own_classes(node)}
    return {
        type_name: type_name.replace("/", "_") if names[name] > 1 or name in taken else name
        for type_name in types
        for name in (type_name.rpartition("/")[2],)
    }


def _own_classes(node: NodeDescription) -> Iterable[str]:
    return (f"{node.node_class}Base", f"{node.node_class}Parameters")
