"""The real rcl reads what we write as parameters: files of `ifgen param dump`, and values after `-p`."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

from tests.against_rclpy.harness import real_rclpy_missing

PROGRAM = """
import sys
import rclpy
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from ifgen_runtime.parameters import parameter_yaml
from tests.runtime.test_parameter_yaml import BEYOND, NAMES, VALUES, bits

file = sys.argv[1]


@settings(max_examples=200, deadline=None, suppress_health_check=list(HealthCheck), database=None)
@given(st.dictionaries(NAMES, VALUES | BEYOND, min_size=1, max_size=6), VALUES)
def check(values, by_hand):
    open(file, "w").write(parameter_yaml.file_text("/robot/arm", values))
    expected = {name: bits(value) for name, value in values.items() if not parameter_yaml.is_beyond_files(value)}
    arguments = ["--ros-args", "--params-file", file]
    text = parameter_yaml.value_text(by_hand)
    arguments += ["-p", f"zz:={text}"]
    expected["zz"] = bits(by_hand)
    context = rclpy.Context()
    rclpy.init(context=context, args=arguments)
    options = {"start_parameter_services": False, "enable_rosout": False}
    node = rclpy.create_node("arm", namespace="robot", context=context, **options)
    overrides = node._parameter_overrides
    found = {name: each.value if each.type_.value < 5 else list(each.value) for name, each in overrides.items()}
    node.destroy_node()
    context.shutdown()
    assert {name: bits(value) for name, value in found.items()} == expected, (found, expected)


check()
print("all read")
"""


@pytest.mark.slow
@pytest.mark.skipif(real_rclpy_missing() is not None, reason=str(real_rclpy_missing()))
@pytest.mark.timeout(200)
def test_real_rcl_reads_what_we_write(tmp_path: Path) -> None:
    program = tmp_path / "program.py"
    program.write_text(PROGRAM)
    command = [
        sys.executable,
        "-m",
        "ifgen",
        "run",
        "--transport",
        "rclpy",
        str(program),
        str(tmp_path / "p.yaml"),
    ]
    root = str(Path(__file__).parents[2])
    done = subprocess.run(
        command,
        capture_output=True,
        text=True,
        timeout=180,
        check=False,
        env={**os.environ, "PYTHONPATH": root},
    )
    assert done.stdout == "all read\n", done.stderr[-3000:]
