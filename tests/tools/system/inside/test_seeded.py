"""Faults of all classes, seeded into four sound systems: each is told before anything starts."""

from __future__ import annotations

import shutil
from collections import Counter
from collections.abc import Iterator
from pathlib import Path

import pytest
from ifgen import resources
from ifgen.diagnostics import InputError
from ifgen.evolution.lock import text as lock_text
from ifgen.nodl.load import registry_of
from ifgen.reading.packages import find_packages
from ifgen.reading.search_path import SearchPath
from ifgen_tools.system.build import Built, Request, build
from ifgen_tools.system.commands import findings

from . import faults, systems
from .faults import Fault, in_text

LAUNCH_OF_HUMANOID = resources.humanoid() / "launch/humanoid.launch.py"


def built(folder: Path, launch: str | Path) -> Built:
    """A system below a folder, whose packages are there."""
    packages = tuple(sorted(path for path in folder.iterdir() if (path / "nodl").is_dir()))
    return build(Request(launch_files=(folder / launch,), arguments={}, packages=packages, transport="local"))


def rules_with(fault: Fault, folder: Path, launch: str | Path) -> set[str]:
    """The rules of what is found in a system with a fault; its file is restored."""
    before = fault.path.read_text()
    fault.path.write_text(fault.applied())
    try:
        return {each.rule for each in findings(built(folder, launch))}
    except InputError as error:
        return {each.rule for each in error.diagnostics}
    finally:
        fault.path.write_text(before)


_SERVER = "service_servers:\n  - {name: load_map, type: std_srvs/Trigger}\n"
_DRIVE = f"{{name: drive, type: geometry_msgs/Twist, qos: {systems.SAFE}}}"
_RECORD = '"bag", "record", "/rover/plan", "/rover/front/scan"'


def _navigation(folder: Path) -> Iterator[Fault]:
    """Faults of the classes that need an idea, in the navigation stack."""
    launch = folder / "rover_nav/launch/nav.launch.py"
    nodl = folder / "rover_nav/nodl"
    values = folder / "rover_nav/config/nav.yaml"
    yield in_text("system-remap-kind", launch, '("cmd_vel", "drive")', '("cmd_vel", "load_map")')
    yield in_text("system-namespace", launch, '("scan", "front/scan")', '("scan", "/front/scan")')
    yield in_text("system-two-servers", nodl / "panel.nodl.yaml", "publishers:", _SERVER + "publishers:")
    yield in_text("system-required", nodl / "planner.nodl.yaml", "{name: plan,", "{name: way,")
    yield in_text(
        "system-two-writers", nodl / "panel.nodl.yaml", "{name: goal,", f"{_DRIVE}\n  - {{name: goal,"
    )
    yield in_text("system-same-node", launch, 'name="charts"', 'name="panel"')
    yield in_text("system-no-executable", launch, 'executable="panel"', 'executable="pannel"')
    yield in_text("system-no-package", launch, 'package="rover_nav"', 'package="rover_nva"')
    yield in_text("system-value-rule", values, "speed: 1.5", "speed: 9.5")
    yield in_text("system-value-rule", values, "speed: 0.8", "speed: -0.1")
    yield in_text("system-value-type", values, "speed: 0.8", "speed: 1")
    yield in_text("system-value-type", values, "retries: 5", "retries: 5.0")
    yield in_text("system-value-type", launch, '"retries": 7', '"retries": "7"')
    yield in_text("system-no-parameter", launch, '"retries": 7', '"retires": 7')
    yield in_text("system-parameter-file", launch, "nav.yaml", "nva.yaml")
    yield in_text("system-read-only", launch, _RECORD, '"param", "set", "/rover/planner", "speed", "1.0"')
    yield in_text("system-no-frame", nodl / "follower.nodl.yaml", "uses: [odom]", "uses: [odmo]")
    yield in_text("system-no-frame", nodl / "follower.nodl.yaml", "uses: [odom]", "uses: [camera]")
    yield in_text("system-two-parents", nodl / "base.nodl.yaml", "base_link: odom", "odom: base_link")
    yield in_text("system-lifecycle", launch, '"charts", "locator"', '"chrats", "locator"')
    yield in_text("system-lifecycle", launch, '"planner", "follower", ', '"planner", ')
    yield in_text("system-lifecycle", launch, '"follower", "mission"', '"follower", "mission", "panel"')
    yield in_text("system-lifecycle", launch, '"charts", "locator"', '"mission", "charts", "locator"')
    yield in_text("system-recording", launch, '"/rover/plan"', '"/rover/paln"')
    yield in_text("system-sim-time", launch, '"use_sim_time", False', '"use_sim_time", True')
    yield in_text("system-no-value", launch, '"node_names": MANAGED', '"autostart": True')
    yield in_text("system-unused-remap", launch, "*nodes]", '*nodes[:0], SetRemap("a", "b"), *nodes]')
    yield in_text("system-launch-file", launch, "nodes = [", "nodes = [1 / 0,")


