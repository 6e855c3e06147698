"""The suite with the codecs of this repository, and with libraries of others."""

from __future__ import annotations

import importlib.util
import sys
from pathlib import Path

import pytest
from ifgen.pipeline.model import load_model

from .definitions import INTERFACES, files
from .make_cases import hashes_in
from .support import FOXGLOVE, HERE, PYTHON, ROOT, node_modules, run_suite, write_definitions


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


def test_the_cases_are_about_all_types_and_have_the_hashes_of_the_wheels() -> None:
    model = load_model(ROOT / "interfaces", INTERFACES)
    interfaces = [interface for package in model.packages for interface in package.interfaces]
    messages = {message.type_name: message.type_hash for message in model.types}
    others = [each for interface in interfaces for each in (*interface.services, interface)]
    lines = [line.split() for line in (HERE / "cases/hashes.txt").read_text().splitlines()]
    hashes = {type_name: type_hash for _, _, type_name, type_hash in lines}
    assert hashes == {each.type_name: each.type_hash for each in others} | messages

    defaults = (line.split()[2] for line in (HERE / "cases/default.txt").read_text().splitlines())
    assert set(defaults) == messages.keys()

    values = (line.split() for line in (HERE / "cases/values.txt").read_text().splitlines())
    constants = {(words[2], words[3]) for words in values if words[1] == "constant"}
    assert constants == {
        (message.type_name, constant.name) for message in model.types for constant in message.constants
    }

    for package in model.packages:
        for type_name, type_hash in hashes_in(Path(sys.prefix, "share", package.name)).items():
            if type_name in hashes:  # a package of another patch release may have more types
                assert hashes[type_name] == type_hash
