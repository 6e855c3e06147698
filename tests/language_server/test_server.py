"""The language server as an editor meets it: over pipes, with texts that are not saved and not valid."""

from __future__ import annotations

import json
import sys
from collections.abc import Generator
from pathlib import Path

import pytest
from ifgen.cli.main import main

from .client import PUSHED, Client, editing

pytest.importorskip("pygls")

POSE = "# A pose.\nstd_msgs/Header header\nfloat64 x 1.5 # [m]\nfloat64[3] rest\nuint8 LEFT=0\n"
XML = (
    '<?xml version="1.0"?>\n<package format="3">\n  <name>demo_msgs</name>\n  <version>0.0.0</version>\n'
    "  <description>d</description>\n  <maintainer email='a@b.c'>m</maintainer>\n  <license>MIT</license>\n"
    "  <depend>std_msgs</depend>\n  <member_of_group>rosidl_interface_packages</member_of_group>\n</package>\n"
)
NODE = "nodl_version: 2\npublishers:\n  - name: pose\n    type: demo_msgs/msg/Pose\n    qos: {history: KEEP_LAST, depth: 10, reliability: RELIABLE}\n"
FILES = {
    "demo_msgs/package.xml": XML,
    "demo_msgs/msg/Pose.msg": POSE,
    "demo_msgs/msg/Pair.msg": "Pose first\nPose second\n",
    "demo_msgs/srv/Move.srv": "Pose goal\n---\nbool ok\n",
    "demo_msgs/nodl/walker.nodl.yaml": NODE,
    "walk.py": "from demo_msgs.msg import Pose\n\nprint(Pose().x)\n",
}


@pytest.fixture
def project(tmp_path: Path) -> Path:
    for name, text in FILES.items():
        path = tmp_path / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)
    return tmp_path


@pytest.fixture
def editor(project: Path) -> Generator[Client]:
    with editing(project) as client:
        yield client


def test_findings_of_unsaved_text(editor: Client) -> None:
    editor.open("demo_msgs/msg/Pose.msg")
    assert editor.pull("demo_msgs/msg/Pose.msg") == []
    editor.change("demo_msgs/msg/Pose.msg", "float64 x\nstd_msgs/Hedder h\nfloat64\nfloat64 y z\n")
    found = editor.pull("demo_msgs/msg/Pose.msg")
    assert [each["range"]["start"]["line"] for each in found] == [1, 2, 3]
    editor.change("demo_msgs/msg/Pose.msg", "# é𐀀\nfloat64 x # é\nstd_msgs/Hedder h\n")
    [finding] = editor.pull("demo_msgs/msg/Pose.msg")
    assert finding["code"] == "unknown-type"
    assert finding["range"] == {"start": {"line": 2, "character": 0}, "end": {"line": 2, "character": 15}}
    assert finding["message"].endswith("help: did you mean `Header`?")
    assert finding["codeDescription"]["href"].endswith("docs/rules.md#unknown-type")


def test_findings_are_those_of_check(editor: Client, capsys: pytest.CaptureFixture[str]) -> None:
    """Each with its rule, its place and its words."""
    name = "demo_msgs/msg/Bad.msg"
    (editor.root / name).write_text("float32 From\nbyte class\nint8 K=300\nNope n\n")
    editor.open(name)
    shown = {(each["code"], each["range"]["start"]["line"] + 1) for each in editor.pull(name)}
    assert main(["check", str(editor.root / "demo_msgs"), "--format", "json"]) == 1
    checked: set[tuple[str, int]] = set()
    for finding in json.loads(capsys.readouterr().out)["diagnostics"]:
        [label] = [each for each in finding["labels"] if each["primary"]]
        if label["path"].endswith("Bad.msg"):
            checked.add((finding["rule"], label["start"]["line"]))
    assert shown == checked
    assert len(shown) >= 3


def test_a_client_that_does_not_ask_is_told(project: Path) -> None:
    with editing(project, PUSHED) as editor:
        name = "demo_msgs/msg/Pair.msg"
        editor.open(name, "Poze first\n")
        editor.request("textDocument/hover", **editor.at(name, 0, 8))
        [finding] = editor.published[editor.uri(name)]
        assert finding["code"] == "unknown-type"
        editor.change(name, "Pose first\n")
        editor.request("textDocument/hover", **editor.at(name, 0, 8))
        assert editor.published[editor.uri(name)] == []


