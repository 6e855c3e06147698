"""The files that `distributions` in [tool.ifgen] adds; tests/packaging/test_installable.py installs them."""

from __future__ import annotations

import tomllib
from pathlib import Path
from typing import Any

import pytest
from ifgen.cli.main import main

CONFIGURATION = '[tool.ifgen]\npaths = ["interfaces"]\n'
NODL = """
nodl_version: 2
description: Says where it is.
codegen: {ifgen: {timers: [{name: report, rate: 20.0, clock: ros, publishes: [/where]}]}}
publishers:
  - {name: /where, type: facility_msgs/msg/Place, qos: {history: KEEP_LAST, depth: 5, reliability: RELIABLE}}
"""


@pytest.fixture(autouse=True)
def project(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    write("interfaces/facility_msgs/msg/Place.msg", "std_msgs/Header header\nfloat32 x 0.1\n")
    write("interfaces/shop_msgs/srv/Bring.srv", "facility_msgs/Place where\n---\n")
    write("interfaces/robot/nodl/walker.nodl.yaml", NODL)
    return tmp_path


def write(name: str, text: str) -> None:
    Path(name).parent.mkdir(parents=True, exist_ok=True)
    Path(name).write_text(text)


def generate(*arguments: str, distributions: str | None = "acme-{package}", more: str = "") -> int:
    key = f'distributions = "{distributions}"\n' if distributions else ""
    write("pyproject.toml", f"{CONFIGURATION}{key}{more}")
    return main(["generate", *arguments])


def project_of(package: str) -> dict[str, Any]:
    return tomllib.loads(Path(f"generated/{package}/pyproject.toml").read_text())


def test_nothing_unless_asked_for() -> None:
    assert generate(distributions=None) == 0
    assert not list(Path("generated").glob("*/pyproject.toml"))
    assert "ensure_importable" not in Path("generated/shop_msgs/__init__.py").read_text()


def test_each_needs_the_runtime_and_the_others_by_their_names() -> None:
    assert generate() == 0
    found = {name: project_of(name)["project"] for name in ("facility_msgs", "shop_msgs", "robot")}
    assert [project["name"] for project in found.values()] == [
        "acme-facility-msgs",
        "acme-shop-msgs",
        "acme-robot",
    ]
    assert found["facility_msgs"]["dependencies"] == ["ifgen-ros-runtime>=0.1.0"]
    assert found["shop_msgs"]["dependencies"] == ["ifgen-ros-runtime>=0.1.0", "acme-facility-msgs"]
    assert found["robot"]["dependencies"] == ["ifgen-ros-runtime>=0.1.0", "acme-facility-msgs"]
    assert found["robot"]["scripts"] == {"walker": "robot.walker:main"}
    ensured = Path("generated/shop_msgs/__init__.py").read_text()
    assert 'ensure_importable("builtin_interfaces", "service_msgs", "std_msgs")' in ensured
    assert '"rclpy")' in Path("generated/robot/robot/__init__.py").read_text()
    assert Path("generated/facility_msgs/msg/Place.msg").exists()


def test_it_says_what_package_xml_says() -> None:
    text = (
        '<package format="3"><name>facility_msgs</name><version>1.2.3</version><description>A "b" \\ c</description>'
        '<maintainer email="a@example.com">Ann O\'Nym</maintainer><license>Some License</license></package>'
    )
    write("interfaces/facility_msgs/package.xml", text)
    assert generate() == 0
    said = project_of("facility_msgs")["project"]
    assert (said["version"], said["description"]) == ("1.2.3", 'A "b" \\ c')
    assert said["authors"] == [{"name": "Ann O'Nym", "email": "a@example.com"}]
    assert said["license"] == {"text": "Some License"}
    write("interfaces/facility_msgs/package.xml", text.replace("1.2.3", "1.2.4"))
    assert generate() == 0
    assert project_of("facility_msgs")["project"]["version"] == "1.2.4"


def test_they_come_and_go_with_the_configuration() -> None:
    assert generate() == 0
    assert generate(distributions=None) == 0
    assert not Path("generated/facility_msgs/pyproject.toml").exists()
    assert not Path("generated/facility_msgs/msg/Place.msg").exists()
    assert generate(distributions="{package}-of-acme") == 0
    assert project_of("shop_msgs")["project"]["dependencies"][1] == "facility-msgs-of-acme"


def test_packages_of_ros_get_none() -> None:
    write("interfaces/std_msgs/msg/Header.msg", "builtin_interfaces/Time stamp\nstring frame_id\n")
    assert generate() == 0
    assert Path("generated/std_msgs").is_dir()
    assert not Path("generated/std_msgs/pyproject.toml").exists()
    assert project_of("facility_msgs")["project"]["dependencies"] == ["ifgen-ros-runtime>=0.1.0"]


def test_a_package_that_nobody_can_install(capsys: pytest.CaptureFixture[str]) -> None:
    write("elsewhere/vendor_msgs/msg/Part.msg", "int32 number\n")
    write("interfaces/shop_msgs/msg/Box.msg", "vendor_msgs/Part[] parts\n")
    assert generate("-I", "elsewhere") == 2
    said = " ".join(capsys.readouterr().err.split())
    assert "pip cannot install shop_msgs: it uses vendor_msgs, which is not generated here" in said
    assert "--> pyproject.toml:3:1" in said
    assert 'such as vendor_msgs = "acme-vendor-msgs"' in said
    assert not Path("generated/shop_msgs").exists()
    asked = '[tool.ifgen.requirements]\nvendor_msgs = "{}"\n'
    assert generate("-I", "elsewhere", more=asked.format("vendor-msgs>=2")) == 0
    assert "vendor-msgs>=2" in project_of("shop_msgs")["project"]["dependencies"]
    assert generate("-I", "elsewhere", more=asked.format("")) == 0
    assert len(project_of("shop_msgs")["project"]["dependencies"]) == 2
    assert generate("--with-deps=own", "-I", "elsewhere") == 0
    assert "acme-vendor-msgs" in project_of("shop_msgs")["project"]["dependencies"]


@pytest.mark.parametrize("pattern", ["acme", "acme {package}", "-{package}", "{package}/x", "{name}"])
def test_a_pattern_that_is_no_name(pattern: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert generate(distributions=pattern) == 2
    said = capsys.readouterr().err
    assert "'distributions' in [tool.ifgen] must be a name with {package} in it" in said


@pytest.mark.parametrize("requirement", ["-e .", "/tmp/x", "a b", "a\\n"])
def test_a_requirement_that_is_none(requirement: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert generate(more=f'[tool.ifgen.requirements]\nvendor_msgs = "{requirement}"\n') == 2
    assert "'requirements' in [tool.ifgen] must be a table" in capsys.readouterr().err
