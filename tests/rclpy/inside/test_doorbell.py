"""The folder where processes find each other, whatever is in it, and whatever comes to the sockets there."""

from __future__ import annotations

import os
import socket
import subprocess
import sys
import tempfile
import threading
import time
from collections.abc import Iterator
from pathlib import Path

import pytest
from ifgen_runtime.domains import neighbours
from rmw_local.transports import TransportError, doorbell
from rmw_local.transports.doorbell import Doorbell

if not doorbell.IS_POSSIBLE:
    pytest.skip("this system has no sockets with names in a folder", allow_module_level=True)

_LONGEST_SOCKET = 107  # bytes of a name on Linux; 103 on macOS
UNDERLAY = str(Path(doorbell.__file__).parents[2])


@pytest.fixture
def base(monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    """The folder of this user, which does not exist yet."""
    with tempfile.TemporaryDirectory(dir="/tmp") as folder:  # sockets have short names
        monkeypatch.setattr(doorbell, "_TEMPORARY", Path(folder))
        yield Path(folder) / f"ifgen-{os.getuid()}"


def rings(bell: Doorbell) -> tuple[threading.Thread, list[int]]:
    """A thread that listens, and a number for each time that it was rung."""
    heard: list[int] = []
    thread = threading.Thread(target=bell.listen, args=(lambda: heard.append(1),))
    thread.start()
    return thread, heard


def socket_of(folder: Path) -> Path:
    (bell,) = folder.glob("7/*.bell")
    return bell


def test_processes_hear_each_other_and_leave_nothing(base: Path) -> None:
    one = Doorbell(7)
    assert not one.ring()
    thread, heard = rings(one)
    other = Doorbell(7)
    assert other.ring()
    assert other.others() == [one.endpoint]
    while not heard:
        assert thread.is_alive()
    other.close()
    one.close()
    thread.join(10)
    assert not thread.is_alive()
    assert not Doorbell(8).ring()
    assert list((base / "7").iterdir()) == []
    assert base.stat().st_mode & 0o777 == 0o700


def test_who_counts_nodes_is_answered_for_each_domain(base: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(neighbours, "FOLDER", base.parent)
    assert neighbours.on_local() == {}
    bells = {Doorbell(7): 2, Doorbell(7): 0, Doorbell(8): 1}
    threads = [
        threading.Thread(target=b.listen, args=(lambda: None, lambda n=n: n)) for b, n in bells.items()
    ]
    for thread in threads:
        thread.start()
    (base / "7" / "1-0.bell").touch()  # no socket
    found = {domain: (nodes.number, nodes.is_least) for domain, nodes in neighbours.on_local().items()}
    assert found == {7: (2, False), 8: (1, False)}
    assert list(neighbours.on_local(8)) == [8]
    assert not list(base.glob("*.asks"))
    for bell in bells:
        bell.close()
    for thread in threads:
        thread.join(10)


def test_stray_datagrams_end_nothing(base: Path) -> None:
    bell = Doorbell(7)
    thread, rung = rings(bell)
    with socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM) as stray:  # without a name of its own
        for data in (b"", b"n", b"r", b"\0", b"nn", bytes(200)):
            stray.sendto(data, str(next((base / "7").glob("*.bell"))))
    before = len(rung)
    assert Doorbell(7).ring() == 1
    deadline = time.monotonic() + 10
    while len(rung) == before and time.monotonic() < deadline:
        time.sleep(0.01)
    assert len(rung) > before, "it still hears who comes"
    bell.close()
    thread.join(10)
    assert not thread.is_alive()


def test_whoever_is_too_busy_to_answer_counts_as_one_node_at_least(
    base: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(neighbours, "FOLDER", base.parent)
    monkeypatch.setattr(neighbours, "LIMIT", 0.01)
    bell = Doorbell(7)
    assert str(neighbours.on_local()[7]) == "at least 1 node runs"
    bell.close()


def test_a_mask_does_not_open_the_folder_to_others(base: Path) -> None:
    before = os.umask(0)
    try:
        Doorbell(7).close()
    finally:
        os.umask(before)
    assert base.stat().st_mode & 0o777 == 0o700


@pytest.mark.parametrize("fault", ["open", "symlink", "file", "owner", "domain"])
def test_a_folder_that_others_may_have_a_hand_in_is_refused(base: Path, fault: str) -> None:
    target = base.parent / "elsewhere"
    target.mkdir(mode=0o700)
    if fault == "symlink":
        base.symlink_to(target)
    elif fault == "file":
        base.write_text("a note")
    else:
        base.mkdir(mode=0o700)
    if fault == "open":
        base.chmod(0o755)
    elif fault == "owner":
        if os.getuid():
            pytest.skip("only root can give a folder away")
        os.chown(base, 12345, 12345)
    elif fault == "domain":
        (base / "7").write_text("a note")
    with pytest.raises(TransportError) as caught:
        Doorbell(7)
    assert str(base) in str(caught.value)
    assert "\n" not in str(caught.value)
    assert list(target.iterdir()) == []
    if fault == "file":
        assert base.read_text() == "a note"


def test_what_is_not_ours_is_neither_rung_at_nor_removed(base: Path) -> None:
    one = Doorbell(7)
    folder = base / "7"
    bystander = socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM)
    bystander.bind(str(base / "bystander"))
    bystander.setblocking(False)
    (folder / "12-0.bell").write_text("a note")
    (folder / "13-0.bell").symlink_to(base / "bystander")
    (folder / "14-0.bell").mkdir()
    for name in (
        "notes",
        "a#b?c;d.bell",
        "../x.bell".replace("/", "_"),
        "-1-0.bell",
        "\u0661-0.bell",
        "x\n.bell",
    ):
        (folder / name).write_text("a note")
    stream = socket.socket(socket.AF_UNIX, socket.SOCK_STREAM)
    stream.bind(str(folder / "a stream.bell"))
    before = sorted(path.name for path in folder.iterdir())
    assert not one.ring()
    assert one.others() == []
    assert sorted(path.name for path in folder.iterdir()) == before
    with pytest.raises(BlockingIOError):
        bystander.recv(1)
    one.close()
    bystander.close()
    stream.close()


def test_the_socket_of_a_killed_process_is_removed(base: Path) -> None:
    one = Doorbell(7)
    dead = socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM)
    dead.bind(str(base / "7/12-0.bell"))
    dead.close()
    (base / "7/12-0.zenoh").touch()
    (base / "7/12-0.zenoh.lock").touch()
    (base / "7/12-0.notes").touch()
    assert not one.ring()
    assert {path.name for path in (base / "7").iterdir()} == {socket_of(base).name, "12-0.notes"}
    one.close()


