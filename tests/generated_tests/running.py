"""Run generated tests as users do: pytest in a process of its own, on one transport."""

from __future__ import annotations

import importlib.util
import os
import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path
from xml.etree import ElementTree

import pytest

_MISSING = [name for name in ("rclpy", "ifgen_native") if importlib.util.find_spec(name) is None]
needs_rclpy = pytest.mark.skipif(
    bool(_MISSING), reason=f"not installed: {', '.join(_MISSING)} (Linux x86_64 only)"
)
on_both = pytest.mark.parametrize("transport", ["local", pytest.param("rclpy", marks=needs_rclpy)])
on_real_rclpy_slowly = pytest.mark.parametrize(
    "transport", ["local", pytest.param("rclpy", marks=(needs_rclpy, pytest.mark.slow))]
)


def run(
    folder: Path, *arguments: str, path: Sequence[Path] = (), limit: float = 200.0
) -> tuple[dict[str, set[str]], str]:
    """Run the tests in `folder`/generated; returns those that failed, by package, and what pytest printed.

    `limit` is in seconds; if it is exceeded, the output tells which test was running.
    """
    report = folder / "report.xml"
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(map(str, path))}
    # On the local transport they run on virtual clocks, in domains that they do not keep: nobody may meet them there.
    del environment["ROS_AUTOMATIC_DISCOVERY_RANGE"]
    command = [
        sys.executable,
        "-P",
        "-m",
        "pytest",
        "-q",
        "-p",
        "no:cacheprovider",
        "-p",
        "no:xdist",
        "-p",
        "no:anyio",
    ]
    command += ["-W", "ignore:module 'sre_:DeprecationWarning"]  # the lark-parser of ROS's wheels is old
    command += ["-o", f"faulthandler_timeout={limit / 2:g}"]
    command += [f"--junitxml={report}", "--rootdir=.", "--tb=short", "--import-mode=importlib"]
    with subprocess.Popen(
        [*command, *arguments, "generated"],
        cwd=folder,
        env=environment,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    ) as tests:
        try:
            output, errors = tests.communicate(timeout=limit)
        except subprocess.TimeoutExpired:
            tests.kill()
            output, errors = tests.communicate()
    assert tests.returncode in {0, 1}, output[-3000:] + errors[-3000:]
    failed: dict[str, set[str]] = {}
    for case in ElementTree.parse(report).iter("testcase"):
        package = case.attrib["classname"].split(".")[1]
        bad = case.find("failure") is not None or case.find("error") is not None
        failed.setdefault(package, set()).update({case.attrib["name"]} if bad else ())
    return failed, output
