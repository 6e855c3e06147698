"""The first text of packages, interfaces, nodes and projects: what `ifgen new` and `ifgen init` write."""

from __future__ import annotations

from typing import Final

INTERFACES: Final[dict[str, str]] = {
    "msg": """\
# Says what the message is for, in the documentation of its class.
#
# A field is a type and a name. A comment beside it documents it, and may name its unit in brackets.
# Types: bool, int8..int64, uint8..uint64, float32, float64, string, `Name` of this package or `package/Name`;
# `[]`, `[<=5]` and `[5]` after a type make sequences and arrays of it, `string<=8` bounds a text.

float64 distance 1.0   # to the next obstacle [m]; 1.0 unless somebody sets it
string label           # what the obstacle is

# A constant has an upper-case name and an `=`.
float64 DISTANCE_MAX=30.0   # how far the sensor sees [m]
""",
    "srv": """\
# Says what the service does. First the fields of the request, as in a message:

float64 distance       # to move [m]

---
# Then those of the response:

bool success           # whether it could
string message         # why, or why not
""",
    "action": """\
# Says what the action does. First the fields of the goal, as in a message:

float64 distance       # to move [m]

---
# Then those of the result:

float64 moved          # in the end [m]

---
# Then those of the feedback while it goes on:

float64 remaining      # still to go [m]
""",
}
"""By their folders. Each is valid as it is."""

"""The address of the schema for editors: the output of `ifgen nodl schema`."""

NODE: Final = """\
# yaml-language-server: $schema={schema}
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

NODE_PACKAGE: Final = """\
<?xml version="1.0"?>
<package format="3">
  <name>{name}</name>
  <version>0.1.0</version>
  <description>Says what the package is for.</description>
  <maintainer email="you@example.com">Your Name</maintainer>
  <license>Apache-2.0</license>
</package>
"""
"""Colcon builds the package that is generated for the nodes, and not this one."""

INTERFACE_PACKAGE: Final = """\
<?xml version="1.0"?>
<package format="3">
  <name>{name}</name>
  <version>0.1.0</version>
  <description>Says what the package is for.</description>
  <maintainer email="you@example.com">Your Name</maintainer>
  <license>Apache-2.0</license>

  <buildtool_depend>ament_cmake</buildtool_depend>
  <buildtool_depend>rosidl_default_generators</buildtool_depend>
  <!-- <depend>std_msgs</depend>, and so for each package whose types are used; for actions action_msgs. -->
  <exec_depend>rosidl_default_runtime</exec_depend>
  <member_of_group>rosidl_interface_packages</member_of_group>

  <export>
    <build_type>ament_cmake</build_type>
  </export>
</package>
"""

INTERFACE_CMAKE: Final = """\
# How colcon builds the package for the other languages of ROS. ifgen reads the list of interfaces in it.
cmake_minimum_required(VERSION 3.12)
project({name})

find_package(ament_cmake REQUIRED)
find_package(rosidl_default_generators REQUIRED)
# find_package(std_msgs REQUIRED), and so for each package whose types are used; see DEPENDENCIES below.

file(GLOB interfaces RELATIVE ${{CMAKE_CURRENT_SOURCE_DIR}} CONFIGURE_DEPENDS
  msg/*.msg srv/*.srv action/*.action msg/*.idl srv/*.idl action/*.idl)
rosidl_generate_interfaces(${{PROJECT_NAME}} ${{interfaces}}
  # DEPENDENCIES std_msgs
)

ament_export_dependencies(rosidl_default_runtime)
ament_package()
"""

REPOSITORY: Final = "https://github.com/ifgen-ros/ifgen"

ATTRIBUTES: Final[dict[str, str]] = {
    "{}/**": "text=auto eol=lf linguist-generated",
    "{}/*/*/[!_]*.py": "-linguist-generated",
}
"""Attributes for git of files in the output folder: their line ends, and which of them need no review."""

WORKFLOW: Final = """\
# Interfaces and descriptions of nodes are right, what is generated is up to date, and its tests pass.
name: ifgen
on:
  push:
  pull_request:
permissions:
  contents: read
jobs:
  ifgen:
    runs-on: ubuntu-latest
    steps:
      - uses: actions/checkout@v4
      - uses: ifgen-ros/ifgen@{revision}
{inputs}"""
"""For GitHub; `inputs` are the lines of a `with`, or nothing."""
