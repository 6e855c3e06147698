"""Two processes whose definitions differ in one edit: it is explained in time, and no garbage gets through.

`tests/rclpy/inside/test_pairs.py` does the same within a process.
"""

from __future__ import annotations

import json
import os
import random
import subprocess
import sys
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path

import ifgen as toolkit
import pytest

from tests.evolution.corpus import Edit, edits, messages
from tests.native.support import needs_rclpy

ROOT = Path(__file__).resolve().parents[3]
PROGRAM = Path(__file__).with_name("pairs.py")

UNSEEN = {None, "default-value", "constant-removed", "constant-renamed", "constant-value", "enum-members"}
"""Rules whose edits change no hash."""

POLICIES = ("refuse", "adapt")


def corpus(size: int) -> list[Edit]:
    """Edits that change the hash, as many of each rule, and some that do not."""
    chance = random.Random(14)
    every = [e for m in messages(toolkit.load(ROOT / "interfaces")) for e in edits(m, chance) if e.after]
    of_rules: dict[str | None, list[Edit]] = {}
    for edit in every:
        of_rules.setdefault(edit.rule, []).append(edit)
    chance = random.Random(15)
    return [edit for found in of_rules.values() for edit in chance.sample(found, size)]


@pytest.mark.slow
@pytest.mark.parametrize("policy", POLICIES)
def test_between_processes_on_the_local_transport(policy: str, tmp_path: Path) -> None:
    pytest.importorskip("zenoh")
    meet(corpus(4), policy, "local", tmp_path)


@needs_rclpy
@pytest.mark.slow
@pytest.mark.parametrize("policy", POLICIES)
def test_between_processes_on_real_rclpy(policy: str, tmp_path: Path) -> None:
    meet(corpus(4), policy, "rclpy", tmp_path)


def meet(pairs: Sequence[Edit], policy: str, transport: str, folder: Path) -> None:
    """Let each pair meet, and judge what was said and received."""
    file = folder / "corpus.json"
    file.write_text(json.dumps([versions(number, edit) for number, edit in enumerate(pairs)]))
    with running(file, policy, transport) as programs:
        delays = [judged(programs, number, edit, policy) for number, edit in enumerate(pairs)]
    found = sorted(delay for delay in delays if delay is not None)
    print(f"{policy}, {transport}: {len(found)} explained after {found[0]:.2f} to {found[-1]:.2f} s")
    assert found[-1] < 10, "within a second, where the machine has time"


def versions(number: int, edit: Edit) -> dict[str, object]:
    """The texts of both versions; every other one is of a type that another type holds."""
    before, after = ("".join(map(str, lines)) for lines in (edit.before, edit.after))
    is_nested = bool(number % 2)
    return {
        "name": f"E{number}",
        "before": before,
        "after": after,
        "same": edit.rule in UNSEEN,
        "nested": is_nested,
    }


def judged(programs: Sequence[subprocess.Popen[str]], number: int, edit: Edit, policy: str) -> float | None:
    """The time that one pair took until it was explained; None if there was nothing to explain."""
    for program in programs:
        assert program.stdin is not None
        program.stdin.write(f"{number}\n")
        program.stdin.flush()
    assert programs[0].stdout is not None
    line = programs[0].stdout.readline()
    assert line, "the program has ended: see the files beside the corpus"
    seen = json.loads(line)
    for program in programs[1:]:
        assert program.stdin is not None
        program.stdin.write("\n")
        program.stdin.flush()
    assert seen["garbage"] == [], edit
    if edit.rule in UNSEEN:
        assert seen["texts"] == [], edit
        assert seen["received"], edit
        return None
    assert len(seen["texts"]) == 1, (edit, seen)
    assert bool(seen["received"]) == (policy == "adapt"), edit
    text = seen["texts"][0]
    assert f"[{edit.rule}]" in text, (edit, text)
    changed = {line.name for line in set(edit.before) ^ set(edit.after)}  # none if two have changed places
    assert not changed or any(name in text for name in changed), (edit, text)
    return float(seen["delays"][0])


@contextmanager
def running(file: Path, policy: str, transport: str) -> Iterator[list[subprocess.Popen[str]]]:
    """The program that listens and the one that publishes, which end when their input does."""
    environment = os.environ | {"IFGEN_ON_TYPE_MISMATCH": policy}
    command = [sys.executable, "-m", "ifgen", "run", "--transport", transport, str(PROGRAM)]
    programs: list[subprocess.Popen[str]] = []
    try:
        for role in ("new", "old"):
            with file.with_name(f"{role}.txt").open("w") as errors:
                programs.append(
                    subprocess.Popen(
                        [*command, role, str(file)],
                        stdin=subprocess.PIPE,
                        stdout=subprocess.PIPE,
                        stderr=errors,
                        text=True,
                        env=environment,
                    )
                )
        yield programs
        for program in programs:
            program.communicate(timeout=30)
            assert program.returncode == 0
    finally:
        for program in programs:
            program.kill()
            program.wait()
