"""Our bundled messages, importable while a module's tests run."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pytest

from ..runtime.support import imported_from

GENERATED = Path(__file__).resolve().parents[2] / "generated"


@pytest.fixture(autouse=True, scope="module")
def importable() -> Iterator[None]:
    packages = ("builtin_interfaces", "geometry_msgs", "nav_msgs", "sensor_msgs", "std_msgs", "test_msgs")
    with imported_from(GENERATED, packages):
        yield
