"""`ifgen demo` as a user runs it: all nodes, connected only by messages."""

from __future__ import annotations

import contextlib
import importlib.util
import json
import os
import re
import signal
import socket
import struct
import subprocess
import sys
from pathlib import Path

import pytest
from humanoid.robot.mjcf import write_mjcf
from ifgen_pytest.domains import own_domain
from PIL import Image

from .bodies import offset_hips

pytestmark = pytest.mark.timeout(600)
SHORT = "high_level_task_manager: {ros__parameters: {tasks: [walk 0.5 0.1 0.3]}}"
REAL = importlib.util.find_spec("rpyutils") is not None
needs_real = pytest.mark.skipif(not REAL, reason="real rclpy is not installed")


def demo(*words: str, timeout: float = 500) -> dict[str, str]:
    """Run the demo; returns the rows of its summary."""
    environment = {
        **os.environ,
        "COLUMNS": "80",
    }
    done = subprocess.run(
        [sys.executable, "-m", "ifgen", "demo", "--headless", *words],
        capture_output=True,
        text=True,
        timeout=timeout,
        env=environment,
        check=False,
    )
    assert done.returncode == 0, done.stdout + done.stderr
    assert "Traceback" not in done.stderr
    assert all(len(line) <= 80 for line in done.stdout.splitlines() if not line.startswith("/"))
    rows = re.findall(r"^  (\S.*?)  +(\S.*)$", done.stdout.partition("\n\n")[2], re.MULTILINE)
    return dict(rows)


def test_it_walks_and_turns_and_stops_when_a_goal_is_cancelled() -> None:
    summary = demo("--scenario", "walk")
    assert summary["outcome"] == "done"
    assert summary["falls"] == "0"
    assert int(summary["steps"]) >= 12
    assert float(summary["foot error"].split()[0]) < 60
    assert float(summary["goal error"].split()[0]) < 60
    assert float(summary["stop after cancel"].split()[0]) <= 3.0


@pytest.mark.slow
def test_the_same_seed_gives_the_same_states_also_from_a_file(tmp_path: Path) -> None:
    model = tmp_path / "own.xml"
    model.write_text(write_mjcf())
    runs = [["--seed", "3"], ["--seed", "3", "--model", str(model)], ["--seed", "4"]]
    first, second, other = (demo("--scenario", "stop", *run)["state hash"] for run in runs)
    assert first == second != other


@pytest.mark.slow
def test_another_body_walks_and_waves(tmp_path: Path) -> None:
    model, tasks = tmp_path / "own.xml", tmp_path / "tasks.yaml"
    model.write_text(offset_hips())
    tasks.write_text("/high_level_task_manager: {ros__parameters: {tasks: [walk 1 0.4 0.8, dance wave]}}")
    summary = demo("--model", str(model), "--scenario", str(tasks))
    assert summary["outcome"] == "done"
    assert summary["falls"] == "0"
    assert summary["dances"] == "1"
    assert float(summary["foot error"].split()[0]) <= 20
    assert float(summary["goal error"].split()[0]) <= 40


@pytest.mark.slow
def test_keeping_to_real_time_changes_nothing() -> None:
    free, paced = (demo("--scenario", "stop", *more) for more in ((), ("--realtime",)))
    assert float(paced["real-time factor"]) < 1.02
    assert free["state hash"] == paced["state hash"]


@pytest.mark.slow
@pytest.mark.parametrize("scenario", ["all", "dance", "push"])
def test_other_scenarios_end_well(scenario: str) -> None:
    summary = demo("--scenario", scenario)
    assert summary["outcome"] == "done"
    assert summary["falls"] == "0"


@pytest.mark.slow
def test_it_greets_whom_it_sees_and_does_what_people_want() -> None:
    summary = demo("--scenario", "people")
    assert summary["outcome"] == "done"
    assert summary["falls"] == "0"
    assert summary["dances"] == "2"  # one for the face, one that was asked for
    assert int(summary["steps"]) >= 4
    assert summary["touches"].startswith("0 ")


