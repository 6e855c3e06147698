"""`ifgen interface proto`, whose messages are those of the transport."""

from __future__ import annotations

import json
from pathlib import Path

import yaml

from tests.cli.conftest import Run, write


def test_default_values(ifgen: Run) -> None:
    assert (
        ifgen("interface", "proto", "geometry_msgs/msg/Quaternion").out
        == '"x: 0.0\ny: 0.0\nz: 0.0\nw: 1.0\n"\n'
    )
    assert ifgen("interface", "proto", "--no-quotes", "std_srvs/srv/SetBool").out == "data: false\n\n"
    out = ifgen("interface", "proto", "--no-quotes", "test_msgs/msg/Defaults").out
    assert yaml.safe_load(out)["float64_value"] == 1.125
    assert json.loads(ifgen("interface", "proto", "example_interfaces/action/Fibonacci", "--json").out) == {
        "order": 0
    }


def test_a_type_that_nobody_generated(ifgen: Run, tmp_path: Path) -> None:
    write(tmp_path / "interfaces/walk_msgs/srv/Plan.srv", "float64 x 0.1\n---\n")
    write(tmp_path / "pyproject.toml", '[tool.ifgen]\npaths = ["interfaces"]\n')
    assert ifgen("interface", "proto", "walk_msgs/srv/Plan").out == '"x: 0.1\n"\n'


def test_unknown_type(ifgen: Run) -> None:
    done = ifgen("interface", "proto", "std_srvs/srv/SetBol")
    assert (done.code, "did you mean 'std_srvs/srv/SetBool'" in done.err) == (1, True)
    assert "names no type" in ifgen("interface", "proto", "std msgs").err
