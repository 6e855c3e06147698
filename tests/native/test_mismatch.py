"""Peers whose definitions differ, on real rclpy: they are told of, and kept away as the policy says."""

from __future__ import annotations

import json
import signal
import subprocess
import sys
from typing import Any

import pytest

from .support import DISTRIBUTION, PROGRAMS, needs_rclpy, run_python

pytestmark = needs_rclpy
PROGRAM = str(PROGRAMS / "mismatch.py")
GOOD = [0.1, 0.2, 0.3]
LIKE = DISTRIBUTION or "jazzy"


def meet(policy: str) -> tuple[dict[str, Any], str]:
    """What a node with this policy has seen of one with other definitions; its warnings."""
    command = [sys.executable, PROGRAM, "other", policy, LIKE]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as other:
        try:
            ran = run_python(PROGRAM, "mine", policy, LIKE, limit=90)
        finally:
            other.send_signal(signal.SIGINT)
            output, errors = other.communicate(timeout=20)
    assert ran.returncode == 0, ran.stdout + ran.stderr
    assert (other.returncode, output) == (0, ""), errors
    assert "Traceback" not in ran.stderr + errors, ran.stderr + errors
    seen: dict[str, Any] = json.loads(ran.stdout)
    assert seen["complete"] == [True, True], ran.stdout
    assert all(message == GOOD for message in seen["later"]), "garbage after the other publisher had left"
    return seen, ran.stderr


@pytest.mark.parametrize(
    "policy", ["warn", *(pytest.param(name, marks=pytest.mark.slow) for name in ("refuse", "adapt"))]
)
def test_peers_with_other_definitions(policy: str) -> None:
    seen, warnings = meet(policy)
    actions = policy if policy == "warn" else "refuse"
    nodes = ["/robot/mine", "/other"]
    assert sorted(found[:6] for found in seen["heard"]) == [
        ["action", "/go", actions, "my_msgs/action/Go_FeedbackMessage", *nodes],
        ["action", "/walk", actions, "my_msgs/action/Go_FeedbackMessage", *nodes],
        ["service", "/ask", policy, "my_msgs/srv/Add_Request", *nodes],
        ["service", "/serve", policy, "my_msgs/srv/Add_Request", *nodes],
        ["topic", "/speed", policy, "my_msgs/msg/Speed", *nodes],
    ]
    described = {found[0]: found[6] for found in seen["heard"]}
    assert described == {"topic": True, "action": True, "service": False}
    delays = [found[-1] for found in seen["heard"]]
    print(f"{policy}: told {min(delays):.2f} to {max(delays):.2f} s after they met")
    assert max(delays) < 10, "within a second, where the machine has time"
    expected = 6 if policy == "warn" and LIKE == "jazzy" else 5  # a service's requests have bytes left over
    assert policy == "warn" or seen["goals"] == []
    assert seen["walk_is_ready"] == (policy == "warn" and LIKE == "jazzy")
    adapted = 3 if policy == "adapt" else 0
    assert (warnings.count("[WARN]"), warnings.count("[INFO]")) == (expected - adapted, adapted), warnings
    received, asked = seen["received"], [seen["requests"], seen["response"]]
    garbage = [message for message in received if message != GOOD]
    match policy:
        case "warn":
            assert garbage, "as in ROS"
            rest = (
                "4 bytes of a message of /other were left over after my_msgs/srv/Add_Request. The message was"
            )
            assert warnings.count(rest) == (LIKE == "jazzy"), warnings
            assert seen["goals"] == ([0.7] if LIKE == "jazzy" else [])
            # Kilted compares types: it connects those of the topic, where only names differ, and no others.
            assert ("not connected" in warnings) == (LIKE == "kilted"), warnings
        case "refuse":
            assert asked == [[], None]
            assert seen["events"] == [[1, 1]]
            assert not garbage
        case _:
            assert received
            assert not garbage
            assert "failed" not in warnings
            assert asked == ([[[0.1, 0.2]], [pytest.approx(0.3), True]] if LIKE == "jazzy" else [[], None])


@pytest.mark.slow
@pytest.mark.parametrize("many", [100, 1000])
def test_the_thread_that_watches(many: int) -> None:
    ran = run_python(str(PROGRAMS / "watching.py"), str(many), limit=250)
    assert ran.returncode == 0, ran.stdout + ran.stderr
    assert "Traceback" not in ran.stderr, ran.stderr
    # Kilted's rclpy tells whose a message is.
    several = "several definitions 1 [] 4.0" if LIKE == "jazzy" else "several definitions 0 [0.5, 2.0] 4.0"
    assert ran.stdout.splitlines() == [
        "before 0",
        "parameter on_type_mismatch is 'sometimes', expected one of warn, refuse, adapt",
        "running 1",
        "child 0",
        "/careful subscription refuse True",
        "/unmoved subscription warn True",
        "two contexts 2",
        "one context 1",
        "without a hash 1 [0.1]",
        "adapted [2.0]",
        several,
        "many True watched nodes ['adapted', 'careful', 'peer', 'unmoved']",
        "after 0 []",
    ]
