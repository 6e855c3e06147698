"""What `pip install ifgen` gives to somebody who has nothing of this repository."""

from __future__ import annotations

import tarfile
import zipfile
from pathlib import Path

import pytest

from .support import ROOT, build, environment, run

pytestmark = [
    pytest.mark.slow,
    pytest.mark.skipif(not (ROOT / "pyproject.toml").exists(), reason="no checkout"),
]


@pytest.fixture(scope="module")
def python(wheel: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    return environment(tmp_path_factory.mktemp("venv"), wheel)


def test_the_wheel_has_everything_and_shadows_nothing(wheel: Path) -> None:
    names = zipfile.ZipFile(wheel).namelist()
    assert {n.split("/")[0] for n in names} == {
        "ifgen",
        "ifgen_pytest",
        "ifgen_runtime",
        wheel.name.split("-py3")[0] + ".dist-info",
    }
    assert not [n for n in names if "__pycache__" in n or "/.ifgen-tmp" in n]
    for name in (
        "ifgen/py.typed",
        "ifgen_runtime/py.typed",
        "ifgen/idl/interface.lark",
        "ifgen/templates/message_package/message.j2",
        "ifgen/interfaces/std_msgs/msg/String.msg",
        "ifgen/generated/std_msgs/msg/_string.py",
        "ifgen/generated/std_msgs/py.typed",
        "ifgen/underlay/rmw_local/__init__.py",
    ):
        assert name in names


def test_the_source_distribution_gives_the_same_wheel(wheel: Path, tmp_path: Path) -> None:
    (tmp_path / "sdist").mkdir()
    (tmp_path / "wheel").mkdir()
    sdist = build(ROOT, tmp_path / "sdist", "sdist")
    with tarfile.open(sdist) as archive:
        archive.extractall(tmp_path, **({"filter": "data"} if hasattr(tarfile, "data_filter") else {}))
    again = build(tmp_path / sdist.name.removesuffix(".tar.gz"), tmp_path / "wheel", "wheel")
    assert sorted(zipfile.ZipFile(again).namelist()) == sorted(zipfile.ZipFile(wheel).namelist())


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
        "print(deserialize(serialize(Pose(x=2.0)), Pose).x, 'ifgen/generated' in std_msgs.__file__)\n"
    )
    assert run(python, "-c", program, cwd=tmp_path) == "2.0 True\n"