@pytest.mark.slow
@pytest.mark.skipif(not REAL, reason="real rclpy is not installed")
@pytest.mark.parametrize("scenario", ["walk", "all", "stop"])
def test_the_same_files_run_on_real_rclpy(scenario: str) -> None:
    summary = demo("--scenario", scenario, "--transport", "rclpy")
    assert summary["outcome"] == "done"
    assert summary["falls"] == "0"


@pytest.mark.alone
@pytest.mark.skipif(not REAL, reason="real rclpy is not installed")
def test_it_walks_on_real_rclpy_in_real_time() -> None:
    # Without lockstep the robot stops safely when its nodes get no processor time for 80 ms, which can happen
    # at any moment on a shared machine. So one walk of three may end that way.
    words = ("--scenario", "walk", "--transport", "rclpy", "--realtime")
    failures: list[str] = []
    for _ in range(3):
        try:
            summary = demo(*words)
        except AssertionError as failure:
            failures.append(str(failure))
        else:
            break
    else:
        pytest.fail("\n".join(failures))
    assert summary["outcome"] == "done"
    assert summary["falls"] == "0"
    assert 0.9 < float(summary["real-time factor"]) < 1.02
    assert int(summary["steps"]) >= 12
    assert float(summary["foot error"].split()[0]) < 60


@pytest.mark.slow
@pytest.mark.parametrize(("name", "begins"), [("robot.png", b"\x89PNG"), ("robot.gif", b"GIF89a")])
def test_pictures_are_written(name: str, begins: bytes, tmp_path: Path) -> None:
    picture, scenario = tmp_path / name, tmp_path / "short.yaml"
    scenario.write_text(SHORT)
    demo("--scenario", str(scenario), "--record", str(picture))
    assert picture.read_bytes().startswith(begins)
    with Image.open(picture) as image:
        frames = getattr(image, "n_frames", 1)
        assert frames == 1 or 50 < frames < 100  # ten for a second


# Starts the demo with one command line after the other, and prints how each ends and what it says.
IN_TURN = """
import contextlib, io, json, sys
from ifgen.cli.main import main
for words in json.load(sys.stdin):
    with contextlib.redirect_stdout(io.StringIO()), contextlib.redirect_stderr(io.StringIO()) as errors:
        try:
            ending = main(["demo", *words])
        except SystemExit as problem:
            ending = problem.code
    print(json.dumps([ending, errors.getvalue()]))
"""


def test_mistakes_are_one_sentence(tmp_path: Path) -> None:
    broken = tmp_path / "broken.xml"
    broken.write_text(write_mjcf().replace("l_knee", "l_kneee"))
    lazy, wrong = tmp_path / "lazy.py", tmp_path / "wrong.py"
    lazy.write_text(
        "from gait_planner._gait_planner_base import GaitPlannerBase\n\n\nclass Lazy(GaitPlannerBase): ...\n"
    )
    wrong.write_text("x = 1\nx +\n")
    mistakes = (
        (["--model", str(broken)], "no joint 'l_knee'"),
        (["--record", "x.avi"], "ends in .gif, .mp4 or .png"),
        (["--record", str(tmp_path / "none" / "x.gif")], f"there is no folder {tmp_path / 'none'}"),
        (["--headless", "--web"], "--headless cannot be used with --web"),
        (["--port", "8001"], "--port needs --web"),
        (["--host", "0.0.0.0"], "--host needs --web"),
        (["--joint-map", __file__], "--joint-map needs --model"),
        (["--idle", "--scenario", "walk"], "--idle cannot be used with --scenario"),
        (
            ["--scenario", "polka"],
            "there is no scenario polka: choose one of all, dance, ",
        ),
        (["--without", "tail"], "the robot has no node 'tail': it has battery_monitor, "),
        (["--replace", "gait_planner"], "write NODE=FILE_OR_MODULE, such as gait_planner=mine.py"),
        (["--replace", "gait_planner=nobody.py"], "there is no file nobody.py"),
        (["--replace", "gait_planner=no_module"], "the module no_module cannot be imported"),
        (
            ["--replace", f"gait_planner={lazy}"],
            "lazy.py: Lazy lacks handle_clear, on_diagnostics_timer, on_footsteps_",
        ),
        (["--replace", f"gait_planner={wrong}"], "wrong.py, line 2: SyntaxError: "),
        (["--replace", "gait_planner=json"], "json: expected one class that derives from rclpy's Node"),
    )
    done = subprocess.run(
        [sys.executable, "-c", IN_TURN],
        input=json.dumps([words for words, _ in mistakes]),
        capture_output=True,
        text=True,
        timeout=100,
        check=False,
    )
    assert (done.returncode, done.stderr) == (0, "")
    answers = [json.loads(line) for line in done.stdout.splitlines()]
    for (words, expected), (ending, errors) in zip(mistakes, answers, strict=True):
        said = errors if ending == 2 else ending  # sys.exit() prints a sentence, and returns 1
        assert expected in said, words
        assert "Traceback" not in said


