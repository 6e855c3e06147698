"""Terminals in a domain of their own, and a site for routers with ports of its own."""

from __future__ import annotations

import socket
from collections.abc import Iterator
from pathlib import Path

import pytest
from ifgen_pytest.domains import own_domain

from tests.running.sites import Site
from tests.running.terminals import Machine


@pytest.fixture
def machine(tmp_path: Path) -> Iterator[Machine]:
    with own_domain() as domain:
        made = Machine(domain, tmp_path)
        yield made
        made.close()


@pytest.fixture
def site(tmp_path: Path) -> Iterator[Site]:
    with own_domain() as domain:
        made = Site(domain, tmp_path)
        yield made
        made.close()


@pytest.fixture
def endpoints() -> list[str]:
    """Endpoints that are free."""
    sockets = [socket.socket() for _ in range(2)]
    for each in sockets:
        each.bind(("127.0.0.1", 0))
    numbers = [each.getsockname()[1] for each in sockets]
    for each in sockets:
        each.close()
    return [f"tcp/127.0.0.1:{number}" for number in numbers]
