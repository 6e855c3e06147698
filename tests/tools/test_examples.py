"""The help of each command ends with an example, and the example works."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest
from ifgen_pytest.domains import own_domain

from tests.conformance.support import PYTHON
from tests.tools.examples import example, leaves
from tests.tools.transcript import environment, playing

BRINGUP = """
from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument, LogInfo
from launch.substitutions import LaunchConfiguration

def generate_launch_description():
    rate = LaunchConfiguration("rate")
    return LaunchDescription([DeclareLaunchArgument("rate"), LogInfo(msg=["at ", rate, " Hz"])])
"""
TALKER = """
import rclpy
rclpy.init()
node = rclpy.create_node("talker")
node.create_timer(0.5, lambda: print("talking", flush=True))
try:
    rclpy.spin(node)
except BaseException:
    pass
"""
# A testee of ours, in the place of the user's.
TESTEE = f"""
import os, sys
os.execv(sys.executable, [sys.executable, {PYTHON[1]!r}, "ours"])
"""
OLD_NODL = """<interface version="1">
  <node name="talker" executable="talk"><parameter name="rate" type="int"/></node>
</interface>
"""
NODL = "nodl_version: 2\n"
FIRST = ["ifgen init", "ifgen generate"]
"""They make what others need."""
LISTENS = 2.0
"""Seconds after its first words until an example that goes on is interrupted."""
PATIENCE = 90.0
"""Seconds until an example has to say something, or to end."""


def test_every_help_has_an_example() -> None:
    assert [path for path, command in leaves() if example(command) is None] == []


def test_examples_are_of_their_command() -> None:
    for path, command in leaves():
        assert path in (example(command) or path)


@pytest.mark.slow
@pytest.mark.timeout(900)
def test_examples_work(tmp_path: Path) -> None:
    """In the order of the commands, in one folder, beside a system that has what they name."""
    failed = []
    project(tmp_path)
    with own_domain() as domain:
        around = environment(domain)
        around["PATH"] = f"{Path(sys.executable).parent}{os.pathsep}{around['PATH']}"
        with playing("example", "auto", around):
            for _, command in sorted(leaves(), key=lambda each: (each[0] not in FIRST, each[0] != FIRST[0])):
                line = example(command)
                assert line is not None
                code, said = run(line, tmp_path, around)
                if code != 0:
                    failed.append(f"$ {line}\n{said}= {code}")
    assert not failed, "\n".join(failed)


def project(folder: Path) -> None:
    """The files that the examples name, in a repository with two versions of a message."""
    programs = ("talker.py", "listener.py", "patrol.py")
    for name, text in {"bringup.launch.py": BRINGUP, **dict.fromkeys(programs, TALKER)}.items():
        (folder / name).write_text(text.replace("talker", name.partition(".")[0]))
    (folder / "nodl").mkdir()
    others = {"testee.py": TESTEE, "robot.nodl.xml": OLD_NODL}
    for name, text in {
        **others,
        "nodl/talker.nodl.yaml": NODL,
        "nodl/patrol.nodl.yaml": NODL,
        "described.nodl.yaml": NODL,
    }.items():
        (folder / name).write_text(text)
    message = folder / "interfaces/demo_msgs/msg/Pose.msg"
    message.parent.mkdir(parents=True)
    git = ["git", "-C", str(folder), "-c", "user.name=a", "-c", "user.email=a@example.org"]
    subprocess.run([*git, "init", "-q", "-b", "main"], check=True)
    for text in ("float64 x\n", "float64 x\nfloat64 y\n"):
        message.write_text(text)
        subprocess.run([*git, "add", "interfaces"], check=True)
        subprocess.run([*git, "commit", "-q", "-m", "Change Pose"], check=True)


def run(line: str, folder: Path, environment: dict[str, str]) -> tuple[int, str]:
    """The exit code of a command line in a shell, and what it said; 0 if it went on until Ctrl-C."""
    with (folder / "said.txt").open("w+") as output:
        shell = subprocess.Popen(
            ["bash", "-c", f"set -o pipefail; {line}"],
            cwd=folder,
            env=environment,
            stdout=output,
            stderr=subprocess.STDOUT,
            start_new_session=True,
        )
        begin, first = time.monotonic(), None
        while shell.poll() is None:
            now = time.monotonic()
            if first is None and os.fstat(output.fileno()).st_size:
                first = now
            if now > (begin + PATIENCE if first is None else first + LISTENS):
                break
            time.sleep(0.05)
        goes_on = shell.poll() is None
        if goes_on:
            os.killpg(shell.pid, signal.SIGINT)
        shell.wait(60)
        output.seek(0)
        said = output.read()
    if goes_on:
        return 0 if said and "error:" not in said else shell.returncode or 1, said
    return shell.returncode, said
