"""`ifgen lock` and `ifgen generate --locked`: what changed under a project is an error that shows the field."""

from __future__ import annotations

from pathlib import Path

import pytest

from .conftest import Run, write

SPEED = "float64 x 0.1\nfloat32 y\nstring NAME='a'\n"


@pytest.fixture(autouse=True)
def project(tmp_path: Path) -> Path:
    """A project that needs a package of somebody else's."""
    write(tmp_path / "pyproject.toml", '[tool.ifgen]\npaths = ["interfaces"]\ninclude = ["others"]\n')
    write(tmp_path / "interfaces/demo_msgs/msg/Move.msg", "others_msgs/Speed speed\nstd_msgs/Header header\n")
    write(tmp_path / "others/others_msgs/msg/Speed.msg", SPEED)
    write(tmp_path / "others/others_msgs/msg/Unused.msg", "int8 a\n")
    return tmp_path


@pytest.fixture
def speed(project: Path) -> Path:
    return project / "others/others_msgs/msg/Speed.msg"


def test_the_lock_holds_what_is_generated_and_what_that_needs(ifgen: Run, project: Path) -> None:
    assert ifgen("lock").out == "ifgen.lock: written (4 interfaces of 4 packages)\n"
    lines = (project / "ifgen.lock").read_text().splitlines()
    assert [line.partition(" ")[0] for line in lines if " RIHS01_" in line] == [
        "builtin_interfaces/msg/Time",
        "demo_msgs/msg/Move",
        "others_msgs/msg/Speed",
        "std_msgs/msg/Header",
    ]
    assert lines[lines.index("    float64 x 0.1") :][:3] == [
        "    float64 x 0.1",
        "    float32 y",
        '    string NAME="a"',
    ]


