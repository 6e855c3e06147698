"""Nodes of this machine that run on the other transport, and an environment in which programs can start."""

from __future__ import annotations

import os
import sys

from ifgen.activation import reason_against_domain
from ifgen_runtime import domains
from ifgen_runtime.domains import neighbours


def usable_environment() -> dict[str, str]:
    """The environment without a ROS_DOMAIN_ID that no program can start with."""
    is_wrong = bool(reason_against_domain("rclpy"))
    return {name: text for name, text in os.environ.items() if not (is_wrong and name == "ROS_DOMAIN_ID")}


def tell(transport: str) -> None:
    """Say on stderr how many nodes run on the other transport, if there are some, and none on this one."""
    domain = domains.of_environment()
    if neighbours.is_elsewhere_only(transport, domain):
        print(f"note: {neighbours.on_other(transport, domain)}", file=sys.stderr, flush=True)