def test_garbage_neither_rings_nor_silences_a_bell(base: Path) -> None:
    one = Doorbell(7)
    thread, heard = rings(one)
    stranger = socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM)
    for data in (b"", b"h", b"hello", b"\xff" * 60_000, b"rr", b"R"):
        stranger.sendto(data, str(socket_of(base)))
    assert thread.is_alive()
    stranger.sendto(b"r", str(socket_of(base)))
    while not heard:
        assert thread.is_alive()
    assert heard == [1]
    one.close()
    thread.join(10)
    assert not thread.is_alive()


def test_a_flood_holds_nobody_up(base: Path) -> None:
    """Neither who is flooded and does not look, nor who rings there, nor the end of the one who listens."""
    deaf, one = Doorbell(7), Doorbell(7)
    stranger = socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM)
    stranger.setblocking(False)
    place = str(deaf._bell(deaf._name))
    with pytest.raises(BlockingIOError):
        while True:
            stranger.sendto(b"x" * 1000, place)
    assert one.ring()
    thread, _ = rings(one)
    over = threading.Event()

    def flood() -> None:
        flooder = socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM)
        while not over.is_set():
            try:
                flooder.sendto(b"r", str(one._bell(one._name)))
            except OSError:
                return

    flooding = threading.Thread(target=flood)
    flooding.start()
    one.close()
    thread.join(10)
    over.set()
    assert not thread.is_alive()
    one.abandon()
    flooding.join(10)
    deaf.close()


def test_no_name_is_too_long() -> None:
    longest = doorbell._TEMPORARY / f"ifgen-{2**32 - 1}" / str(2**31) / f"{2**22}-999{doorbell._DOOR}.lock"
    assert len(str(longest)) < _LONGEST_SOCKET


@pytest.mark.parametrize(
    ("options", "words"),
    [("ro", "Read-only file system"), ("nr_inodes=1", "No space left"), ("nr_inodes=3", "No space left")],
    ids=["read-only", "full", "nearly full"],
)
def test_a_disk_that_takes_nothing_is_one_error(options: str, words: str, tmp_path: Path) -> None:
    program = (
        "import pathlib; from rmw_local.transports import doorbell; "
        f"doorbell._TEMPORARY = pathlib.Path({str(tmp_path)!r}); doorbell.Doorbell(7)"
    )
    mount = f'mount -t tmpfs -o {options} none "$2" && exec "$0" -c "$1"'
    run = subprocess.run(
        [
            "unshare",
            "--user",
            "--map-root-user",
            "--mount",
            "sh",
            "-c",
            mount,
            sys.executable,
            program,
            tmp_path,
        ],
        env={**os.environ, "PYTHONPATH": UNDERLAY},
        capture_output=True,
        text=True,
        timeout=60,
        check=False,
    )
    if "unshare:" in run.stderr or "mount:" in run.stderr:
        pytest.skip(run.stderr.strip())
    assert run.stderr.splitlines()[-1].startswith(
        f"rmw_local.transports.TransportError: {tmp_path}/ifgen-0"
    ) or (f"no socket can be made in {tmp_path}/ifgen-0/7" in run.stderr)
    assert words in run.stderr
