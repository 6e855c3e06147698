"""The wheels, built once for all tests of installation."""

from __future__ import annotations

from pathlib import Path

import pytest

from .support import ROOT, build, unpacked


@pytest.fixture(scope="session")
def sdists(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Path]:
    """The sdists of the toolkit and of the runtime."""
    folder = tmp_path_factory.mktemp("sdists")
    return build(ROOT, folder, "sdist"), build(ROOT / "codegen/runtime", folder, "sdist")


@pytest.fixture(scope="session")
def wheels(sdists: tuple[Path, Path], tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Path]:
    """The wheels of the toolkit and of the runtime, built from their sdists as for an index."""
    folder = tmp_path_factory.mktemp("wheels")
    toolkit, runtime = (build(unpacked(sdist, folder / sdist.name), folder, "wheel") for sdist in sdists)
    return toolkit, runtime
