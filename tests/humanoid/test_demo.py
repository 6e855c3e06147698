"""`ifgen demo` as a user runs it: all nodes, messages alone between them."""

from __future__ import annotations

import importlib.util
import os
import re
import subprocess
import sys
from pathlib import Path

import pytest
from humanoid.mjcf import write_mjcf

pytestmark = pytest.mark.timeout(600)
REAL = importlib.util.find_spec("rpyutils") is not None


def demo(*words: str, domain: int = 87, timeout: float = 500) -> dict[str, str]:
    """Run it and give its summary as rows."""
    environment = {
        **os.environ,
        "ROS_DOMAIN_ID": str(domain),
        "ROS_AUTOMATIC_DISCOVERY_RANGE": "LOCALHOST",
        "COLUMNS": "80",
    }
    done = subprocess.run(
        [sys.executable, "-m", "ifgen", "demo", "--headless", *words],
        capture_output=True,
        text=True,
        timeout=timeout,
        env=environment,
        check=False,
    )
    assert done.returncode == 0, done.stdout + done.stderr
    assert "Traceback" not in done.stderr
    assert all(len(line) <= 80 for line in done.stdout.splitlines() if not line.startswith("/"))
    rows = re.findall(r"^  (\S.*?)  +(\S.*)$", done.stdout.partition("\n\n")[2], re.MULTILINE)
    return dict(rows)


def test_it_walks_and_turns_and_stops_when_a_goal_is_cancelled() -> None:
    summary = demo("--scenario", "walk")
    assert summary["outcome"] == "done"
    assert summary["falls"] == "0"
    assert int(summary["steps"]) >= 12
    assert float(summary["foot error"].split()[0]) < 60
    assert float(summary["goal error"].split()[0]) < 60
    assert float(summary["stop after cancel"].split()[0]) <= 3.0


def test_the_same_seed_gives_the_same_states_also_from_a_file(tmp_path: Path) -> None:
    model = tmp_path / "own.xml"
    model.write_text(write_mjcf())
    runs = [["--seed", "3"], ["--seed", "3", "--model", str(model)], ["--seed", "4"]]
    first, second, other = (demo("--scenario", "stop", *run)["state hash"] for run in runs)
    assert first == second != other


@pytest.mark.slow
def test_keeping_to_real_time_changes_nothing() -> None:
    free, paced = (demo("--scenario", "stop", *more) for more in ((), ("--realtime",)))
    assert float(paced["real-time factor"]) < 1.02
    assert free["state hash"] == paced["state hash"]


@pytest.mark.slow
@pytest.mark.parametrize("scenario", ["all", "dance", "push"])
def test_other_scenarios_end_well(scenario: str) -> None:
    summary = demo("--scenario", scenario)
    assert summary["outcome"] == "done"
    assert summary["falls"] == "0"


@pytest.mark.slow
@pytest.mark.skipif(not REAL, reason="real rclpy is not installed")
def test_the_same_files_walk_on_real_rclpy() -> None:
    summary = demo("--scenario", "walk", "--transport", "rclpy", domain=88)
    assert summary["outcome"] == "done"
    assert summary["falls"] == "0"


def test_pictures_are_written(tmp_path: Path) -> None:
    picture = tmp_path / "robot.png"
    demo("--scenario", "dance", "--record", str(picture))
    assert picture.read_bytes().startswith(b"\x89PNG")


def test_mistakes_are_one_sentence(tmp_path: Path) -> None:
    broken = tmp_path / "broken.xml"
    broken.write_text(write_mjcf().replace("l_knee", "l_kneee"))
    for words, expected in (
        (["--model", str(broken)], "no joint 'l_knee'"),
        (["--record", "x.mp4"], "ends in .gif or .png"),
        (["--headless", "--web"], "--headless does not go with --web"),
        (["--joint-map", __file__], "--joint-map goes with --model"),
    ):
        command = [sys.executable, "-m", "ifgen", "demo", *words]
        done = subprocess.run(command, capture_output=True, text=True, timeout=60, check=False)
        assert done.returncode in (1, 2)
        assert expected in done.stderr
        assert "Traceback" not in done.stderr
