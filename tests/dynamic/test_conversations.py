"""Types that nobody generated, between nodes: the same on the local transport and on real rclpy."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

from tests.nodes.conftest import TRANSPORTS
from tests.real_rclpy import again_if_crashed

HERE = Path(__file__).parent


@pytest.mark.parametrize("transport", TRANSPORTS)
@pytest.mark.parametrize("name", ["conversation", "actions"])
def test_what_nodes_say(name: str, transport: str) -> None:
    command = [sys.executable, "-m", "ifgen", "run", "--transport", transport, str(HERE / f"{name}.py")]

    def run() -> subprocess.CompletedProcess[str]:
        return subprocess.run(command, capture_output=True, text=True, timeout=120, check=False)

    done = again_if_crashed(transport, run, lambda ended: ended.returncode)
    assert (done.stdout, done.returncode) == ((HERE / f"{name}.txt").read_text(), 0), done.stderr
