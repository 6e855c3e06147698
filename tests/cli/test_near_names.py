"""Files and folders that do not exist get a near name, and what is no program is said to be none."""

from __future__ import annotations

from pathlib import Path

import pytest

from .conftest import Run, write


@pytest.fixture(autouse=True)
def files(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    write(Path("interfaces/demo_msgs/msg/Pose.msg"), "float64 x\n")
    write(Path("camera.py"), "print('hi')\n")
    Path("programs").mkdir()


@pytest.mark.parametrize(
    ("words", "said"),
    [
        ("generate interfacs", "did you mean 'interfaces'?"),
        ("check interfaces/demo_msg", "did you mean 'interfaces/demo_msgs'?"),
        ("generate interfaces -I interface", "did you mean 'interfaces'?"),
        ("generate interfaces --templates programms", "did you mean 'programs'?"),
        ("run camra.py", "did you mean camera.py?"),
        ("run programs", "'programs' is a folder: name a program in it"),
        ("run .", "it has camera.py"),
        ("run interfaces/demo_msgs/msg/Pose.msg", "it is no program"),
    ],
)
def test_one_error_says_what_to_do(ifgen: Run, words: str, said: str) -> None:
    done = ifgen(*words.split())
    assert (done.code, said in " ".join(done.err.split())) == (2, True), done


def test_help_and_version_by_other_names(ifgen: Run) -> None:
    assert ifgen("help", "show").out == ifgen("show", "--help").out
    assert ifgen("help").out == ifgen("--help").out
    assert ifgen("-v").out == ifgen("--version").out
    assert ifgen("help", "shwo").code == 2
