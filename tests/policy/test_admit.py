"""`ifgen admit`: who may join a system, with a reason for each verdict."""

from __future__ import annotations

import json
import sys
from collections.abc import Callable
from pathlib import Path
from subprocess import run
from typing import Any

import pytest
from ifgen.cli import main

HASH = "RIHS01_" + "0" * 64
RELIABLE = {"history": "KEEP_LAST", "depth": 1, "reliability": "RELIABLE"}
LOSSY = RELIABLE | {"reliability": "BEST_EFFORT"}


def end(category: str, name: str, type_: str = "std_msgs/msg/String", **more: Any) -> dict[str, Any]:
    profile = {"qos": RELIABLE} if "/msg/" in type_ else {}
    return {"category": category, "name": name, "type": type_, "hash": HASH, **profile, **more}


def manifest(nodes: dict[str, list[dict[str, Any]]], open_ends: tuple[str, ...] = ()) -> str:
    described = {name: {"package": "p", "executable": "e", "endpoints": ends} for name, ends in nodes.items()}
    return json.dumps({"version": 1, "open_ends": list(open_ends), "nodes": described})


ROBOT = {
    "/cam": [end("publishers", "/image", version="2.1.0")],
    "/base": [end("service_servers", "/reset", "std_srvs/srv/Trigger")],
}
Admit = Callable[..., tuple[int, dict[str, Any]]]


@pytest.fixture
def admit(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> Admit:
    """Judge nodes against the robot; returns the exit code and the verdict."""

    def judged(
        nodes: dict[str, Any], *words: str, open_ends: tuple[str, ...] = (), robot: Any = ROBOT
    ) -> Any:
        (tmp_path / "new.lock").write_text(manifest(nodes, open_ends))
        (tmp_path / "robot.lock").write_text(manifest(robot))
        against = ("--against", str(tmp_path / "robot.lock"))
        code = main.main(["admit", str(tmp_path / "new.lock"), *against, "--format", "json", *words])
        return code, json.loads(capsys.readouterr().out)

    return judged


def words(verdict: dict[str, Any]) -> list[str]:
    return [each["reason"] for each in verdict["reasons"]]


def test_accepted(admit: Admit) -> None:
    viewer = [end("subscriptions", "/image"), end("service_clients", "/reset", "std_srvs/srv/Trigger")]
    assert admit({"/viewer": viewer}) == (0, {"outcome": "accepted", "nodes": 1, "reasons": []})


@pytest.mark.parametrize(
    ("ends", "reason"),
    [
        ([end("subscriptions", "/image", "std_msgs/msg/Int8")], "type"),
        ([end("subscriptions", "/image", hash="RIHS01_" + "1" * 64)], "major"),
        ([end("subscriptions", "/image", version="3..3")], "major"),
        ([end("service_servers", "/reset", "std_srvs/srv/Trigger")], "two providers"),
        (
            [
                end("publishers", "/scan"),
                end("subscriptions", "/scan", qos=RELIABLE | {"durability": "TRANSIENT_LOCAL"}),
            ],
            "qos",
        ),
    ],
)
def test_rejected(admit: Admit, ends: list[dict[str, Any]], reason: str) -> None:
    code, verdict = admit({"/new": ends})
    assert (code, verdict["outcome"], words(verdict)) == (1, "rejected", [reason])


def test_qos_that_never_meets(admit: Admit) -> None:
    robot = {"/cam": [end("publishers", "/image", qos=LOSSY)]}
    code, verdict = admit({"/viewer": [end("subscriptions", "/image")]}, robot=robot)
    assert (code, words(verdict)) == (1, ["qos"])


def test_a_client_without_server(admit: Admit) -> None:
    """It may come later, unless the system is complete."""
    client = {"/new": [end("service_clients", "/reste", "std_srvs/srv/Trigger")]}
    assert admit(client)[0] == 0
    code, verdict = admit(client, "--complete")
    assert (code, words(verdict)) == (1, ["no provider"])


def test_nobody_can_tell(admit: Admit) -> None:
    code, verdict = admit({"/new": []}, open_ends=("/new",))
    assert (code, words(verdict)) == (2, ["no document"])
    unknown = end("subscriptions", "/image")
    del unknown["hash"]
    code, verdict = admit({"/new": [unknown]})
    assert (code, words(verdict)) == (2, ["no definition"])


def test_a_newer_version_of_a_node_takes_its_place(admit: Admit) -> None:
    assert admit({"/base": [end("service_servers", "/reset", "std_srvs/srv/Trigger")]})[0] == 0


def test_what_is_wrong_already_is_no_reason(admit: Admit) -> None:
    robot = {
        "/a": [end("publishers", "/x")],
        "/b": [end("subscriptions", "/x", "std_msgs/msg/Int8")],
    }
    assert admit({"/new": [end("publishers", "/y")]}, robot=robot)[0] == 0


def test_errors(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file = tmp_path / "a.lock"
    file.write_text(manifest(ROBOT).replace('"version": 1', '"version": 9'))
    assert main.main(["admit", str(file), "--against", str(file)]) == 2
    assert "update ifgen" in capsys.readouterr().err
    file.write_text(manifest(ROBOT))
    assert main.main(["admit", str(file), "--against", "nothing"]) == 2
    assert "write `running`" in capsys.readouterr().err


def test_against_what_runs(tmp_path: Path) -> None:
    """Nothing runs in this domain, so everybody may come."""
    (tmp_path / "a.lock").write_text(manifest(ROBOT))
    command = [
        sys.executable,
        "-m",
        "ifgen",
        "admit",
        "a.lock",
        "--against",
        "running",
        "--transport",
        "local",
    ]
    done = run(command, cwd=tmp_path, capture_output=True, text=True, timeout=60, check=False)
    assert (done.returncode, done.stdout) == (0, "accepted: 2 nodes\n"), done.stderr