def test_a_client_that_asks_is_not_told_twice(editor: Client) -> None:
    name = "demo_msgs/msg/Pair.msg"
    editor.open(name, "Poze first\n")
    assert len(editor.pull(name)) == 1
    assert editor.uri(name) not in editor.published


def test_hover(editor: Client) -> None:
    editor.open("demo_msgs/msg/Pair.msg")
    text = editor.request("textDocument/hover", **editor.at("demo_msgs/msg/Pair.msg", 0, 2))["contents"][
        "value"
    ]
    assert text.startswith("**demo_msgs/msg/Pose** (message)\n\nA pose.\n\n```rosmsg\n")
    assert "float64 x 1.5  # [m]" in text
    assert "variable size, used in 3 files" in text
    assert "RIHS01_" in text
    editor.open("demo_msgs/srv/Move.srv")
    text = editor.request("textDocument/hover", **editor.at("demo_msgs/srv/Move.srv", 2, 6))["contents"][
        "value"
    ]
    assert text == "```rosmsg\nbool ok\n```\n\n1 bytes at offset 0 of demo_msgs/srv/Move_Response"


def test_definition_and_references(editor: Client) -> None:
    editor.open("demo_msgs/msg/Pair.msg")
    place = editor.at("demo_msgs/msg/Pair.msg", 1, 2)
    assert editor.request("textDocument/definition", **place)["uri"] == editor.uri("demo_msgs/msg/Pose.msg")
    found = editor.request("textDocument/references", **place, context={"includeDeclaration": False})
    assert sorted(Path(each["uri"]).name for each in found) == [
        "Move.srv",
        "Pair.msg",
        "Pair.msg",
        "walker.nodl.yaml",
    ]
    node = editor.at("demo_msgs/nodl/walker.nodl.yaml", 3, 24)
    editor.open("demo_msgs/nodl/walker.nodl.yaml")
    assert editor.request("textDocument/definition", **node)["uri"] == editor.uri("demo_msgs/msg/Pose.msg")


def test_the_outline(editor: Client) -> None:
    editor.open("demo_msgs/srv/Move.srv")
    document = {"textDocument": {"uri": editor.uri("demo_msgs/srv/Move.srv")}}
    outline = editor.request("textDocument/documentSymbol", **document)
    assert [(part["name"], [each["name"] for each in part["children"]]) for part in outline] == [
        ("request", ["goal"]),
        ("response", ["ok"]),
    ]
    assert [each["startLine"] for each in editor.request("textDocument/foldingRange", **document)] == []
    tokens = editor.request("textDocument/semanticTokens/full", **document)["data"]
    assert tokens == [0, 0, 4, 0, 0, 0, 5, 4, 1, 0, 2, 5, 2, 1, 0]
    found = editor.request("workspace/symbol", query="rest")
    assert [(each["name"], each["containerName"]) for each in found] == [("rest", "demo_msgs/msg/Pose")]


def test_inlay_hints(editor: Client) -> None:
    editor.open("demo_msgs/msg/Pair.msg", "bool a\nfloat64[3] b\nstring c\nint8 d\n")
    whole = {"start": {"line": 0, "character": 0}, "end": {"line": 9, "character": 0}}
    hints = editor.request(
        "textDocument/inlayHint", textDocument={"uri": editor.uri("demo_msgs/msg/Pair.msg")}, range=whole
    )
    assert [each["label"] for each in hints] == ["@0 +1", "@8 +24"]


def test_completion(editor: Client) -> None:
    editor.open("demo_msgs/msg/Pair.msg", "Po\n")
    items = editor.request("textDocument/completion", **editor.at("demo_msgs/msg/Pair.msg", 0, 2))
    by_label = {each["label"]: each for each in items}
    assert {"Pose", "float64", "geometry_msgs/Pose", "std_msgs/Header"} <= by_label.keys()
    assert "Pair" not in by_label
    assert "command" not in by_label["std_msgs/Header"]
    command = by_label["geometry_msgs/Pose"]["command"]
    editor.request("workspace/executeCommand", command=command["command"], arguments=command["arguments"])
    editor.request("textDocument/completion", **editor.at("demo_msgs/msg/Pair.msg", 0, 2))
    [edit] = [each for each in editor.asked if each["method"] == "workspace/applyEdit"]
    [change] = edit["params"]["edit"]["changes"][editor.uri("demo_msgs/package.xml")]
    assert change["newText"] == "  <depend>geometry_msgs</depend>\n"


