"""Runs also take turns if folders cannot be locked: on Windows, on network drives, without any lock at all."""

from __future__ import annotations

import os
import shutil
import stat
import sys
import threading
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from types import SimpleNamespace

import pytest
from ifgen.writing import transaction, write
from ifgen.writing.write import OutputPackage

fcntl = pytest.importorskip("fcntl", reason="the locks of another system are made of this one's")

Fake = Callable[[pytest.MonkeyPatch], None]

real_flock = fcntl.flock


def on_windows(patched: pytest.MonkeyPatch) -> None:
    """No fcntl, and an msvcrt whose locks are made from those of this system."""

    def locking_(descriptor: int, mode: int, count: int) -> None:
        assert count == 1
        if mode == 2:
            real_flock(descriptor, fcntl.LOCK_UN)
            return
        assert mode == 1
        try:
            real_flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            raise PermissionError(13, "Permission denied") from None

    patched.setitem(sys.modules, "fcntl", None)
    patched.setitem(sys.modules, "msvcrt", SimpleNamespace(locking=locking_, LK_NBLCK=1, LK_UNLCK=2))


def on_a_network_drive(patched: pytest.MonkeyPatch) -> None:
    """Folders on the drive cannot be locked; the user's cache can."""

    def flock(descriptor: int, operation: int) -> None:
        if stat.S_ISDIR(os.fstat(descriptor).st_mode):
            raise OSError(95, "Operation not supported")
        real_flock(descriptor, operation)

    patched.setattr(fcntl, "flock", flock)


def nowhere(patched: pytest.MonkeyPatch) -> None:
    """A system without locks."""
    patched.setitem(sys.modules, "fcntl", None)
    patched.setitem(sys.modules, "msvcrt", None)


@pytest.mark.parametrize("system", [on_windows, on_a_network_drive])
def test_runs_take_turns(system: Fake, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    system(monkeypatch)
    out = tmp_path / "out"
    out.mkdir()
    order: list[str] = []
    inside = threading.Event()

    def second() -> None:
        inside.wait()
        with transaction.exclusive(out / ".." / "out") as alone:
            order.append(f"second {alone}")

    thread = threading.Thread(target=second)
    thread.start()
    with transaction.exclusive(out) as alone:
        inside.set()
        thread.join(0.1)
        order.append(f"first {alone}")
    thread.join(10)
    assert order == ["first False", "second False"]
    assert list(out.iterdir()) == [], "nothing is left in a folder that is committed"
    assert not transaction.is_free(out)


def test_a_run_that_fails_does_not_take_the_folder_from_one_that_waits(tmp_path: Path) -> None:
    """The first run makes the folder, and removes it again because nothing came."""
    out = tmp_path / "deep" / "out"
    for _ in range(10):
        waits = threading.Event()
        written: list[Path] = []

        def second() -> None:
            waits.set()  # noqa: B023 - the thread ends before the next turn
            with transaction.locked(out):
                written.extend(write.write([OutputPackage("a_msgs", {"a.py": "a"})], out, "test").written)  # noqa: B023

        thread = threading.Thread(target=second)
        with suppress(KeyboardInterrupt), transaction.locked(out):
            thread.start()
            waits.wait(10)
            thread.join(0.02)
            raise KeyboardInterrupt
        thread.join(10)
        assert [path.name for path in written] == ["a.py"]
        assert (out / "a_msgs/a.py").read_text() == "a"
        shutil.rmtree(tmp_path / "deep")


@pytest.mark.parametrize("system", [on_windows, on_a_network_drive, nowhere])
def test_a_run_leaves_the_stage_of_another_alone(
    system: Fake, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """As if the other one ran on another machine."""
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    system(monkeypatch)
    stage = tmp_path / "out" / ".ifgen-tmp-live"
    stage.mkdir(parents=True)
    (stage / "new0").write_text("not moved yet")
    with transaction.locked(tmp_path / "out"):
        write.write([OutputPackage("demo_msgs", {"a.py": "a"})], tmp_path / "out", "test")
    assert (stage / "new0").read_text() == "not moved yet"
    assert (tmp_path / "out/demo_msgs/a.py").read_text() == "a"


def test_no_lock_and_no_place_for_one_stops_nobody(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "cache").write_text("a file where the folder should be")
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    for system in (nowhere, on_windows):
        with monkeypatch.context() as patched:
            system(patched)
            with transaction.exclusive(tmp_path) as alone:
                assert not alone
