"""`ifgen doctor` says what is installed and, in each bad situation, what to do."""

from __future__ import annotations

import os
import subprocess
import sys
from importlib.metadata import version
from pathlib import Path

import pytest
from ifgen_pytest.domains import own_domain
from ifgen_runtime.codec import choice
from ifgen_runtime.installation import add_extra, add_native
from ifgen_tools.doctor import machine

from tests.running.terminals import Terminal

from .support import DISTRIBUTION, needs_rclpy, run_python


def findings(**environment: str) -> dict[str, str]:
    """The findings about each subject, with the advice."""
    ran = run_python("-m", "ifgen", "doctor", environment={**os.environ, **environment})
    assert (ran.returncode, ran.stderr) == (0, "")
    said: dict[str, str] = {}
    for line in ran.stdout.splitlines():
        subject, _, rest = line.partition(":")
        if line.startswith(" "):
            said[list(said)[-1]] += line.strip().replace("->", " ->", 1)
        else:
            said[subject] = rest.strip()
    return said


@needs_rclpy
def test_where_all_is_well() -> None:
    said = findings()
    assert list(said) == [
        "ifgen",
        "runtime",
        "Python",
        "lark",
        "codec",
        "local transport",
        "other processes",
        "nodes",
        "real rclpy",
        "middleware",
        "type support",
    ]
    assert f"(ROS 2 {DISTRIBUTION}: by its wheels)" in said["real rclpy"]
    assert said["middleware"] == "rmw_fastrtps_cpp"
    assert said["type support"].endswith("never-compiled packages work")
    assert said["codec"] == f"in C, by ifgen-ros-native {version('ifgen-ros-native')}"
    assert "->" not in "".join(said.values())


@needs_rclpy
def test_a_middleware_that_is_not_there() -> None:
    said = findings(RMW_IMPLEMENTATION="rmw_nonsense")["real rclpy"]
    assert said.startswith(
        "does not start with RMW_IMPLEMENTATION=rmw_nonsense ->"
        " unset it, or set RMW_IMPLEMENTATION=rmw_fastrtps_cpp; it says: Expected RMW implementation"
    )


@pytest.mark.slow
@needs_rclpy
def test_a_sourced_distribution_that_is_not_the_installed_one() -> None:
    said = findings(ROS_DISTRO="rolling")
    assert "-> ROS_DISTRO says rolling: unset it, or" in said["real rclpy"]
    assert said["type support"].endswith("never-compiled packages work")


