"""`ifgen launch` with real processes: their lines, their ends, and nothing that is left behind."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from importlib.util import find_spec
from pathlib import Path

import pytest
from ifgen_pytest.domains import own_domain

NODE = """
import rclpy, sys
rclpy.init()
node = rclpy.create_node("talker")
print(node.get_fully_qualified_name(), node.declare_parameter("rate", 1.0).value, sys.argv[1:2], flush=True)
if "--stay" in sys.argv:
    try:
        rclpy.spin(node)
    except KeyboardInterrupt:
        pass
"""
HEAD = """
from launch import LaunchDescription
from launch.actions import *
from launch.event_handlers import *
from launch.events import Shutdown as ShutdownEvent
from launch_ros.actions import *
def generate_launch_description():
"""


def start(folder: Path, *words: str, transport: str = "local") -> subprocess.Popen[str]:
    return subprocess.Popen(
        [sys.executable, "-m", "ifgen", "launch", "--transport", transport, *words],
        cwd=folder,
        env={
            **os.environ,
            "ROS_LOG_DIR": str(folder / "log"),
            "ROS_AUTOMATIC_DISCOVERY_RANGE": "LOCALHOST",
        },
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
    )


def launch(folder: Path, text: str, *words: str) -> tuple[int, list[str]]:
    """Run a launch file to its end; returns the exit code and the lines that it prints."""
    name = "a.launch.xml" if text.startswith("<") else "a.launch.py"
    (folder / name).write_text(text)
    (folder / "talker.py").write_text(NODE)
    process = start(folder, *words, name)
    out, _ = process.communicate(timeout=60)
    assert "Traceback" not in out
    return process.returncode, out.splitlines()


@pytest.fixture(autouse=True)
def domain(monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    with own_domain() as number:
        monkeypatch.setenv("ROS_DOMAIN_ID", str(number))
        yield


def wait_for(process: subprocess.Popen[str], text: str) -> None:
    assert process.stdout is not None
    for line in process.stdout:
        if text in line:
            return
    pytest.fail(f"it never said {text!r}")


def group_is_there(group: int) -> bool:
    try:
        os.killpg(group, 0)
    except ProcessLookupError:
        return False
    return True


def gone(group: int) -> bool:
    end = time.monotonic() + 20
    while group_is_there(group) and time.monotonic() < end:
        time.sleep(0.05)
    return not group_is_there(group)


def test_nodes_run_with_their_names_and_parameters(tmp_path: Path) -> None:
    code, lines = launch(
        tmp_path,
        "<launch><node exec='talker.py' name='t' namespace='a' output='screen' args='hi'>"
        "<param name='rate' value='0.1'/></node></launch>",
    )
    assert code == 0
    assert "[talker.py-1] /a/t 0.1 ['hi']" in lines
    assert [line.partition(" [pid")[0] for line in lines if "process has" in line] == [
        "[INFO] [talker.py-1]: process has finished cleanly"
    ]


FROM_SOURCES = """
from ament_index_python.packages import PackageNotFoundError, get_package_share_directory
from bringup.words import hello
from launch import LaunchDescription
from launch.actions import LogInfo

def generate_launch_description():
    share = get_package_share_directory("beside")
    lines = open(f"{get_package_share_directory('bringup')}/config/word.txt").read().split()
    try:
        get_package_share_directory("nobody_has_it")
    except PackageNotFoundError as error:
        lines.append(str(error.args[0]).partition(",")[0])
    return LaunchDescription([LogInfo(msg=f"{hello} {' '.join(lines)} {share}")])