def test_the_lock_is_beside_pyproject_toml(
    ifgen: Run, project: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(project / "interfaces/demo_msgs")
    assert ifgen("lock").code == 0
    assert (project / "ifgen.lock").is_file()
    assert ifgen("generate", "--locked").code == 0


def test_a_second_run_writes_nothing(ifgen: Run, project: Path) -> None:
    ifgen("lock")
    before = (project / "ifgen.lock").stat()
    assert ifgen("lock").out == "ifgen.lock: up to date (4 interfaces of 4 packages)\n"
    assert (project / "ifgen.lock").stat().st_mtime_ns == before.st_mtime_ns


def test_interfaces_of_nodes_are_locked_too(ifgen: Run, project: Path) -> None:
    chat = (
        "{name: chat, type: std_msgs/msg/String, qos: {history: KEEP_LAST, depth: 1, reliability: RELIABLE}}"
    )
    node = f"nodl_version: 2\npublishers: [{chat}]\n"
    write(project / "interfaces/talker/nodl/talker.nodl.yaml", node)
    found = ifgen("lock")
    assert found.code == 0, found.err
    assert "std_msgs/msg/String RIHS01_" in (project / "ifgen.lock").read_text()


@pytest.mark.parametrize(
    ("old", "new", "message", "places"),
    [
        ("float32 y", "float64 y", "`float64 y` was `float32 y`", ("Speed.msg:2:9", "ifgen.lock")),
        ("x 0.1", "x 0.2", "`float64 x 0.2` was `float64 x 0.1`", ("Speed.msg:1:9", "ifgen.lock")),
        ("float32 y", "float32 yaw", "`float32 yaw` was `float32 y`", ("Speed.msg:2:9", "ifgen.lock")),
        ("float32 y\n", "", "`float32 y` is gone", ("Speed.msg:1:1", "ifgen.lock")),
        (
            "float32 y\n",
            "float32 y\nint8 z\n",
            "`int8 z` is not in ifgen.lock",
            ("Speed.msg:3:6", "ifgen.lock"),
        ),
        ("NAME='a'", "NAME='b'", '`string NAME="b"` was `string NAME="a"`', ("Speed.msg:3:8", "ifgen.lock")),
        (
            "float64 x 0.1\nfloat32 y\n",
            "float32 y\nfloat64 x 0.1\n",
            "the field 'y' is now where 'x' was",
            ("Speed.msg:1:9", "ifgen.lock"),
        ),
    ],
)
def test_a_dependency_that_changed_is_an_error_that_shows_the_field(
    ifgen: Run, project: Path, speed: Path, old: str, new: str, message: str, places: tuple[str, ...]
) -> None:
    ifgen("lock")
    assert ifgen("generate", "--locked").code == 0
    generated = {path: path.read_bytes() for path in (project / "generated").rglob("*") if path.is_file()}
    assert old in SPEED
    write(speed, SPEED.replace(old, new))
    for arguments in (["generate", "--locked"], ["generate", "--check", "--locked"]):
        found = ifgen(*arguments)
        assert found.code == 1
        assert found.err.count("error[lock-mismatch]: others_msgs/msg/Speed: ") == 1
        told = " ".join(found.err.split())
        assert message in told
        assert all(place in told for place in places)
        assert "read `ifgen breaking --against ifgen.lock`" in told
    assert generated == {
        path: path.read_bytes() for path in (project / "generated").rglob("*") if path.is_file()
    }
    assert ifgen("lock", "--check").code == 1
    assert ifgen("lock").code == 0
    assert ifgen("generate", "--locked").code == 0


def test_comments_change_nothing(ifgen: Run, speed: Path) -> None:
    ifgen("lock")
    write(speed, f"# How fast.\n{SPEED}")
    assert ifgen("generate", "--locked").code == 0
    assert ifgen("lock", "--check").out == "ifgen.lock: up to date\n"


def test_a_new_and_a_missing_interface_are_errors(ifgen: Run, project: Path) -> None:
    ifgen("lock")
    move = project / "interfaces/demo_msgs/msg/Move.msg"
    move.rename(move.with_name("Turn.msg"))
    found = ifgen("generate", "--locked")
    assert found.code == 1
    assert "demo_msgs/msg/Turn is not in ifgen.lock" in found.err
    assert "demo_msgs/msg/Move is in ifgen.lock, and no longer exists" in found.err
    assert not list((project / "generated").glob("*"))


def test_a_single_file_is_compared_by_itself(ifgen: Run, project: Path, speed: Path) -> None:
    write(project / "interfaces/demo_msgs/msg/Other.msg", "int8 a\n")
    ifgen("lock")
    move = "interfaces/demo_msgs/msg/Move.msg"
    assert ifgen("generate", "--locked", move).code == 0
    write(speed, SPEED.replace("y", "z"))
    assert "`float32 z` was `float32 y`" in ifgen("generate", "--locked", move).err


def test_an_unchanged_run_is_fresh_and_another_lock_is_not(ifgen: Run, project: Path, speed: Path) -> None:
    """What was compared once is not compared again; a lock file that changed is."""
    ifgen("lock")
    ifgen("generate", "--locked")
    assert "up to date" in ifgen("generate", "--locked").out
    write(speed, SPEED.replace("y", "z"))
    ifgen("generate")
    assert ifgen("generate", "--locked").code == 1
    good = (project / "ifgen.lock").read_text()
    write(speed, SPEED)
    assert ifgen("generate", "--locked").code == 0
    write(project / "ifgen.lock", good.replace('NAME="a"', 'NAME="b"'))
    assert ifgen("generate", "--locked").code == 1


def test_check_shows_the_difference_and_writes_nothing(ifgen: Run, project: Path, speed: Path) -> None:
    ifgen("lock")
    before = (project / "ifgen.lock").read_bytes()
    write(speed, SPEED.replace("float32 y", "float64 y"))
    found = ifgen("lock", "--check")
    assert found.code == 1
    assert "-    float32 y\n+    float64 y\n" in found.out
    assert found.err == "ifgen.lock is not up to date: run `ifgen lock`\n"
    assert (project / "ifgen.lock").read_bytes() == before


@pytest.mark.parametrize("command", [["generate", "--locked"], ["lock", "--check"]])
def test_without_a_lock_the_advice_is_to_write_one(ifgen: Run, project: Path, command: list[str]) -> None:
    found = ifgen(*command)
    assert found.code == 1
    assert "error[invalid-lock]: there is no ifgen.lock\n  = help: run `ifgen lock`" in found.err
    assert not (project / "generated").exists()


def test_a_merge_conflict_is_one_error_and_lock_resolves_it(ifgen: Run, project: Path) -> None:
    ifgen("lock")
    good = (project / "ifgen.lock").read_text()
    write(
        project / "ifgen.lock",
        good.replace("    float32 y\n", "<<<<<<< HEAD\n    float32 y\n=======\n>>>>>>> a\n"),
    )
    for command in (["generate", "--locked"], ["lock", "--check"]):
        found = ifgen(*command)
        assert found.code == 1
        assert found.err.count("error[invalid-lock]") == 1
        assert "this is the marker of a merge conflict" in found.err
    assert ifgen("lock").out.startswith("ifgen.lock: written again (")
    assert (project / "ifgen.lock").read_text() == good


def test_a_mistake_in_an_interface_leaves_the_lock_as_it_was(ifgen: Run, project: Path, speed: Path) -> None:
    ifgen("lock")
    before = (project / "ifgen.lock").read_bytes()
    write(speed, "float128 x\n")
    assert ifgen("lock").code == 1
    assert (project / "ifgen.lock").read_bytes() == before
    assert not list(project.glob(".ifgen-tmp-*"))


def test_the_summary_counts_what_changed(ifgen: Run, project: Path, speed: Path) -> None:
    ifgen("lock")
    write(speed, SPEED.replace("float32 y", "float64 y"))
    write(project / "interfaces/demo_msgs/msg/Stop.msg", "")
    assert ifgen("lock").out == "ifgen.lock: 1 added, 2 changed (5 interfaces of 4 packages)\n"
