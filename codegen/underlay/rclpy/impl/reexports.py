"""Names that upstream's modules have only because they import them: programs import them from there too."""

from __future__ import annotations

import importlib
from collections.abc import Callable
from typing import Any

from rclpy.impl import distro

_WAITABLE = {"NumberOfEntities": "rclpy.waitable", "Waitable": "rclpy.waitable"}
_TYPE_CHECK = {"check_is_valid_srv_type": "rclpy.type_support"}

# The home of each name that a module passes on; `:` if it has another name there.
_HOMES: dict[str, dict[str, str]] = {
    "rclpy.action.client": {"CancelGoal": "action_msgs.srv", **_WAITABLE},
    "rclpy.action.server": _WAITABLE,
    "rclpy.executors": {
        "Client": "rclpy.client",
        "Clock": "rclpy.clock",
        "ClockType": "rclpy.clock",
        "InvalidHandle": "rclpy.exceptions",
        "Service": "rclpy.service",
        "Subscription": "rclpy.subscription",
        "ThreadPoolExecutor": "concurrent.futures",
        "Timer": "rclpy.timer",
        "timeout_sec_to_nsec": "rclpy.utilities",
        **_WAITABLE,
    },
    "rclpy.lifecycle.node": {"CallbackGroup": "rclpy.callback_groups"},
    "rclpy.logging_service": {"LoggingSeverity": "rclpy.impl.logging_severity"},
    "rclpy.node": {"ListParameters": "rcl_interfaces.srv", "ParameterMsg": "rcl_interfaces.msg:Parameter"},
    "rclpy.parameter_event_handler": {"Parameter": "rclpy.parameter"},
    "rclpy.time_source": {"SetParametersResult": "rcl_interfaces.msg"},
    "rclpy.topic_endpoint_info": {
        "QoSHistoryPolicy": "rclpy.qos",
        "QoSPresetProfiles": "rclpy.qos",
        "QoSProfile": "rclpy.qos",
        "TypeHash": "rclpy.type_hash",
    },
    "rclpy.type_description_service": {
        "GetTypeDescription": "type_description_interfaces.srv",
        "ParameterDescriptor": "rcl_interfaces.msg",
        "ParameterType": "rcl_interfaces.msg",
        "Service": "rclpy.service",
        **_TYPE_CHECK,
    },
}


def reexport(module: str) -> Callable[[str], Any]:
    """A module's `__getattr__`, which finds a name that the module passes on when somebody asks for it.

    Homes within rclpy are imported at once: programs reach those modules, too, because upstream imports them.
    Names of newer distributions are found as well (`rclpy.impl.distro`).
    """
    homes = _HOMES.get(module, {})
    for each in homes.values():
        if each.startswith("rclpy."):
            importlib.import_module(each)
    if module == "rclpy.node" and not distro.follows("old_names"):
        importlib.import_module("rclpy.topic_endpoint_info")

    def find(name: str) -> Any:
        home, _, name_at_home = (homes.get(name) or distro.home_of(module, name)).partition(":")
        if not home:
            raise AttributeError(f"module {module!r} has no attribute {name!r}")
        return getattr(importlib.import_module(home), name_at_home or name)

    return find
