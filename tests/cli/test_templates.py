"""`ifgen generate --templates DIR`: how a user's templates replace ours, and the errors of their mistakes."""

from __future__ import annotations

from pathlib import Path

import pytest
from ifgen import resources

from .conftest import Run, write

FOLDER = "message_package/folder.py.j2"


def original(name: str) -> str:
    return (resources.templates() / name).read_text()


def test_one_file_is_replaced(ifgen: Run, demo_msgs: Path, tmp_path: Path) -> None:
    write(tmp_path / "mine" / FOLDER, "# by my robot company\n" + original(FOLDER))
    ifgen("generate", "demo_msgs")
    done = ifgen("generate", "demo_msgs", "--templates", "mine")
    assert (done.code, done.out) == (0, "generated: 2 files written, 6 files unchanged\n")
    assert Path("generated/demo_msgs/msg/__init__.py").read_text().startswith("# by my robot company\n")
    write(tmp_path / "mine" / FOLDER, "# by another company\n" + original(FOLDER))
    assert "2 files written" in ifgen("generate", "demo_msgs", "--templates", "mine").out
    assert "2 files written" in ifgen("generate", "demo_msgs").out


def test_partials_of_ones_own(ifgen: Run, demo_msgs: Path, tmp_path: Path) -> None:
    write(tmp_path / "mine" / FOLDER, '{% include "licence.j2" %}\n' + original(FOLDER))
    write(tmp_path / "mine/licence.j2", "# all rights reserved\n")
    assert ifgen("generate", "demo_msgs", "--templates", "mine").code == 0
    assert "all rights reserved" in Path("generated/demo_msgs/srv/__init__.py").read_text()


def test_an_option_wins_over_the_configured_folder(ifgen: Run, demo_msgs: Path, tmp_path: Path) -> None:
    write(tmp_path / "pyproject.toml", '[tool.ifgen]\npaths = ["demo_msgs"]\ntemplates = "configured"\n')
    write(tmp_path / "configured" / FOLDER, "# configured\n")
    write(tmp_path / "configured/message_package/package.py.j2", "# configured\n")
    write(tmp_path / "mine" / FOLDER, "# mine\n")
    assert ifgen("generate", "--templates", "mine").code == 0
    assert Path("generated/demo_msgs/msg/__init__.py").read_text() == "# mine\n"
    assert Path("generated/demo_msgs/__init__.py").read_text() == "# configured\n"
    assert "written" in ifgen("generate").out
    assert Path("generated/demo_msgs/msg/__init__.py").read_text() == "# configured\n"


def test_other_files_may_stand_beside(ifgen: Run, demo_msgs: Path, tmp_path: Path) -> None:
    write(tmp_path / "mine/README.md", "{{ no template }")
    write(tmp_path / "mine/.hidden.j2", "")
    assert ifgen("generate", "demo_msgs", "--templates", "mine").code == 0


@pytest.mark.parametrize(
    ("name", "text", "said"),
    [
        (
            "message_package/foldr.py.j2",
            "",
            "mine/message_package/foldr.py.j2 replaces nothing",
        ),
        ("message_package/folder.py", "", "did you mean message_package/folder.py.j2?"),
        ("mine.j2", "", "none of yours uses it"),
        (FOLDER, "line\n{% for x in %}\n", "mine/message_package/folder.py.j2:2:13"),
        (FOLDER, "line\n\n{{ module.nonsense }}\n", "mine/message_package/folder.py.j2:3:11"),
        (FOLDER, "{{ nonsense }}\n", "'nonsense' is not defined here"),
        (FOLDER, '{% include "no such" %}\n', "mine/message_package/folder.py.j2:1:13"),
        (FOLDER, "{{ 1 / 0 }}\n", "ZeroDivisionError: division by zero"),
    ],
)
def test_mistakes(ifgen: Run, demo_msgs: Path, tmp_path: Path, name: str, text: str, said: str) -> None:
    write(tmp_path / "mine" / name, text)
    done = ifgen("generate", "demo_msgs", "--templates", "mine")
    assert done.code == 1
    assert said in done.err
    assert not Path("generated").exists()
