"""Which transport the tools look at, and what they say where the other one was meant."""

from __future__ import annotations

import importlib.util
import os
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest
from ifgen_pytest.domains import own_domain

from tests.cli.conftest import Run

MISSING = [name for name in ("rclpy", "ifgen_native") if importlib.util.find_spec(name) is None]

TALKER = "import rclpy\nrclpy.init()\nnode = rclpy.create_node('talker')\nprint('talks', flush=True)\nrclpy.spin(node)\n"


def tool(*words: str, folder: Path, **variables: str) -> subprocess.CompletedProcess[str]:
    environment = {**os.environ, **variables}
    command = [sys.executable, "-m", "ifgen", *words]
    return subprocess.run(
        command, cwd=folder, env=environment, capture_output=True, text=True, timeout=100, check=False
    )


@pytest.mark.parametrize("words", ["topic list", "run talker.py", "graph --running", "test battery"])
def test_a_variable_is_the_default(words: str, ifgen: Run, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("IFGEN_TRANSPORT", "lcal")
    ran = ifgen(*words.split())
    assert ran.code == 2
    assert (
        "error: the environment variable IFGEN_TRANSPORT has an invalid value: 'lcal' is not one of"
        in ran.err
    )


@pytest.mark.parametrize("transport", ["local", *([] if MISSING else ["rclpy"])])
@pytest.mark.parametrize(
    "words", ["topic list", "run x.py", "graph --running", "top --once", "bag record -a"]
)
def test_a_domain_that_is_no_number_is_one_sentence(
    words: str, transport: str, ifgen: Run, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "x.py").touch()
    monkeypatch.setenv("ROS_DOMAIN_ID", "abc")
    monkeypatch.setenv("IFGEN_TRANSPORT", transport)
    ran = ifgen(*words.split())
    assert (
        ran.err.partition(": ")[2]
        == "ROS_DOMAIN_ID is 'abc', expected a whole number, such as ROS_DOMAIN_ID=5\n"
    )
    assert ran.code


@pytest.fixture
def talker(request: pytest.FixtureRequest, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[str]:
    """A node in a domain of its own, on a transport; returns the other one."""
    transport: str = request.param
    (tmp_path / "talker.py").write_text(TALKER)
    command = [sys.executable, "-m", "ifgen", "run", "--transport", transport, "talker.py"]
    with own_domain() as domain:
        monkeypatch.setenv("ROS_DOMAIN_ID", str(domain))
        started = subprocess.Popen(command, cwd=tmp_path, stdout=subprocess.PIPE, text=True)
        assert started.stdout is not None and started.stdout.readline() == "talks\n"
        yield "rclpy" if transport == "local" else "local"
        started.kill()
        started.wait()


@pytest.mark.slow
@pytest.mark.skipif(bool(MISSING), reason=f"not installed: {', '.join(MISSING)}")
@pytest.mark.parametrize("talker", ["local", "rclpy"], indirect=True)
def test_who_is_on_the_other_transport_is_told_once(talker: str, tmp_path: Path) -> None:
    few, other = ("", "the local transport: --transport local")
    if talker == "local":
        few, other = "at least ", "the real rclpy: --transport rclpy"
    sentence = f"{few}1 node runs on {other}"
    (tmp_path / "listener.py").write_text("import rclpy\nrclpy.init()\nrclpy.create_node('listener')\n")
    for words in ("node list", "run listener.py", "run listener.py : listener.py", "graph --running"):
        ran = tool(*words.split(), folder=tmp_path, IFGEN_TRANSPORT=talker)
        assert ran.stderr.count("note: ") == 1, ran.stderr
        assert f"note: {sentence}\n" in ran.stderr
    there = "local" if talker == "rclpy" else "rclpy"
    assert "note: " not in tool("node", "list", folder=tmp_path, IFGEN_TRANSPORT=there).stderr
