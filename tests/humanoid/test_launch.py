"""The launch file that brings the humanoid up, a process for each node."""

from __future__ import annotations

import json
import os
import re
import subprocess
import sys
from importlib.util import find_spec
from pathlib import Path

import pytest
from ifgen import resources

from tests.real_rclpy import again_if_crashed

pytestmark = pytest.mark.timeout(300)
REAL = find_spec("rpyutils") is not None
FILE = resources.humanoid() / "launch" / "humanoid.launch.py"
SHORT = "high_level_task_manager: {ros__parameters: {tasks: [walk 0.5 0.1 0.3]}}"


def launched(*words: str, timeout: float = 250) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, "-m", "ifgen", "launch", *words]
    return subprocess.run(command, capture_output=True, text=True, timeout=timeout, check=False)


@pytest.fixture
def short(tmp_path: Path) -> Path:
    file = tmp_path / "short.yaml"
    file.write_text(SHORT)
    return file


@pytest.mark.slow
@pytest.mark.parametrize(
    "transport",
    ["local", pytest.param("rclpy", marks=pytest.mark.skipif(not REAL, reason="no real rclpy"))],
)
def test_it_walks_with_a_process_for_each_node(transport: str, short: Path) -> None:
    words = ("--transport", transport, "humanoid", "humanoid.launch.py", f"scenario:={short}")
    done = again_if_crashed(transport, lambda: launched(*words), lambda ended: ended.returncode)
    assert done.returncode == 0, done.stdout + done.stderr
    assert "Traceback" not in done.stdout + done.stderr
    rows = dict(re.findall(r"^\[director-\d+\]   (\S.*?)  +(\S.*)$", done.stdout, re.MULTILINE))
    assert (rows["outcome"], rows["falls"]) == ("done", "0")
    assert float(rows["goal error"].split()[0]) < 60
    assert "the robot" not in done.stderr


@pytest.mark.slow
def test_it_sees_where_there_are_obstacles(tmp_path: Path) -> None:
    scenario = tmp_path / "behind.yaml"
    scenario.write_text(
        SHORT.replace("walk 0.5 0.1 0.3", "wait 1, walk 2.2 0 0")
        + "\nhumanoid_simulator: {ros__parameters: {obstacles: [red_box 1.2 0]}}\n"
    )
    done = launched("--transport", "local", str(FILE), f"scenario:={scenario}")
    assert done.returncode == 0, done.stdout + done.stderr
    rows = dict(re.findall(r"^\[director-\d+\]   (\S.*?)  +(\S.*)$", done.stdout, re.MULTILINE))
    assert (rows["outcome"], rows["touches"]) == ("done", "0 (obstacles: 1)")


@pytest.mark.slow
def test_the_exit_code_is_that_of_the_director(tmp_path: Path) -> None:
    scenario = tmp_path / "far.yaml"
    scenario.write_text(SHORT.replace("walk 0.5 0.1 0.3", "dance polka"))
    done = launched("--transport", "local", str(FILE), f"scenario:={scenario}")
    assert "polka" in done.stdout
    assert done.returncode == 1


@pytest.mark.slow
def test_a_node_that_cannot_begin_ends_the_launch() -> None:
    done = launched("--transport", "local", str(FILE), "model:=/nowhere.xml", "scenario:=idle", timeout=100)
    assert "/nowhere.xml: there is no such file" in done.stdout + done.stderr
    assert done.returncode != 0


@pytest.mark.parametrize(
    ("word", "expected"),
    [
        ("scenario:=polka", "there is no scenario polka: choose one of all, dance, "),
        ("without:=tail", "the robot has no node 'tail': it has battery_monitor, "),
        ("transport:=zenoh", "transport:=zenoh: expected auto, local or rclpy"),
        ("seed:=many", "seed:=many: expected a whole number"),
        ("camera:=yes", "camera:=yes: expected auto, true or false"),
        ("noise:=some", "noise:=some: expected true or false"),
        ("speed:=fast", "speed:=fast: expected a number"),
    ],
)
def test_mistakes_are_one_sentence(word: str, expected: str) -> None:
    done = launched("--transport", "local", str(FILE), word, timeout=60)
    assert done.returncode == 1
    assert expected in done.stdout + done.stderr
    assert "Traceback" not in done.stdout + done.stderr


CREW = """
import json
from humanoid.show import crew
from rclpy.lifecycle import LifecycleNode

names = crew.all_nodes()
print(json.dumps({
    "names": names,
    "managed": [name for name in names if issubclass(crew.node_class(name), LifecycleNode)],
    "MANAGED": crew.MANAGED,
    "WITH_BODY": crew.WITH_BODY,
    "two": crew.chosen("teleop, gait_planner"),
    "all": crew.chosen(crew.ALL),
    "some": crew.chosen(crew.ALL, "teleop,gait_planner"),
}))
"""


def test_the_crew_knows_its_nodes(tmp_path: Path) -> None:
    program = tmp_path / "crew.py"
    program.write_text(CREW)
    command = [sys.executable, "-m", "ifgen", "run", "--transport", "local", str(program)]
    environment = {**os.environ, "PYTHONPATH": str(resources.humanoid())}
    done = subprocess.run(command, env=environment, capture_output=True, text=True, check=True, timeout=60)
    crew = json.loads(done.stdout)
    assert sorted(crew["MANAGED"]) == sorted(crew["managed"])
    assert sorted(crew["WITH_BODY"]) == sorted(name for name in crew["names"] if _loads_a_model(name))
    assert crew["two"] == ["teleop", "gait_planner"]
    assert sorted(crew["all"]) == sorted(crew["names"]) == sorted([*crew["some"], *crew["two"]])


def _loads_a_model(node: str) -> bool:
    file = resources.bundled_nodes() / node / "config" / f"{node}.yaml"
    return "model_file:" in file.read_text(encoding="utf-8")


def test_sources_and_an_installation_have_the_same_scenarios(tmp_path: Path) -> None:
    """`pip install` puts the files where the library and `ros2 launch` look for them."""
    target = tmp_path / "installed"
    package = resources.humanoid()
    command = [sys.executable, "-m", "pip", "install", "--quiet", "--no-deps", "--no-build-isolation"]
    copy = tmp_path / "sources"
    subprocess.run(["cp", "-r", str(package), str(copy)], check=True)
    subprocess.run([*command, "--prefix", str(target), str(copy)], check=True, timeout=100)
    shared = target / "share" / "humanoid"
    assert (shared / "launch" / FILE.name).read_bytes() == FILE.read_bytes()
    (library,) = target.glob("lib/python*/site-packages")
    program = "from humanoid.show import scenarios; print(scenarios.folder(), *scenarios.names())"
    environment = {**os.environ, "PYTHONPATH": str(library)}
    said = subprocess.run(
        [sys.executable, "-c", program],
        env=environment,
        capture_output=True,
        text=True,
        check=True,
        timeout=60,
    ).stdout.split()
    assert said[0] == str(shared / "config" / "scenarios")
    assert set(said[1:]) == {path.stem for path in (package / "config/scenarios").glob("*.yaml")}
    assert (target / "lib" / "humanoid" / "director").is_file() or (target / "bin" / "director").is_file()
