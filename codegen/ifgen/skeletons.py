"""The first text of packages, interfaces and nodes: what `ifgen new` writes."""

from __future__ import annotations

from typing import Final

INTERFACES: Final[dict[str, str]] = {
    "msg": """\
# Says what the message is for, in the documentation of its class.
#
# A field is a type and a name; a comment behind it documents it, a unit in brackets first.
# Types: bool, int8..int64, uint8..uint64, float32, float64, string, `Name` of this package or `package/Name`;
# `[]`, `[<=5]` and `[5]` behind a type make sequences and arrays of it, `string<=8` bounds a text.

float64 distance 1.0   # [m] to the next obstacle; 1.0 unless somebody sets it
string label           # what the obstacle is

# A constant has an upper-case name and an `=`.
float64 DISTANCE_MAX=30.0
""",
    "srv": """\
# Says what the service does. First the fields of the request, as in a message:

float64 distance       # [m] to move

---
# Then those of the response:

bool success           # whether it could
string message         # why, or why not
""",
    "action": """\
# Says what the action does. First the fields of the goal, as in a message:

float64 distance       # [m] to move

---
# Then those of the result:

float64 moved          # [m] in the end

---
# Then those of the feedback while it goes on:

float64 remaining      # [m] still to go
""",
}
"""By their folders; each generates as it is."""

NODE: Final = """\
# The public interface of the node `{name}`, in NoDL: https://github.com/ros-tooling/nodl
# `ifgen check` looks for mistakes in it, `ifgen generate` makes a package with tests of it.
nodl_version: 2
description: Says what the node is for.

codegen:
  ifgen:
    style: callbacks          # or lifecycle, asyncio
    timers:
      - {{name: status, period_param: status_period, publishes: [~/status]}}

parameters:
  status_period:
    type: double
    default_value: 1.0
    description: Time between two status messages [s]
    validation:
      gt: 0.0

publishers:
  - name: ~/status            # ~/ is the node's own namespace: /{name}/status
    type: std_msgs/msg/String
    qos: {{history: KEEP_LAST, depth: 10, reliability: RELIABLE}}
    description: How the node is

# More lists of this kind: subscriptions, service_servers, service_clients, action_servers, action_clients.
"""

PACKAGE: Final = """\
<?xml version="1.0"?>
<package format="3">
  <name>{name}</name>
  <version>0.1.0</version>
  <description>Says what the package is for.</description>
  <maintainer email="you@example.com">Your Name</maintainer>
  <license>Apache-2.0</license>
</package>
"""
