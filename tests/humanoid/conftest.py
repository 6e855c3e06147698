"""The humanoid's modules on sys.path, and a compiled model for all tests."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import TYPE_CHECKING

import pytest

sys.path.insert(0, str(Path(__file__).parents[2] / "examples/humanoid"))

if TYPE_CHECKING:
    from humanoid.robot.model import HumanoidModel

_MUJOCO = pytest.importorskip("mujoco", reason="the simulation comes with the extra ifgen-ros[sim]")


@pytest.fixture(scope="session")
def model() -> HumanoidModel:
    from humanoid.robot.model import load

    return load()
