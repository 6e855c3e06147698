"""The generated classes, made once for all tests of the codec."""

from __future__ import annotations

import pytest

from .support import Classes, generate


@pytest.fixture(scope="session")
def classes(tmp_path_factory: pytest.TempPathFactory) -> Classes:
    """Every bundled message class and those of codec_msgs, by type name."""
    return generate(tmp_path_factory.mktemp("generated"))
