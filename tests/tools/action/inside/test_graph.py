"""`ifgen action list`, `type`, `find` and `info`."""

from __future__ import annotations

import json

import pytest

from tests.cli.conftest import Run

TYPE = "example_interfaces/action/Fibonacci"
pytestmark = pytest.mark.usefixtures("counter")


def test_list(ifgen: Run) -> None:
    assert ifgen("action", "list").out == "/count\n"
    assert ifgen("action", "list", "-t").out == f"/count [{TYPE}]\n"
    assert ifgen("action", "list", "--count-actions").out == "1\n"
    assert json.loads(ifgen("action", "list", "--json").out) == [{"name": "/count", "types": [TYPE]}]


def test_type(ifgen: Run) -> None:
    assert ifgen("action", "type", "/count").out == f"{TYPE}\n"
    assert ifgen("action", "type", "count", "--json").out == f'["{TYPE}"]\n'


def test_find(ifgen: Run) -> None:
    assert ifgen("action", "find", TYPE).out == "/count\n"
    assert ifgen("action", "find", "example_interfaces/Fibonacci", "-c").out == "1\n"
    assert ifgen("action", "find", "test_msgs/action/Fibonacci", "--json").out == "[]\n"


def test_info(ifgen: Run) -> None:
    assert ifgen("action", "info", "/count").out == (
        "Action: /count\nAction clients: 1\n    /counter\nAction servers: 1\n    /counter\n"
    )
    assert f"    /counter [{TYPE}]\n" in ifgen("action", "info", "/count", "-t").out
    assert ifgen("action", "info", "/count", "--count").out == (
        "Action: /count\nAction clients: 1\nAction servers: 1\n"
    )
    found = json.loads(ifgen("action", "info", "/count", "--json").out)
    has = [{"name": "/counter", "types": [TYPE]}]
    assert found == {"name": "/count", "clients": has, "servers": has}


def test_unknown_action(ifgen: Run) -> None:
    for verb in ("type", "info"):
        done = ifgen("action", verb, "/coun")
        assert (done.code, done.out) == (1, "")
        assert done.err == "error: there is no action '/coun'\n  = help: did you mean '/count'?\n"
