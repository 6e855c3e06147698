"""`ifgen nodl conform`: each single edit of a document is noticed in a running node, on both transports."""

from __future__ import annotations

import copy
import importlib.util
import random
import subprocess
import sys
from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
import yaml
from ifgen_tools.nodl import contract
from ifgen_tools.nodl.conformance import Choices, Report, Side, compare

HERE = Path(__file__).parent
needs_rclpy = pytest.mark.skipif(importlib.util.find_spec("rclpy") is None, reason="there is no real rclpy")
TRANSPORTS = [
    pytest.param("local", marks=pytest.mark.slow),
    pytest.param("rclpy", marks=[needs_rclpy, pytest.mark.slow]),
]
DOCUMENT = yaml.safe_load((HERE / "conforming.nodl.yaml").read_text())
Tree = dict[str, Any]
Edit = tuple[str, str, set[str]]
"""The list and the name that an edit is about, and the kinds of differences that must be noticed."""


def report(tmp_path: Path, document: Tree, seen: Side, choices: Choices = Choices()) -> Report:  # noqa: B008
    path = tmp_path / "edited.nodl.yaml"
    path.write_text(yaml.safe_dump(document))
    return compare(contract.read(path).side("/robot/walker"), seen, choices)


def full(name: str) -> str:
    if name.startswith("~"):
        return name.replace("~/", "/robot/walker/")
    return name if name.startswith("/") else f"/robot/{name}"


def edits() -> Iterator[Callable[[Tree], Edit]]:
    """Every way to change one thing in the document."""

    def end(category: str, index: int, change: Callable[[Tree], set[str]]) -> Callable[[Tree], Edit]:
        def edit(document: Tree) -> Edit:
            found = document[category][index]
            name = full(found["name"])
            return category, name, change(found)

        return edit

    def put(key: str, value: object, *kinds: str) -> Callable[[Tree], set[str]]:
        def change(found: Tree) -> set[str]:
            found[key] = value
            return set(kinds)

        return change

    def in_qos(key: str, value: object) -> Callable[[Tree], set[str]]:
        def change(found: Tree) -> set[str]:
            found["qos"][key] = value
            return {"qos_mismatch", "unverifiable"} if key in {"depth", "history"} else {"qos_mismatch"}

        return change

    def remove(category: str, index: int) -> Callable[[Tree], Edit]:
        def edit(document: Tree) -> Edit:
            found = document[category].pop(index)
            return category, full(found["name"]), {"extra"}

        return edit

    def parameter(name: str, key: str, value: object, kind: str) -> Callable[[Tree], Edit]:
        def edit(document: Tree) -> Edit:
            document["parameters"][name][key] = value
            return "parameters", name, {kind}

        return edit

    def drop_parameter(name: str) -> Callable[[Tree], Edit]:
        def edit(document: Tree) -> Edit:
            del document["parameters"][name]
            return "parameters", name, {"extra"}

        return edit

    others = {
        "msg": "std_msgs/msg/Empty",
        "srv": "std_srvs/srv/SetBool",
        "action": "test_msgs/action/Fibonacci",
    }
    for category, listed in DOCUMENT.items():
        for index, found in enumerate(listed if isinstance(listed, list) else ()):
            folder = found["type"].split("/")[1]
            yield end(category, index, put("name", f"{found['name']}_x", "missing", "extra"))
            yield end(category, index, put("type", others[folder], "type_mismatch"))
            yield remove(category, index)
            if qos := found.get("qos"):
                best = "BEST_EFFORT" if qos["reliability"] == "RELIABLE" else "RELIABLE"
                yield end(category, index, in_qos("reliability", best))
                latched = "VOLATILE" if qos["durability"] == "TRANSIENT_LOCAL" else "TRANSIENT_LOCAL"
                yield end(category, index, in_qos("durability", latched))
                yield end(category, index, in_qos("liveliness", "MANUAL_BY_TOPIC"))
                yield end(category, index, in_qos("depth", qos["depth"] + 1))
                yield end(category, index, in_qos("deadline_ns", 7_000_000))
                yield end(category, index, in_qos("lifespan_ns", 7_000_000))
                yield end(category, index, in_qos("liveliness_lease_duration_ns", 7_000_000))
                other = "KEEP_LAST" if qos["history"] == "KEEP_ALL" else "KEEP_ALL"
                yield end(category, index, in_qos("history", other))
    for name, said in DOCUMENT["parameters"].items():
        yield drop_parameter(name)
        if "default_value" not in said:
            continue  # nobody sees the type of what has no value
        yield parameter(
            name, "type", "bool_array" if said["type"] != "bool_array" else "int", "type_mismatch"
        )
        yield parameter(name, "read_only", not said.get("read_only", False), "property_mismatch")
        if said["type"] in {"bool", "string"}:
            other_value: Any = "other" if said["type"] == "string" else not said["default_value"]
            yield parameter(name, "default_value", other_value, "property_mismatch")
        if said["type"] in {"int", "double"} and "default_value" in said:
            yield parameter(name, "validation", {"bounds": [-1000, 1000]}, "property_mismatch")
            yield parameter(name, "default_value", 7, "property_mismatch")


EDITS = list(edits())


