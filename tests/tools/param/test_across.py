"""`ifgen param` and `ifgen lifecycle` in processes of their own, on both transports."""

from __future__ import annotations

import signal
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest
from ifgen_pytest.domains import own_domain

from tests.real_rclpy import again_if_crashed

pytestmark = [pytest.mark.slow, pytest.mark.usefixtures("robot")]

ROBOT = """
import signal
import time

import rclpy
from rcl_interfaces.srv import GetParameters
from rclpy.executors import SingleThreadedExecutor
from rclpy.lifecycle import LifecycleNode

rclpy.init()
arm = rclpy.create_node("arm", namespace="robot")
arm.declare_parameter("speed", 0.1)
arm.declare_parameter("gains", [0.1, 2.5])
arm.declare_parameter("pid.names", ["a", "b"])
arm.declare_parameter("bytes", [b"a", b"\\xff"])
camera = LifecycleNode("camera")
executor = SingleThreadedExecutor()
executor.add_node(arm)
executor.add_node(camera)
print("ready", flush=True)
signal.signal(signal.SIGUSR1, lambda *_: time.sleep(100))  # from then on it does not answer
try:
    while rclpy.ok():
        executor.spin_once(timeout_sec=0.05)
except BaseException:
    pass
"""
NAMES = ["bytes", "gains", "pid.names", "speed", "start_type_description_service", "use_sim_time"]
ARM = "/robot/arm"


@pytest.fixture(params=["local", "rclpy"])
def transport(request: pytest.FixtureRequest) -> str:
    return str(request.param)


@pytest.fixture
def robot(
    transport: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> Iterator[subprocess.Popen[bytes]]:
    """A node with parameters, and a lifecycle node."""
    file = tmp_path / "robot.py"
    file.write_text(ROBOT)
    monkeypatch.chdir(tmp_path)
    with own_domain() as domain:
        monkeypatch.setenv("ROS_DOMAIN_ID", str(domain))
        command = [sys.executable, "-m", "ifgen", "run", "--transport", transport, str(file)]
        with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL) as program:
            assert program.stdout is not None
            assert program.stdout.readline() == b"ready\n"
            yield program
            program.kill()


def run(transport: str, *words: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(ifgen(transport, *words), capture_output=True, text=True, timeout=60, check=False)


def ifgen(transport: str, *words: str) -> list[str]:
    return [sys.executable, "-m", "ifgen", *words, "--transport", transport, "--spin-time", "10"]


def test_every_verb(transport: str) -> None:
    """The output is that of ros2 on the real rclpy; see the tests `inside` for all of it."""

    def out(*words: str) -> str:
        done = run(transport, *words)
        assert (done.returncode, done.stderr) == (0, ""), words
        return done.stdout

    assert out("param", "list", ARM).split() == NAMES
    assert out("param", "get", ARM, "gains") == "Double values are: array('d', [0.1, 2.5])\n"
    assert out("param", "get", ARM, "bytes") == "Byte values are: [b'a', b'\\xff']\n"
    assert out("param", "set", ARM, "speed", "0.2", "pid.names", "[c]").count("Set parameter successful") == 2
    described = "Parameter name: speed\n  Type: double\n  Constraints:\n"
    assert out("param", "describe", ARM, "speed") == described
    Path("arm.yaml").write_text(out("param", "dump", ARM).replace("0.2", "0.3"))
    assert "Set parameter speed successful\n" in out("param", "load", ARM, "arm.yaml")
    assert out("param", "get", ARM, "speed", "--hide-type") == "0.3\n"
    refused = run(transport, "param", "set", ARM, "speed", "fast")
    assert (refused.returncode, refused.stdout) == (1, "")
    assert refused.stderr.startswith("Setting parameter failed: Wrong parameter type")
    missing = run(transport, "param", "get", ARM, "sped")
    assert (
        missing.stderr
        == f"error: the node {ARM!r} has no parameter 'sped'\n  = help: did you mean 'speed'?\n"
    )
    assert out("lifecycle", "set", "/camera", "configure") == "Transitioning successful\n"
    assert out("lifecycle", "get", "/camera") == "inactive [2]\n"
    assert len(out("lifecycle", "list", "/camera", "--all").splitlines()) == 75


def test_a_node_that_does_not_answer(robot: subprocess.Popen[bytes], transport: str) -> None:
    """Without a limit, the command waits until Ctrl-C, which ends it quietly."""
    assert run(transport, "param", "get", ARM, "speed").returncode == 0  # its types are known now
    robot.send_signal(signal.SIGUSR1)
    late = run(transport, "param", "get", ARM, "speed", "--service-timeout", "0.5")
    assert late.returncode == 1
    assert "did not answer on 'get_parameters' within 0.5 s" in late.stderr

    def interrupt() -> tuple[int, bytes]:
        command = ifgen(transport, "param", "get", ARM, "speed")
        with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE) as waiting:
            with pytest.raises(subprocess.TimeoutExpired):
                waiting.communicate(timeout=5)
            waiting.send_signal(signal.SIGINT)
            return waiting.wait(30), waiting.communicate(timeout=30)[1]

    assert again_if_crashed(transport, interrupt, lambda ended: ended[0]) == (signal.SIGINT, b"")
