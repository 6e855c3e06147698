"""Our codec and the compiled type supports read each other, and agree on which bytes are not a message."""

from __future__ import annotations

import importlib.util
import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

_SCRIPT = Path(__file__).with_name("codec_exchange.py")


@pytest.mark.skipif(importlib.util.find_spec("rclpy") is None, reason="rclpy is not installed")
@pytest.mark.parametrize("examples", [1, pytest.param(12, marks=pytest.mark.slow)])
@pytest.mark.timeout(330)
def test_exchange_with_compiled_type_supports(tmp_path: Path, examples: int) -> None:
    """Over all types that have wheels: both directions, both byte orders, broken payloads, stated differences.

    It runs in a process of its own, because a compiled type support may crash on a payload.
    """
    done = subprocess.run(
        [sys.executable, _SCRIPT, tmp_path, str(examples)],
        capture_output=True,
        text=True,
        timeout=300,
        check=False,
        env={**os.environ, "PYTHONHASHSEED": "0"},
    )
    assert done.returncode == 0, done.stderr[-4000:]
    report = json.loads(done.stdout.splitlines()[-1])
    assert not report["problems"], "\n".join(f"{name}: {text}" for name, text in report["problems"].items())
    assert not report["verdicts"]
    assert len(report["compared"]) > 200
