"""All codecs agree about mutated bytes and mutated messages; docs/codec.md tells how to try millions."""

from __future__ import annotations

import subprocess
import sys

import pytest

from ..native import sanitizers
from .fuzzing.cases import Cases, Disagreement
from .fuzzing.corpus import PAYLOADS
from .fuzzing.judge import python_codec
from .support import ROOT, Classes


def test_codecs_agree(classes: Classes) -> None:
    cases = Cases(1, classes)
    for number in range(len(classes) * 8):  # of every class
        cases.run(number)


def test_a_disagreement_is_noticed(classes: Classes, monkeypatch: pytest.MonkeyPatch) -> None:
    """A generated function that swaps two fields does not get far."""
    name = "geometry_msgs/msg/Point32"
    cases = Cases(1, Classes({name: classes[name]}))
    encode = python_codec(classes[name])[0]
    monkeypatch.setitem(encode.__globals__, "_serialize_Point32", lambda message: encode(message)[:-1] + b"?")
    with pytest.raises(Disagreement, match=r"case \d+ of seed 1, geometry_msgs/msg/Point32"):
        for number in range(100):
            cases._good = {name: [encode(classes[name]())] * PAYLOADS}
            cases.run(number)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("options", "limit"),
    [
        (["--cases", "300000"], 250),
        pytest.param(
            ["--cases", "40000", "--sanitize"],
            250,
            marks=pytest.mark.skipif(bool(sanitizers.why_not()), reason=sanitizers.why_not()),
        ),
    ],
    ids=["many", "sanitized"],
)
def test_many_cases(options: list[str], limit: float) -> None:
    command = [sys.executable, "-m", "tests.codec.fuzzing", "--jobs", "2", *options]
    ran = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, timeout=limit, check=False)
    assert ran.returncode == 0, ran.stdout + ran.stderr
    assert "all codecs agree" in ran.stdout
    assert not any(sign in ran.stderr for sign in sanitizers.SIGNS), ran.stderr