"""


@pytest.mark.parametrize("transport", ["local", pytest.param("rclpy", marks=pytest.mark.slow)])
def test_packages_that_are_sources_look_installed(
    tmp_path: Path, transport: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Launch files import their modules, and find their shared files by ament_index_python."""
    if transport == "rclpy" and find_spec("rclpy") is None:
        pytest.skip("there is no real rclpy")
    monkeypatch.delenv("AMENT_PREFIX_PATH", raising=False)
    for name in ("bringup", "beside"):
        folder = tmp_path / "src" / name
        (folder / name).mkdir(parents=True)
        (folder / "package.xml").write_text(f"<package format='3'><name>{name}</name></package>")
        (folder / name / "__init__.py").touch()
    folder = tmp_path / "src/bringup"
    (folder / "bringup/words.py").write_text("hello = 'hello'")
    (folder / "config").mkdir()
    (folder / "config/word.txt").write_text("world")
    (folder / "launch").mkdir()
    (folder / "launch/a.launch.py").write_text(FROM_SOURCES)
    process = start(tmp_path, "bringup", "a.launch.py", transport=transport)
    out, _ = process.communicate(timeout=60)
    said = f"hello world package 'nobody_has_it' not found {tmp_path}/src/beside"
    assert (process.returncode, out.splitlines()[1:]) == (0, [f"[INFO] [launch.user]: {said}"])


@pytest.mark.slow
@pytest.mark.parametrize(
    ("commands", "expected"),
    [
        ("[ExecuteProcess(cmd=['true']), ExecuteProcess(cmd=['sh', '-c', 'exit 3'])]", 3),
        ("[ExecuteProcess(cmd=['sh', '-c', 'kill -9 $$'])]", 137),
        ("[ExecuteProcess(cmd=['sleep', '100']), ExecuteProcess(cmd=['true'], on_exit=Shutdown())]", 0),
        ("[ExecuteProcess(cmd=['false'], respawn=True, respawn_max_retries=2)]", 1),
        ("[ExecuteProcess(cmd=['ifgen-none'])]", 1),
        ("[ExecuteProcess(cmd=['test -t 1'], shell=True, emulate_tty=True)]", 0),
        ("[ExecuteProcess(cmd=['test -t 1'], shell=True)]", 1),
    ],
)
def test_exit_codes(commands: str, expected: int, tmp_path: Path) -> None:
    code, lines = launch(tmp_path, f"{HEAD}    return LaunchDescription({commands})\n")
    assert code == expected
    if "retries" in commands:
        assert sum("process started" in line for line in lines) == 3


@pytest.mark.slow
def test_events_start_and_end_processes(tmp_path: Path) -> None:
    text = f"""{HEAD}
    first = Node(executable="talker.py", name="first", output="screen", arguments=["--stay"])
    second = ExecuteProcess(cmd=["sh", "-c", "echo out; echo err >&2; exit 4"], output="screen")
    said = RegisterEventHandler(OnProcessIO(target_action=first, on_stdout=lambda event: second, handle_once=True))
    def ended(event, context):
        return [LogInfo(msg=f"ended {{event.returncode}}"), EmitEvent(event=ShutdownEvent(reason="x"))]
    end = RegisterEventHandler(OnProcessExit(target_action=second, on_exit=ended))
    return LaunchDescription([said, end, first])
"""
    code, lines = launch(tmp_path, text)
    assert code == 4
    assert {"[sh-2] out", "[sh-2] err", "[INFO] [launch.user]: ended 4"} <= set(lines)
    assert "[INFO] [talker.py-1]: sending signal 'SIGINT' to process[talker.py-1]" in lines
    assert any("[talker.py-1]: process has finished cleanly" in line for line in lines)


@pytest.mark.slow
def test_what_ends_slowly_does_not_hide_what_ended_the_launch(tmp_path: Path) -> None:
    text = f"""{HEAD}
    deaf = ExecuteProcess(
        cmd=["sh", "-c", "trap '' INT TERM; echo ready; while :; do sleep 0.1; done"],
        output="screen", sigterm_timeout="0.2", sigkill_timeout="0.2")
    ends = ExecuteProcess(cmd=["sh", "-c", "exit 3"], on_exit=Shutdown())
    return LaunchDescription([deaf, RegisterEventHandler(OnProcessIO(target_action=deaf, on_stdout=lambda _: ends))])
"""
    code, lines = launch(tmp_path, text)
    assert code == 3
    assert any("escalating to 'SIGKILL'" in line for line in lines)