@pytest.mark.parametrize(
    ("home", "environment", "expected"),
    [
        ("/opt/ros/lyrical/lib/python3.14/site-packages/rclpy/__init__.py", {}, ("lyrical", "by its folder")),
        ("/ws/install/rclpy/__init__.py", {"ROS_DISTRO": "rolling"}, ("rolling", "by ROS_DISTRO")),
        ("/ws/install/rclpy/__init__.py", {}, ("unknown", "no ROS_DISTRO, no wheels")),
    ],
)
def test_how_a_distribution_is_known(
    home: str, environment: dict[str, str], expected: tuple[str, str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(machine, "_version", lambda name: None)
    monkeypatch.delenv("ROS_DISTRO", raising=False)
    for name, value in environment.items():
        monkeypatch.setenv(name, value)
    assert machine._distribution(home) == expected


def test_a_distribution_that_nobody_has_tested(monkeypatch: pytest.MonkeyPatch) -> None:
    home = "/opt/ros/lyrical/lib/python3.14/site-packages/rclpy/__init__.py"
    monkeypatch.setattr(machine.importlib.util, "find_spec", lambda name: object())
    monkeypatch.setattr(machine, "_ask_real", lambda: [home, "rmw_fastrtps_cpp", "ok native 1"])
    last = list(machine._real_rclpy("Linux x86_64"))[-1]
    assert last.found == (
        "native 1: never-compiled packages work; symbols and layouts fit, but its tests were never run on lyrical"
    )


@pytest.mark.slow
@needs_rclpy
def test_the_codec_is_chosen() -> None:
    assert findings(IFGEN_CODEC="python")["codec"] == "in Python (slower): IFGEN_CODEC=python"


@pytest.mark.parametrize(
    ("number", "system", "is_advised"),
    [(None, "Linux", True), ("0.1.0", "Linux", False), (None, "Windows", False)],
)
def test_no_codec_in_c(
    number: str | None, system: str, is_advised: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """An extension that is there and does not fit is not mended by installing it."""
    python = choice.CodecChoice(None, "ifgen_native is not installed")
    monkeypatch.setattr(choice, "chosen", lambda: python)
    monkeypatch.setattr(machine, "_version", lambda name: number)
    monkeypatch.setattr(machine.platform, "system", lambda: system)
    found = machine._codec()
    assert found.found == "in Python (slower): ifgen_native is not installed"
    assert found.advice == (add_native() if is_advised else None)
    assert len(f"{found.subject + ':':17}{found.found}") < 80


@needs_rclpy
def test_no_extension(tmp_path: Path) -> None:
    (tmp_path / "ifgen_native").mkdir()
    (tmp_path / "ifgen_native" / "__init__.py").touch()
    said = findings(PYTHONPATH=str(tmp_path))
    assert add_native() in said["type support"]
    assert said["codec"].startswith(
        "in Python (slower): ifgen_native cannot be loaded: cannot import name '_native'"
    )


@pytest.mark.parametrize(
    "text, reason",
    [
        ("raise ImportError('of another Python')", "of another Python"),
        pytest.param("import os; os._exit(1)", "`import rclpy` in Python says more", marks=pytest.mark.slow),
        pytest.param("print('not what was asked')", "", marks=pytest.mark.slow),
    ],
)
def test_a_broken_rclpy(text: str, reason: str, tmp_path: Path) -> None:
    (tmp_path / "rclpy").mkdir()
    (tmp_path / "rclpy" / "__init__.py").write_text(text)
    said = findings(PYTHONPATH=str(tmp_path))
    assert list(said)[-1] == "real rclpy"
    assert said["real rclpy"].startswith("cannot be imported ->")
    assert reason in said["real rclpy"]


def test_no_rclpy(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(machine.importlib.util, "find_spec", lambda name: None)
    monkeypatch.setattr(machine.platform, "machine", lambda: "x86_64")
    *_, last = machine.examine()
    assert (last.subject, last.found) == ("real rclpy", "not found")
    assert (add_extra("ros") in (last.advice or "")) == (sys.platform == "linux")


@pytest.mark.parametrize(
    ("environment", "words"),
    [
        (
            {"ROS_AUTOMATIC_DISCOVERY_RANGE": "LOCALHOST"},
            "those of this user on this machine, in domain 97: ",
        ),
        ({"ROS_AUTOMATIC_DISCOVERY_RANGE": "OFF"}, "not reached: ROS_AUTOMATIC_DISCOVERY_RANGE is OFF"),
        pytest.param(
            {"ROS_STATIC_PEERS": "127.0.0.1:9"},
            "no nodes now (Zenoh 1.10.2) -> other processes are not reached until",
            marks=pytest.mark.slow,
        ),
        ({"ZENOH_SESSION_CONFIG_URI": "no.json5"}, "no.json5 cannot be used: No such file"),
    ],
    ids=["here", "off", "router", "file"],
)
def test_who_is_reached_and_why_not(
    environment: dict[str, str], words: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    pytest.importorskip("zenoh")
    for name, value in ({"ROS_DOMAIN_ID": "97"} | environment).items():
        monkeypatch.setenv(name, value)
    found = machine._other_processes()
    said = f"{found.found} -> {found.advice}".replace(version("eclipse-zenoh"), "1.10.2")
    assert words in said


@pytest.mark.slow
def test_nodes_of_others_are_counted(tmp_path: Path) -> None:
    pytest.importorskip("zenoh")
    program = tmp_path / "waits.py"
    program.write_text(
        "import rclpy\nrclpy.init()\nnodes = [rclpy.create_node(name) for name in ('a', 'b')]\n"
        "print('ready', flush=True)\ntry:\n    rclpy.spin(nodes[0])\nexcept KeyboardInterrupt:\n    pass\n"
    )
    with own_domain() as domain:
        reached = {
            **os.environ,
            "ROS_DOMAIN_ID": str(domain),
            "ROS_AUTOMATIC_DISCOVERY_RANGE": "LOCALHOST",
        }
        terminal = Terminal(reached, str(program))
        try:
            terminal.until("ready")
            asked = subprocess.run(
                [
                    sys.executable,
                    "-c",
                    "from ifgen_tools.running import elsewhere; print(elsewhere.look()[0])",
                ],
                env=reached,
                capture_output=True,
                text=True,
                timeout=60,
                check=True,
            )
            assert terminal.end() == 0
        finally:
            terminal.process.kill()
    assert asked.stdout == f"those of this user on this machine, in domain {domain}: 2 nodes now\n"
