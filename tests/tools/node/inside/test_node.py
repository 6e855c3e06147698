"""`ifgen node list` and `info`."""

from __future__ import annotations

import json

import pytest
import rclpy
from ifgen_tools.node import show
from rclpy.node import Node

from tests.cli.conftest import Run

INFO = """/lab/robot
  Subscribers:
    /heard: std_msgs/msg/String
  Publishers:
    /lab/chatter: std_msgs/msg/String
    /parameter_events: rcl_interfaces/msg/ParameterEvent
  Service Servers:
    /lab/add: example_interfaces/srv/AddTwoInts
    /lab/robot/get_type_description: type_description_interfaces/srv/GetTypeDescription
  Service Clients:
    /other_add: example_interfaces/srv/AddTwoInts
  Action Servers:
    /lab/count: example_interfaces/action/Fibonacci
  Action Clients:
    /other_count: example_interfaces/action/Fibonacci
"""


def test_list(ifgen: Run, robot: Node) -> None:
    hidden = rclpy.create_node("_hidden")
    assert ifgen("node", "list").out == "/lab/robot\n"
    assert ifgen("node", "list", "--all").out == "/_hidden\n/lab/robot\n"
    assert ifgen("node", "list", "-a", "--count-nodes", "--no-daemon").out == "2\n"
    assert json.loads(ifgen("node", "list", "--json", "--spin-time", "0.1").out) == ["/lab/robot"]
    hidden.destroy_node()


def test_two_of_one_name(ifgen: Run, robot: Node) -> None:
    twin = rclpy.create_node("robot", namespace="lab")
    done = ifgen("node", "list")
    assert done.out == "/lab/robot\n/lab/robot\n"
    assert done.err == "warning: more than one node is called /lab/robot\n"
    assert "2 nodes are called /lab/robot" in ifgen("node", "info", "/lab/robot").err
    twin.destroy_node()


def test_info(ifgen: Run, robot: Node) -> None:
    assert ifgen("node", "info", "/lab/robot").out == INFO
    assert ifgen("node", "info", "lab/robot").out == INFO
    hidden = ifgen("node", "info", "/lab/robot", "--include-hidden").out
    assert "    /lab/_secret: std_msgs/msg/String\n" in hidden
    assert "    /lab/count/_action/send_goal: example_interfaces/action/Fibonacci_SendGoal\n" in hidden


def test_empty_lists_leave_an_empty_line(ifgen: Run, robot: Node) -> None:
    """As in ROS."""
    idle = rclpy.create_node("idle", enable_rosout=False)
    assert ifgen("node", "info", "/idle").out.endswith("  Action Servers:\n\n  Action Clients:\n\n")
    idle.destroy_node()


def test_json(ifgen: Run, robot: Node) -> None:
    found = json.loads(ifgen("node", "info", "/lab/robot", "--json").out)
    assert found["name"] == "/lab/robot"
    assert found["subscribers"] == [{"name": "/heard", "types": ["std_msgs/msg/String"]}]
    assert found["action_clients"] == [
        {"name": "/other_count", "types": ["example_interfaces/action/Fibonacci"]}
    ]


def test_unknown_node(ifgen: Run, robot: Node) -> None:
    done = ifgen("node", "info", "/lab/robo")
    assert (done.code, done.out) == (1, "")
    assert done.err == "error: there is no node '/lab/robo'\n  = help: did you mean '/lab/robot'?\n"
    assert "see `ifgen node list`" in ifgen("node", "info", "zzz").err


def test_a_node_that_goes_meanwhile(ifgen: Run, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(show, "find_node", lambda *_: "/gone")
    assert "the node '/gone' has just gone" in ifgen("node", "info", "/gone").err
