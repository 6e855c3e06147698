"""`ifgen action send_goal`."""

from __future__ import annotations

import json
import os
import re
import signal
import threading
import time

import pytest
from rclpy.action import CancelResponse

from tests.cli.conftest import Run
from tests.tools.action.inside.conftest import Counter

TYPE = "example_interfaces/action/Fibonacci"

RESULT = """Waiting for an action server to become available...
Sending goal:
     order: 2

Goal accepted with ID: 0

Result:
    sequence:
- 0
- 1

Goal finished with status: SUCCEEDED
"""


def interrupt_once_executing(counter: Counter) -> None:
    """Ctrl-C, once a goal has been accepted and its feedback has come."""

    def interrupt() -> None:
        assert counter.started.wait(20.0)
        time.sleep(0.2)
        os.kill(os.getpid(), signal.SIGINT)

    threading.Thread(target=interrupt).start()


def test_result(ifgen: Run, spinning: Counter) -> None:
    done = ifgen("action", "send_goal", "/count", TYPE, "{order: 2}")
    assert (done.code, done.err) == (0, "")
    assert re.sub("ID: [0-9a-f]{32}", "ID: 0", done.out) == RESULT
    assert ifgen("action", "send_goal", "count", "example_interfaces/Fibonacci", "order: 2").code == 0


def test_rejected_and_aborted(ifgen: Run, spinning: Counter) -> None:
    rejected = ifgen("action", "send_goal", "/count", TYPE, "{order: -1}")
    assert (rejected.code, rejected.out.endswith("\nGoal was rejected.\n")) == (1, True)
    aborted = ifgen("action", "send_goal", "/count", TYPE, "{order: 3}").out
    assert aborted.endswith("\nGoal finished with status: ABORTED\n")


def test_json(ifgen: Run, spinning: Counter) -> None:
    out = ifgen("action", "send_goal", "/count", TYPE, "{order: 1}", "--json").out
    events = [json.loads(line) for line in out.splitlines()]
    assert events[0] == {"goal": {"order": 1}}
    assert events[-1] == {"status": "SUCCEEDED", "result": {"sequence": [0]}}
    assert ifgen("action", "send_goal", "/count", TYPE, "order: -1", "--json").out.endswith(
        '{"accepted": false}\n'
    )


def test_an_interruption_cancels_the_goal(ifgen: Run, spinning: Counter) -> None:
    """Feedback has come by then. What comes together with a result is dropped by rclpy, real or ours."""
    interrupt_once_executing(spinning)
    done = ifgen("action", "send_goal", "/count", TYPE, "{order: 9}", "--feedback")
    assert spinning.cancelled.is_set()
    assert "Feedback:\n    sequence:\n- 0\n- 1\n- 2\n\n" in done.out
    assert done.code == 2
    assert "Canceling goal...\nGoal canceled.\nResult:\n" in done.out
    assert done.out.endswith("Goal finished with status: CANCELED\n")


def test_feedback_as_json(ifgen: Run, spinning: Counter) -> None:
    interrupt_once_executing(spinning)
    out = ifgen("action", "send_goal", "/count", TYPE, "{order: 9}", "-f", "--json").out
    events = [json.loads(line) for line in out.splitlines()]
    assert {"feedback": {"sequence": [0, 1, 2]}} in events
    assert events[-1]["status"] == "CANCELED"


def test_a_server_that_refuses_to_cancel(ifgen: Run, spinning: Counter) -> None:
    spinning.cancelling = CancelResponse.REJECT
    interrupt_once_executing(spinning)
    done = ifgen("action", "send_goal", "/count", TYPE, "{order: 9}")
    assert done.code == 1
    assert "the server of the action '/count' refuses to cancel the goal, which goes on" in done.err


def test_mistakes(ifgen: Run, counter: Counter) -> None:
    done = ifgen("action", "send_goal", "/count", TYPE, "{orde: 1}")
    assert (done.code, "did you mean 'order'?" in done.err) == (1, True)
    done = ifgen("action", "send_goal", "/count", "test_msgs/action/Fibonacci")
    assert f"the action '/count' has the type {TYPE}, not test_msgs/action/Fibonacci" in done.err
    done = ifgen("action", "send_goal", "/count", "std_srvs/srv/Empty")
    assert (done.code, "names no action" in done.err) == (1, True)


@pytest.mark.usefixtures("counter", "interrupted_wait")
def test_nobody_serves_it(ifgen: Run) -> None:
    done = ifgen("action", "send_goal", "/coun", TYPE)
    assert done.code == 2
    assert "waiting for the action '/coun'... did you mean '/count'?" in done.err


@pytest.mark.slow
@pytest.mark.usefixtures("counter")
def test_a_second_interruption_stops_at_once(ifgen: Run, counter: Counter) -> None:
    """Nobody spins the server, so it neither accepts the goal nor cancels it."""
    for after in (1.0, 1.5):
        threading.Timer(after, os.kill, (os.getpid(), signal.SIGINT)).start()
    assert ifgen("action", "send_goal", "/count", TYPE).code == 2
