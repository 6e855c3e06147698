"""The ros wheels start every interpreter a second time, with another LD_LIBRARY_PATH: programs must not notice.

`ros_wheels_bootstrapper.pth` calls execve while `site` is imported, unless _ROS_WHEELS_BOOTSTRAP_COMPLETE is set.
"""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
import textwrap
from importlib.util import find_spec
from pathlib import Path

import pytest

GUARD = "_ROS_WHEELS_BOOTSTRAP_COMPLETE"
WORDS = [
    "two words",
    "",
    "日本語 ñ",
    "--help",
    "-c",
    "'quoted' \"twice\"",
    "back\\slash",
    "$HOME",
    "--ros-args",
    "-p",
    "x:=1",
]
TRANSPORTS = ["local", "rclpy"]

pytestmark = pytest.mark.skipif(
    find_spec("ros_wheels_bootstrapper") is None, reason="the ros wheels are not installed"
)


@pytest.fixture(scope="module")
def program(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A program in a folder with a space in its name; it prints its arguments and ends with 7."""
    path = tmp_path_factory.mktemp("folder with space") / "tell.py"
    path.write_text(
        textwrap.dedent(
            """
            import json, os, rclpy, sys
            print(json.dumps({
                "arguments": sys.argv[1:],
                "input": sys.stdin.read(),
                "ours": "underlay" in rclpy.__file__,
                "main": __name__,
                "folder": sys.path[0],
            }))
            sys.exit(7)
            """
        )
    )
    return path


def fresh(
    *command: str | Path, text: str = "", cwd: Path | None = None, **more: str
) -> subprocess.CompletedProcess[str]:
    """Run a command like a shell that knows nothing about the wheels."""
    environment = {key: value for key, value in os.environ.items() if key not in {GUARD, "LD_LIBRARY_PATH"}}
    return subprocess.run(
        [str(word) for word in command],
        input=text,
        env={**environment, **more},
        cwd=cwd,
        capture_output=True,
        text=True,
        timeout=60,
        check=False,
    )


@pytest.mark.parametrize("transport", TRANSPORTS)
@pytest.mark.parametrize("script", [True, False], ids=["ifgen", "python -m ifgen"])
def test_arguments_input_and_exit_code_reach_a_program(program: Path, transport: str, script: bool) -> None:
    start = [Path(sys.executable).with_name("ifgen")] if script else [sys.executable, "-m", "ifgen"]
    text = "line one\nläst line"
    ran = fresh(*start, "run", "--transport", transport, program, *WORDS, text=text)
    assert (ran.returncode, ran.stderr) == (7, "")
    told = json.loads(ran.stdout)
    assert told == {
        "arguments": WORDS,
        "input": text,
        "ours": transport == "local",
        "main": "__main__",
        "folder": str(program.parent),
    }


@pytest.mark.parametrize("transport", TRANSPORTS)
def test_modules_run_too(program: Path, transport: str) -> None:
    command = [sys.executable, "-m", "ifgen", "run", "--transport", transport, "-m", "tell", *WORDS]
    ran = fresh(*command, text="in", cwd=program.parent)
    assert (ran.returncode, ran.stderr) == (7, "")
    told = json.loads(ran.stdout)
    assert (told["arguments"], told["input"], told["main"]) == (WORDS, "in", "__main__")


def test_failures_keep_their_exit_codes(tmp_path: Path) -> None:
    (tmp_path / "broken.py").write_text("raise ValueError('on purpose')\n")
    ran = fresh(sys.executable, "-m", "ifgen", "run", tmp_path / "broken.py")
    assert ran.returncode == 1
    assert ran.stderr.endswith("ValueError: on purpose\n")
    missing = fresh(sys.executable, "-m", "ifgen", "run", tmp_path / "no such file.py")
    assert missing.returncode == 2
    assert "no such file.py" in missing.stderr and "Traceback" not in missing.stderr


def test_pytest_and_commands_from_a_pipe_work(tmp_path: Path) -> None:
    (tmp_path / "test_it.py").write_text(
        "import ifgen\nassert ifgen.activate('local') == 'local'\n"
        "import rclpy\ndef test_it(): assert 'underlay' in rclpy.__file__\ndef test_fails(): assert not rclpy\n"
    )
    ran = fresh(
        sys.executable, "-m", "pytest", "-q", "-k", "it and not fails", tmp_path / "test_it.py", cwd=tmp_path
    )
    assert ran.returncode == 0, ran.stdout + ran.stderr
    ran = fresh(sys.executable, "-m", "pytest", "-q", tmp_path / "test_it.py", cwd=tmp_path)
    assert ran.returncode == 1, ran.stdout + ran.stderr
    ran = fresh(
        sys.executable, "-", "a b", text="import ifgen, sys\nprint(ifgen.activate('local'), sys.argv[1:])\n"
    )
    assert ran.stdout == "local ['a b']\n"


@pytest.mark.skipif(shutil.which("strace") is None, reason="needs strace to count what is executed")
def test_programs_started_by_ifgen_do_not_start_twice(program: Path, tmp_path: Path) -> None:
    log = tmp_path / "log"
    command = [
        sys.executable,
        "-m",
        "ifgen",
        "run",
        "--transport",
        "rclpy",
        program,
        "first",
        ":",
        program,
        "last",
    ]
    fresh("strace", "-f", "-e", "trace=execve", "-o", log, *command)
    assert count_of_pythons(log) == 4  # that of the shell, the wheels' second one, and one for each program


def count_of_pythons(log: Path) -> int:
    return sum("execve(" in line and " = 0" in line for line in log.read_text().splitlines())
