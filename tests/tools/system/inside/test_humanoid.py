"""The humanoid's own system: sound, as its lock has it, and checked in no time."""

from __future__ import annotations

import time
from pathlib import Path

import pytest
from ifgen import resources
from ifgen_tools.system import manifest
from ifgen_tools.system.build import Request, build
from ifgen_tools.system.commands import findings
from ifgen_tools.system.model import System

LAUNCH = resources.humanoid() / "launch/humanoid.launch.py"
LOCK = resources.humanoid() / manifest.NAME
ALL = {"scenario": "idle", "camera": "true"}


@pytest.fixture(autouse=True)
def elsewhere(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)


def humanoid(arguments: dict[str, str]) -> System:
    request = Request(
        launch_files=(LAUNCH,),
        arguments=arguments,
        packages=(resources.bundled_interfaces(),),
        transport="local",
    )
    built = build(request)
    assert findings(built) == []
    return built.system


def test_it_is_sound_with_each_scenario_and_without_most_nodes() -> None:
    everything = humanoid(ALL)
    assert len(everything.nodes) == 20
    assert everything.open_ends == ()
    walk = humanoid({"scenario": "walk"})
    assert [node.name for node in walk.open_ends] == ["/director"]
    assert humanoid({"scenario": "idle", "without": "teleop"}).node("/teleop") is None


def test_it_is_as_its_lock_says() -> None:
    # `ifgen check --system` with `--lock` writes it; what changes there changes for whoever meets the robot.
    content = manifest.of_system(humanoid(ALL))
    assert manifest.text(content) == LOCK.read_text()
    assert manifest.read(LOCK) == content


def test_it_is_checked_within_a_second() -> None:
    humanoid(ALL)  # with the imports
    start = time.process_time()
    humanoid(ALL)
    assert time.process_time() - start < 1
