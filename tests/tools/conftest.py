"""The command line in this process."""

from __future__ import annotations

import os
import signal
from collections.abc import Callable

import pytest
from ifgen_runtime import neighbours
from ifgen_tools.session import Session

from tests.cli.conftest import cache_folder, clean_environment, ifgen

__all__ = ["cache_folder", "clean_environment", "ifgen"]


@pytest.fixture(autouse=True)
def nobody_elsewhere(monkeypatch: pytest.MonkeyPatch) -> None:
    """Let no nodes run in other domains, as those of other tests do, which tools tell of."""
    monkeypatch.setattr(neighbours, "_everybody", lambda _: {})


@pytest.fixture
def interrupted_wait(monkeypatch: pytest.MonkeyPatch) -> None:
    """Ctrl-C as soon as a command waits for something without a limit."""
    wait = Session.wait_for

    def wait_for(
        session: Session, condition: Callable[[], bool], timeout: float | None = None, *turn: float
    ) -> bool:
        if timeout is None:
            os.kill(os.getpid(), signal.SIGINT)
        return wait(session, condition, timeout, *turn)

    monkeypatch.setattr(Session, "wait_for", wait_for)
