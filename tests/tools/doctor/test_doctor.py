"""`ifgen doctor --graph` names what nodes have different definitions of."""

from __future__ import annotations

import importlib.util
import json
import os
import subprocess
import sys
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from ifgen_pytest.domains import own_domain
from ifgen_runtime.mismatch.type_description_client import Question
from ifgen_tools.doctor import definitions
from ifgen_tools.doctor.definitions import Disagreement, User, Version, descriptions

PROGRAM = Path(__file__).with_name("programs") / "robot.py"
NEW = {
    "msg/Battery.msg": "float32 voltage  # [V]\nfloat32 current  # [A]\nuint8 status\n",
    "msg/State.msg": "string name\nBattery[<=2] batteries\n",
    "srv/SetMode.srv": "uint16 mode\n---\nbool success\n",
    "action/Walk.action": "float32 distance 0.1\n---\nbool success\n---\nBattery battery\n",
}
OLD = {
    **NEW,
    "msg/Battery.msg": "float32 voltage  # [V]\nuint8 status\n",
    "srv/SetMode.srv": "uint8 mode\n---\nbool success\n",
}
TRANSPORTS = [
    "local",
    pytest.param(
        "rclpy",
        marks=pytest.mark.skipif(
            importlib.util.find_spec("rpyutils") is None, reason="real rclpy is not installed"
        ),
    ),
]


@pytest.fixture
def domain() -> Iterator[dict[str, str]]:
    with own_domain() as number:
        yield {"ROS_DOMAIN_ID": str(number), "ROS_AUTOMATIC_DISCOVERY_RANGE": "LOCALHOST"}


@pytest.fixture
def project(tmp_path: Path) -> Path:
    """A project with the new version, and the old one beside it."""
    for folder, files in (("interfaces", NEW), ("released", OLD)):
        for name, text in files.items():
            path = tmp_path / folder / "robot_msgs" / name
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(text)
    (tmp_path / "pyproject.toml").write_text('[tool.ifgen]\npaths = ["interfaces"]\n')
    return tmp_path


def doctor(folder: Path, domain: dict[str, str], *words: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [sys.executable, "-m", "ifgen", "doctor", "--graph", *words],
        capture_output=True,
        text=True,
        timeout=120,
        check=False,
        cwd=folder,
        env={**os.environ, **domain},
    )


def running(*versions: str) -> list[str]:
    """The options that run a driver and a monitor of these versions."""
    names = ("driver", "monitor")
    return [
        word
        for pair in zip(names, versions, strict=False)
        for word in ("--run", f"{PROGRAM} {' '.join(pair)}")
    ]


def messages(done: subprocess.CompletedProcess[str]) -> dict[str, list[dict[str, Any]]]:
    """The diagnostics by the first lines of their messages."""
    found: dict[str, list[dict[str, Any]]] = {}
    for each in json.loads(done.stdout)["diagnostics"]:
        found.setdefault(each["message"].partition("\n")[0], []).append(each)
    return found


def places(diagnostic: dict[str, Any]) -> list[str]:
    return [f"{label['path']}:{label['start']['line']}" for label in diagnostic["labels"]]


@pytest.mark.slow
@pytest.mark.parametrize("transport", TRANSPORTS)
def test_two_versions_meet(transport: str, project: Path, domain: dict[str, str]) -> None:
    words = ("--transport", transport, *running("old", "new"), "-I", "released", "--format", "json")
    done = doctor(project, domain, *words)
    assert done.returncode == 1, done.stderr
    found = messages(done)
    # Processes of the local transport announce whole services.
    part = "robot_msgs/srv/SetMode" if transport == "local" else "robot_msgs/srv/SetMode_Request"
    assert sorted(found) == [
        "action '/walk' has 2 definitions of robot_msgs/action/Walk_FeedbackMessage",
        "robot_msgs/State.batteries.current is new",
        "robot_msgs/action/Walk_FeedbackMessage.feedback.battery.current is new",
        "robot_msgs/srv/SetMode_Request.mode was `uint8`, and is `uint16`",
        f"service '/set_mode' has 2 definitions of {part}",
        "topic '/other' has 2 types",
        "topic '/state' has 2 definitions of robot_msgs/msg/State",
    ]
    (state,) = found["topic '/state' has 2 definitions of robot_msgs/msg/State"]
    assert state["severity"] == "error"
    for line in (
        "RIHS01_018ff6a9caff5571...  /driver (publisher)",
        "RIHS01_d87728b1c5cf0e7e...  /monitor (subscription)",
    ):
        assert f"\n  {line}" in state["message"]
    (service,) = found[f"service '/set_mode' has 2 definitions of {part}"]
    assert "/driver (service server)" in service["message"]
    assert "/monitor (service client)" in service["message"]
    (types,) = found["topic '/other' has 2 types"]
    assert "\n  robot_msgs/msg/Same  /driver (publisher)" in types["message"]
    assert places(found["robot_msgs/State.batteries.current is new"][0]) == [
        "interfaces/robot_msgs/msg/State.msg:2",
        "interfaces/robot_msgs/msg/Battery.msg:2",
    ]
    (mode,) = found["robot_msgs/srv/SetMode_Request.mode was `uint8`, and is `uint16`"]
    assert places(mode) == [
        "interfaces/robot_msgs/srv/SetMode.srv:1",
        "released/robot_msgs/srv/SetMode.srv:1",
    ]


