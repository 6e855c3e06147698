"""Drawn examples are the same in every process: a failing test must fail again."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

DRAW = """
import hashlib, sys
if {busy}:
    import ifgen.cli.main, ifgen.cli.rules, ifgen.generator_py.tests.contract
from tests import conftest
from tests.nodes import descriptions
from tests.generated_tests import definitions
drawn = [repr(node) for node in descriptions.drawn({count})]
drawn += [repr(descriptions.one(definitions.packages(), number)) for number in range({count})]
print(hashlib.sha256("".join(drawn).encode()).hexdigest())
"""


@pytest.mark.parametrize("count", [3, pytest.param(30, marks=pytest.mark.slow)])
def test_drawn_in_two_processes(count: int) -> None:
    """They do not depend on imported modules or on the order of sets."""
    found = []
    for busy in (False, True):
        done = subprocess.run(
            [sys.executable, "-c", DRAW.format(busy=busy, count=count)],
            cwd=Path(__file__).parents[2],
            capture_output=True, text=True, timeout=60, check=True,
        )  # fmt: skip
        found.append(done.stdout)
    assert found[0] == found[1]
