"""Recorders that are killed, disks that are full, and recordings that are larger than memory should be."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
from pathlib import Path

import pytest
from ifgen_runtime.bag import Bag, BagWarning

GENERATED = Path(__file__).resolve().parents[2] / "generated"

HEAD = """
import sys, resource, signal
sys.path.insert(0, sys.argv[1])
from ifgen_runtime.bag import Bag, BagError, Recorder
from std_msgs.msg import String
"""
UNTIL_KILLED = (
    HEAD
    + """
with Recorder(sys.argv[2], chunk_size=2000) as recorder:
    for index in range(10**9):
        recorder.write("/log", String(data=f"message {index:09}"), received=index)
        if index % 100 == 99:
            print(index, flush=True)
"""
)
UNTIL_FULL = (
    HEAD
    + """
resource.setrlimit(resource.RLIMIT_FSIZE, (50_000, 50_000))
try:
    with Recorder(sys.argv[2], chunk_size=4000, compression="none") as recorder:
        for index in range(10**6):
            recorder.write("/log", String(data=f"message {index:09}"), received=index)
except BagError as error:
    print(error)
print(index)
"""
)
A_MILLION = (
    HEAD
    + """
def record(count):
    with Recorder(sys.argv[2], overwrite=True) as recorder:
        for index in range(count):
            recorder.write("/log", String(data=f"message {index:09}"), received=index)
    with Bag(sys.argv[2], strict=True) as bag:
        assert sum(1 for message in bag["/log"]) == sum(1 for recorded in bag) == len(bag) == count

record(100_000)
before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
record(1_000_000)
print(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before)
"""
)


def command(program: str, path: Path) -> list[str]:
    return [sys.executable, "-c", program, str(GENERATED), str(path)]


@pytest.mark.parametrize("name", ["run.mcap", "run"])
def test_a_recorder_that_is_killed_loses_the_last_chunk_at_most(tmp_path: Path, name: str) -> None:
    path = tmp_path / name
    with subprocess.Popen(
        command(UNTIL_KILLED, path), stdout=subprocess.PIPE, text=True, env={**os.environ}
    ) as process:
        assert process.stdout is not None
        while int(process.stdout.readline()) < 999:
            pass
        process.kill()
        written = [int(line) for line in process.stdout.readlines() if line.endswith("\n")]
    assert process.returncode == -signal.SIGKILL
    last = max(written, default=999)
    with pytest.warns(
        BagWarning, match="has no summary: it is cut off, or the recorder was killed|beyond the end"
    ):
        bag = Bag(path)
    with bag:
        found = [message.data for message in bag["/log"]]
    assert found == [f"message {index:09}" for index in range(len(found))]
    assert len(found) > last - 2000 // 40, "a message takes more than 40 bytes of a chunk"


def test_a_full_disk(tmp_path: Path) -> None:
    path = tmp_path / "run.mcap"
    done = subprocess.run(
        command(UNTIL_FULL, path), capture_output=True, text=True, timeout=60, check=False, env={**os.environ}
    )
    assert (done.stderr, done.returncode) == ("", 0)
    error, last = done.stdout.splitlines()
    assert error.startswith(f"{path}: cannot be written any further: File too large. It has ")
    with Bag(path, strict=True) as bag:  # there was room for the summary
        found = [message.data for message in bag["/log"]]
        assert f"It has {len(bag):,} messages" in error
    assert found == [f"message {index:09}" for index in range(len(found))]
    assert int(last) - 100 < len(found) <= int(last)


@pytest.mark.slow
def test_a_million_messages_take_no_more_memory(tmp_path: Path) -> None:
    program = command(A_MILLION, tmp_path / "run.mcap")
    done = subprocess.run(
        program, capture_output=True, text=True, timeout=280, check=False, env={**os.environ}
    )
    assert (done.stderr, done.returncode) == ("", 0)
    assert int(done.stdout) < 4000  # [kB]
