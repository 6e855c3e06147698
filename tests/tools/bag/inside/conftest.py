"""Bags to play."""

from __future__ import annotations

from pathlib import Path

import pytest
from geometry_msgs.msg import Point
from ifgen_runtime.bag import OfferedQoS, Recorder
from std_msgs.msg import String

START = 1_700_000_000_000_000_000


@pytest.fixture
def drive(tmp_path: Path) -> Path:
    """A bag of 2 s: 20 points on /position, and the text of /mode, which is transient local."""
    path = tmp_path / "drive"
    with Recorder(path) as recorder:
        recorder.add_topic("/mode", String, OfferedQoS(durability="transient_local", depth=1))
        recorder.write("/mode", String(data="walk"), START)
        for index in range(20):
            recorder.write("/position", Point(x=0.1 * index), START + index * 100_000_000)
    return path
