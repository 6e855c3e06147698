"""The verbs of `ifgen nodl` on documents: validate, diff, rewrite, migrate."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
import yaml
from ifgen.cli import main
from ifgen.nodl.verdict import verdict
from ifgen.reading.search_path import SearchPath

QOS = "qos: {history: KEEP_LAST, depth: 1, reliability: RELIABLE}"
TALKER = f"""# kept
nodl_version: 2
include:
  - ref: local://part.nodl.yaml   # this one
publishers:
  - {{name: ~/out, type: std_msgs/String, {QOS}}}
"""
PART = "nodl_version: 2\nparameters: {rate: {type: double, default_value: 1.0, validation: {gt: 0.0}}}\n"


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder with two documents, in which commands run."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "talker.nodl.yaml").write_text(TALKER)
    (tmp_path / "part.nodl.yaml").write_text(PART)
    return tmp_path


def nodl(*words: str) -> int:
    return main.main(["nodl", *words])


def test_validate(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert nodl("validate", "talker.nodl.yaml", "part.nodl.yaml") == 0
    assert capsys.readouterr().out == "talker.nodl.yaml: ok\npart.nodl.yaml: ok\n"
    (folder / "part.nodl.yaml").write_text("nodl_version: 3\n")
    assert nodl("validate", "talker.nodl.yaml") == 1
    assert "part.nodl.yaml:1:15" in capsys.readouterr().out
    assert nodl("validate", "--no-resolve", "talker.nodl.yaml") == 0


def test_what_ifgen_needs_beyond_nodl_is_a_warning(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (folder / "part.nodl.yaml").write_text(
        f"nodl_version: 2\nsubscriptions: [{{name: a, type: x/Y, {QOS}}}]\n"
    )
    assert nodl("validate", "part.nodl.yaml") == 0
    assert "warning[unknown-package]" in capsys.readouterr().out
    assert nodl("validate", "--strict", "part.nodl.yaml") == 1
    assert "error[unknown-package]" in capsys.readouterr().out


def test_diff(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (folder / "other.nodl.yaml").write_text(TALKER.replace("RELIABLE", "BEST_EFFORT"))
    assert nodl("diff", "talker.nodl.yaml", "talker.nodl.yaml") == 0
    capsys.readouterr()
    assert nodl("diff", "talker.nodl.yaml", "other.nodl.yaml", "--node-name", "/a/b") == 1
    detail = "reliability RELIABLE is declared, but it is BEST_EFFORT"
    assert capsys.readouterr().out == f"[qos_mismatch] publishers '/a/b/out': {detail}\n"
    # Who publishes as well as it can serves all that the document promises.
    assert nodl("diff", "--compatible", "other.nodl.yaml", "talker.nodl.yaml") == 0
    assert nodl("diff", "--compatible", "talker.nodl.yaml", "other.nodl.yaml") == 1
    (folder / "other.nodl.yaml").write_text("[]\n")
    assert nodl("diff", "talker.nodl.yaml", "other.nodl.yaml") == 2


def test_diff_in_json(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (folder / "other.nodl.yaml").write_text("nodl_version: 2\n")
    assert nodl("diff", "talker.nodl.yaml", "other.nodl.yaml", "--format", "json") == 1
    found = json.loads(capsys.readouterr().out)
    assert not found["conforms"]
    assert [(each["kind"], each["section"], each["name"]) for each in found["differences"]] == [
        ("missing", "publishers", "/node/out"),
        ("missing", "parameters", "rate"),
    ]


def test_rewrite_keeps_all_but_the_reference(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert nodl("rewrite", "talker.nodl.yaml", "-r", "local://./part.nodl.yaml:=nodl://demo/part") == 0
    assert capsys.readouterr().out == TALKER.replace("local://part.nodl.yaml", "nodl://demo/part")
    assert nodl("rewrite", "talker.nodl.yaml") == 1
    captured = capsys.readouterr()
    assert "error[local-reference]" in captured.out + captured.err


def test_rewrite_merges(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert nodl("rewrite", "talker.nodl.yaml", "--merge") == 0
    merged = yaml.safe_load(capsys.readouterr().out)
    assert merged.keys() == {"nodl_version", "parameters", "publishers"}
    assert merged["publishers"][0]["type"] == "std_msgs/String"
    assert nodl("rewrite", "talker.nodl.yaml", "--merge", "-o", "merged.json") == 0
    assert json.loads((folder / "merged.json").read_text()) == merged


OLD = """<?xml version="1.0"?>
<interface version="1">
  <node name="talker" executable="talk">
    <parameter name="rate" type="int"/>
    <topic name="chatter" type="std_msgs/msg/String" role="both"/>
    <topic name="~/old" type="std_msgs/String" publisher="true">
      <qos_profile depth="3" deadline=".5" reliability="best_effort" history=""/>
    </topic>
    <service name="/go" type="std_srvs/srv/Empty" role="client"/>
    <action name="fib" type="example_interfaces/action/Fibonacci" role="server"/>
  </node>
  <node name="other" executable="talk"><parameter name="a.b" type="string"/></node>
