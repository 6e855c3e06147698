"""Real exchanges, with all that is installed."""

from __future__ import annotations

import sys

import pytest

from tests.interop.bench.matrix import Matrix
from tests.interop.bench.outcomes import Feature, Outcome
from tests.interop.bench.peers import PEERS

pytest.importorskip("zenoh")


@pytest.mark.slow
def test_what_is_installed_works() -> None:
    """Lyrical's simulated publisher always is."""
    with Matrix({"Lyrical": sys.executable}) as matrix:
        rows = list(matrix.rows(PEERS, list(Feature)))
    failed = [(row.peer, each) for row in rows for cell in row.cells for each in cell.checks]
    assert not [each for each in failed if each[1].outcome is Outcome.FAILS]
    assert rows[-1].cells[-1].word == "ok"
