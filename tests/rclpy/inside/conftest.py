"""Pairs of processes (contract/processes.py), and what tests of differing definitions share."""

from __future__ import annotations

from collections.abc import Callable, Iterator

import pytest
from ifgen_runtime import adapters
from ifgen_runtime.mismatch import reporting
from ifgen_runtime.mismatch.reporting import Mismatch

from tests.rclpy.inside.contract.processes import ACROSS, Pair, connected


@pytest.fixture(params=ACROSS)
def across(request: pytest.FixtureRequest) -> Iterator[Pair]:
    """Over each transport."""
    with connected(request.param) as made:
        yield made


@pytest.fixture
def recorded() -> Iterator[Pair]:
    """Over the transport that the test governs."""
    with connected("recorded") as made:
        yield made


@pytest.fixture
def no_adapters(monkeypatch: pytest.MonkeyPatch) -> None:
    """What other tests have registered, and what is installed, does not count."""
    monkeypatch.setattr(adapters, "_registered", {})
    monkeypatch.setattr(adapters, "_found", {})


@pytest.fixture
def heard(monkeypatch: pytest.MonkeyPatch) -> list[Mismatch]:
    """What the listener for strict mode hears."""
    noted: list[Mismatch] = []
    monkeypatch.setattr(reporting, "listener", noted.append)
    return noted


@pytest.fixture
def log(capfd: pytest.CaptureFixture[str]) -> Callable[[], list[str]]:
    """The warnings since the last call."""
    return lambda: [line for line in capfd.readouterr().err.splitlines() if "[WARN]" in line]