def _base(folder: Path) -> Iterator[Fault]:
    """Faults of the classes that need an idea, in the small base."""
    launch = folder / "crab_base/launch/crab.launch.xml"
    nodl = folder / "crab_base/nodl"
    yield in_text("system-rate", nodl / "wander.nodl.yaml", "rate: 10.0", "rate: 50.0")
    yield in_text("system-rate", nodl / "driver.nodl.yaml", "rate: 20.0", "rate: 2.0")
    yield in_text("system-unit", nodl / "wander.nodl.yaml", "unit: m", "unit: mm")
    yield in_text("system-frame", nodl / "wander.nodl.yaml", "frame: odom", "frame: map")
    yield in_text("system-version", nodl / "driver.nodl.yaml", "version: 2.1.0", "version: 4.0.0")
    yield in_text("system-version", nodl / "wander.nodl.yaml", "version: 2.0..3", "version: '2.4'")
    yield in_text("system-two-writers", launch, 'to="input_teleop"', 'to="drive"')
    sonar = 'exec="sonar" name="sonar">\n      <remap from="ranges" to="sonar/ranges"'
    yield in_text("system-required", launch, sonar, sonar.replace('to="sonar/ranges"', 'to="sonar/noise"'))
    yield in_text("system-near-name", launch, sonar, sonar.replace('to="sonar/ranges"', 'to="sonar/rangse"'))
    yield in_text("system-near-name", launch, 'to="input_auto"', 'to="input_atuo"')
    yield in_text("system-same-node", launch, 'name="teleop"', 'name="driver"')
    yield in_text("system-no-executable", launch, 'exec="power"', 'exec="pwoer"')
    yield in_text("system-no-value", launch, "crab.yaml", "../package.xml")
    yield in_text("system-launch-file", launch, "</launch>", "")
    yield in_text("system-launch-file", launch, 'default="crab"', "")
    remap = '<remap from="output"'
    yield in_text("system-duplicate", launch, remap, f'<remap from="input_auto" to="input_teleop"/>{remap}')
    power = f"motor_power, type: std_msgs/Bool, qos: {systems.KEPT}"
    late = power.replace(", durability: TRANSIENT_LOCAL", "")
    yield in_text("system-late-joiner", nodl / "driver.nodl.yaml", power, late)


def _pipeline(folder: Path) -> Iterator[Fault]:
    """Faults of the classes that need an idea, in the pipeline."""
    launch = folder / "sight/launch/eyes.launch.yaml"
    eye = folder / "sight/launch/one_eye.launch.yaml"
    yield in_text("system-value-rule", eye, "value: 20", "value: 200")
    yield in_text("system-value-rule", eye, "value: fixed", "value: other")
    yield in_text("system-value-type", eye, "value: 0.7", "value: high")
    yield in_text("system-no-parameter", eye, "name: exposure", "name: exposrue")
    yield in_text("system-no-executable", eye, "exec: rectify", "exec: rectfiy")
    yield in_text("system-near-name", launch, "to: left/objects", "to: left/objcets")
    yield in_text("system-sim-time", eye, "name: mode, value: fixed", "name: use_sim_time, value: false")
    yield in_text("system-recording", launch, "/left/image", "/left/imgae")
    yield in_text("system-recording", launch, "/tracks", "/trakcs")
    yield in_text("system-launch-file", launch, "$(dirname)/one_eye", "$(dirname)/two_eyes")
    yield in_text("system-launch-file", eye, "pkg: sight", "pgk: sight")
    yield in_text("system-launch-file", eye, "launch:", "launch: [")
    yield in_text("system-sim-time", folder / "sight/nodl/world.nodl.yaml", "name: clock", "name: cloak")


