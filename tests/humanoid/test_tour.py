"""docs/humanoid.md: its files are written, and its commands are run."""

from __future__ import annotations

import os
import re
import shlex
import signal
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest
from ifgen_pytest.domains import own_domain
from ifgen_tools.running.demo import demo

pytestmark = pytest.mark.timeout(300)
PAGE = Path(__file__).parents[2] / "docs" / "humanoid.md"
_FILE = re.compile(r"<!-- file: (\S+) -->\n```\w+\n(.*?)```\n", re.DOTALL)
_COMMANDS = re.compile(r"^```sh\n(.*?)^```$", re.DOTALL | re.MULTILINE)


def commands(begin: str) -> list[list[str]]:
    """The commands of the page that begin with these words, without comments."""
    blocks = _COMMANDS.findall(PAGE.read_text(encoding="utf-8"))
    lines = [line for block in blocks for line in block.splitlines()]
    found = [shlex.split(line, comments=True) for line in lines if line.startswith(begin)]
    assert found
    return found


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """A folder with the files of the page."""
    for name, text in _FILE.findall(PAGE.read_text(encoding="utf-8")):
        (tmp_path / name).write_text(text, encoding="utf-8")
    (tmp_path / "docs").mkdir()
    return tmp_path


def run(words: list[str], folder: Path, domain: int | None = None) -> str:
    """Run a command of the page; return what it says."""
    environment = {**os.environ} if domain is None else {**os.environ, "ROS_DOMAIN_ID": str(domain)}
    command = [sys.executable, "-m", *words]
    done = subprocess.run(
        command, cwd=folder, env=environment, capture_output=True, text=True, timeout=200, check=False
    )
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout + done.stderr


def test_the_demo_has_the_options(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(folder)
    page = PAGE.read_text(encoding="utf-8")
    said = [
        *commands("ifgen demo"),
        *(shlex.split(words) for words in re.findall(r"`(ifgen demo [^`]*)`", page)),
    ]
    said += [["ifgen", "demo", *shlex.split(words)] for words in re.findall(r"^\| `(--[^`]*)`", page, re.M)]
    for words in said:
        demo.make_context("demo", words[2:])  # exits with 2 for options that there are not


@pytest.mark.slow
@pytest.mark.parametrize("scenario", ["short.yaml", "party.yaml"])
def test_its_scenarios_and_its_own_node_end_well(scenario: str, folder: Path) -> None:
    (words,) = [words for words in commands("ifgen demo --headless") if scenario in words]
    said = run(words, folder)
    assert re.search(r"^  outcome +done$", said, re.MULTILINE)
    assert re.search(r"^  falls +0$", said, re.MULTILINE)


@pytest.mark.slow
def test_a_node_that_is_broken_as_the_page_says_is_named(folder: Path) -> None:
    file = folder / "my_gait.py"
    whole = file.read_text()
    broken = whole.replace("        self.publish_footsteps_upcoming(self.upcoming)", "        ...")
    assert broken != whole
    file.write_text(broken)
    (words,) = [words for words in commands("ifgen demo --headless") if "short.yaml" in words]
    done = subprocess.run(
        [sys.executable, "-m", *words], cwd=folder, capture_output=True, text=True, timeout=200, check=False
    )
    assert done.returncode == 1
    (said,) = re.findall(r"`(nobody walks[^`]*)`", PAGE.read_text(encoding="utf-8"))
    assert said.replace("\n", " ") in done.stdout


@pytest.fixture
def idle() -> Iterator[int]:
    """The domain of an idle robot."""
    with own_domain() as domain:
        environment = {**os.environ, "ROS_DOMAIN_ID": str(domain)}
        (words,) = [words for words in commands("ifgen demo") if "--idle" in words]
        command = [sys.executable, "-m", *words]
        with subprocess.Popen(command, env=environment, stdout=subprocess.PIPE, text=True) as robot:
            assert robot.stdout is not None
            while "stands, and waits" not in (line := robot.stdout.readline()):
                assert line, "the robot has ended"
            yield domain
            robot.send_signal(signal.SIGINT)
            robot.communicate(timeout=60)


@pytest.mark.slow
def test_others_look_inside_and_command_the_robot(idle: int, folder: Path) -> None:
    nodes, state, _, walk = [
        run(words, folder, idle) for words in commands("ifgen ") if words[1] in {"node", "topic", "action"}
    ]
    assert "/whole_body_controller" in nodes.splitlines()
    assert "mode: 1" in state
    assert "SUCCEEDED" in walk
    (words,) = commands("ifgen run")
    assert re.search(r"arrived after \d+ steps", run(words, folder, idle))
