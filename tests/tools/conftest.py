"""The command line in this process."""

from __future__ import annotations

import pytest
from ifgen_runtime import neighbours

from tests.cli.conftest import cache_folder, clean_environment, ifgen

__all__ = ["cache_folder", "clean_environment", "ifgen"]


@pytest.fixture(autouse=True)
def nobody_elsewhere(monkeypatch: pytest.MonkeyPatch) -> None:
    """Let no nodes run in other domains, as those of other tests do, which tools tell of."""
    monkeypatch.setattr(neighbours, "_everybody", lambda _: {})
