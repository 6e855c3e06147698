"""Prints the API of the rclpy that this interpreter imports, as JSON: run as a program by test_api_coverage.py.

{module: {name: description}}, with a description per kind:
class: {kind, members: {name: description}, signature}, function or method: {kind, signature}, other: {kind}.
Each of a module's own names has its `home`, too: the module that it is defined in.
A signature is a list of [name, kind, has a default], or null if Python cannot tell.
"""

from __future__ import annotations

import enum
import importlib
import inspect
import json
import re
import sys
import types
from typing import Any

MODULES = [
    "rclpy",
    "rclpy.action",
    "rclpy.action.client",
    "rclpy.action.graph",
    "rclpy.action.server",
    "rclpy.callback_groups",
    "rclpy.client",
    "rclpy.clock",
    "rclpy.clock_type",
    "rclpy.constants",
    "rclpy.context",
    "rclpy.destroyable",
    "rclpy.duration",
    "rclpy.event_handler",
    "rclpy.exceptions",
    "rclpy.executors",
    "rclpy.expand_topic_name",
    "rclpy.experimental",
    "rclpy.experimental.events_executor",
    "rclpy.guard_condition",
    "rclpy.impl",
    "rclpy.impl.implementation_singleton",
    "rclpy.impl.logging_severity",
    "rclpy.impl.rcutils_logger",
    "rclpy.lifecycle",
    "rclpy.lifecycle.managed_entity",
    "rclpy.lifecycle.node",
    "rclpy.lifecycle.publisher",
    "rclpy.logging",
    "rclpy.logging_service",
    "rclpy.node",
    "rclpy.parameter",
    "rclpy.parameter_client",
    "rclpy.parameter_event_handler",
    "rclpy.parameter_service",
    "rclpy.publisher",
    "rclpy.qos",
    "rclpy.qos_event",
    "rclpy.qos_overriding_options",
    "rclpy.serialization",
    "rclpy.service",
    "rclpy.service_introspection",
    "rclpy.signals",
    "rclpy.subscription",
    "rclpy.task",
    "rclpy.time",
    "rclpy.time_source",
    "rclpy.timer",
    "rclpy.topic_endpoint_info",
    "rclpy.topic_or_service_is_hidden",
    "rclpy.type_description_service",
    "rclpy.type_hash",
    "rclpy.type_support",
    "rclpy.utilities",
    "rclpy.validate_full_topic_name",
    "rclpy.validate_namespace",
    "rclpy.validate_node_name",
    "rclpy.validate_parameter_name",
    "rclpy.validate_topic_name",
    "rclpy.wait_for_message",
    "rclpy.waitable",
]
SEAM = "seam"  # both reach it through rclpy.impl.implementation_singleton

# Members that every class has or that belong to how C++ classes reach Python.
_IGNORED_MEMBERS = {"_pybind11_conduit_v1_"}


def main() -> None:
    """Describe the names that stdin requests ({module: [name, ...]}), or all if it is empty."""
    asked_for = json.loads(sys.stdin.read() or "{}")
    api: dict[str, Any] = {}
    for name in [*MODULES, SEAM]:
        try:
            module = importlib.import_module("rclpy.impl.implementation_singleton" if name == SEAM else name)
        except Exception as error:  # whatever the error is, the module cannot be used
            api[name] = {"missing": repr(error)}
            continue
        if name == SEAM:
            module = module.rclpy_implementation
            own = [key for key in dir(module) if not key.startswith("_")]
        else:
            own = [key for key, value in vars(module).items() if is_api(key, value, name)]
        found = {key: getattr(module, key, None) for key in asked_for.get(name, own)}
        api[name] = {
            key: describe(value, top=bool(asked_for) or not is_lent(value, name))
            | {"home": str(getattr(value, "__module__", ""))}
            for key, value in found.items()
            if value is not None
        }
    json.dump(api, sys.stdout)


def is_api(name: str, value: Any, module: str) -> bool:
    """Whether a module's name is for users: not private, not an imported module, not of Python's library."""
    if name.startswith("_") or isinstance(value, (types.ModuleType, types.GenericAlias)):
        return False
    home = getattr(value, "__module__", None)
    if inspect.isclass(value) or inspect.isroutine(value):
        return home == module or str(home).startswith("rclpy") or is_lent(value, module)
    if isinstance(value, enum.Enum):
        return False
    return home is None or not str(home).startswith(("typing", "collections", "__future__", "enum"))


def is_lent(value: Any, module: str) -> bool:
    """Whether a class or function comes from another module of rclpy or from a message package."""
    home = str(getattr(value, "__module__", None))
    return (
        home != module
        and home.partition(".")[0].endswith(("rclpy", "_msgs", "_interfaces"))
        and module != "rclpy"
    )


def describe(value: Any, *, top: bool = False) -> dict[str, Any]:
    """Describe one thing."""
    if inspect.isclass(value):
        # A property of one may be a plain attribute of the other.
        members = {name: {"kind": "data"} for name in assigned_attributes(value)} | {
            name: describe(member)
            for base in reversed(value.__mro__)
            if base is not object
            for name, member in vars(base).items()
            if not name.startswith("_") and name not in _IGNORED_MEMBERS
        }
        return {"kind": "class", "members": members if top else {}, "signature": signature(value)}
    if isinstance(value, property) or inspect.isdatadescriptor(value):
        return {"kind": "data"}
    if isinstance(value, (staticmethod, classmethod)):
        return {"kind": "function", "signature": signature(value.__func__)}
    if callable(value):
        return {"kind": "function", "signature": signature(value)}
    return {"kind": "data"}


def assigned_attributes(value: type) -> list[str]:
    """Return the public names that the code of a class and its private bases assigns on `self`."""
    private = [base for base in value.__bases__ if base.__name__.startswith("_Base")]
    try:
        text = "".join(inspect.getsource(each) for each in (value, *private))
        names = re.findall(r"self\.(\w+)\b[^=\n]* = ", text)
    except (OSError, TypeError):
        return []
    return [name for name in names if not name.startswith("_")]


def signature(value: Any) -> list[list[Any]] | None:
    """Describe the arguments of a callable."""
    if inspect.isclass(value) and value.__init__ is object.__init__ and value.__new__ is object.__new__:
        return None
    try:
        parameters = inspect.signature(value).parameters.values()
    except (TypeError, ValueError):
        return None
    return [[each.name, int(each.kind), each.default is not each.empty] for each in parameters]


if __name__ == "__main__":
    main()
