"""`ifgen policy sros2`: the policy.xml of a system, and what its schema refuses."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from xml.etree import ElementTree

import pytest
from ifgen.cli import main
from ifgen_tools.policy import sros2
from ifgen_tools.policy.grants import Grants

from .conftest import HERE

LAUNCH = [str(HERE / "robot.launch.py"), str(HERE / "robot")]


def test_a_policy_is_one(robot: list[Grants], humanoid: list[Grants]) -> None:
    for grants in (robot, humanoid):
        assert sros2.problems(sros2.text(grants)) == []


def test_what_a_node_may(robot: list[Grants]) -> None:
    root = ElementTree.fromstring(sros2.text(robot))
    [planner] = [each for each in root.iter("profile") if each.get("node") == "planner"]
    assert planner.get("ns") == "/robot"
    lists = {(each.tag, *each.attrib.items()): [item.text for item in each] for each in planner}
    assert lists["topics", ("subscribe", "ALLOW")] == ["/robot/map"]
    assert lists["services", ("request", "ALLOW")] == ["/robot/driver/reset"]
    assert lists["actions", ("call", "ALLOW")] == ["/robot/move"]
    assert "/robot/planner/get_parameters" in lists["services", ("reply", "ALLOW")]
    assert lists["topics", ("publish", "ALLOW")] == ["/parameter_events", "/rosout"]
    [mover] = [each for each in root.iter("profile") if each.get("node") == "mover"]
    assert "/robot/cmd_vel" in [each.text for each in mover.iter("topic")]


def test_nodes_of_one_enclave(robot: list[Grants]) -> None:
    root = ElementTree.fromstring(sros2.text([replace(each, enclave="/robot") for each in robot]))
    assert [each.get("path") for each in root.iter("enclave")] == ["/robot"]
    assert len(list(root.iter("profile"))) == 5


PROFILE = (
    '<policy version="0.2.0"><enclaves><enclave path="/"><profiles><profile ns="/" node="a">{}'
    "</profile></profiles></enclave></enclaves></policy>"
)


@pytest.mark.parametrize(
    ("policy", "said"),
    [
        ("<policy", "no XML"),
        ("<enclaves/>", "`enclaves` is no policy"),
        ("<policy><enclaves/></policy>", "`policy` needs the attribute `version`"),
        ('<policy version="0.2.0"/>', "`policy` must not be empty"),
        (PROFILE.format("<topic>a</topic>"), "`topic` does not belong into `profile`"),
        (PROFILE.format('<topics publish="YES"><topic>a</topic></topics>'), "ALLOW or DENY, not `YES`"),
        (PROFILE.format('<topics publish="ALLOW"/>'), "`topics` must not be empty"),
        (PROFILE.format('<topics publish="ALLOW"><topic/></topics>'), "a name as its text"),
        (PROFILE.format('<topics reply="ALLOW"><topic>a</topic></topics>'), "no attribute `reply`"),
        (PROFILE.replace(' node="a"', "").format(""), "needs the attribute `node`"),
    ],
)
def test_what_is_none(policy: str, said: str) -> None:
    assert any(said in each for each in sros2.problems(policy))


def test_a_profile_may_be_empty() -> None:
    assert sros2.problems(PROFILE.format("")) == []


def test_the_commands_write(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main.main(["policy", "sros2", *LAUNCH, "-o", str(tmp_path / "policy.xml")]) == 0
    assert sros2.problems((tmp_path / "policy.xml").read_text()) == []
    assert main.main(["policy", "zenoh", *LAUNCH, "-o", str(tmp_path / "sessions")]) == 0
    assert {path.name for path in (tmp_path / "sessions").iterdir()} == {
        f"robot.{name}.json5" for name in ("camera", "driver", "mapper", "mover", "planner")
    }
    capsys.readouterr()


def test_a_node_without_a_document_may_do_nothing(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main.main(["policy", "sros2", LAUNCH[0]]) == 0
    done = capsys.readouterr()
    assert "warning: /robot/driver has no document, so it may do nothing" in done.err
    assert "profile" not in done.out


def test_a_wrong_domain(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    monkeypatch.setenv("ROS_DOMAIN_ID", "many")
    assert main.main(["policy", "router", *LAUNCH]) == 1
    assert "ROS_DOMAIN_ID is 'many'" in capsys.readouterr().err
