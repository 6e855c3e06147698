"""Images between processes through shared memory: what is left of it, and what a slow or dead reader costs."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path

import pytest

from tests.running.terminals import Machine, Terminal

pytest.importorskip("zenoh")
if sys.platform != "linux":
    pytest.skip("files in memory are Linux's", allow_module_level=True)

CAMERA = str(Path(__file__).parent / "peers/camera.py")
FOLDER = Path(f"/dev/shm/ifgen-{os.getuid()}")
LARGE = "400000"  # bytes


def watch(machine: Machine, pause: str = "0", depth: str = "100", before: Sequence[str] = ()) -> Terminal:
    watcher = machine.run("watch", pause, depth, program=CAMERA, before=before)
    watcher.until("ready")
    return watcher


def show(
    machine: Machine,
    period: str,
    count: int,
    size: str = LARGE,
    before: Sequence[str] = (),
    watchers: int = 1,
) -> Terminal:
    return machine.run("show", size, period, str(count), str(watchers), program=CAMERA, before=before)


def file_of(terminal: Terminal) -> Path:
    """The file that a process shares with others: that which it has locked."""
    here = Path(f"/proc/{terminal.process.pid}")
    locked = {
        (here / "fd" / each.name).readlink()
        for each in (here / "fdinfo").iterdir()
        if "FLOCK" in each.read_text()
    }
    (found,) = (path for path in locked if path.is_relative_to(FOLDER))
    return found


def until(condition: Callable[[], bool]) -> None:
    end = time.monotonic() + 10.0
    while not condition():
        assert time.monotonic() < end, "it did not happen in time"
        time.sleep(0.01)


def test_all_arrives_whole_and_nothing_is_left(machine: Machine) -> None:
    watcher = watch(machine)
    camera = show(machine, "0.005", 60)
    camera.until("shown")
    assert watcher.until("number 59").startswith("number 59 got 60")
    files = [file_of(each) for each in (camera, watcher)]
    assert files[0].stat().st_size >= int(LARGE)
    assert files[1].stat().st_size == 0, "who lends nothing needs no memory"
    assert (camera.end(), watcher.end()) == (0, 0)
    assert not any(file.exists() for file in files)
    assert not any(line.startswith(("broken", "not", "rmw_local")) for line in watcher.lines + camera.lines)


@pytest.mark.parametrize("killed", ["camera", "watcher"])
def test_the_other_one_removes_what_a_killed_process_leaves(machine: Machine, killed: str) -> None:
    watcher = watch(machine)
    camera = show(machine, "0.02", 100_000)
    watcher.until("number 3")
    victim, survivor = (camera, watcher) if killed == "camera" else (watcher, camera)
    file = file_of(victim)
    victim.process.kill()
    until(lambda: not file.exists())
    if killed == "camera":  # neither does anybody keep its memory
        maps = Path(f"/proc/{survivor.process.pid}/maps")
        until(lambda: str(file) not in maps.read_text())
        watcher.so_far()
        camera = show(machine, "0.02", 100_000)
    else:
        watcher = watch(machine)
    watcher.until("number")


@pytest.mark.slow
def test_the_next_one_removes_what_the_last_one_left(machine: Machine) -> None:
    watcher, camera = watch(machine), show(machine, "0.02", 100_000)
    watcher.until("number 3")
    files = [file_of(each) for each in (watcher, camera)]
    for each in (watcher, camera):
        each.process.send_signal(signal.SIGSTOP)
    for each in (watcher, camera):
        each.process.kill()
        each.process.wait()
    assert all(file.exists() for file in files)
    watcher, camera = watch(machine), show(machine, "0.02", 100_000)
    watcher.until("number 3")
    assert not any(file.exists() for file in files)


def test_a_stopped_reader_holds_nobody_up_and_goes_on(machine: Machine) -> None:
    watcher, other = watch(machine), watch(machine)
    camera = show(machine, "0.01", 40, watchers=2)
    watcher.until("number")
    watcher.process.send_signal(signal.SIGSTOP)
    assert other.until("number 39").startswith("number 39 got 40")
    watcher.process.send_signal(signal.SIGCONT)
    watcher.until("number 39")
    assert camera.end() == 0


@pytest.mark.parametrize(("size", "count"), [(LARGE, 400), ("40", 10_000)], ids=["large", "small"])
def test_a_camera_that_is_too_fast_costs_no_memory(machine: Machine, size: str, count: int) -> None:
    """The watcher skips what its history has no room for; nobody keeps the rest."""
    watcher = watch(machine, "0.005", "3")
    camera = show(machine, "0", count, size)
    before = resident(watcher.until("number"))
    shown = camera.until("shown")
    later = show(machine, "0.02", 3, "44")
    assert camera.end() == 0
    later.until("shown")
    last = watcher.until("number 2 ")
    assert int(last.split()[3]) < count
    assert resident(last) - before < 30, "of the 160 MB, or of the messages"
    assert int(shown.split()[-1]) < 80, "no more than may be shared, and a little"
    assert not any(line.startswith("broken") for line in watcher.lines)


def resident(line: str) -> int:
    """Memory [MB], as a watcher says it."""
    return int(line.rpartition(" ")[2])


@pytest.fixture
def crowded() -> Iterator[tuple[str, ...]]:
    """What a command begins with that runs where there is 1 MB of shared memory."""
    hold = ("unshare", "--user", "--map-root-user", "--mount", "sh", "-c")
    script = "mount -t tmpfs -o size=1m none /dev/shm && echo ready && exec sleep 300"
    try:
        holder = subprocess.Popen([*hold, script], stdout=subprocess.PIPE, text=True)
    except FileNotFoundError as error:
        pytest.skip(f"no namespaces: {error}")
    with holder:
        assert holder.stdout is not None
        if holder.stdout.readline() != "ready\n":
            pytest.skip("no file systems of one's own")
        yield ("nsenter", "--target", str(holder.pid), "--user", "--mount", "--preserve-credentials")
        holder.kill()


def test_little_shared_memory_costs_one_line(machine: Machine, crowded: tuple[str, ...]) -> None:
    watcher = watch(machine, before=crowded)
    camera = show(machine, "0.05", 40, "2000000", before=crowded)
    line = camera.until("rmw_local")
    assert line.endswith(
        "/dev/shm is full: large messages to other processes go over sockets, which is slower"
    )
    for _ in range(3):  # sockets that are busy drop some
        watcher.until("number")
    assert not any(line.startswith(("broken", "rmw_local")) for line in watcher.lines)
    assert camera.end() == 0
    assert sum(line.startswith("rmw_local") for line in camera.lines) == 1


@pytest.mark.slow
def test_who_has_other_shared_memory_gets_all_the_same(machine: Machine, crowded: tuple[str, ...]) -> None:
    watcher = watch(machine, before=crowded)
    camera = show(machine, "0.05", 20)
    assert watcher.until("number 19").startswith("number 19 got 20")
    assert file_of(camera).stat().st_size == 0
