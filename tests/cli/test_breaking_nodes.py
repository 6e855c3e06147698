"""What a node's description may change without breaking anybody, and what it may not."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from .conftest import Run, write


def qos(**policies: object) -> str:
    known: dict[str, object] = {"history": "KEEP_LAST", "depth": 5, "reliability": "RELIABLE", **policies}
    return "{" + ", ".join(f"{key}: {value}" for key, value in known.items()) + "}"


def topic(category: str, profile: str, name: str = "chatter") -> str:
    return f"{category}:\n  - {{name: {name}, type: std_msgs/msg/String, qos: {profile}}}\n"


def parameter(text: str) -> str:
    return f"parameters:\n  a: {{{text}}}\n"


RELIABLE, BEST_EFFORT = qos(), qos(reliability="BEST_EFFORT")
LATCHED = qos(durability="TRANSIENT_LOCAL")
SOON, LATE = qos(deadline_ns=1000), qos(deadline_ns=2000)
SERVICE = "service_servers:\n  - {name: reset, type: std_srvs/srv/Empty}\n"
FEWER, MORE = (parameter(f"type: int, default_value: 1, validation: {{bounds<>: [0, {n}]}}") for n in (3, 9))
SHORT, LONG = (parameter(f"type: string_fixed_{n}, default_value: a") for n in (3, 9))
ONE, TWO = (
    parameter(f"type: string, default_value: a, validation: {{one_of<>: [[{x}]]}}") for x in ("a", "a, b")
)


@pytest.mark.parametrize(
    ("before", "after", "rule", "rule_back"),
    [
        ("", SERVICE, None, "endpoint-removed"),
        ("", parameter("type: int, default_value: 1"), None, "parameter-removed"),
        ("", parameter("type: int"), "parameter-required", "parameter-removed"),
        (topic("publishers", RELIABLE), topic("publishers", BEST_EFFORT), "qos-incompatible", None),
        (topic("subscriptions", RELIABLE), topic("subscriptions", BEST_EFFORT), None, "qos-incompatible"),
        (topic("publishers", LATCHED), topic("publishers", RELIABLE), "qos-incompatible", None),
        (topic("publishers", SOON), topic("publishers", LATE), "qos-incompatible", None),
        (topic("subscriptions", SOON), topic("subscriptions", LATE), None, "qos-incompatible"),
        (topic("publishers", RELIABLE), topic("publishers", qos(depth=50)), None, None),
        (topic("publishers", RELIABLE), topic("publishers", RELIABLE, "/chatter"), None, None),
        (topic("publishers", RELIABLE), topic("publishers", RELIABLE, "~/chatter"), "endpoint-renamed", "endpoint-renamed"),
        (topic("publishers", RELIABLE), topic("subscriptions", RELIABLE), "endpoint-removed", "endpoint-removed"),
        (FEWER, MORE, None, "parameter-validation"),
        (SHORT, LONG, None, "parameter-type"),
        (ONE, TWO, None, "parameter-validation"),
        (parameter("type: int, default_value: 1, read_only: true"), parameter("type: int, default_value: 1"), None, "parameter-read-only"),
        (parameter("type: int"), parameter("type: int, default_value: 1"), None, "parameter-required"),
        (parameter("type: double, default_value: 1.0, description: x"), parameter("type: double, default_value: 1.0"), None, None),
    ],
)  # fmt: skip
def test_both_ways(ifgen: Run, before: str, after: str, rule: str | None, rule_back: str | None) -> None:
    for folder, text in (("old", before), ("new", after)):
        write(Path(folder) / "demo/nodl/talker.nodl.yaml", f"nodl_version: 2\n{text}")
    for new, old, expected in (("new", "old", rule), ("old", "new", rule_back)):
        done = ifgen("breaking", new, "--against", old, "--format", "json")
        found = [diagnostic["rule"] for diagnostic in json.loads(done.out)["diagnostics"]]
        assert (done.code, found) == ((1, [expected]) if expected else (0, [])), done.out