def test_completion_of_descriptions(editor: Client) -> None:
    name = "demo_msgs/nodl/walker.nodl.yaml"

    def offered(text: str) -> set[str]:
        editor.change(name, text)
        line = text.count("\n")
        place = editor.at(name, line, len(text.rpartition("\n")[2]))
        return {each["label"] for each in editor.request("textDocument/completion", **place)}

    editor.open(name)
    assert {"publishers", "parameters", "include"} <= offered("nodl_version: 2\np")
    assert {"name", "type", "qos"} <= offered("nodl_version: 2\npublishers:\n  - name: pose\n    t")
    assert "demo_msgs/msg/Pose" in offered("nodl_version: 2\npublishers:\n  - name: pose\n    type: ")
    assert "demo_msgs/srv/Move" in offered("nodl_version: 2\nservice_servers:\n  - name: move\n    type: ")
    assert {"RELIABLE", "BEST_EFFORT"} <= offered(
        "nodl_version: 2\npublishers:\n  - name: pose\n    qos:\n      reliability: "
    )


def test_quick_fixes(editor: Client) -> None:
    name = "demo_msgs/msg/Pair.msg"
    editor.open(name, "Poze first\ngeometry_msgs/Point p\n")
    whole = {"start": {"line": 0, "character": 0}, "end": {"line": 9, "character": 0}}
    found = editor.request(
        "textDocument/codeAction",
        textDocument={"uri": editor.uri(name)},
        range=whole,
        context={"diagnostics": []},
    )
    titles = {each["title"]: each for each in found}
    [edit] = titles["Change to `Pose`"]["edit"]["changes"][editor.uri(name)]
    assert edit["newText"] == "Pose first\n"


def test_formatting(editor: Client) -> None:
    name = "demo_msgs/msg/Pair.msg"
    editor.open(name, "Pose   first\r\nPose second\r\n")
    edits = editor.request(
        "textDocument/formatting",
        textDocument={"uri": editor.uri(name)},
        options={"tabSize": 2, "insertSpaces": True},
    )
    assert [each["newText"] for each in edits] == ["Pose first\n"]


def test_a_type_is_renamed_everywhere(editor: Client) -> None:
    name = "demo_msgs/msg/Pair.msg"
    editor.open(name)
    edit = editor.request("textDocument/rename", **editor.at(name, 0, 2, newName="Stance"))
    moves = [each for each in edit["documentChanges"] if each.get("kind") == "rename"]
    assert [each["newUri"] for each in moves] == [editor.uri("demo_msgs/msg/Stance.msg")]
    changed = {each["textDocument"]["uri"] for each in edit["documentChanges"] if "textDocument" in each}
    assert changed == {
        editor.uri(each) for each in (name, "demo_msgs/srv/Move.srv", "demo_msgs/nodl/walker.nodl.yaml")
    }
    [annotation] = edit["changeAnnotations"].values()
    assert annotation["needsConfirmation"]
    assert "places in Python" in annotation["label"]


def test_a_field_is_renamed(editor: Client) -> None:
    name = "demo_msgs/msg/Pose.msg"
    editor.open(name)
    place = editor.at(name, 2, 8)
    assert editor.request("textDocument/prepareRename", **place)["placeholder"] == "x"
    edit = editor.request("textDocument/rename", **place, newName="forward")
    [change] = edit["documentChanges"]
    assert [each["newText"] for each in change["edits"]] == ["forward"]
    with pytest.raises(RuntimeError, match="has a 'rest' already"):
        editor.request("textDocument/rename", **place, newName="rest")
    with pytest.raises(RuntimeError, match="does not allow"):
        editor.request("textDocument/rename", **place, newName="Forward")
    assert editor.request("textDocument/prepareRename", **editor.at(name, 1, 3)) is None


def test_without_the_extra(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    monkeypatch.setitem(sys.modules, "pygls", None)
    monkeypatch.delitem(sys.modules, "ifgen.language_server.server", raising=False)
    assert main(["lsp"]) == 2
    assert "pip install 'ifgen-ros[lsp]'" in capsys.readouterr().err
