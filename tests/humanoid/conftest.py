"""A compiled model for all tests of the humanoid."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

if TYPE_CHECKING:
    from humanoid.robot.model import HumanoidModel

_MUJOCO = pytest.importorskip("mujoco", reason="the simulation comes with the extra ifgen-ros[sim]")


@pytest.fixture(scope="session")
def model() -> HumanoidModel:
    from humanoid.robot.model import load

    return load()