</interface>
"""


def test_migrate(folder: Path) -> None:
    (folder / "robot.nodl.xml").write_text(OLD)
    assert nodl("migrate", "robot.nodl.xml", "-o", "nodl") == 0
    for name in ("talker", "other"):
        assert not verdict(folder / f"nodl/{name}.nodl.yaml", SearchPath()).errors
    text = (folder / "nodl/talker.nodl.yaml").read_text()
    document = yaml.safe_load(text)
    assert "# to check: the QoS of publisher chatter" in text
    assert document["parameters"] == {"rate": {"type": "int"}}
    profile = {"history": "KEEP_LAST", "depth": 3, "reliability": "BEST_EFFORT", "deadline_ns": 500_000_000}
    assert document["publishers"][1]["qos"] == profile
    assert [end["name"] for end in document["subscriptions"]] == ["chatter"]
    assert document["service_clients"] == [{"name": "/go", "type": "std_srvs/srv/Empty"}]
    assert nodl("migrate", "robot.nodl.xml", "-o", "nodl") == 2
    assert nodl("migrate", "robot.nodl.xml", "-o", "nodl", "--force") == 0


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ('version="1"', 'version="2"'),
        ('role="both"', 'role="none"'),
        ('type="int"', 'type="quaternion"'),
        ('name="chatter"', 'name="1a"'),
        ("std_msgs/msg/String", "std_srvs/srv/Empty"),
        ('name="talker"', 'name="my-node"'),
        ('name="other"', 'name="talker"'),
        ('depth="3"', 'depth="many"'),
        ("<parameter", "<timer"),
        ("</interface>", ""),
        ("<interface", "<!DOCTYPE x [<!ENTITY a 'b'>]><interface"),
    ],
)
def test_what_cannot_be_migrated(
    folder: Path, capsys: pytest.CaptureFixture[str], old: str, new: str
) -> None:
    (folder / "robot.nodl.xml").write_text(OLD.replace(old, new, 1))
    assert nodl("migrate", "robot.nodl.xml") == 1
    captured = capsys.readouterr()
    assert "robot.nodl.xml:" in captured.out + captured.err


def seen_qos(history: int, depth: int) -> dict[str, object]:
    never = {"sec": 2147483647, "nanosec": 4294967295}
    return {
        **{"depth": depth, "deadline": {"sec": 1, "nanosec": 500}, "lifespan": never, "history": history},
        **{"reliability": 2, "durability": 1, "liveliness": 1, "liveliness_lease_duration": never},
    }


def seen_type(name: str) -> dict[str, object]:
    return {"name": name, "hash": {"version": 1, "value": [0] * 32}}


MESSAGE = {
    "name": "/robot/arm",
    "parameters": [
        {
            "name": "gain",
            "type": 3,
            "floating_point_range": [{"from_value": 0.0, "to_value": 2.0, "step": 0.0}],
        },
        {"name": "use_sim_time", "type": 1},
    ],
    "parameter_values": [{"type": 3, "double_value": 1.5}, {"type": 1, "bool_value": False}],
    "publishers": [
        {"name": "/robot/arm/out", "type": seen_type("std_msgs/msg/String"), "qos": seen_qos(1, 5)},
        {"name": "/rosout", "type": seen_type("rcl_interfaces/msg/Log"), "qos": seen_qos(1, 1)},
    ],
    "subscriptions": [{"name": "/in", "type": seen_type("std_msgs/msg/String"), "qos": seen_qos(3, 0)}],
    "service_servers": [{"name": "/robot/arm/go", "request_type": seen_type("std_srvs/srv/Trigger_Request")}],
    "action_servers": [
        {
            "name": "/a",
            "send_goal": {"request_type": seen_type("test_msgs/action/Fibonacci_SendGoal_Request")},
        },
        {"name": "/b", "request_type": seen_type("test_msgs/action/Fibonacci_SendGoal_Request")},
    ],
}


def test_describe_a_message(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """As `ros2 topic echo` prints it, in both forms that actions have had."""
    (folder / "seen.yaml").write_text(f"{yaml.safe_dump(MESSAGE)}---\n")
    assert nodl("describe", "--from", "seen.yaml") == 0
    found = yaml.safe_load(capsys.readouterr().out)
    assert found["parameters"] == {
        "gain": {"type": "double", "default_value": 1.5, "validation": {"bounds": [0.0, 2.0]}}
    }
    latched = {"reliability": "BEST_EFFORT", "durability": "TRANSIENT_LOCAL", "deadline_ns": 1_000_000_500}
    assert [(end["name"], end["qos"]) for end in found["publishers"]] == [
        ("~/out", {"history": "KEEP_LAST", "depth": 5, **latched})
    ]
    assert found["subscriptions"][0]["qos"] == {"history": "SYSTEM_DEFAULT", **latched}
    assert found["service_servers"] == [{"name": "~/go", "type": "std_srvs/srv/Trigger"}]
    assert {end["type"] for end in found["action_servers"]} == {"test_msgs/action/Fibonacci"}


@pytest.mark.parametrize(
    "text", ["", "[]", "name: /a\npublishers: [5]\n", "a: [", "name: /a\n---\nname: /b\n"]
)
def test_what_is_no_message(folder: Path, text: str) -> None:
    (folder / "seen.yaml").write_text(text)
    assert nodl("describe", "--from", "seen.yaml") == 2
