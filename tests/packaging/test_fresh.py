"""The README's first five minutes on a new machine: our wheels, an index, and no compiler."""

from __future__ import annotations

import os
import platform
import re
import shutil
import sys
import venv
from pathlib import Path

import pytest

from .readme import README, replayed
from .support import ROOT, building, run, unpacked

pytestmark = [
    pytest.mark.slow,
    pytest.mark.skipif(not (ROOT / "pyproject.toml").exists(), reason="no checkout"),
    pytest.mark.timeout(900),  # all of real ROS is fetched
]
OURS = ("ifgen-ros", "ifgen-ros-runtime", "ifgen-ros-native")


@pytest.fixture(scope="module")
def built(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The distributions that `make dist` builds."""
    folder = tmp_path_factory.mktemp("dist")
    with building():
        run(sys.executable, ROOT / ".ci/make_dist.py", folder, "--no-isolation", cwd=folder, limit=300)
    return folder


@pytest.fixture(scope="module")
def programs(built: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The folder of programs of a new environment that has all of it."""
    if (platform.system(), platform.machine()) != ("Linux", "x86_64"):
        pytest.skip("real ROS has wheels for Linux x86_64 only")
    folder = tmp_path_factory.mktemp("venv")
    venv.create(folder, symlinks=True)
    python = folder / "bin" / "python"
    pip = (sys.executable, "-m", "pip", "--python", python, "install", "--quiet", "--find-links", built)
    run(*pip, "--no-index", "--no-deps", *OURS, cwd=folder)
    run(*pip, "ifgen-ros[ros]", cwd=folder, limit=600)
    return folder / "bin"


@pytest.fixture
def path(programs: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> str:
    """A PATH with only our programs, and what README's lines need of a shell."""
    shell = tmp_path / "shell"
    shell.mkdir()
    for program in ("cut", "grep"):
        (shell / program).symlink_to(shutil.which(program) or pytest.fail(f"{program} is not installed"))
    monkeypatch.setenv("PATH", f"{programs}{os.pathsep}{shell}")
    assert not any(map(shutil.which, ("cc", "gcc", "clang", "make", "cmake")))
    return os.environ["PATH"]


def test_what_is_built(built: Path) -> None:
    names = sorted(path.name for path in built.iterdir())
    assert [n for n in names if n.endswith("py3-none-any.whl")] == [
        "ifgen_ros-0.1.0-py3-none-any.whl",
        "ifgen_ros_runtime-0.1.0-py3-none-any.whl",
    ]
    assert len([n for n in names if n.endswith(".tar.gz")]) == 3
    natives = [n for n in names if "native" in n and n.endswith(".whl")]
    assert all("cp311-abi3-manylinux2014_" in name for name in natives)
    assert [n for n in natives if n.endswith(f"{platform.machine()}.whl")]
    if shutil.which("aarch64-linux-gnu-gcc"):
        assert [n for n in natives if n.endswith("aarch64.whl")]


def test_the_first_five_minutes(path: str, tmp_path: Path) -> None:
    assert replayed(tmp_path, path) == README.read_text()


def test_on_real_rclpy(path: str, tmp_path: Path) -> None:
    real = README.read_text().replace("--transport local", "--transport rclpy")
    real = real.replace('activate("local"', 'activate("rclpy"')
    assert 'activate("rclpy"' in real
    found = replayed(tmp_path, path, real).splitlines()
    # Sometimes the middleware prints a message of its own, about a client that has gone.
    assert not [line for line in real.splitlines() if line not in found]
    said = run("ifgen", "doctor", cwd=tmp_path)
    assert "(from a folder of wheels: " in said
    assert "ifgen-ros-native 0.1.0: never-compiled packages work" in said


@pytest.mark.skipif(shutil.which("make") is None, reason="make is not installed")
def test_make_demo_in_an_unpacked_sdist(built: Path, tmp_path: Path) -> None:
    [sdist] = built.glob("ifgen_ros-*.tar.gz")
    said = run("make", "demo", cwd=unpacked(sdist, tmp_path), limit=600)
    assert re.search(r"^  falls +0$", said, re.MULTILINE)


def test_a_robot_needs_no_tools(built: Path, tmp_path: Path) -> None:
    venv.create(tmp_path / "venv", symlinks=True)
    python = tmp_path / "venv/bin/python"
    run(
        *(sys.executable, "-m", "pip", "--python", python, "install", "--quiet", "--find-links", built),
        "ifgen-ros-runtime",
        cwd=tmp_path,
        limit=300,
    )
    listed = run(sys.executable, "-m", "pip", "--python", python, "list", "--format=freeze", cwd=tmp_path)
    assert {line.split("==")[0].lower() for line in listed.splitlines()} == {
        "eclipse-zenoh",
        "ifgen-ros-runtime",
        "numpy",
        "pyyaml",
        "xxhash",
    }


TESTEE = """\
import sys
import ifgen

for line in sys.stdin:
    operation, name, type_name, *_ = line.split()
    if operation == "hello":
        print("ok", name, "protocol=1 language=python", flush=True)
    elif operation == "hash":
        print("ok", name, ifgen.type_hash(type_name), flush=True)
    else:
        print("skip", name, operation, flush=True)
"""


@pytest.mark.usefixtures("path")
def test_generators_outside_a_checkout(programs: Path, built: Path, tmp_path: Path) -> None:
    """Each of ours, one of a package that pip installs, one that its author begins, a model, and the suite."""
    ifgen, python = programs / "ifgen", programs / "python"
    shutil.copytree(ROOT / "examples/generators/ros-csv", tmp_path / "ros-csv")
    assert "created acme-docs/pyproject.toml" in run(ifgen, "generators", "new", "acme-docs", cwd=tmp_path)
    pip = (sys.executable, "-m", "pip", "--python", python, "install", "--quiet", "--find-links", built)
    run(*pip, "./ros-csv", "./acme-docs", cwd=tmp_path, limit=300)
    listed = [line.split()[0] for line in run(ifgen, "generators", "list", cwd=tmp_path).splitlines()]
    assert len(listed) == 11 and {"acme-docs", "csv", "html", "typescript"} <= set(listed)
    for name in listed:
        bounds = '{"bounds": {"*.string": 32, "*.wstring": 32, "*.sequence": 4}}' if name == "c" else "{}"
        said = run(ifgen, "generators", "test", name, "--options", bounds, cwd=tmp_path)
        assert said.endswith("no mistakes\n")
        assert run(ifgen, "generators", "describe", name, cwd=tmp_path).startswith(f"{name} ")
    (tmp_path / "a_msgs/msg").mkdir(parents=True)
    (tmp_path / "a_msgs/msg/Dot.msg").write_text("geometry_msgs/Point at\n")
    assert '"id": "geometry_msgs/msg/Point.x"' in run(ifgen, "model", "a_msgs", cwd=tmp_path)
    (tmp_path / "testee.py").write_text(TESTEE)
    suite = (ifgen, "conformance", "--only", "hash/geometry_msgs/*", "--", python, "testee.py")
    assert re.search(r"^hash +32 +0 ", run(*suite, cwd=tmp_path), re.MULTILINE)