@pytest.fixture(scope="module", params=TRANSPORTS)
def seen(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Side:
    """What a running node has, as a process of its own sees it."""
    import pickle

    file = tmp_path_factory.mktemp("seen") / "side"
    command = [
        sys.executable,
        str(HERE / "observe.py"),
        request.param,
        str(HERE / "conforming.py"),
        str(file),
    ]
    subprocess.run(command, check=True, timeout=60, capture_output=True)
    side: Side = pickle.loads(file.read_bytes())
    return side


def test_the_document_fits(tmp_path: Path, seen: Side) -> None:
    found = report(tmp_path, DOCUMENT, seen)
    assert found.failures == ()
    assert {each.name for each in found.differences} <= {"/b", "/robot/walker/a", "/robot/c", "unset"}
    assert all("history" in each.detail or "no value" in each.detail for each in found.differences)


def test_two_hundred_edits(tmp_path: Path, seen: Side) -> None:
    """Each is noticed, and nothing else is; DDS does not say the depth."""
    chooser = random.Random(28)
    missed = []
    before = set(report(tmp_path, DOCUMENT, seen).differences)
    for number in range(200):
        document = copy.deepcopy(DOCUMENT)
        edit = EDITS[number] if number < len(EDITS) else chooser.choice(EDITS)
        section, name, kinds = edit(document)
        new = [each for each in report(tmp_path, document, seen).differences if each not in before]
        if "unverifiable" in kinds and not new:
            new = [each for each in before if each.name == name]
        right = [each for each in new if each.section == section and each.name.startswith(name)]
        if not right or right != new or not kinds & {each.kind for each in right}:
            missed.append((section, name, kinds, new))
    assert missed == []
    assert len(EDITS) > 50


def test_definitions_of_services_and_actions(seen: Side) -> None:
    """Each of their parts has its hash, and one that differs is noticed."""
    services = [end for end in seen.ends if end.category.folder != "msg"]
    assert {end.category.value for end in services} >= {"service_servers", "action_servers"}
    for end in services:
        assert end.parts, end
        for type_name, type_hash in end.parts.items():
            assert type_hash.startswith("RIHS01_")
            said = replace(end, parts={type_name: "RIHS01_other"})
            [found] = compare(Side((said,), ()), Side((end,), ()), Choices()).differences
            assert (found.kind, found.name) == ("hash_mismatch", end.name)
            assert type_name in found.detail


def test_rules_to_ignore(tmp_path: Path, seen: Side) -> None:
    document = copy.deepcopy(DOCUMENT)
    removed = document["publishers"].pop(0)
    for rule in ("publisher:/b", f"publisher:*:{removed['type']}", "publisher:/*"):
        found = report(tmp_path, document, seen, Choices(ignore=(rule,)))
        assert found.failures == ()
        assert [each.name for each in found.ignored] == ["/b"]
    for rule in ("publisher:/c", "subscription:/b", "publisher:*:std_msgs/msg/Int8"):
        assert report(tmp_path, document, seen, Choices(ignore=(rule,))).failures


@pytest.mark.parametrize(
    "rule", ["publisher", "topic:/b", "publisher:b", "parameter:a:int", "publisher:/a:b:c"]
)
def test_rules_that_are_none(tmp_path: Path, rule: str) -> None:
    from ifgen.diagnostics import UsageError

    with pytest.raises(UsageError, match="says nothing to ignore"):
        report(tmp_path, DOCUMENT, Side((), ()), Choices(ignore=(rule,)))


@pytest.mark.slow
def test_the_command_takes_remaps_from_a_launch_file(tmp_path: Path) -> None:
    launch = f"""
from launch import LaunchDescription
from launch_ros.actions import Node

def generate_launch_description():
    program = {str(HERE / "conforming.py")!r}
    return LaunchDescription([Node(executable=program, name="walker", namespace="robot", remappings=[("/plain", "/b")])])
"""
    (tmp_path / "robot.launch.py").write_text(launch)
    document = copy.deepcopy(DOCUMENT)
    document["publishers"][0]["name"] = "/plain"
    (tmp_path / "w.nodl.yaml").write_text(yaml.safe_dump(document))

    def conform(*words: str) -> subprocess.CompletedProcess[str]:
        command = [sys.executable, "-m", "ifgen", "nodl", "conform", "--file", "w.nodl.yaml", *words]
        program = ["--transport", "local", "--", str(HERE / "conforming.py")]
        return subprocess.run(
            [*command, *program], capture_output=True, text=True, timeout=60, cwd=tmp_path, check=False
        )

    done = conform("--launch", "robot.launch.py")
    assert (done.returncode, "conforms" in done.stdout) == (0, True), done.stdout + done.stderr
    done = conform("--format", "github")
    assert done.returncode == 1
    assert "::error file=w.nodl.yaml,line=" in done.stdout


def test_remaps(tmp_path: Path, seen: Side) -> None:
    document = copy.deepcopy(DOCUMENT)
    document["publishers"][0]["name"] = "/plain"
    path = tmp_path / "remapped.nodl.yaml"
    path.write_text(yaml.safe_dump(document))
    remaps = contract.remaps_of(["/plain:=/b"])
    assert compare(contract.read(path).side("/robot/walker", remaps), seen, Choices()).failures == ()