SCENES = {
    "list.yaml": ("- walk", "expected nodes with `ros__parameters`, as in a parameter file of ROS"),
    "broken.yaml": ("a: [", "is not YAML: while parsing"),
    "event.yaml": (
        "audience: {ros__parameters: {events: ['noon: push']}}",
        "'noon: push' is not an event: write WHEN: WHAT, such as",
    ),
}


@pytest.mark.parametrize("name", SCENES)
def test_mistakes_in_a_scenario_of_ones_own_are_one_sentence(name: str, tmp_path: Path) -> None:
    text, expected = SCENES[name]
    scenario = tmp_path / name
    scenario.write_text(text)
    refused(["--headless", "--scenario", str(scenario)], expected)


PAGE = Path(__file__).parents[2] / "docs" / "humanoid.md"


@pytest.mark.slow
@needs_real
def test_the_gait_planner_of_the_page_walks_on_real_rclpy(tmp_path: Path) -> None:
    file, scenario = tmp_path / "mine.py", tmp_path / "short.yaml"
    (text,) = re.findall(r"<!-- file: my_gait.py -->\n```python\n(.*?)```\n", PAGE.read_text(), re.DOTALL)
    file.write_text(text)
    scenario.write_text(SHORT)
    words = ("--replace", f"gait_planner={file}", "--without", "teleop", "--transport", "rclpy")
    summary = demo("--scenario", str(scenario), *words)
    assert (summary["outcome"], summary["falls"]) == ("done", "0")
    assert float(summary["goal error"].split()[0]) < 60


def test_a_second_robot_in_the_same_domain_is_refused(tmp_path: Path) -> None:
    with own_domain() as domain:
        environment = {**os.environ, "ROS_DOMAIN_ID": str(domain)}
        command = [sys.executable, "-m", "ifgen", "demo", "--headless", "--idle"]
        heard = tmp_path / "heard"
        with (
            heard.open("w") as log,
            subprocess.Popen(
                command, stdout=subprocess.PIPE, stderr=log, text=True, env=environment
            ) as first,
        ):
            assert first.stdout is not None
            try:
                assert first.stdout.readline().startswith("waking up")
                assert "stands, and waits" in first.stdout.readline()
                second = subprocess.run(
                    command, capture_output=True, text=True, timeout=60, env=environment, check=False
                )
                first.send_signal(signal.SIGINT)
                assert first.wait(30) == 130
            finally:
                first.kill()
        # Nothing that the second one published has reached the first.
        assert "refused" not in heard.read_text()
    assert second.returncode == 1
    assert second.stderr == (
        f"error: another simulation runs in ROS domain {domain}: end it, or choose another domain, "
        f"such as ROS_DOMAIN_ID={domain % 100 + 1}\n"
    )


def test_a_port_in_use_is_named() -> None:
    with socket.create_server(("127.0.0.1", 0)) as taken:
        port = taken.getsockname()[1]
        refused(["--web", "--port", str(port)], f"127.0.0.1:{port}: Address already in use; choose another")