@pytest.mark.slow
def test_what_does_not_end_is_ended(tmp_path: Path) -> None:
    text = f"""{HEAD}
    return LaunchDescription([ExecuteProcess(
        cmd=["sh", "-c", "trap '' INT TERM; echo ready; while :; do sleep 0.1; done"],
        output="screen", sigterm_timeout="0.2", sigkill_timeout="0.2")])
"""
    (tmp_path / "a.launch.py").write_text(text)
    process = start(tmp_path, "a.launch.py")
    wait_for(process, "ready")
    process.send_signal(signal.SIGINT)
    out, _ = process.communicate(timeout=30)
    assert process.returncode == 137
    assert [line.partition("'SIG")[2] for line in out.splitlines() if "escalating" in line] == [
        "INT', escalating to 'SIGTERM'",
        "TERM', escalating to 'SIGKILL'",
    ]


@pytest.mark.slow
@pytest.mark.parametrize(
    ("number", "code"), [(signal.SIGINT, 0), (signal.SIGTERM, 143), (signal.SIGKILL, -9)]
)
def test_nothing_is_left_behind(number: signal.Signals, code: int, tmp_path: Path) -> None:
    text = f"""{HEAD}
    return LaunchDescription([ExecuteProcess(cmd=["echo $$; sleep 1000 & sleep 1000"], shell=True, output="screen")])
"""
    (tmp_path / "a.launch.py").write_text(text)
    process = start(tmp_path, "a.launch.py")
    assert process.stdout is not None
    group = next(int(line.split()[1]) for line in process.stdout if line.startswith("[echo-1] "))
    assert group_is_there(group)
    process.send_signal(number)
    process.communicate(timeout=30)
    assert process.returncode == code
    assert gone(group)


MANAGED = """
import rclpy
from rclpy.lifecycle import LifecycleNode
rclpy.init()
try:
    rclpy.spin(LifecycleNode("m"))
except KeyboardInterrupt:
    pass
"""


@pytest.mark.slow
@pytest.mark.parametrize("moment", ["process started", "importing"])
def test_who_interrupts_a_start_sees_no_traceback(moment: str, tmp_path: Path) -> None:
    """Python tells of what it was just importing, which is nobody's mistake."""
    (tmp_path / "slow.py").write_text("import time; print('importing', flush=True); time.sleep(60)")
    (tmp_path / "a.launch.xml").write_text("<launch><node exec='slow.py' output='screen'/></launch>")
    process = start(tmp_path, "a.launch.xml")
    wait_for(process, moment)
    process.send_signal(signal.SIGINT)
    out, _ = process.communicate(timeout=60)
    assert process.returncode == 0
    assert "Traceback" not in out
    assert "[INFO] [slow.py-1]: process has finished cleanly" in out


@pytest.mark.parametrize("transport", ["local", "rclpy"])
def test_managed_nodes_start_and_say_their_states(transport: str, tmp_path: Path) -> None:
    if transport == "rclpy" and find_spec("rclpy") is None:
        pytest.skip("there is no real rclpy here")
    (tmp_path / "managed.py").write_text(MANAGED)
    (tmp_path / "a.launch.py").write_text(f"""{HEAD}
    from launch_ros.event_handlers import OnStateTransition
    node = LifecycleNode(executable="managed.py", name="m", namespace="a", autostart=True)
    said = [LogInfo(msg="is active"), Shutdown(reason="done")]
    return LaunchDescription([
        RegisterEventHandler(OnStateTransition(target_lifecycle_node=node, goal_state="active", entities=said)),
        node,
    ])
""")
    out, _ = start(tmp_path, "a.launch.py", transport=transport).communicate(timeout=60)
    assert "[INFO] [launch.user]: is active" in out
    assert "process has finished cleanly" in out