@pytest.mark.slow
@pytest.mark.parametrize("transport", TRANSPORTS)
def test_one_version_meets_itself(transport: str, project: Path, domain: dict[str, str]) -> None:
    done = doctor(project, domain, "--transport", transport, *running("new", "new"))
    first, _, rest = done.stdout.partition("\n")
    assert (done.returncode, first) == (0, "2 nodes: all definitions agree")
    assert rest.count("which nobody serves") == 2, "both are clients"


def test_a_definition_comes_from_the_node_where_it_is_not_installed(
    project: Path, domain: dict[str, str]
) -> None:
    (project / "pyproject.toml").unlink()
    done = doctor(project, domain, "--transport", "local", *running("old", "new"))
    assert "warning[field-added]: robot_msgs/State.batteries.current is new\n" in done.stdout
    assert " --> /monitor:robot_msgs/msg/State.msg:2:14\n" in done.stdout


@pytest.mark.slow
def test_a_silent_node_costs_only_the_detail(project: Path, domain: dict[str, str]) -> None:
    done = doctor(project, domain, "--transport", "local", *running("old silent", "new"))
    assert done.returncode == 1
    assert "topic '/state' has 2 definitions of robot_msgs/msg/State\n" in done.stdout
    assert "help: what differs is unknown: no node sent the definition\n" in done.stdout
    assert "ifgen adapt robot_msgs/msg/State --from RIHS01_018ff6a9caff5571\n" in done.stdout


def test_the_same_definition_is_asked_of_three_nodes_at_most_and_of_none_twice(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    asked: list[Question] = []
    monkeypatch.setattr(definitions, "answers", lambda _, questions, __: asked.extend(questions) or {})
    having = {
        Version("a/msg/B", type_hash): [
            User(f"/{end}{number % 9}", "publisher", "topic", "/x", "/x", "a/msg/B", type_hash)
            for number in range(20)
        ]
        for end, type_hash in (("old", "RIHS01_" + "a" * 64), ("new", "RIHS01_" + "b" * 64))
    }
    found = Disagreement("topic", "/x", having)
    descriptions(None, [found, replace(found, name="/y")])
    assert [each.node for each in asked] == ["/old0", "/new0", "/old1", "/new1", "/old2", "/new2"]


def test_wrong_usage(project: Path, domain: dict[str, str]) -> None:
    nothing = doctor(project, domain, "--transport", "local")
    assert nothing.returncode == 2
    assert "error[no-node]: no node is running" in nothing.stderr
    command = [sys.executable, "-m", "ifgen", "doctor", "--transport", "local"]
    without = subprocess.run(command, capture_output=True, text=True, timeout=60, check=False)
    assert without.returncode == 2
    assert "these options need --graph" in without.stderr


@pytest.mark.slow
def test_healthy_nodes_of_other_processes_agree(
    project: Path, domain: dict[str, str], tmp_path: Path
) -> None:
    """Their own definitions are unknown where the doctor looks, those of their parameters are known."""
    command = [sys.executable, "-m", "ifgen", "run", "--transport", "local", str(PROGRAM)]
    environment = {**os.environ, **domain}
    started = [
        subprocess.Popen([*command, name, "new"], cwd=project, env=environment)
        for name in ("driver", "monitor")
    ]
    try:
        found = ""
        for _ in range(20):  # they come one after the other
            found = doctor(tmp_path, domain, "--transport", "local").stdout
            if found.startswith("2 nodes"):
                break
        assert found.startswith("2 nodes: all definitions agree\n")
    finally:
        for each in started:
            each.kill()
            each.wait()