def refused(words: list[str], expected: str) -> None:
    command = [sys.executable, "-m", "ifgen", "demo", *words]
    done = subprocess.run(command, capture_output=True, text=True, timeout=100, check=False)
    assert done.returncode in (1, 2)
    assert expected in done.stderr
    assert "Traceback" not in done.stderr


@pytest.mark.slow
@pytest.mark.skipif(sys.platform == "win32", reason="needs a pseudo-terminal")
def test_on_a_terminal_log_lines_are_not_garbled_and_ctrl_c_exits_with_130() -> None:
    import fcntl
    import pty
    import termios

    ours, theirs = pty.openpty()
    fcntl.ioctl(ours, termios.TIOCSWINSZ, struct.pack("HHHH", 24, 40, 0, 0))  # a narrow window
    command = [sys.executable, "-m", "ifgen", "demo", "--headless", "--scenario", "stop"]
    environment = {name: value for name, value in os.environ.items() if name != "COLUMNS"}
    process = subprocess.Popen(command, stdin=theirs, stdout=theirs, stderr=theirs, env=environment)
    os.close(theirs)
    seen = b""
    with contextlib.suppress(OSError):  # Linux raises it when nobody is at the other end any longer
        while part := os.read(ours, 4096):
            if b"robot accepts" in part:
                process.send_signal(signal.SIGINT)
            seen += part
    os.close(ours)
    assert process.wait(60) == 130
    # What is visible of a line is the text after the last carriage return.
    lines = [line.rstrip("\r").rpartition("\r")[2] for line in seen.decode().split("\n")]
    (logged,) = [line for line in lines if "[emergency_stop]: emergency stop" in line]
    assert re.fullmatch(r"(\x1b\[\d*m)?\[ERROR\] .*", logged)
    progress = [line.removeprefix("\x1b[K") for line in seen.decode().split("\r") if " steps, " in line]
    assert max(map(len, progress)) == 39
    assert any("interrupted" in line for line in lines)


@pytest.mark.skipif(sys.platform != "linux", reason="/proc is a folder where nobody can write, root included")
def test_a_film_that_cannot_be_written_is_refused_before_the_scenario() -> None:
    refused(["--headless", "--record", "/proc/robot.gif"], "--record: /proc/robot.gif cannot be written")


def test_a_seed_that_is_no_integer_of_a_parameter_is_refused() -> None:
    refused(["--seed", str(2**63)], f"{2**63} is not in the range 0<=x<={2**63 - 1}")


@pytest.mark.skipif(sys.platform == "win32", reason="needs SIGTERM")
def test_sigterm_ends_with_a_summary() -> None:
    environment = {name: value for name, value in os.environ.items() if "DISPLAY" not in name}
    command = [sys.executable, "-m", "ifgen", "demo", "--scenario", "stop"]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True, env=environment) as demo:
        assert demo.stdout is not None
        assert demo.stdout.readline() == "waking up the humanoid: scenario stop, seed 0\n"
        assert "--web or --record FILE.gif" in demo.stdout.readline()
        assert "walk to" in demo.stdout.readline()
        demo.terminate()
        said, _ = demo.communicate(timeout=60)
    assert demo.returncode == 143
    assert re.search(r"outcome +interrupted", said)


@needs_real
@pytest.mark.slow
@pytest.mark.parametrize("seconds", [0.6, 1.2, 2.0])
def test_an_early_ctrl_c_on_real_rclpy_shows_no_tracebacks(seconds: float) -> None:
    command = [sys.executable, "-m", "ifgen", "demo", "--headless", "--transport", "rclpy"]
    # A group of its own: a terminal sends Ctrl-C to the children, too.
    with subprocess.Popen(
        command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, start_new_session=True
    ) as demo:
        assert demo.stdout is not None
        assert demo.stdout.readline().startswith("waking up")
        with contextlib.suppress(subprocess.TimeoutExpired):
            demo.wait(seconds)  # into the start of the processes, wherever that is
        os.killpg(demo.pid, signal.SIGINT)
        said, _ = demo.communicate(timeout=60)
    assert "Traceback" not in said
    assert demo.returncode == 130
