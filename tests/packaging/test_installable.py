"""Generated packages that pip installs together: without the tools, in plain Python and on real rclpy."""

from __future__ import annotations

import importlib.util
import os
import sysconfig
from pathlib import Path

import pytest

from .support import ROOT, attempt, build, environment, install, run

pytestmark = [
    pytest.mark.slow,
    pytest.mark.skipif(not (ROOT / "pyproject.toml").exists(), reason="no checkout"),
]
FILES = {
    "pyproject.toml": '[tool.ifgen]\npaths = ["interfaces"]\ndistributions = "acme-{package}"\n',
    "interfaces/facility_msgs/msg/Place.msg": "std_msgs/Header header\nfloat32 x 0.1\n",
    "interfaces/facility_msgs/package.xml": (
        '<package format="3"><name>facility_msgs</name><version>1.2.3</version>'
        '<description>Where "things" are.</description><maintainer email="a@example.com">Ann</maintainer>'
        "<license>Apache License 2.0</license><depend>std_msgs</depend></package>\n"
    ),
    "interfaces/shop_msgs/srv/Bring.srv": "facility_msgs/Place where\n---\nbool done\n",
    "interfaces/robot/nodl/walker.nodl.yaml": (
        "nodl_version: 2\n"
        "description: Says where it is.\n"
        "codegen: {ifgen: {timers: [{name: report, rate: 20.0, clock: ros, publishes: [/where]}]}}\n"
        "parameters: {speed: {type: double, default_value: 0.1, description: How fast}}\n"
        "publishers:\n"
        "  - {name: /where, type: facility_msgs/msg/Place, qos: {history: KEEP_LAST, depth: 5, reliability: RELIABLE}}\n"
    ),
}
PACKAGES = ("facility_msgs", "shop_msgs", "robot")
SERIALISES = """
from ifgen_runtime import deserialize, serialize
from shop_msgs.srv import Bring
request = Bring.Request()
request.where.header.frame_id = "map"
again = deserialize(serialize(request), Bring.Request)
assert again.where.header == request.where.header
import std_msgs, sys
print(round(again.where.x, 3), "ifgen_runtime" in std_msgs.__file__, "ifgen" in sys.modules)
"""
TALKS = """
from robot.walker import Walker
import rclpy
from facility_msgs.msg import Place
from rclpy.executors import SingleThreadedExecutor
rclpy.init(args=[])
walker, other = Walker(), rclpy.create_node("other")
got = []
other.create_subscription(Place, "/where", got.append, 5)
executor = SingleThreadedExecutor()
executor.add_node(walker)
executor.add_node(other)
while not got:
    executor.spin_once()
print(type(got[0]).__name__, "ifgen_runtime" in rclpy.__file__)
rclpy.shutdown()
"""


@pytest.fixture(scope="module")
def built(wheels: tuple[Path, Path], tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with the wheels of the packages and of the runtime."""
    folder = tmp_path_factory.mktemp("project")
    for name, text in FILES.items():
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).write_text(text)
    toolkit = environment(folder / "toolkit", *wheels)
    run(toolkit.with_name("ifgen"), "generate", cwd=folder)
    made = folder / "made"
    made.mkdir()
    for package in PACKAGES:
        build(folder / "generated" / package, made, "wheel")
    assert run(toolkit.with_name("ifgen"), "generate", "--check", cwd=folder) == "generated: up to date\n"
    (made / wheels[1].name).symlink_to(wheels[1])
    return made


@pytest.fixture(scope="module")
def plain(built: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """An environment with these, and what the runtime needs of this one: nothing else, in particular no ROS."""
    folder = tmp_path_factory.mktemp("plain")
    python = environment(folder / "venv", behind=folder / "site")
    site = Path(sysconfig.get_path("purelib"))
    (folder / "site").mkdir()
    for pattern in ("numpy*", "yaml", "_yaml", "[Pp][Yy][Yy][Aa][Mm][Ll]-*", "*zenoh*", "xxhash*"):
        for found in site.glob(pattern):
            (folder / "site" / found.name).symlink_to(found)
    install(python, "--no-index", "--find-links", built, *(f"acme-{p.replace('_', '-')}" for p in PACKAGES))
    return python


def test_they_work_in_plain_python(plain: Path, tmp_path: Path) -> None:
    assert run(plain, "-c", SERIALISES, cwd=tmp_path) == "0.1 True False\n"


def test_a_node_runs_where_there_is_no_ros(plain: Path, tmp_path: Path) -> None:
    assert run(plain, "-c", TALKS, cwd=tmp_path) == "Place True\n"
    refused = attempt(plain.with_name("walker"), "--ros-args", "-r", "nonsense", cwd=tmp_path)
    assert refused.returncode == 1
    assert "nonsense" in refused.stderr.splitlines()[-1]


def test_what_ros_wants_of_a_node_is_there(plain: Path) -> None:
    venv = plain.parents[1]
    assert (venv / "share/ament_index/resource_index/packages/robot").exists()
    assert (venv / "share/robot/package.xml").exists()
    [site] = venv.glob("lib/*/site-packages")
    assert {path.name for path in (site / "facility_msgs").iterdir()} >= {"__init__.py", "msg", "py.typed"}
    assert not [path for path in site.rglob("*") if path.name in {"test", "pyproject.toml", "PKG-INFO"}]


def test_others_generate_from_what_is_installed(
    built: Path, wheels: tuple[Path, Path], tmp_path: Path
) -> None:
    python = environment(tmp_path / "venv", *built.glob("*.whl"), wheels[0])
    (tmp_path / "interfaces/other_msgs/msg").mkdir(parents=True)
    (tmp_path / "interfaces/other_msgs/msg/Way.msg").write_text("facility_msgs/Place[] places\n")
    said = run(python.with_name("ifgen"), "generate", "interfaces", cwd=tmp_path)
    assert said == "generated: 5 files written\n"
    program = "import sys; sys.path.append('generated'); from other_msgs.msg import Way; print(Way())"
    assert run(python, "-c", program, cwd=tmp_path) == "other_msgs.msg.Way(places=[])\n"


@pytest.mark.skipif(importlib.util.find_spec("ifgen_native") is None, reason="ifgen_native is not installed")
@pytest.mark.skipif(importlib.util.find_spec("rclpy") is None, reason="rclpy is not installed")
def test_they_work_on_real_rclpy(built: Path, tmp_path: Path) -> None:
    python = environment(tmp_path / "venv", *built.glob("*.whl"))
    assert run(python, "-c", SERIALISES, cwd=tmp_path) == "0.1 False False\n"
    assert run(python, "-c", TALKS, cwd=tmp_path) == "Place False\n"
    assert os.environ["ROS_DOMAIN_ID"]


def test_an_editable_installation_finds_what_is_edited(built: Path, tmp_path: Path) -> None:
    python = environment(tmp_path / "venv", *built.glob("ifgen_ros_runtime*.whl"))
    packages = built.parent / "generated"
    for package in PACKAGES:
        install(
            *(python, "--no-deps", "--no-index", "--no-build-isolation", "--editable", packages / package)
        )
    said = run(
        python, "-c", "import robot, shop_msgs; print(robot.__file__, shop_msgs.__file__)", cwd=tmp_path
    )
    assert said == f"{packages}/robot/robot/__init__.py {packages}/shop_msgs/__init__.py\n"
