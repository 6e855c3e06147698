"""`ifgen breaking`: what it reads as the earlier version, what it prints, and what it says of bad input."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

from .conftest import STATE, Git, Outcome, Run, commit, write


def rules(done: Outcome) -> list[tuple[str, str]]:
    """The rules and messages that were printed as JSON."""
    return [(d["rule"], d["message"]) for d in document(done)]


def document(done: Outcome) -> list[dict[str, Any]]:
    assert done.err == ""
    found: list[dict[str, Any]] = json.loads(done.out)["diagnostics"]
    return found


def test_against_a_revision_with_the_places_of_both_versions(ifgen: Run, git: Git) -> None:
    write(Path("demo_msgs/msg/State.msg"), "float64 x\nfloat32 y\n")
    done = ifgen("breaking", "demo_msgs", "--against", "HEAD")
    assert (done.code, done.err) == (1, "")
    assert done.out == (
        "error[field-type]: demo_msgs/State.y was `float64`, and is `float32`\n"
        " --> demo_msgs/msg/State.msg:2:1\n"
        "  |\n"
        "2 | float32 y\n"
        "  | ^^^^^^^\n"
        " ::: HEAD:demo_msgs/msg/State.msg:2:1\n"
        "  |\n"
        "2 | float64 y\n"
        "  | ------- before\n"
        "  = help: this breaks source, hash and wire\n"
    )
    found = ifgen("breaking", "demo_msgs", "--against", "HEAD", "--format", "github")
    assert found.code == 1
    assert found.out == (
        "::error file=demo_msgs/msg/State.msg,line=2,endLine=2,col=1,endColumn=8,title=ifgen field-type::"
        "demo_msgs/State.y was `float64`, and is `float32`%0AHEAD:demo_msgs/msg/State.msg:2: before%0A"
        "help: this breaks source, hash and wire\n"
    )
    [diagnostic] = document(ifgen("breaking", "demo_msgs", "--against", "main", "--format", "json"))
    assert diagnostic["breaks"] == ["source", "hash", "wire"]
    assert [label.get("revision") for label in diagnostic["labels"]] == [None, "main"]


def test_nothing_is_reported_of_equal_versions(ifgen: Run, git: Git) -> None:
    write(Path("demo_msgs/msg/State.msg"), "# The state.\n\nfloat64   x  # [m]\nfloat64 y\n")
    write(Path("demo_msgs/msg/New.msg"), "State state\n")
    done = ifgen("breaking", "demo_msgs", "--against", "HEAD")
    assert done == Outcome(0, "2 interfaces: no change since HEAD breaks source\n", "")
    assert ifgen("breaking", "demo_msgs", "--against", "HEAD", "--quiet").out == ""
    assert ifgen("breaking", "demo_msgs", "--against", "HEAD", "--format", "github").out == ""


def test_a_package_that_was_in_another_folder_is_compared(ifgen: Run, git: Git) -> None:
    Path("src").mkdir()
    git("mv", "demo_msgs", "src/demo_msgs")
    assert ifgen("breaking", "src", "--against", "HEAD").code == 0
    write(Path("src/demo_msgs/msg/State.msg"), "float64 x\n")
    assert rules(ifgen("breaking", "src", "--against", "HEAD", "--format", "json")) == [
        ("field-removed", "demo_msgs/State.y is gone")
    ]


def test_a_renamed_file_is_one_change_and_the_fields_of_its_type_none(ifgen: Run, git: Git) -> None:
    write(Path("demo_msgs/msg/Held.msg"), "State[] states\n")
    commit(git)
    Path("demo_msgs/msg/State.msg").rename("demo_msgs/msg/Position.msg")
    write(Path("demo_msgs/msg/Held.msg"), "Position[] states\n")
    assert rules(ifgen("breaking", "demo_msgs", "--against", "HEAD", "--format", "json")) == [
        ("interface-renamed", "demo_msgs/msg/State is now demo_msgs/msg/Position")
    ]


def test_a_renamed_package_is_so_for_each_interface(ifgen: Run, git: Git) -> None:
    write(Path("demo_msgs/srv/Go.srv"), "State state\n---\n")
    commit(git)
    Path("demo_msgs").rename("robot_msgs")
    assert rules(ifgen("breaking", "robot_msgs", "--against", "HEAD", "--format", "json")) == []
    found = rules(ifgen("breaking", ".", "--against", "HEAD", "--format", "json"))
    assert found == [
        ("interface-renamed", "demo_msgs/msg/State is now robot_msgs/msg/State"),
        ("interface-renamed", "demo_msgs/srv/Go is now robot_msgs/srv/Go"),
    ]


def test_a_change_of_another_package_is_reported_by_its_path(ifgen: Run, git: Git) -> None:
    write(Path("base_msgs/msg/Pose.msg"), "float64 x\nfloat64[36] covariance\n")
    write(Path("base_msgs/msg/Pair.msg"), "Pose first\nPose second\n")
    write(Path("demo_msgs/msg/State.msg"), "bool flag\nbase_msgs/Pose pose\nbase_msgs/Pair[] pairs\n")
    commit(git)
    write(Path("base_msgs/msg/Pose.msg"), "float64 x\nfloat64[9] covariance\n")
    words = ("breaking", "demo_msgs", "-I", ".", "--against", "HEAD")
    [found] = document(ifgen(*words, "--format", "json"))
    assert found["message"] == "demo_msgs/State.pose.covariance was `float64[36]`, and is `float64[9]`"
    assert found["help"] == (
        "this breaks source, hash and wire. "
        "It also changes demo_msgs/State.pairs.first and demo_msgs/State.pairs.second"
    )
    assert [(label["path"], label["start"]["line"], label.get("revision")) for label in found["labels"]] == [
        ("demo_msgs/msg/State.msg", 2, None),
        ("base_msgs/msg/Pose.msg", 2, None),
        ("base_msgs/msg/Pose.msg", 2, "HEAD"),
    ]
    found_in_both = document(ifgen("breaking", ".", "--against", "HEAD", "--format", "json"))
    assert [d["message"] for d in found_in_both] == [
        "base_msgs/Pose.covariance was `float64[36]`, and is `float64[9]`"
    ]
    assert "It also changes base_msgs/Pair.first" in found_in_both[0]["help"]
    write(
        Path("demo_msgs/msg/State.msg"),
        "bool flag\n# ifgen: ignore[field-array]\nbase_msgs/Pose pose\nbase_msgs/Pair[] pairs\n",
    )
    assert ifgen(*words).code == 0


def test_categories_by_option_and_by_configuration(ifgen: Run, git: Git) -> None:
    write(Path("demo_msgs/msg/State.msg"), "float64 x\nfloat64 z\nuint8 K=1\n")
    write(Path("pyproject.toml"), '[tool.ifgen]\npaths = ["demo_msgs"]\nbreaking = "wire"\n')
    assert ifgen("breaking", "--against", "HEAD").out == "1 interface: no change since HEAD breaks wire\n"
    found = ifgen("breaking", "--against", "HEAD", "--category", "hash", "--format", "json")
    assert rules(found) == [("field-renamed", "demo_msgs/State.z was called `y`")]
    write(Path("pyproject.toml"), '[tool.ifgen]\npaths = ["demo_msgs"]\nbreaking = "bytes"\n')
    done = ifgen("breaking", "--against", "HEAD")
    assert done.code == 2
    assert '\'breaking\' in [tool.ifgen] must be "source", "hash" or "wire"' in done.err


def test_changes_can_be_ignored_in_three_ways(ifgen: Run, git: Git) -> None:
    write(Path("demo_msgs/msg/State.msg"), "float64 x\nfloat64 y\nbool fresh  # ifgen: ignore[field-added]\n")
    assert ifgen("breaking", "demo_msgs", "--against", "HEAD").code == 0
    assert ifgen("check", "demo_msgs", "--strict").code == 0
    write(Path("demo_msgs/msg/State.msg"), "float64 x\nfloat64 y\nbool fresh\n")
    assert ifgen("breaking", "demo_msgs", "--against", "HEAD").code == 1
    for line in ('ignore = ["field-added"]', 'per_file_ignores = {"demo_msgs/*" = ["field-added"]}'):
        write(Path("pyproject.toml"), f'[tool.ifgen]\npaths = ["demo_msgs"]\n{line}\n')
        assert ifgen("breaking", "--against", "HEAD").code == 0


def test_a_mistake_in_the_earlier_version_is_told_and_the_rest_compared(ifgen: Run, git: Git) -> None:
    write(Path("demo_msgs/msg/Broken.msg"), "float64\n")
    write(Path("demo_msgs/msg/Other.msg"), "Missing m\n")
    write(Path("demo_msgs/nodl/wrong.nodl.yaml"), "nodl_version: 3\n")
    write(
        Path("demo_msgs/nodl/right.nodl.yaml"),
        "nodl_version: 2\nparameters:\n  a: {type: int, default_value: 1}\n",
    )
    commit(git)
    write(Path("demo_msgs/msg/Broken.msg"), "float64 x\n")
    write(Path("demo_msgs/msg/Other.msg"), "State m\n")
    write(Path("demo_msgs/msg/State.msg"), "float64 x\n")
    write(Path("demo_msgs/nodl/wrong.nodl.yaml"), "nodl_version: 2\n")
    write(Path("demo_msgs/nodl/right.nodl.yaml"), "nodl_version: 2\n")
    found = document(ifgen("breaking", "demo_msgs", "--against", "HEAD", "--format", "json"))
    assert {(d["rule"], d["severity"], d["labels"][0].get("revision")) for d in found} == {
        ("field-removed", "error", None),
        ("parameter-removed", "error", None),
        ("missing-name", "warning", "HEAD"),
        ("unknown-type", "warning", "HEAD"),
        ("nodl-version", "warning", "HEAD"),
    }
    write(Path("demo_msgs/msg/State.msg"), STATE)
    write(
        Path("demo_msgs/nodl/right.nodl.yaml"),
        "nodl_version: 2\nparameters:\n  a: {type: int, default_value: 1}\n",
    )
    assert ifgen("breaking", "demo_msgs", "--against", "HEAD").code == 0


def test_a_mistake_now_is_an_error_and_no_change(ifgen: Run, git: Git) -> None:
    write(Path("demo_msgs/msg/State.msg"), "float64\n")
    done = ifgen("breaking", "demo_msgs", "--against", "HEAD", "--format", "json")
    assert (done.code, [rule for rule, _ in rules(done)]) == (1, ["missing-name"])


def test_against_a_folder(ifgen: Run, demo_msgs: Path) -> None:
    write(Path("earlier/demo_msgs/msg/State.msg"), STATE)
    write(Path("earlier/other_msgs/msg/State.msg"), STATE)
    write(Path("later/demo_msgs/msg/State.msg"), "float64 x\n")
    words = ("--against", "earlier", "--format", "json")
    assert rules(ifgen("breaking", "later/demo_msgs", *words)) == [
        ("package-removed", "package 'other_msgs' is gone, with 1 interface"),
        ("field-removed", "demo_msgs/State.y is gone"),
    ]
    Path("earlier/later").mkdir()
    Path("earlier/demo_msgs").rename("earlier/later/demo_msgs")
    assert rules(ifgen("breaking", "later", *words)) == [("field-removed", "demo_msgs/State.y is gone")]


def test_against_the_lock_file(ifgen: Run) -> None:
    write(Path("demo_msgs/msg/State.msg"), f"{STATE}uint8 K=1\nstd_msgs/Header header\n")
    write(Path("pyproject.toml"), '[tool.ifgen]\npaths = ["demo_msgs"]\n')
    assert ifgen("lock").code == 0
    assert ifgen("breaking", "--against", "ifgen.lock").code == 0
    write(Path("demo_msgs/msg/State.msg"), "float64 x\nfloat64 b\nuint8 K=2\nstd_msgs/Header header\n")
    assert [rule for rule, _ in rules(ifgen("breaking", "--against", "ifgen.lock", "--format", "json"))] == [
        "field-renamed",
        "constant-value",
    ]
    assert "::: ifgen.lock:" in ifgen("breaking", "--against", "ifgen.lock").out
    Path("ifgen.lock").write_text("version 1\n")
    done = ifgen("breaking", "--against", "ifgen.lock")
    assert (done.code, done.err.partition(":")[0]) == (1, "error[invalid-lock]")


@pytest.mark.parametrize("name", ["nothing", "--all", "", "HEAD~7", "x y", "§", "HEAD:demo_msgs", "a\nb"])
def test_a_revision_that_does_not_exist_is_one_error(ifgen: Run, git: Git, name: str) -> None:
    done = ifgen("breaking", "demo_msgs", f"--against={name}")
    assert (done.code, done.out) == (2, "")
    assert done.err.startswith("error[unknown-revision]: '")
    assert done.err.count("error[") == 1


def test_other_bad_places_are_one_error_each(ifgen: Run, git: Git, monkeypatch: pytest.MonkeyPatch) -> None:
    git("branch", "demo_msgs")
    done = ifgen("breaking", "demo_msgs", "--against", "demo_msgs")
    assert done.err.startswith("error[unknown-revision]: 'demo_msgs' is a folder here, and a revision too")
    assert ifgen("breaking", "demo_msgs", "--against", "./demo_msgs").code == 0
    git("clone", "--quiet", "--depth=1", f"file://{Path.cwd()}", "shallow")
    done = ifgen("breaking", "shallow/demo_msgs", "--against", "HEAD~1")
    assert "this clone is shallow" in done.err
    write(Path("damaged/.git"), "gitdir: nowhere\n")
    write(Path("damaged/demo_msgs/msg/State.msg"), STATE)
    done = ifgen("breaking", "damaged", "--against", "HEAD")
    assert (done.code, done.err.count("error[")) == (2, 1)
    monkeypatch.setenv("GIT_CEILING_DIRECTORIES", str(Path.cwd().parent))
    git("init", "--quiet", "empty")
    write(Path("empty/demo_msgs/msg/State.msg"), STATE)
    assert "the repository has no commit yet" in ifgen("breaking", "empty", "--against", "v1").err
    done = ifgen("breaking", "empty", "--against", "HEAD")
    assert (done.code, "the repository has no commit yet" in done.err) == (2, True)
    Path("nothing").mkdir()
    write(Path("other.lock"), "version 1\nend\n")
    for reference in ("nothing", "other.lock"):
        done = ifgen("breaking", "demo_msgs", "--against", reference)
        assert (done.code, "there is nothing to compare" in done.err) == (2, True), done
    monkeypatch.setenv("PATH", "")
    done = ifgen("breaking", "demo_msgs", "--against", "HEAD")
    assert (done.code, done.err.splitlines()[0]) == (2, "error[no-git]: git is not installed")


def test_outside_of_a_repository(ifgen: Run, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("GIT_CEILING_DIRECTORIES", str(Path.cwd().parent))
    write(Path("demo_msgs/msg/State.msg"), STATE)
    done = ifgen("breaking", "demo_msgs", "--against", "HEAD")
    assert done.code == 2
    assert done.err.startswith("error[unknown-revision]: ")
    assert "is not in a git repository" in done.err


def test_unusual_names_links_and_a_dirty_folder(ifgen: Run, git: Git) -> None:
    folder = Path("dü mmy\nx")
    write(folder / "demo_msgs/msg/State.msg", STATE)
    write(folder / "linked_msgs/msg/Linked.msg", "int8 x\n")
    (folder / "demo_msgs/srv").symlink_to("../services", target_is_directory=True)
    write(folder / "services/Go.srv", "int8 x\n---\n")
    (folder / "demo_msgs/msg/Copy.msg").symlink_to("State.msg")
    Path("demo_msgs/msg/State.msg").unlink()
    commit(git)
    assert ifgen("breaking", folder, "--against", "HEAD").code == 0
    write(folder / "demo_msgs/msg/State.msg", "float64 x\n")
    write(folder / "services/Go.srv", "int16 x\n---\n")
    (folder / "demo_msgs/msg/State.msg").read_text()
    found = rules(ifgen("breaking", folder, "--against", "HEAD", "--format", "json"))
    assert found == [
        ("field-removed", "demo_msgs/Copy.y is gone"),
        ("field-removed", "demo_msgs/State.y is gone"),
        ("field-type", "demo_msgs/srv/Go_Request.x was `int8`, and is `int16`"),
    ]


def test_lists_of_cmake_and_markers_count_as_they_were(ifgen: Run, git: Git) -> None:
    write(Path("demo_msgs/package.xml"), "<package format='3'><name>demo_msgs</name></package>\n")
    cmake = "project(demo_msgs)\nfile(GLOB files RELATIVE ${CMAKE_CURRENT_SOURCE_DIR} msg/*.msg)\n"
    write(Path("demo_msgs/CMakeLists.txt"), f"{cmake}rosidl_generate_interfaces(demo_msgs ${{files}})\n")
    write(Path("demo_msgs/msg/Unused.msg"), "int8 x\n")
    write(Path("more/old_msgs/msg/Old.msg"), "int8 x\n")
    write(Path("more/old_msgs/COLCON_IGNORE"), "")
    commit(git)
    write(
        Path("demo_msgs/CMakeLists.txt"),
        'project(demo_msgs)\nrosidl_generate_interfaces(demo_msgs "msg/State.msg")\n',
    )
    Path("more/old_msgs/COLCON_IGNORE").unlink()
    assert rules(ifgen("breaking", ".", "--against", "HEAD", "--format", "json")) == [
        ("interface-removed", "demo_msgs/msg/Unused is gone")
    ]


def test_submodules_are_read_at_their_commit(ifgen: Run, git: Git) -> None:
    git("clone", "--quiet", ".", "elsewhere")
    git("submodule", "--quiet", "add", f"{Path.cwd()}/elsewhere", "parts/sub")
    commit(git)
    write(Path("parts/sub/demo_msgs/msg/State.msg"), "float64 x\n")
    Path("demo_msgs/msg/State.msg").unlink()
    assert rules(ifgen("breaking", "parts", "--against", "HEAD", "--format", "json")) == [
        ("field-removed", "demo_msgs/State.y is gone")
    ]


def test_a_revision_is_completed(ifgen: Run, git: Git, monkeypatch: pytest.MonkeyPatch) -> None:
    git("tag", "v1.2")
    monkeypatch.setenv("_IFGEN_COMPLETE", "bash_complete")
    monkeypatch.setenv("COMP_WORDS", "ifgen breaking --against v")
    monkeypatch.setenv("COMP_CWORD", "3")
    assert ifgen().out == "plain,v1.2\n"
