"""The generated classes, made once for all tests of the codec."""

from __future__ import annotations

import pytest

from .support import Classes, folder_of_all, generate


@pytest.fixture(scope="session")
def classes(tmp_path_factory: pytest.TempPathFactory) -> Classes:
    """Every bundled message class and those of codec_msgs, by type name."""
    return generate(folder_of_all(tmp_path_factory))
