"""Which words after a program are options of `ifgen run`."""

from __future__ import annotations

from pathlib import Path

import pytest
from ifgen_tools.running.commands import take_late_options

from tests.cli.conftest import Run, cache_folder, clean_environment, ifgen

__all__ = ["cache_folder", "clean_environment", "ifgen"]


@pytest.mark.parametrize(
    ("line", "left", "found"),
    [
        ("a.py --transport local", "a.py", {"--transport": "local"}),
        ("a.py --transport=rclpy 1 2", "a.py 1 2", {"--transport": "rclpy"}),
        ("a.py 1 --lockstep : b.py --generate", "a.py 1 : b.py", {"--lockstep": "", "--generate": ""}),
        ("-m a.b --transport auto", "-m a.b", {"--transport": "auto"}),
        ("pkg node --transport local -r x:=y", "pkg node -r x:=y", {"--transport": "local"}),
        ("a.py --transport bus", "a.py --transport bus", {}),
        ("a.py --transport lcal", "a.py", {"--transport": "lcal"}),
        ("a.py --transport", "a.py --transport", {}),
        ("a.py -- --transport local", "a.py -- --transport local", {}),
        ("a.py --ros-args --transport local", "a.py --ros-args --transport local", {}),
        ("a.py -- x : b.py --transport local", "a.py -- x : b.py", {"--transport": "local"}),
        ("own.py --transport local", "own.py --transport local", {}),
        ("own.py --transport local : a.py --lockstep", "own.py --transport local : a.py", {"--lockstep": ""}),
        ("a.py --until-all-end --help", "a.py --until-all-end --help", {}),
    ],
)
def test_words(
    line: str, left: str, found: dict[str, str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "a.py").write_text("# ifgen run a.py --transport local\n")
    (tmp_path / "own.py").write_text("parser.add_argument('--transport')\n")
    assert take_late_options(line.split(), ()) == (left.split(), found)


def test_an_option_before_the_program_leaves_those_after_it_to_the_program() -> None:
    assert take_late_options(["a.py", "--transport", "local"], ["--transport"]) == (
        ["a.py", "--transport", "local"],
        {},
    )


def test_the_command_says_what_it_takes(ifgen: Run, tmp_path: Path) -> None:
    """Both together are refused, so nothing starts in this process."""
    (tmp_path / "a.py").touch()
    ran = ifgen("run", "a.py", "--transport", "rclpy", "--lockstep")
    assert "note: `ifgen run` takes --transport rclpy --lockstep as its own" in ran.err
    assert "the real rclpy has no lockstep" in ran.err
    ran = ifgen("run", "a.py", "--transport", "rclp")
    assert "there is no transport 'rclp', only local, rclpy or auto" in ran.err
