"""Runs each file of `inside/` with pytest in a process whose rclpy is ours.

Our rclpy and the real one can never share a process, and this one may have the real one.
"""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

HERE = Path(__file__).parent
ROOT = HERE.parent.parent
UNDERLAY = (ROOT / "codegen" / "underlay", ROOT / "generated", ROOT / "codegen")
TIME_LIMIT = 110  # [s] for one file


FILES = sorted((HERE / "inside").glob("test_*.py"))
# Both codecs, where bytes of other definitions are read.
RUNS = [(file, "") for file in FILES]
RUNS += [(file, "python") for file in FILES if file.stem in {"test_mismatch", "test_mismatch_services"}]


@pytest.mark.parametrize(("file", "codec"), RUNS, ids=[f"{file.stem}{codec}" for file, codec in RUNS])
def test_file(file: Path, codec: str, tmp_path: Path) -> None:
    """Every test in the file passes."""
    environment = {
        **os.environ,
        "IFGEN_CODEC": codec,
        "PYTHONPATH": os.pathsep.join(map(str, UNDERLAY)),
        "IFGEN_INSIDE_UNDERLAY": "1",
    }
    for name in [name for name in environment if name.startswith(("PYTEST_", "ROS_", "RCUTILS_"))]:
        del environment[name]
    environment["ROS_AUTOMATIC_DISCOVERY_RANGE"] = "OFF"
    environment["ROS_LOG_DIR"] = str(tmp_path)  # not among the user's
    command = [sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider", "--timeout=60", str(file)]
    run = subprocess.run(
        command, cwd=ROOT, env=environment, capture_output=True, text=True, timeout=TIME_LIMIT, check=False
    )
    assert run.returncode == 0, f"{run.stdout[-8000:]}\n{run.stderr[-4000:]}"
