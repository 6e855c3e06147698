"""`ifgen graph` as a user runs it."""

from __future__ import annotations

import importlib.util
import subprocess
import sys
from pathlib import Path

import pytest
from ifgen.cli.main import main

ROOT = Path(__file__).parents[3]
TALKER = ROOT / "examples/topics/publisher.py"
LISTENER = ROOT / "examples/topics/subscriber.py"
TRANSPORTS = [
    "local",
    pytest.param(
        "rclpy",
        marks=[
            pytest.mark.skipif(
                importlib.util.find_spec("rpyutils") is None, reason="real rclpy is not installed"
            ),
            pytest.mark.slow,
        ],
    ),
]


def ifgen(*words: str | Path) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, "-m", "ifgen", *map(str, words)]
    return subprocess.run(command, capture_output=True, text=True, timeout=60, check=False)


def test_descriptions_are_drawn_in_the_format_of_the_file(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    for suffix, beginning in ((".svg", "<svg "), (".dot", "digraph"), (".mmd", "flowchart")):
        file = tmp_path / f"graph{suffix}"
        assert main(["graph", str(ROOT / "interfaces"), "-o", str(file)]) == 0
        text = file.read_text()
        assert text.startswith(beginning)
        assert "/whole_body_controller" in text
        assert "nodes, " in capsys.readouterr().out


@pytest.mark.parametrize("transport", TRANSPORTS)
def test_programs_are_drawn_while_they_run(transport: str) -> None:
    programs = ("--run", str(TALKER), "--run", str(LISTENER))
    done = ifgen("graph", "--transport", transport, *programs)
    assert done.returncode == 0, done.stderr
    assert done.stdout.startswith("flowchart LR\n")
    for text in ("/minimal_publisher", "/minimal_subscriber", "/my_topic<br>std_msgs/msg/String"):
        assert text in done.stdout
    assert "_ifgen_graph" not in done.stdout
    assert "open\n" not in done.stdout.replace("classDef open", "")


def test_mistakes_are_told(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    nothing = ifgen("graph", "--running", "--transport", "local")
    assert nothing.returncode == 2
    assert "no node is running" in nothing.stderr
    for words, expected in (
        ([ROOT / "interfaces/std_msgs"], "there is no description of a node"),
        ([ROOT / "interfaces", "--run", TALKER], "--running and --run take no PATH"),
        (["--run", tmp_path / "none.py"], "there is no file"),
    ):
        assert main(["graph", *map(str, words)]) == 2
        assert expected in capsys.readouterr().err
