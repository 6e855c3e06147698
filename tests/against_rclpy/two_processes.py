"""Runs scenarios with roles on both transports, each role in a process of its own, and compares what they say.

On the local transport they run in one process, too: what works there must work in two.
"""

from __future__ import annotations

import difflib
import os
import re
import socket
import subprocess
import sys
import tempfile
import threading
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

from ifgen_pytest.domains import own_domain

from tests.against_rclpy import stage
from tests.against_rclpy.harness import HERE, UNDERLAY, Outcome

ACROSS = HERE / "across"
TIME_LIMIT = 90.0  # [s] for one run

IS_POSSIBLE = hasattr(os, "getuid")
"""Whether programs on this system find each other."""

_ROLE = re.compile(r'^    "(\w+)": \w+,', re.MULTILINE)  # of the dict at the end of a scenario
_PLAY = "import stage; stage.main()"


def in_one(scenario: Path) -> Outcome:
    """Run all roles in one process, on the local transport."""
    with own_domain() as domain:
        environment = _environment(domain, ours=True) | {"ROS_AUTOMATIC_DISCOVERY_RANGE": "OFF"}
        return _ended(_started(environment, "ours", str(scenario)))


def in_two(scenario: Path, *, ours: bool) -> Outcome:
    """Run each role in a process of its own."""
    with own_domain() as domain, ThreadPoolExecutor() as pool:
        environment = _environment(domain, ours=ours)
        ends: list[socket.socket] = []
        running: list[subprocess.Popen[str]] = []
        for role in roles_of(scenario):
            here, there = socket.socketpair()
            with there:
                number = there.fileno()
                words = ("ours" if ours else "real", str(scenario), f"{role}={number}")
                running.append(_started(environment, *words, descriptor=number))
            ends.append(here)
        chair = threading.Thread(target=stage.preside, args=(ends,))
        chair.start()
        outcomes = list(pool.map(_ended, running))
        chair.join()
        for end in ends:
            end.close()
    codes = [each.exit_code for each in outcomes]
    return Outcome(
        "".join(each.transcript for each in outcomes),
        "".join(each.errors for each in outcomes),
        None if None in codes else max(codes, key=lambda code: abs(code or 0)),
    )


def roles_of(scenario: Path) -> list[str]:
    """The names of a scenario's roles, in order; the scenario needs an rclpy, so it is only read."""
    roles = _ROLE.findall(scenario.read_text(encoding="utf-8"))
    assert len(roles) > 1, f"{scenario.name} has no ROLES"
    return roles


def difference(first: Outcome, second: Outcome, names: tuple[str, str]) -> str | None:
    """None if two runs ended well and said the same, otherwise a report."""
    if first.exit_code == second.exit_code == 0 and first.transcript == second.transcript:
        return None if first.transcript else "nothing was said"
    lines = difflib.unified_diff(
        first.transcript.splitlines(), second.transcript.splitlines(), *names, lineterm="", n=4
    )
    return "\n".join(
        [
            f"exit codes {first.exit_code}, {second.exit_code}",
            *lines,
            *(
                f"--- stderr, {name}\n{run.errors[-4000:]}"
                for name, run in zip(names, (first, second), strict=True)
            ),
        ]
    )


def against_real(scenario: Path) -> str | None:
    """Compare two processes on the local transport with two on real rclpy."""
    ours = in_two(scenario, ours=True)
    real = in_two(scenario, ours=False)
    return difference(real, ours, ("real rclpy", "local transport"))


def against_one(scenario: Path) -> str | None:
    """Compare two processes on the local transport with one."""
    return difference(in_one(scenario), in_two(scenario, ours=True), ("one process", "two processes"))


def _environment(domain: int, *, ours: bool) -> dict[str, str]:
    return {
        **os.environ,
        "ROS_DOMAIN_ID": str(domain),
        "ROS_AUTOMATIC_DISCOVERY_RANGE": "LOCALHOST",
        "ROS_LOG_DIR": str(Path(tempfile.gettempdir()) / "ifgen_test_logs"),
        "PYTHONPATH": os.pathsep.join(map(str, (*(UNDERLAY if ours else ()), HERE))),
    }


def _started(
    environment: dict[str, str], *words: str, descriptor: int | None = None
) -> subprocess.Popen[str]:
    return subprocess.Popen(
        [sys.executable, "-c", _PLAY, *words],
        env=environment,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        pass_fds=() if descriptor is None else (descriptor,),
    )


def _ended(process: subprocess.Popen[str]) -> Outcome:
    try:
        output, errors = process.communicate(timeout=TIME_LIMIT)
    except subprocess.TimeoutExpired:
        process.kill()
        output, errors = process.communicate()
        return Outcome(output, errors, None)
    return Outcome(output, errors, process.returncode)


def main() -> None:
    """`python -m tests.against_rclpy.two_processes [NAME...]`: compare, and print what differs."""
    failed = False
    for scenario in sorted(ACROSS.glob("*.py")):
        if sys.argv[1:] and not any(name in scenario.stem for name in sys.argv[1:]):
            continue
        for compare in (against_one, against_real):
            report = compare(scenario)
            print(f"{scenario.stem}, {compare.__name__}: {report or 'equal'}", flush=True)
            failed |= report is not None
    sys.exit(failed)


if __name__ == "__main__":
    main()
