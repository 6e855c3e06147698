"""`ifgen service call`."""

from __future__ import annotations

import io
import json
import os
import signal
import sys
import threading
from typing import Any

import pytest
import rclpy
from ifgen.command_kit.tool import ToolError
from ifgen.dynamic import class_from_text
from ifgen_tools.calling import answer, class_on_the_wire
from ifgen_tools.session import open_session
from rclpy.node import Node
from std_srvs.srv import SetBool

from tests.cli.conftest import Run

ADD = "example_interfaces/srv/AddTwoInts"


def test_request_and_response(ifgen: Run, spinning: Node) -> None:
    done = ifgen("service", "call", "/add", ADD, "{a: 41, b: 1}")
    assert (done.code, done.err) == (0, "")
    assert done.out == (
        "requester: making request: example_interfaces.srv.AddTwoInts_Request(a=41, b=1)\n\n"
        "response:\nexample_interfaces.srv.AddTwoInts_Response(sum=42)\n\n"
    )


def test_missing_values_and_short_names(ifgen: Run, spinning: Node) -> None:
    assert (
        "AddTwoInts_Response(sum=2)"
        in ifgen("service", "call", "add", "example_interfaces/AddTwoInts", "b: 2").out
    )
    assert "AddTwoInts_Response(sum=0)" in ifgen("service", "call", "add", ADD).out


def test_json_and_stdin(ifgen: Run, spinning: Node, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sys, "stdin", io.StringIO("a: 3\nb: 4\n"))
    out = ifgen("service", "call", "/add", ADD, "--stdin", "--json").out
    assert json.loads(out) == {"request": {"a": 3, "b": 4}, "response": {"sum": 7}}
    done = ifgen("service", "call", "/add", ADD, "{}", "--stdin")
    assert (done.code, "--stdin and values exclude each other" in done.err) == (2, True)


def test_rate_until_it_is_interrupted(ifgen: Run, spinning: Node) -> None:
    threading.Timer(1.0, os.kill, (os.getpid(), signal.SIGINT)).start()
    done = ifgen("service", "call", "/add", ADD, "-r", "20", "--json")
    assert done.code == 2  # the number of the signal, as in ROS
    assert len(done.out.splitlines()) > 2
    assert ifgen("service", "call", "/add", ADD, "-r", "0").code == 2


def test_a_type_that_nobody_generated(ifgen: Run, spinning: Node) -> None:
    """The server describes it; it has another definition than what is installed here, too."""
    scale = class_from_text("nobody_msgs/srv/Scale", "float64 x 0.1\nfloat64[] by\n---\nfloat64 y\n")

    def answer(request, response):  # type: ignore[no-untyped-def]
        response.y = request.x * sum(request.by)
        return response

    spinning.create_service(scale, "scale", answer)
    out = ifgen("service", "call", "/scale", "nobody_msgs/srv/Scale", "by: [2, 3]", "--json").out
    assert json.loads(out) == {"request": {"x": 0.1, "by": [2.0, 3.0]}, "response": {"y": 0.5}}
    other = class_from_text("std_srvs/srv/SetBool", "float64 x 0.1\n---\nfloat64 y\n")
    spinning.create_service(other, "other", lambda _, response: response)
    assert ifgen("service", "call", "/other", "std_srvs/srv/SetBool", "--json").out == (
        '{"request": {"x": 0.1}, "response": {"y": 0.0}}\n'
    )


@pytest.mark.parametrize(
    ("values", "said"),
    [
        ("{a: 1, c: 2}", "has no field 'c'"),
        ("{a: 0.5}", "the value of 'a': expected an integer (int64), got 0.5"),
        ("{a: 1", "the values of the request are no YAML"),
    ],
)
def test_wrong_values(ifgen: Run, server: Node, values: str, said: str) -> None:
    done = ifgen("service", "call", "/missing", ADD, values)  # nobody is waited for
    assert (done.code, done.out, said in done.err) == (1, "", True)


def test_wrong_types(ifgen: Run, server: Node) -> None:
    done = ifgen("service", "call", "/add", "std_srvs/srv/SetBool")
    assert done.code == 1
    assert f"the service '/add' has the type {ADD}, not std_srvs/srv/SetBool" in done.err
    done = ifgen("service", "call", "/add", "std_msgs/msg/Bool")
    assert (done.code, "names no service" in done.err) == (1, True)


@pytest.mark.usefixtures("server", "interrupted_wait")
def test_nobody_serves_it(ifgen: Run) -> None:
    done = ifgen("service", "call", "/ad", ADD)
    assert done.code == 2
    assert done.err == "waiting for the service '/ad'... did you mean '/add'?\n"


def test_a_server_that_comes_later(ifgen: Run, spinning: Node) -> None:
    create = (SetBool, "later", lambda _, response: response)
    threading.Timer(0.5, spinning.create_service, create).start()
    done = ifgen("service", "call", "/later", "std_srvs/srv/SetBool", "--json")
    assert (done.code, json.loads(done.out)["response"]["success"]) == (0, False)


def test_a_server_that_goes_away(ifgen: Run, server: Node) -> None:
    """It never answers, because nobody spins it."""
    threading.Timer(0.5, server.destroy_node).start()
    done = ifgen("service", "call", "/add", ADD)
    assert done.code == 1
    assert done.err == "error: the server of the service '/add' has gone before it answered\n"


def test_a_server_that_says_nothing_of_another_definition(server: Node) -> None:
    """It does not spin, so nobody describes what it has."""
    other = class_from_text("std_srvs/srv/SetBool", "bool data\n---\nbool success\n")
    server.create_service(other, "switch", lambda _, response: response)
    with open_session("local") as session, pytest.raises(ToolError) as raised:
        class_on_the_wire(session, "service", "/switch", SetBool, timeout=0.2)
    assert raised.value.message.startswith("the server has another definition than this process; ")
    assert raised.value.help == "generate or install its package here"


def test_a_call_that_fails(server: Node) -> None:
    future: Any = rclpy.Future()
    future.set_exception(ValueError("no such thing"))
    with (
        open_session("local") as session,
        pytest.raises(ToolError, match="the service 'x' has failed: no such"),
    ):
        answer(session, future, lambda: True, "service 'x'")
