"""The files that `pip install ifgen-ros` installs for somebody without a copy of this repository."""

from __future__ import annotations

import email.message
import email.parser
import re
import zipfile
from pathlib import Path

import pytest

from .support import ROOT, build, environment, run

pytestmark = [
    pytest.mark.slow,
    pytest.mark.skipif(not (ROOT / "pyproject.toml").exists(), reason="no checkout"),
]
TOOLS = {"click", "jinja2", "lark", "pydantic", "rich", "watchfiles"}


@pytest.fixture(scope="module")
def python(wheels: tuple[Path, Path], tmp_path_factory: pytest.TempPathFactory) -> Path:
    return environment(tmp_path_factory.mktemp("venv"), *wheels)


def files(wheel: Path) -> set[str]:
    return set(zipfile.ZipFile(wheel).namelist())


def metadata(wheel: Path) -> email.message.Message:
    name = next(name for name in files(wheel) if name.endswith(".dist-info/METADATA"))
    return email.parser.Parser().parsestr(zipfile.ZipFile(wheel).read(name).decode())


def requirements(wheel: Path) -> dict[str, str]:
    """The requirements of a wheel without extras: the versions, by name."""
    lines = [line for line in metadata(wheel).get_all("Requires-Dist", []) if "extra ==" not in line]
    return {name: line.removeprefix(name) for line in lines for name in re.findall(r"^[\w-]+", line)}


def test_the_wheels_have_everything_and_shadow_nothing(wheels: tuple[Path, Path]) -> None:
    toolkit, runtime = map(files, wheels)
    folders = {"ifgen", "ifgen_generators", "ifgen_pytest", "ifgen_tools", "ifgen_ros-0.1.0.dist-info"}
    assert {name.split("/")[0] for name in toolkit} == folders
    assert {name.split("/")[0] for name in runtime} == {"ifgen_runtime", "ifgen_ros_runtime-0.1.0.dist-info"}
    assert not [n for n in toolkit | runtime if "__pycache__" in n or "/.ifgen-tmp" in n or "/test/" in n]
    for name in (
        "ifgen/py.typed",
        "ifgen_pytest/py.typed",
        "ifgen/idl/interface.lark",
        "ifgen/rules.md",
        "ifgen/templates/message_package/message.j2",
        "ifgen/interfaces/std_msgs/msg/String.msg",
        "ifgen/generated/gait_planner/gait_planner/gait_planner.py",
        "ifgen/examples/humanoid/humanoid/show/web/index.html",
        "ifgen/examples/humanoid/humanoid/show/web/three/three.core.js",
        "ifgen/examples/humanoid/humanoid/show/web/three/LICENSE",
    ):
        assert name in toolkit
    for name in (
        "ifgen_runtime/py.typed",
        "ifgen_runtime/generated/std_msgs/msg/_string.py",
        "ifgen_runtime/generated/std_msgs/py.typed",
        "ifgen_runtime/underlay/rclpy/__init__.py",
        "ifgen_runtime/underlay/rmw_local/__init__.py",
        "ifgen_runtime/libraries/ament_index_python/__init__.py",
        "ifgen_runtime/libraries/ament_index_python/py.typed",
    ):
        assert name in runtime


def test_a_robot_gets_no_tools(wheels: tuple[Path, Path]) -> None:
    toolkit, runtime = map(requirements, wheels)
    assert set(runtime) == {"eclipse-zenoh", "numpy", "pyyaml", "xxhash"}
    assert toolkit.keys() >= TOOLS
    assert toolkit["ifgen-ros-runtime"] == "==0.1.0"


def test_the_metadata_leads_somewhere(wheels: tuple[Path, Path]) -> None:
    for wheel in wheels:
        said = metadata(wheel)
        assert {url.split(",")[0] for url in said.get_all("Project-URL", [])} >= {"Homepage", "Changelog"}
        links = re.findall(r"\]\(([^)]+)\)", str(said.get_payload()))
        assert links
        assert not [link for link in links if not link.startswith("https://")]


@pytest.mark.parametrize("project", [".", "codegen/runtime"])
def test_a_wheel_of_the_checkout_has_the_files_of_one_of_the_sdist(
    project: str, wheels: tuple[Path, Path], tmp_path: Path
) -> None:
    built = build(ROOT / project, tmp_path, "wheel")
    assert files(built) == files(wheels[project != "."])


def test_a_user_far_from_the_repository(python: Path, tmp_path: Path) -> None:
    home = run(python, "-c", "import ifgen; print(ifgen.__file__)", cwd=tmp_path)
    assert str(ROOT) not in home
    folder = tmp_path / "interfaces/demo_msgs/msg"
    folder.mkdir(parents=True)
    (folder / "Pose.msg").write_text("# A pose.\nstd_msgs/Header header\nfloat64 x 1.5\n")
    (tmp_path / "pyproject.toml").write_text('[tool.ifgen]\npaths = ["interfaces"]\noutput = "src"\n')
    ifgen = python.with_name("ifgen")
    assert run(ifgen, "generate", cwd=tmp_path) == "src: 5 files written\n"
    assert run(ifgen, "generate", "--check", cwd=tmp_path) == "src: up to date\n"
    assert run(ifgen, "hash", "std_msgs/msg/String", cwd=tmp_path).startswith(
        "std_msgs/msg/String RIHS01_df668c74"
    )
    assert "\nfloat64 x 1.5\n" in run(ifgen, "show", "demo_msgs/Pose", cwd=tmp_path)
    program = (
        "import sys, ifgen\n"
        "assert ifgen.activate('local') == 'local'\n"
        "sys.path.append('src')\n"
        "from demo_msgs.msg import Pose\n"
        "from ifgen_runtime import deserialize, serialize\n"
        "import std_msgs\n"
        "print(deserialize(serialize(Pose(x=2.0)), Pose).x, 'ifgen_runtime/generated' in std_msgs.__file__)\n"
    )
    assert run(python, "-c", program, cwd=tmp_path) == "2.0 True\n"
