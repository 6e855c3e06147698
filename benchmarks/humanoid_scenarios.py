"""The humanoid's scenarios: every one with six seeds, by the command that users type.

python benchmarks/humanoid_scenarios.py [--quick]     two seeds instead of six

`ifgen demo --headless --scenario NAME --seed N`: all nodes in one process, in lockstep, with noisy sensors
and the head camera. A run counts as done if its exit code is 0.
"""

from __future__ import annotations

from _demo import play, span
from _table import is_quick

SCENARIOS = ("walk", "dance", "push", "stop", "all", "obstacles", "people")
SEEDS = (0, 1, 2, 3, 7, 42)
MEASURED = {
    "foot error, rms [mm]": "foot error",
    "goal error [mm]": "goal error",
    "to stand after a cancel [s]": "stop after cancel",
    "times real time": "real-time factor",
}
"""Columns, and the rows of the summary that they show."""


def main() -> None:
    """Measure and print."""
    seeds = SEEDS[:2] if is_quick(__doc__) else SEEDS
    print(f"Seeds {', '.join(map(str, seeds))}.\n")
    print(f"| scenario | done | falls | {' | '.join(MEASURED)} |\n|---{'|---:' * (2 + len(MEASURED))}|")
    done = falls = count = 0
    for scenario in SCENARIOS:
        runs = [play("--scenario", scenario, "--seed", str(seed)) for seed in seeds]
        well, fell = sum(run.code == 0 for run in runs), sum(int(run.number("falls") or 0) for run in runs)
        done, falls, count = done + well, falls + fell, count + len(runs)
        spans = (span(runs, row) for row in MEASURED.values())
        print(f"| {scenario} | {well} of {len(runs)} | {fell} | {' | '.join(spans)} |", flush=True)
    print(f"| **all of them** | {done} of {count} | {falls} | | | | |")


if __name__ == "__main__":
    main()
