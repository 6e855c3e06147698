"""Mistakes in descriptions of nodes as a user sees them: `ifgen check` in all its forms, and `ifgen generate`."""

from __future__ import annotations

import json
import re
from pathlib import Path

import pytest
from ifgen.cli import main

DOCUMENT = """nodl_version: 2
publishers:
  - name: /joints
    type: sensor_msgs/msg/JointStat
    qos: {history: KEEP_LAST, reliability: RELIABLE}
parameters:
  gain:
    type: double
    default_value: 3.0
    validation:
      bounds: [0.0, 1.0]
"""
TEXT = """\
error[unknown-type]: package 'sensor_msgs' has no message 'JointStat'
 --> demo/nodl/talker.nodl.yaml:4:11
  |
4 |     type: sensor_msgs/msg/JointStat
  |           ^^^^^^^^^^^^^^^^^^^^^^^^^ not found
  = help: did you mean `JointState` or `MultiDOFJointState`?

error[missing-key]: KEEP_LAST needs the key `depth`
 --> demo/nodl/talker.nodl.yaml:5:20
  |
5 |     qos: {history: KEEP_LAST, reliability: RELIABLE}
  |                    ^^^^^^^^^
  = help: say how many messages to keep, such as `depth: 10`

error[rejected-default]: the default does not pass its own validator: `bounds` allows [0.0, 1.0]
  --> demo/nodl/talker.nodl.yaml:9:20
   |
 9 |     default_value: 3.0
   |                    ^^^
11 |       bounds: [0.0, 1.0]
   |       ------ because of this
   = help: the node could not start: change one of the two

3 errors
"""


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A package with a wrong description, in the working directory."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    monkeypatch.setenv("COLUMNS", "100")
    monkeypatch.setenv("NO_COLOR", "1")
    file = tmp_path / "demo/nodl/talker.nodl.yaml"
    file.parent.mkdir(parents=True)
    file.write_text(DOCUMENT)
    return tmp_path


def test_for_people(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main.main(["check", "demo"]) == 1
    assert capsys.readouterr().out == TEXT


def test_for_tools(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main.main(["check", "demo", "--format", "json"]) == 1
    document = json.loads(capsys.readouterr().out)
    assert (document["errors"], document["warnings"]) == (3, 0)
    label = document["diagnostics"][1]["labels"][0]
    assert (label["path"], label["start"]) == ("demo/nodl/talker.nodl.yaml", {"line": 5, "column": 20})
    assert main.main(["check", "demo/nodl/talker.nodl.yaml", "--format", "github"]) == 1
    lines = capsys.readouterr().out.splitlines()
    assert lines[0].startswith("::error file=demo/nodl/talker.nodl.yaml,line=4,endLine=4,col=11,")


def test_nothing_is_generated(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Correct packages are not generated either; errors of interfaces and nodes are reported together."""
    (folder / "demo/msg").mkdir()
    (folder / "demo/msg/Bad.msg").write_text("float46 x\n")
    (folder / "good/msg").mkdir(parents=True)
    (folder / "good/msg/A.msg").write_text("float64 x\n")
    assert main.main(["generate", "demo", "good"]) == 1
    shown = capsys.readouterr().err
    assert "4 errors" in shown
    assert not (folder / "generated").exists()


def test_interfaces_of_a_nodes_own_package(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """They are found there, and each of their mistakes is reported once."""
    (folder / "demo/nodl/talker.nodl.yaml").write_text(
        "nodl_version: 2\nservice_servers: [{name: a, type: demo/A}, {name: b, type: demo/srv/B}]\n"
    )
    (folder / "demo/srv").mkdir()
    (folder / "demo/srv/A.srv").write_text("float64 x\n---\nB y\n")
    (folder / "demo/srv/B.srv").write_text("---\n")
    assert main.main(["check", "demo"]) == 1
    shown = capsys.readouterr().out
    assert re.findall(r"error\[.*?\]", shown) == ["error[unknown-type]"]
    (folder / "demo/srv/A.srv").write_text("float64 x\n---\n")
    assert main.main(["check", "demo"]) == 0
    assert capsys.readouterr().out == "2 interfaces and 1 node in 1 package: no mistakes\n"


def test_the_example_of_the_documentation(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    text = (Path(__file__).parents[2] / "docs/nodl.md").read_text()
    (folder / "demo/nodl/talker.nodl.yaml").write_text(text.split("```yaml\n")[1].split("```")[0])
    assert main.main(["check", "demo"]) == 0
    assert capsys.readouterr().out == "1 node in 1 package: no mistakes\n"
