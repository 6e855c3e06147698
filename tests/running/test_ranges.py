"""IFGEN_CHECK_FIELDS=1 warns of values outside their ranges at publish and at receive, on both transports."""

from __future__ import annotations

import re
from pathlib import Path

import ifgen
import pytest

from .test_programs import on_both, run

ROOT = Path(__file__).resolve().parents[2]


@pytest.fixture(scope="module")
def packages(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("meant")
    source = folder / "meant_msgs/msg/Wheel.msg"
    source.parent.mkdir(parents=True)
    source.write_text("float64 speed  # [m/s] [@range -3, 3] Speed\n")
    ifgen.generate(folder / "meant_msgs", output=folder / "out", include=[ROOT / "interfaces"])
    return folder / "out"


@on_both
@pytest.mark.parametrize("checks", ["1", ""])
def test_both_sides_warn(transport: str, checks: str, packages: Path, tmp_path: Path) -> None:
    command = ("-m", "ifgen", "run", "--transport", transport, "ranges.py")
    outcome = run(tmp_path, *command, PYTHONPATH=str(packages), IFGEN_CHECK_FIELDS=checks)
    assert (outcome.code, outcome.stdout) == (0, "4.5\n"), outcome.stderr
    said = re.findall(r"\[wheel\]: (topic .*)", outcome.stderr)
    text = "meant_msgs/msg/Wheel with speed = 4.5, outside -3 to 3 (meant_msgs/msg/Wheel.msg:1)"
    assert said[:2] == (
        [f"topic '/wheel': {verb} {text}" for verb in ("published", "received")] if checks else []
    )
