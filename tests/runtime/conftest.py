"""Packages generated for a test module, importable while it runs, separate from a ROS that may be installed."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import ifgen
import pytest

from .support import imported_from

ROOT = Path(__file__).resolve().parents[2]
CLASS_MSGS = Path(__file__).with_name("class_msgs")


@pytest.fixture(scope="session")
def generated(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The folder with class_msgs and its dependencies."""
    folder = tmp_path_factory.mktemp("generated")
    ifgen.generate(CLASS_MSGS, output=folder, include=[ROOT / "interfaces"], with_deps=True)
    return folder


@pytest.fixture(scope="module")
def importable(generated: Path) -> Iterator[Path]:
    """The same folder, first on sys.path."""
    with imported_from(generated, (path.name for path in generated.iterdir())):
        yield generated
