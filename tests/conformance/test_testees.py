"""The suite with the codecs of this repository, and with libraries of others."""

from __future__ import annotations

import importlib.util
from pathlib import Path

import pytest

from .definitions import INTERFACES, files
from .support import FOXGLOVE, HERE, PYTHON, node_modules, run_suite, write_definitions


def test_the_codec_passes_some_of_each_group() -> None:
    patterns = (
        "alignment/Mixed/*",
        "big/*",
        "bounds/*",
        "float/*",
        "text/*",
        "hostile/std_msgs/*",
        "hash/test_msgs/*",
    )
    code, output = run_suite(
        [*PYTHON, "ours"], *(word for pattern in patterns for word in ("--only", pattern))
    )
    assert code == 0, output


@pytest.mark.slow
@pytest.mark.parametrize("codec", ["native", "python"])
def test_both_codecs_pass(codec: str) -> None:
    code, output = run_suite([*PYTHON, "ours"], env={"IFGEN_CODEC": codec})
    assert code == 0, output


@pytest.mark.slow
@pytest.mark.parametrize(
    ("testee", "package"), [("rclpy", "rclpy._rclpy_pybind11"), ("rosbags", "rosbags"), ("mcap", "mcap_ros2")]
)
def test_libraries_for_python_fail_what_is_listed(testee: str, package: str) -> None:
    if importlib.util.find_spec(package.partition(".")[0]) is None:
        pytest.skip(f"{package} is not installed")
    code, output = run_suite([*PYTHON, testee], failures=testee)
    assert code == 0, output


@pytest.mark.slow
def test_foxglove_fails_what_is_listed(tmp_path: Path) -> None:
    modules = node_modules(tmp_path, FOXGLOVE)
    write_definitions(tmp_path / "definitions.json")
    program = ["node", str(HERE / "testees/foxglove.mjs"), str(modules), str(tmp_path / "definitions.json")]
    code, output = run_suite(program, failures="foxglove")
    assert code == 0, output


def test_the_definitions_of_the_suite_are_those_that_the_script_writes() -> None:
    folder = INTERFACES / "conformance_msgs/msg"
    assert {path.stem: path.read_text() for path in folder.glob("*.msg")} == dict(files())


def test_the_cases_are_small_enough_for_a_repository() -> None:
    assert sum(path.stat().st_size for path in (HERE / "cases").iterdir()) < 1_000_000
