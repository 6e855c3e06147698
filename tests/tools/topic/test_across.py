"""`ifgen topic` in a process of its own, and nodes in others."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path

import pytest
from ifgen_pytest.domains import own_domain

from tests.real_rclpy import again_if_crashed

TALKER = """
import rclpy
from std_msgs.msg import String

rclpy.init()
node = rclpy.create_node("talker")
publisher = node.create_publisher(String, "chatter", 10)
count = 0

def publish():
    global count
    count += 1
    publisher.publish(String(data=f"word {count}"))

node.create_timer(0.001, publish)
silent = node.create_publisher(String, "silent", 10)
listeners = 0

def watch():
    global listeners
    before, listeners = listeners, silent.get_subscription_count()
    if listeners > before:
        print("somebody listens", flush=True)

node.create_timer(0.05, watch)
print("ready", flush=True)
try:
    rclpy.spin(node)
except BaseException:
    pass
"""
NOT_YET = b"WARNING: topic [/silent] does not appear to be published yet\n"
BOTH = ["local", pytest.param("rclpy", marks=pytest.mark.slow)]


def ifgen(*words: str) -> list[str]:
    return [sys.executable, "-m", "ifgen", *words]


@pytest.fixture
def talker(
    transport: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> Iterator[subprocess.Popen[bytes]]:
    """A node that publishes on /chatter at about 1 kHz, and never on /silent; it says who listens to that."""
    file = tmp_path / "talker.py"
    file.write_text(TALKER)
    with own_domain() as domain:
        monkeypatch.setenv("ROS_DOMAIN_ID", str(domain))
        command = ifgen("run", "--transport", transport, str(file))
        with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL) as program:
            assert program.stdout is not None
            assert program.stdout.readline() == b"ready\n"
            yield program
            program.kill()


@pytest.mark.usefixtures("talker")
@pytest.mark.parametrize("transport", BOTH)
def test_echo_once(transport: str) -> None:
    command = ifgen("topic", "echo", "/chatter", "--once", "--transport", transport)
    done = subprocess.run(command, capture_output=True, text=True, timeout=60, check=False)
    assert (done.returncode, done.stderr) == (0, "")
    assert done.stdout.startswith("data: word ")


@pytest.mark.slow
@pytest.mark.usefixtures("talker")
@pytest.mark.parametrize("transport", ["local", "rclpy"])
def test_nothing_is_lost_and_ctrl_c_ends_quietly(transport: str) -> None:
    def run() -> tuple[int, str, str]:
        command = ifgen("topic", "echo", "/chatter", "--transport", transport)
        with subprocess.Popen(
            command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, env={**os.environ}
        ) as echo:
            assert echo.stdout is not None
            first = echo.stdout.readline()
            time.sleep(2)  # as long as somebody listens
            echo.send_signal(signal.SIGINT)
            rest, said = echo.communicate(timeout=30)
        return echo.returncode, first + rest, said

    code, shown, said = again_if_crashed(transport, run, lambda ended: ended[0])
    assert (code, said) == (signal.SIGINT, "")
    numbers = [int(line.split()[-1]) for line in shown.splitlines() if line != "---"]
    del numbers[:10]  # some of which may come before the publisher knows of the subscription
    assert len(numbers) > 100
    assert numbers == list(range(numbers[0], numbers[-1] + 1))


@pytest.mark.slow
@pytest.mark.timeout(90)
@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
@pytest.mark.parametrize("verb", ["hz", "bw", "echo"])
@pytest.mark.parametrize("transport", ["local", "rclpy"])
def test_who_hears_nothing_ends_as_well(
    transport: str, verb: str, number: signal.Signals, talker: subprocess.Popen[bytes]
) -> None:
    """In the background of a script, too, where a shell lets programs ignore Ctrl-C."""
    assert talker.stdout is not None
    stdout = talker.stdout

    def run() -> tuple[int, bytes]:
        command = ["sh", "-c", 'trap "" INT; exec "$@"', "sh"]
        type_name = ["std_msgs/msg/String"] if verb == "echo" else []  # the others wait for the topic
        command += ifgen("topic", verb, "/silent", *type_name, "--transport", transport)
        with subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE) as tool:
            assert stdout.readline() == b"somebody listens\n"
            tool.send_signal(number)
            said = tool.communicate(timeout=30)[1]
        # Real rclpy may find the talker late; ours knows when it knows everybody.
        return tool.returncode, said.removeprefix(NOT_YET if transport == "rclpy" else b"")

    assert again_if_crashed(transport, run, lambda ended: ended[0]) == (number, b"")


@pytest.mark.slow
@pytest.mark.usefixtures("talker")
@pytest.mark.parametrize("transport", ["local"])
def test_a_reader_that_leaves(transport: str) -> None:
    command = ifgen("topic", "echo", "/chatter", "--transport", transport)
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE) as echo:
        assert echo.stdout is not None
        assert echo.stderr is not None
        echo.stdout.readline()
        echo.stdout.close()
        assert echo.wait(30) == 1
        assert echo.stderr.read() == b""


@pytest.mark.slow
@pytest.mark.usefixtures("talker")
@pytest.mark.parametrize("transport", ["local"])
def test_without_zenoh_it_says_so(transport: str) -> None:
    code = "import sys; sys.modules['zenoh'] = None; from ifgen.cli.main import main; sys.exit(main(sys.argv[1:]))"
    command = [sys.executable, "-c", code, "topic", "list", "--transport", transport]
    done = subprocess.run(command, capture_output=True, text=True, timeout=60, check=False)
    assert done.stdout == "/parameter_events\n"
    assert done.stderr.startswith("note: other processes are not reached without Zenoh. Install it: ")
