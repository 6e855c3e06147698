"""`ifgen interface list`, `package`, `packages` and `proto`."""

from __future__ import annotations

import io
import json
import sys
from pathlib import Path

import pytest

from tests.cli.conftest import Run, write


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    write(tmp_path / "walk_msgs/msg/Step.msg", "float64 x 0.1\n")
    write(tmp_path / "walk_msgs/srv/Plan.srv", "Step[] steps\nstring name\n---\nbool ok\n")
    write(tmp_path / "walk_msgs/action/Walk.action", "int8 count 3\n---\n---\n")
    return tmp_path


def test_list(ifgen: Run, folder: Path) -> None:
    lines = ifgen("interface", "list", "-I", folder).out.splitlines()
    assert [line for line in lines if "walk_msgs" in line or line.endswith(":")] == [
        "Messages:",
        "    walk_msgs/msg/Step",
        "Services:",
        "    walk_msgs/srv/Plan",
        "Actions:",
        "    walk_msgs/action/Walk",
    ]
    assert "    std_srvs/srv/Empty" in lines


def test_list_of_kinds(ifgen: Run, folder: Path) -> None:
    lines = ifgen("interface", "list", "-s", "--only-actions", "-I", folder).out.splitlines()
    assert lines[0] == "Services:"
    assert "Actions:" in lines
    assert "Messages:" not in lines
    found = json.loads(ifgen("interface", "list", "-a", "-I", folder, "--json").out)
    assert "walk_msgs/action/Walk" in found
    assert all("/action/" in name for name in found)


def test_package(ifgen: Run, folder: Path) -> None:
    asked = ("interface", "package", "walk_msgs", "-I", folder)
    assert ifgen(*asked).out == "walk_msgs/action/Walk\nwalk_msgs/msg/Step\nwalk_msgs/srv/Plan\n"
    assert ifgen(*asked, "-m", "-s").out == "walk_msgs/msg/Step\nwalk_msgs/srv/Plan\n"
    assert json.loads(ifgen(*asked, "--only-srvs", "--json").out) == ["walk_msgs/srv/Plan"]


def test_unknown_package(ifgen: Run, folder: Path) -> None:
    done = ifgen("interface", "package", "walk_msg", "-I", folder)
    assert (done.code, done.out) == (1, "")
    assert done.err.startswith("error: unknown package 'walk_msg'\n  = help: did you mean 'walk_msgs'")
    assert "see `ifgen interface packages`" in ifgen("interface", "package", "Qqqqqqqq").err


def test_packages(ifgen: Run, folder: Path) -> None:
    found = ifgen("interface", "packages", "-I", folder).out.splitlines()
    assert {"std_msgs", "std_srvs", "walk_msgs"} <= set(found)
    assert found == sorted(found)
    with_actions = json.loads(ifgen("interface", "packages", "-a", "-I", folder, "--json").out)
    assert "walk_msgs" in with_actions
    assert "std_srvs" not in with_actions


def test_types_from_a_pipe(ifgen: Run, folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sys, "stdin", io.StringIO("walk_msgs/msg/Step\n"))
    assert ifgen("interface", "show", "-", "-I", folder).out == "float64 x 0.1\n"
    nothing = ifgen("interface", "show", "-", "-I", folder)
    assert (nothing.code, "'-' stands for a pipe, and nothing came through it" in nothing.err) == (2, True)
    terminal = io.StringIO()
    monkeypatch.setattr(terminal, "isatty", lambda: True)
    monkeypatch.setattr(sys, "stdin", terminal)
    shown = ifgen("interface", "show", "-", "-I", folder)
    assert (shown.code, "'-' stands for a pipe, and stdin is a terminal" in shown.err) == (2, True)


def test_comments_are_all_or_none(ifgen: Run, folder: Path) -> None:
    done = ifgen("interface", "show", "walk_msgs/msg/Step", "--all-comments", "--no-comments")
    assert (done.code, "--all-comments and --no-comments exclude each other" in done.err) == (2, True)