BY_HAND = {"navigation": _navigation, "base": _base, "pipeline": _pipeline}


@pytest.fixture(scope="module", params=list(systems.SYSTEMS))
def system(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> tuple[str, Path]:
    folder = tmp_path_factory.mktemp(request.param)
    systems.write(systems.SYSTEMS[request.param][0], folder)
    return request.param, folder


@pytest.fixture
def in_folder(system: tuple[str, Path], monkeypatch: pytest.MonkeyPatch) -> tuple[str, Path]:
    monkeypatch.chdir(system[1])
    return system


def test_sound_systems_have_no_findings(in_folder: tuple[str, Path]) -> None:
    name, folder = in_folder
    assert findings(built(folder, systems.SYSTEMS[name][1])) == []


def missed(found: list[Fault], folder: Path, launch: str | Path) -> list[str]:
    return [
        f"{fault}: {sorted(rules)}"
        for fault in found
        if fault.rule not in (rules := rules_with(fault, folder, launch))
    ]


def seeded(name: str, folder: Path) -> list[Fault]:
    launch = systems.SYSTEMS[name][1]
    return [*BY_HAND[name](folder), *faults.of_built(built(folder, launch))]


def test_one_fault_of_each_class_is_told(in_folder: tuple[str, Path]) -> None:
    name, folder = in_folder
    first = {fault.rule: fault for fault in reversed(seeded(name, folder))}
    assert missed(list(first.values()), folder, systems.SYSTEMS[name][1]) == []


@pytest.mark.slow
def test_all_seeded_faults_are_told(in_folder: tuple[str, Path]) -> None:
    name, folder = in_folder
    found = seeded(name, folder)
    assert len(found) >= {"navigation": 60, "base": 40, "pipeline": 40}[name]
    assert missed(found, folder, systems.SYSTEMS[name][1]) == []


@pytest.fixture
def humanoid(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A copy of the humanoid's documents."""
    for nodl in resources.bundled_interfaces().glob("*/nodl"):
        shutil.copytree(nodl, tmp_path / nodl.parent.name / "nodl")
        shutil.copy(nodl.parent / "package.xml", tmp_path / nodl.parent.name)
    monkeypatch.chdir(tmp_path)
    return tmp_path


def test_a_node_that_was_built_with_another_definition(humanoid: Path, tmp_path: Path) -> None:
    old = tmp_path / "old/sensor_msgs/msg/Imu.msg"
    old.parent.mkdir(parents=True)
    old.write_text("std_msgs/Header header\nfloat64 x\n")
    registry = registry_of(["sensor_msgs/msg/Imu"], SearchPath(find_packages([tmp_path / "old"])))
    (humanoid / "joint_controller/ifgen.lock").write_text(lock_text.text([registry]))
    found = findings(built(humanoid, LAUNCH_OF_HUMANOID))
    assert {each.rule for each in found} == {"system-hash"}
    assert "of sensor_msgs/msg/Imu, which `/imu/data` is of" in found[0].message
    (humanoid / "joint_controller/ifgen.lock").write_text("version 7\n")
    assert {each.rule for each in findings(built(humanoid, LAUNCH_OF_HUMANOID))} == {"invalid-lock"}


@pytest.mark.slow
def test_faults_of_the_humanoid_are_told(humanoid: Path) -> None:
    sound = built(humanoid, LAUNCH_OF_HUMANOID)
    assert findings(sound) == []
    found = [fault for fault in faults.of_built(sound) if fault.path.is_relative_to(humanoid)]
    assert len(found) >= 200
    assert Counter(fault.rule for fault in found).keys() >= {"system-near-name", "system-type", "system-qos"}
    # Each takes a fifth of a second: every other one.
    assert missed(found[::2], humanoid, LAUNCH_OF_HUMANOID) == []
