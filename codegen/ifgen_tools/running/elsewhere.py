"""Nodes of other processes: on the other transport, and those that programs here reach."""

from __future__ import annotations

import json
import os
import subprocess
import sys

from ifgen.activation import reason_against_domain
from ifgen_runtime import domains
from ifgen_runtime.domains import neighbours

_TIME_LIMIT = 30.0  # [s]
_PREFIX = "rmw_local: "

# A separate process, because importing an rclpy fixes the transport of this one.
_LOOK = """
import ifgen
ifgen.activate("local")
import json, os, sys, time
import rclpy
from rmw_local.graph import range_is_off
from rmw_local.transports.doorbell import IS_POSSIBLE
from rmw_local.transports.environment import read
if range_is_off():
    print(json.dumps(None))
    sys.exit()
rclpy.init(args=[])
node = rclpy.create_node("_ifgen_doctor", start_parameter_services=False, enable_rosout=False)
time.sleep(0.5)  # for those that answer
reach = read({name: value for name, value in os.environ.items() if name != "ZENOH_CONFIG_OVERRIDE"})
where = "of this user on this machine" if IS_POSSIBLE else "in this process: there are no Unix sockets here"
if reach.config_file:
    where = f"that {reach.config_file} reaches"
elif reach.routers:
    where = f"at the router {' or '.join(reach.routers)}"
elif reach.subnet:
    where = "of this user on this machine, and those that multicast reaches"
print(json.dumps([where, node.context.get_domain_id(), len(node.get_node_names()) - 1]))
"""


def usable_environment() -> dict[str, str]:
    """The environment without a ROS_DOMAIN_ID that no program can start with."""
    is_wrong = bool(reason_against_domain("rclpy"))
    return {name: text for name, text in os.environ.items() if not (is_wrong and name == "ROS_DOMAIN_ID")}


def tell(transport: str) -> None:
    """Say on stderr how many nodes run on the other transport, if there are some, and none on this one."""
    domain = domains.of_environment()
    if neighbours.is_elsewhere_only(transport, domain):
        print(f"note: {neighbours.on_other(transport, domain)}", file=sys.stderr, flush=True)


def look() -> tuple[str, str | None]:
    """Say which processes are reached and how many nodes are there, and why that is not more."""
    try:
        asked = subprocess.run(
            [sys.executable, "-c", _LOOK],
            env=usable_environment(),
            capture_output=True,
            text=True,
            timeout=_TIME_LIMIT,
            check=False,
        )
    except subprocess.TimeoutExpired:
        return "not reached", f"a node that looks for others was not made within {_TIME_LIMIT:.0f} s"
    complaints = [
        line.removeprefix(_PREFIX) for line in asked.stderr.splitlines() if line.startswith(_PREFIX)
    ]
    advice = "; ".join(dict.fromkeys(complaints)) or None
    if asked.returncode:
        return "not reached", advice or asked.stderr.strip().rpartition("\n")[2]
    answer: tuple[str, int, int] | None = json.loads(asked.stdout)
    if answer is None:
        return "not reached: ROS_AUTOMATIC_DISCOVERY_RANGE is OFF", None
    where, domain, nodes = answer
    return f"those {where}, in domain {domain}: {nodes or 'no'} node{'' if nodes == 1 else 's'} now", advice
