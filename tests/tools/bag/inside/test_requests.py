"""`ifgen bag play --publish-service-requests`, beside a server of the same process."""

from __future__ import annotations

import threading
from collections.abc import Callable, Generator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any

import ifgen.dynamic
import pytest
import rclpy
from example_interfaces.srv import AddTwoInts
from ifgen_runtime.bag import Recorder
from rclpy.executors import ExternalShutdownException, SingleThreadedExecutor
from rmw_local.virtual_time import virtual_time

from tests.cli.conftest import Outcome, Run

START = 1_700_000_000_000_000_000
SENT, RECEIVED, ANSWERED = 0, 1, 2
TEXT = "float64 a 0.5\n---\nfloat64 twice\n"


def recorded(path: Path, cls: Any, events: list[tuple[int, Any]], topic: str = "/add") -> Path:
    """A bag of service events, of the kind and with the request of each; None is an event without contents."""
    with Recorder(path) as recorder:
        for index, (kind, request) in enumerate(events):
            event = cls.Event()
            event.info.event_type = kind
            event.request = [] if request is None else [request]
            recorder.write(f"{topic}/_service_event", event, START + index * 100_000_000)
    return path


@contextmanager
def serving(cls: Any, answer: Callable[[Any], None] | None) -> Generator[None]:
    """A server of /add in a thread of its own, in virtual time, which hands its requests on; None serves nothing."""

    def respond(request: Any, response: Any) -> Any:
        assert answer is not None
        answer(request)
        return response

    with virtual_time():
        context = rclpy.Context()
        rclpy.init(args=[], context=context)
        node = rclpy.create_node("server", context=context)
        if answer is not None:
            node.create_service(cls, "/add", respond)
        executor = SingleThreadedExecutor(context=context)
        executor.add_node(node)

        def spin() -> None:
            with suppress(ExternalShutdownException):
                executor.spin()

        thread = threading.Thread(target=spin)
        thread.start()
        yield
        context.shutdown()
        thread.join()
        node.destroy_node()


def play(ifgen: Run, path: Path, *options: str) -> Outcome:
    return ifgen("bag", "play", path, "--transport", "local", "--publish-service-requests", *options)


EVENTS = [
    (RECEIVED, AddTwoInts.Request(a=1, b=2)),
    (ANSWERED, None),
    (SENT, AddTwoInts.Request(a=7, b=8)),
    (RECEIVED, AddTwoInts.Request(a=3, b=4)),
]


@pytest.mark.parametrize(
    ("options", "expected"),
    [
        ([], [(1, 2), (3, 4)]),
        (["--service-requests-source", "client_introspection"], [(7, 8)]),
        (["--services", "/other"], None),
    ],
    ids=["service", "client", "none"],
)
def test_requests_are_sent(
    ifgen: Run, tmp_path: Path, options: list[str], expected: list[tuple[int, int]] | None
) -> None:
    path = recorded(tmp_path / "calls", AddTwoInts, EVENTS)
    heard: list[tuple[int, int]] = []
    with serving(AddTwoInts, lambda request: heard.append((request.a, request.b))):
        done = play(ifgen, path, *options)
    if expected is None:
        assert f"error: nothing of {path} is played" in done.err
    else:
        assert (done.code, done.err, heard) == (0, "", expected)


def test_a_type_that_nobody_generated(ifgen: Run, tmp_path: Path) -> None:
    cls = ifgen_class()
    path = recorded(tmp_path / "calls", cls, [(RECEIVED, cls.Request(a=0.1))])
    heard: list[float] = []
    with serving(cls, lambda request: heard.append(request.a)):
        done = play(ifgen, path)
    assert (done.code, done.err, heard) == (0, "", [0.1])


def ifgen_class(text: str = TEXT) -> Any:
    return ifgen.dynamic.class_from_text("lab_msgs/srv/Double", text)


def test_a_server_of_another_definition(ifgen: Run, tmp_path: Path) -> None:
    old = ifgen_class("float32 a\n---\nfloat64 twice\n")
    path = recorded(tmp_path / "calls", old, [(RECEIVED, old.Request(a=0.5))])
    with serving(ifgen_class(), pytest.fail):
        done = play(ifgen, path)
    assert done.code == 0
    assert done.err == (
        "warning: requests of /add are not sent: its server has another definition; `ifgen bag check` says what "
        "differs\n"
    )


def test_events_without_contents(ifgen: Run, tmp_path: Path) -> None:
    path = recorded(tmp_path / "calls", AddTwoInts, [(RECEIVED, None), (RECEIVED, None)])
    with serving(AddTwoInts, pytest.fail):
        done = play(ifgen, path)
    assert done.code == 0
    assert done.err == (
        "warning: requests of /add are not sent: its events have no contents: introspection told only when it "
        "was called\n"
    )


def test_nobody_serves(ifgen: Run, tmp_path: Path) -> None:
    path = recorded(tmp_path / "calls", AddTwoInts, EVENTS)
    with serving(AddTwoInts, None):
        done = play(ifgen, path)
    assert (done.code, done.err) == (0, "warning: requests of /add are not sent: nobody serves it\n")


def test_nobody_describes(ifgen: Run, tmp_path: Path) -> None:
    cls = ifgen_class()
    path = recorded(tmp_path / "calls", cls, [(RECEIVED, cls.Request())])
    with serving(cls, None):
        done = play(ifgen, path)
    assert done.code == 1
    assert "warning: requests of /add are not sent: there is no interface package 'lab_msgs'; " in done.err
    assert f"error: nothing of {path} is played" in done.err
