"""`ifgen service list`, `type`, `find` and `info`."""

from __future__ import annotations

import json

import rclpy
from example_interfaces.srv import AddTwoInts
from rclpy.node import Node
from std_srvs.srv import SetBool

from tests.cli.conftest import Run

ADD = "example_interfaces/srv/AddTwoInts"
DESCRIBE = "/adder/get_type_description"


def test_list(ifgen: Run, server: Node) -> None:
    assert ifgen("service", "list").out == f"/add\n{DESCRIBE}\n"
    assert f"/add [{ADD}]\n" in ifgen("service", "list", "-t").out
    assert ifgen("service", "list", "--include-hidden-services").out == f"/_secret\n/add\n{DESCRIBE}\n"
    assert ifgen("service", "--include-hidden-services", "list", "--count-services").out == "3\n"
    assert {"name": "/add", "types": [ADD]} in json.loads(ifgen("service", "list", "--json").out)


def test_type(ifgen: Run, server: Node) -> None:
    assert ifgen("service", "type", "/add").out == f"{ADD}\n"
    assert ifgen("service", "type", "add", "--json").out == f'["{ADD}"]\n'


def test_find(ifgen: Run, server: Node) -> None:
    assert ifgen("service", "find", ADD).out == "/add\n"
    assert ifgen("service", "find", "example_interfaces/AddTwoInts", "-c").out == "1\n"
    assert ifgen("service", "find", "std_srvs/srv/SetBool").out == ""
    assert ifgen("service", "find", "std_srvs/srv/SetBool", "--include-hidden-services").out == "/_secret\n"
    assert json.loads(ifgen("service", "find", ADD, "--json").out) == [{"name": "/add", "types": [ADD]}]


def test_info(ifgen: Run, server: Node) -> None:
    client = rclpy.create_node("caller", namespace="lab")
    client.create_client(AddTwoInts, "/add")
    assert ifgen("service", "info", "/add").out == f"Type: {ADD}\nClients count: 1\nServices count: 1\n"
    assert ifgen("service", "info", "/add", "-v").out == (
        f"Type: {ADD}\nClients count: 1\n    /lab/caller\nServices count: 1\n    /adder\n"
    )
    found = json.loads(ifgen("service", "info", "/add", "--json").out)
    assert (found["clients"], found["client_nodes"], found["server_nodes"]) == (
        1,
        ["/lab/caller"],
        ["/adder"],
    )
    client.destroy_node()


def test_two_types(ifgen: Run, server: Node) -> None:
    """As in ROS, which prints a list of Python."""
    client = rclpy.create_node("caller", context=rclpy.get_default_context())
    other = rclpy.Context()
    rclpy.init(args=[], context=other)
    elsewhere = rclpy.create_node("elsewhere", context=other)
    elsewhere.create_client(SetBool, "/add")
    assert ifgen("service", "info", "/add").out.startswith(f"Type: ['{ADD}', 'std_srvs/srv/SetBool']\n")
    assert ifgen("service", "type", "/add").out == f"{ADD}\nstd_srvs/srv/SetBool\n"
    elsewhere.destroy_node()
    other.shutdown()
    client.destroy_node()


def test_unknown_service(ifgen: Run, server: Node) -> None:
    for verb in ("type", "info"):
        done = ifgen("service", verb, "/ad")
        assert (done.code, done.out) == (1, "")
        assert done.err == "error: there is no service '/ad'\n  = help: did you mean '/add'?\n"
