"""Runs one program under the real rclpy and under ours, in two processes, and compares what it prints.

A scenario is a file in `scenarios/` with a `main()`. It prints its transcript to stdout; stderr is only shown
when something is wrong. It may import `transcript` (in this folder) and the public API.
"""

from __future__ import annotations

import difflib
import importlib.util
import os
import subprocess
import sys
import tempfile
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path

HERE = Path(__file__).parent
ROOT = HERE.parent.parent
SCENARIOS = HERE / "scenarios"
TIME_LIMIT = 90.0  # [s] for one run; a hang is a failure, not a hung suite

# Ours must win over an installed rclpy, so these come first on the path.
UNDERLAY = (ROOT / "codegen" / "underlay", ROOT / "generated", ROOT / "codegen")

# argv: is it ours that must be imported, the scenario, the scenario's own arguments
_RUN_MAIN = f"""
import importlib.util, runpy, sys
ours, path = sys.argv.pop(1) == "ours", sys.argv.pop(1)
found = importlib.util.find_spec("rclpy").origin
assert found.startswith({str(UNDERLAY[0])!r}) == ours, f"the wrong rclpy would be tested: {{found}}"
sys.argv[0] = path
runpy.run_path(path)["main"]()
"""


@dataclass(frozen=True)
class Outcome:
    """The output of one run, and how it ended."""

    transcript: str
    errors: str
    exit_code: int | None  # None: stopped at the time limit


def real_rclpy_missing() -> str | None:
    """The reason why the comparison cannot run here, or None if this interpreter has the real rclpy."""
    if importlib.util.find_spec("rclpy") is None:
        return "the real rclpy is not installed (`make test` installs it, Linux x86_64 only)"
    return None


def run(
    scenario: Path, *, ours: bool, arguments: tuple[str, ...] = (), before: Path | None = None
) -> Outcome:
    """Run a scenario's `main()` in a fresh interpreter, on our rclpy or on the real one.

    Packages in the folder `before` come before the installed ones; they may need those of codegen/.
    """
    first = UNDERLAY if ours else (before, ROOT / "codegen") if before else ()
    environment = {
        **os.environ,
        "ROS_LOG_DIR": str(Path(tempfile.gettempdir()) / "ifgen_test_logs"),  # not among the user's
        "PYTHONPATH": os.pathsep.join(map(str, (*first, HERE))),
    }
    command = [sys.executable, "-c", _RUN_MAIN, "ours" if ours else "real", str(scenario), *arguments]
    try:
        ended = subprocess.run(
            command, env=environment, capture_output=True, text=True, timeout=TIME_LIMIT, check=False
        )
    except subprocess.TimeoutExpired as expired:
        return Outcome(_text(expired.stdout), _text(expired.stderr), None)
    return Outcome(ended.stdout, ended.stderr, ended.returncode)


def compare(scenario: Path) -> str | None:
    """Run a scenario on both; None if the transcripts are equal, otherwise a report with the difference."""
    with ThreadPoolExecutor(2) as pool:
        real_run = pool.submit(run, scenario, ours=False)
        ours_run = pool.submit(run, scenario, ours=True)
        real, ours = real_run.result(), ours_run.result()
    if real.exit_code is None or real.exit_code < 0:
        # On a busy machine the real one sometimes hangs or crashes in its own C++.
        real = run(scenario, ours=False)
    if real.exit_code == ours.exit_code == 0 and real.transcript == ours.transcript:
        return None if real.transcript else f"{scenario.name} printed nothing"
    difference = difflib.unified_diff(
        real.transcript.splitlines(),
        ours.transcript.splitlines(),
        "real rclpy",
        "our rclpy",
        lineterm="",
        n=4,
    )
    return "\n".join(
        [
            f"{scenario.name}: exit code real {real.exit_code}, ours {ours.exit_code}",
            *difference,
            "--- stderr of the real one (tail)",
            real.errors[-1500:],
            "--- stderr of ours (tail)",
            ours.errors[-4000:],
        ]
    )


def _text(output: bytes | str | None) -> str:
    """Decode the output of a stopped process, which subprocess returns as bytes."""
    return output.decode(errors="replace") if isinstance(output, bytes) else output or ""


def main() -> None:
    """`python harness.py SCENARIO...`: compare these files (or name parts) and print the reports."""
    failed = False
    os.environ |= {"ROS_DOMAIN_ID": str(1 + os.getpid() % 101), "ROS_AUTOMATIC_DISCOVERY_RANGE": "LOCALHOST"}
    for pattern in sys.argv[1:] or [""]:
        for scenario in sorted(SCENARIOS.glob("*.py")):
            if pattern.removesuffix(".py") not in scenario.stem:
                continue
            report = compare(scenario)
            print(report or f"{scenario.name}: equal")
            failed |= report is not None
    sys.exit(failed)


if __name__ == "__main__":
    main()
