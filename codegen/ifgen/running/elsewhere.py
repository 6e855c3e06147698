"""The ROS domain of this environment, and a note on nodes of it that run on the other transport."""

from __future__ import annotations

import os
import sys
from importlib import import_module
from typing import Any, Final

# By name: the toolkit imports nothing of the runtime.

_LAST_OF_DDS: Final = 232


def reason_against_domain(transport: str) -> str:
    """The reason why no program can start with ROS_DOMAIN_ID on a transport; empty if it can."""
    domain_id: Any = import_module("ifgen_runtime.domain_id")
    text = os.environ.get("ROS_DOMAIN_ID")
    try:
        number: int = domain_id.of_environment()
    except ValueError:
        return f"ROS_DOMAIN_ID is {text!r}, expected a whole number, such as ROS_DOMAIN_ID=5"
    is_dds = transport == "rclpy" and "zenoh" not in os.environ.get("RMW_IMPLEMENTATION", "")
    if is_dds and number > _LAST_OF_DDS:
        return f"ROS_DOMAIN_ID is {text!r}, and the domains of DDS are 0 to {_LAST_OF_DDS}"
    return ""


def usable_environment() -> dict[str, str]:
    """The environment without a ROS_DOMAIN_ID that no program can start with."""
    is_wrong = bool(reason_against_domain("rclpy"))
    return {name: text for name, text in os.environ.items() if not (is_wrong and name == "ROS_DOMAIN_ID")}


def everywhere() -> str:
    """Say how many nodes run on this machine, on which transport and in which domain; empty if none do."""
    text: str = import_module("ifgen_runtime.neighbours").everywhere()
    return text


def tell(transport: str) -> None:
    """Say on stderr how many nodes run on the other transport, if there are some, and none on this one."""
    neighbours: Any = import_module("ifgen_runtime.neighbours")
    domain: int = import_module("ifgen_runtime.domain_id").of_environment()
    if neighbours.is_elsewhere_only(transport, domain):
        print(f"note: {neighbours.on_other(transport, domain)}", file=sys.stderr, flush=True)
