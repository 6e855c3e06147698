"""Generated nodes behave the same on the local transport and on real rclpy, as programs/NAME.txt says."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

from tests.nodes.conftest import SLOWLY_ON_REAL, TRANSPORTS, Ifgen

PROGRAMS = Path(__file__).parent / "programs"


@pytest.mark.parametrize("transport", SLOWLY_ON_REAL)
@pytest.mark.parametrize("name", ["skeletons", "parameters", "coroutines"])
def test_what_nodes_do(name: str, transport: str, robot: Path, run_ifgen: Ifgen) -> None:
    done = run_ifgen("run", "--transport", transport, PROGRAMS / f"{name}.py", folder=robot)
    assert (done.stdout, done.returncode) == ((PROGRAMS / f"{name}.txt").read_text(), 0), done.stderr


@pytest.mark.parametrize("transport", TRANSPORTS)
def test_the_examples_of_the_format(transport: str, examples: Path, run_ifgen: Ifgen) -> None:
    done = run_ifgen("run", "--transport", transport, PROGRAMS / "examples.py", folder=examples)
    assert (done.stdout, done.returncode) == ((PROGRAMS / "examples.txt").read_text(), 0), done.stderr


@pytest.mark.parametrize("transport", SLOWLY_ON_REAL)
def test_a_node_starts_as_module_and_as_file_and_reads_its_parameter_file(
    transport: str, robot: Path, run_ifgen: Ifgen
) -> None:
    config = ["--params-file", "generated/robot/config/arm.yaml", "-p", "names:=[a]"]
    listener = PROGRAMS / "listener.py"
    for program in (["-m", "robot.arm"], ["generated/robot/robot/arm.py"]):
        done = run_ifgen(
            "run", "--transport", transport, *program, "--ros-args", *config, ":", listener, folder=robot
        )
        assert done.stdout == "heard robot.msg.Joint(name='', angle=0.0)\n", done.stderr
        assert done.returncode == 0, done.stderr


def test_parameters_that_cannot_be_end_a_node_with_a_reason(robot: Path, run_ifgen: Ifgen) -> None:
    done = run_ifgen("run", "--transport", "local", "-m", "robot.arm", folder=robot)
    reason = "arm: parameter 'names' must be given: with -p names:=VALUE or in a file\n"
    assert (done.stderr, done.returncode) == (reason, 1)


def test_python_alone_runs_a_node(robot: Path) -> None:
    """As in a sourced workspace: everything is on PYTHONPATH, without ifgen's commands."""
    root = Path(__file__).parents[2]
    path = [robot / "generated/robot", root / "codegen/underlay", root / "generated", root / "codegen"]
    done = subprocess.run(
        [sys.executable, "-m", "robot.arm", "--ros-args", "-p", "names:=[a, b]"],
        env={**os.environ, "PYTHONPATH": os.pathsep.join(map(str, path))},
        capture_output=True,
        text=True,
        timeout=60,
        check=False,
    )
    assert done.stderr == "arm: parameter 'names' = ('a', 'b'): there must be an odd number of names, not 2\n"


def test_an_abstract_method_that_is_missing_is_named(robot: Path, run_ifgen: Ifgen) -> None:
    program = robot / "incomplete.py"
    program.write_text(
        "import rclpy\nfrom robot._brain_base import BrainBase\nrclpy.init()\n"
        "class Brain(BrainBase):\n    pass\n"
        "try:\n    Brain()\nexcept TypeError as error:\n    print(error)\n"
    )
    done = run_ifgen("run", "--transport", "local", program, folder=robot)
    for method in ("on_target", "handle_ask", "accept_act", "cancel_act", "execute_act", "on_think_timer"):
        assert method in done.stdout
