"""Types that nobody generated, between nodes, on the local transport and on real rclpy."""

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
    expect(name, transport, f"{name}.txt")


@pytest.mark.parametrize("transport", TRANSPORTS)
def test_what_nodes_say_about_services_and_actions(transport: str) -> None:
    expect("calls", transport, f"calls_on_{transport}.txt")


def expect(name: str, transport: str, output: str) -> None:
    command = [sys.executable, "-m", "ifgen", "run", "--transport", transport, str(HERE / f"{name}.py")]

    def run() -> subprocess.CompletedProcess[str]:
        return subprocess.run(command, capture_output=True, text=True, timeout=120, check=False)

    done = again_if_crashed(transport, run, lambda ended: ended.returncode)
    assert (done.stdout, done.returncode) == ((HERE / output).read_text(), 0), done.stderr
