"""A robot of five nodes with each kind of endpoint, and the humanoid."""

from __future__ import annotations

from pathlib import Path

import pytest
from ifgen_tools.policy import grants
from ifgen_tools.policy.grants import Grants
from ifgen_tools.system.build import Request, build

HERE = Path(__file__).parent
ROOT = HERE.parents[1]
DOMAIN = 28


@pytest.fixture(scope="session")
def robot() -> list[Grants]:
    built = build(Request(launch_files=(HERE / "robot.launch.py",), arguments={}, packages=(HERE / "robot",)))
    assert not built.findings
    return grants.of_system(built.system, built.registry)


@pytest.fixture(scope="session")
def humanoid() -> list[Grants]:
    launch = ROOT / "examples/humanoid/launch/humanoid.launch.py"
    built = build(Request(launch_files=(launch,), arguments={}, packages=(ROOT / "interfaces",)))
    return grants.of_system(built.system, built.registry)
