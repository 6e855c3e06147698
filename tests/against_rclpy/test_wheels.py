"""The wheels that everything is compared with are the newest, and the manual says which release is followed."""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path

import pytest

MANUAL = (Path(__file__).resolve().parents[2] / "docs" / "platforms.md").read_text(encoding="utf-8")
KNOWN = {7: "7.1.6", 9: "9.1.2"}
"""The newest wheel of rclpy for Jazzy and for Kilted that scenarios were compared with."""


def newer(available: list[str]) -> list[str]:
    """Those of the versions that are newer than what is known of their distribution, or of a new one."""
    numbers = {text: tuple(map(int, text.split("."))) for text in available}
    return sorted(
        text
        for text, version in numbers.items()
        if version[0] >= min(KNOWN) and version > tuple(map(int, KNOWN.get(version[0], "0").split(".")))
    )


def test_what_counts_as_newer() -> None:
    assert newer(["7.1.6", "7.1.5", "9.1.2", "3.3.11"]) == []
    assert newer(["7.1.6", "7.1.12", "9.1.2", "10.0.11"]) == ["10.0.11", "7.1.12"]


def test_the_manual_says_which_release_is_followed() -> None:
    assert f"the wheels ({KNOWN[7]};" in MANUAL
    assert re.search(r"the local rclpy behaves as 7\.1\.12 on rcl 9\.2\.10", MANUAL)


@pytest.mark.slow
def test_the_index_has_nothing_newer() -> None:
    """Each run of .ci/run asks: then compare with the new wheels, and change KNOWN and docs/platforms.md."""
    asked = subprocess.run(
        [sys.executable, "-m", "pip", "index", "versions", "ros-rclpy"],
        capture_output=True,
        text=True,
        timeout=120,
        check=False,
    )
    versions = re.search(r"Available versions: (.*)", asked.stdout)
    if versions is None:
        pytest.skip(f"the package index does not answer: {asked.stderr.strip()[-200:]}")
    assert newer(versions[1].split(", ")) == []
