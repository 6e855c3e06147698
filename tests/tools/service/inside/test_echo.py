"""`ifgen service echo`."""

from __future__ import annotations

import json
import threading
import time
from collections.abc import Iterator

import pytest
import rclpy
from example_interfaces.srv import AddTwoInts
from ifgen_tools.service.call import echo
from ifgen_tools.service.commands import EchoOptions
from ifgen_tools.texts.style import Style
from rclpy.node import Node
from rclpy.qos import qos_profile_services_default
from rclpy.service_introspection import ServiceIntrospectionState

from tests.cli.conftest import Run

INTROSPECTION = ServiceIntrospectionState.CONTENTS


@pytest.fixture
def calls(spinning: Node) -> Iterator[None]:
    """Calls of /add with 1 and 2, again and again, and events of the server about them."""
    [service] = [each for each in spinning.services if each.srv_name == "add"]
    service.configure_introspection(spinning.get_clock(), qos_profile_services_default, INTROSPECTION)
    client = spinning.create_client(AddTwoInts, "/add")
    timer = spinning.create_timer(0.05, lambda: client.call_async(AddTwoInts.Request(a=1, b=2)))
    yield
    timer.cancel()


@pytest.mark.usefixtures("calls")
def test_yaml(capsys: pytest.CaptureFixture[str]) -> None:
    echo(EchoOptions(name="add", type_name=None, style=Style(no_arr=True)), most=2)
    out = capsys.readouterr().out
    assert out.startswith("info:\n  event_type: RE")
    assert "  client_gid: '<array type: uint8[16]>'\n  sequence_number: " in out
    assert out.count("\n---\n") == 2
    assert "example_interfaces/srv/AddTwoInts_Request[1], length: " in out


@pytest.mark.usefixtures("calls")
def test_json_and_csv(capsys: pytest.CaptureFixture[str]) -> None:
    echo(
        EchoOptions(name="/add", type_name="example_interfaces/AddTwoInts", style=Style(), as_json=True),
        most=2,
    )
    events = [json.loads(line) for line in capsys.readouterr().out.splitlines()]
    of_kind = {event["info"]["event_type"]: event for event in events}
    assert of_kind[1]["request"] == [{"a": 1, "b": 2}]
    assert of_kind[2]["response"] == [{"sum": 3}]
    echo(EchoOptions(name="/add", type_name=None, style=Style(), csv=True), most=1)
    assert capsys.readouterr().out.split(",")[0] in {"1", "2"}


def test_nobody_publishes_yet(spinning: Node, capsys: pytest.CaptureFixture[str]) -> None:
    [service] = [each for each in spinning.services if each.srv_name == "add"]
    client = spinning.create_client(AddTwoInts, "/add")

    def begin() -> None:
        service.configure_introspection(spinning.get_clock(), qos_profile_services_default, INTROSPECTION)
        while not spinning.count_subscribers("/add/_service_event"):
            time.sleep(0.01)
        client.call_async(AddTwoInts.Request(a=1, b=2))

    threading.Timer(0.5, begin).start()
    echo(EchoOptions(name="/add", type_name=None, style=Style(), csv=True), most=1)
    said = capsys.readouterr()
    assert "nobody publishes events of '/add' yet" in said.err
    assert "configure_introspection" in said.err
    assert said.out.startswith("1,")


def test_mistakes(ifgen: Run, server: Node) -> None:
    assert rclpy.ok()
    done = ifgen("service", "echo", "/ad")
    assert (done.code, done.err.startswith("error: there is no service '/ad'\n")) == (1, True)
    done = ifgen("service", "echo", "/add", "--csv", "--json")
    assert (done.code, "--csv and --json exclude each other" in done.err) == (2, True)
