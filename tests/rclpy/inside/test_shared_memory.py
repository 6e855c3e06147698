"""Large messages go to other processes through memory where both sides can, and never get lost where not."""

from __future__ import annotations

import errno
import os
import random
import shutil
import socket
import struct
import sys
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from types import SimpleNamespace
from typing import Any, cast

import pytest
from rclpy.event_handler import SubscriptionEventCallbacks
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy
from rclpy.serialization import serialize_message
from rmw_local.transports.environment import read_memory
from sensor_msgs.msg import Image

from tests.rclpy.inside.contract.processes import Pair, Process, connected

if sys.platform != "linux":
    pytest.skip("files in memory are Linux's", allow_module_level=True)

from rmw_local.transports import memory
from rmw_local.transports.memory import Borrower, Loan, Pool

LARGE = 300_000  # bytes
FOLDER = memory.SHARED / f"ifgen-{os.getuid()}"


@pytest.fixture(autouse=True)
def _no_settings(monkeypatch: pytest.MonkeyPatch) -> None:
    for name in ("ZENOH_SHM_ALLOC_SIZE", "ZENOH_SHM_MESSAGE_SIZE_THRESHOLD"):
        monkeypatch.delenv(name, raising=False)


@pytest.fixture
def pool(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Pool]:
    """A pool of 1 MiB in a folder of its own."""
    monkeypatch.setattr(memory, "SHARED", tmp_path)
    made = Pool("aa", 1 << 20)
    yield made
    made.close()


@pytest.fixture
def borrower(pool: Pool) -> Iterator[Borrower]:
    made = Borrower()
    yield made
    made.close()


def names(folder: Path) -> set[str]:
    return {each.name for each in folder.iterdir()}


def image(size: int = LARGE, number: int = 0) -> Image:
    message = Image(height=1, width=size, step=size, encoding="mono8", data=os.urandom(16) * (size // 16))
    message.header.frame_id = str(number)
    return message


class Traffic:
    """Images from one process to others."""

    def __init__(self, pair: Pair, qos: Any = 10, hearers: int = 1) -> None:
        self.pair = pair
        self.talker = pair.process("talker")
        self.publisher = self.talker.node.create_publisher(Image, "image", qos)
        self.heard: list[list[Image]] = []
        for number in range(hearers):
            self.listen(pair.process(f"listener_{number}"), qos)

    def listen(self, process: Process, qos: Any = 10) -> None:
        heard: list[Image] = []
        process.node.create_subscription(Image, "image", heard.append, qos)
        self.heard.append(heard)
        self.pair.until(lambda: self.publisher.get_subscription_count() == len(self.heard))

    def send(self, *messages: Image) -> None:
        """Publish, and wait until everybody has got it all, as it was."""
        for message in messages:
            self.publisher.publish(message)
        self.pair.until(lambda: all(len(each) >= len(messages) for each in self.heard))
        for each in self.heard:
            assert each == list(messages)
            each.clear()


@pytest.fixture
def pair() -> Iterator[Pair]:
    with connected("zenoh") as made:
        yield made
        files = [file_of(process) for process in made.processes]
    assert not any(file.exists() for file in files)


def shared(process: Process) -> int:
    """How large the file of a process is; -1 if there is none."""
    path = file_of(process)
    return path.stat().st_size if path.exists() else -1


def file_of(process: Process) -> Path:
    assert process.link is not None
    return FOLDER / process.link._transport._id


def test_large_messages_and_no_others_go_through_memory(pair: Pair) -> None:
    traffic = Traffic(pair, hearers=2)
    traffic.send(image(1000))
    assert shared(traffic.talker) == 0
    traffic.send(*(image(LARGE, number) for number in range(5)))
    assert shared(traffic.talker) >= LARGE
    size = shared(traffic.talker)
    for number in range(5):
        traffic.send(image(LARGE, number), image(1000), image(LARGE, number + 1))
    assert shared(traffic.talker) == size, "places are used again"


@pytest.mark.parametrize("reliability", [ReliabilityPolicy.RELIABLE, ReliabilityPolicy.BEST_EFFORT])
def test_both_ways_keep_one_order(pair: Pair, reliability: ReliabilityPolicy) -> None:
    """No message overtakes another, none counts as lost, and what was lent is acknowledged."""
    traffic = Traffic(pair, QoSProfile(depth=100, reliability=reliability))
    lost: list[Any] = []
    events = SubscriptionEventCallbacks(message_lost=lost.append)
    qos = QoSProfile(depth=100, reliability=reliability)
    pair.processes[1].node.create_subscription(Image, "image", lambda _: None, qos, event_callbacks=events)
    pair.until(lambda: traffic.publisher.get_subscription_count() == 2)
    traffic.send(*(image(LARGE if number % 2 else 1600, number) for number in range(40)))
    assert traffic.publisher.wait_for_all_acked()
    pair.settle()
    assert not lost


def test_two_subscriptions_of_one_process_get_their_own(pair: Pair) -> None:
    traffic = Traffic(pair, hearers=1)
    traffic.listen(pair.processes[1])
    traffic.send(image())
    traffic.publisher.publish(image())
    pair.until(lambda: all(traffic.heard))
    traffic.heard[0][0].data[0] = (traffic.heard[1][0].data[0] + 1) % 256
    assert traffic.heard[0][0] != traffic.heard[1][0]


def test_what_is_kept_for_late_joiners_does_not_stay_in_memory(pair: Pair) -> None:
    traffic = Traffic(pair, QoSProfile(depth=3, durability=DurabilityPolicy.TRANSIENT_LOCAL))
    traffic.send(image(), image())
    assert shared(traffic.talker) == 0


def test_who_is_farther_away_gets_bytes_and_so_does_everybody(
    pair: Pair, monkeypatch: pytest.MonkeyPatch
) -> None:
    traffic = Traffic(pair)
    monkeypatch.setenv("ZENOH_SHM_ALLOC_SIZE", "0")
    far = pair.process("far")
    traffic.listen(far)
    traffic.send(image(), image())
    assert shared(far) == -1
    assert shared(traffic.talker) == 0
    far.leave()
    traffic.heard.pop()
    pair.until(lambda: traffic.publisher.get_subscription_count() == 1)
    traffic.send(image())
    assert shared(traffic.talker) >= LARGE


def test_a_file_that_is_too_small_and_one_that_is_not(pair: Pair, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("ZENOH_SHM_ALLOC_SIZE", "200000")
    monkeypatch.setenv("ZENOH_SHM_MESSAGE_SIZE_THRESHOLD", "5000")
    traffic = Traffic(pair)
    traffic.send(image(LARGE))
    assert shared(traffic.talker) == 0
    traffic.send(*(image(96_000, number) for number in range(10)))
    assert 96_000 < shared(traffic.talker) <= 200_000


def test_a_full_file_system_is_said_once(
    pair: Pair, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> None:
    def fail(*_: object) -> None:
        raise OSError(errno.ENOSPC, "No space left on device")

    traffic = Traffic(pair)
    monkeypatch.setattr(os, "posix_fallocate", fail)
    traffic.send(image(), image(), image())
    lines = capfd.readouterr().err.splitlines()
    assert lines == [
        "rmw_local: /dev/shm is full: large messages to other processes go over sockets, which is slower"
    ]


def test_a_folder_of_somebody_else_is_not_used(
    pair: Pair, monkeypatch: pytest.MonkeyPatch, tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / FOLDER.name).mkdir(mode=0o777)
    (tmp_path / FOLDER.name).chmod(0o777)
    monkeypatch.setattr(memory, "SHARED", tmp_path)
    traffic = Traffic(pair)
    traffic.send(image())
    assert "only its owner, this user, can use" in capfd.readouterr().err


@contextmanager
def a_quiet_pair(capfd: pytest.CaptureFixture[str], said: int = 0) -> Iterator[Pair]:
    """A pair that says as many lines, and drops nothing."""
    with connected("zenoh") as made:
        yield made
        for each in made.processes:
            assert each.link is not None
            assert not each.link._transport.malformed.count  # type: ignore[attr-defined]
    lines = capfd.readouterr().err.splitlines()
    assert len(lines) == said, lines


@pytest.mark.parametrize("whose", ["talker", "listener", "both", "folder", "moved", "cut", "replaced"])
@pytest.mark.parametrize("before", [0, 2], ids=["before the first", "after two"])
def test_who_lends_goes_on_when_somebody_deletes_its_file(
    whose: str,
    before: int,
    capfd: pytest.CaptureFixture[str],
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """As systemd does when a user logs out (RemoveIPC), and programs go on."""
    monkeypatch.setattr(memory, "SHARED", tmp_path)
    with a_quiet_pair(capfd) as pair:
        traffic = Traffic(pair)
        talker, listener = (tmp_path / FOLDER.name / file_of(each).name for each in pair.processes)
        traffic.send(*(image(LARGE, number) for number in range(before)))
        if whose == "folder":
            shutil.rmtree(talker.parent)
        elif whose == "moved":
            talker.rename(tmp_path / "elsewhere")
        elif whose == "cut":
            os.truncate(talker, 0)
        elif whose == "replaced":
            talker.unlink()
            talker.write_bytes(b"not ours")
        else:
            for each in (
                (talker, listener) if whose == "both" else (talker if whose == "talker" else listener,)
            ):
                each.unlink()
        for number in range(3):
            traffic.send(image(LARGE, number), image(LARGE, number + 1))
        traffic.listen(pair.process("newcomer"))
        for number in range(3):
            traffic.send(image(LARGE, number), image(LARGE, number + 1))
        assert talker.stat().st_size >= LARGE, "it shares memory again"
        later = pair.process("later")
        traffic.publisher = later.node.create_publisher(Image, "image", 10)
        pair.until(lambda: traffic.publisher.get_subscription_count() == 2)
        for number in range(3):
            traffic.send(image(LARGE, number), image(LARGE, number + 1))
        assert (listener.parent / file_of(later).name).stat().st_size >= LARGE, "so do later ones"


@pytest.mark.parametrize(
    "error", [errno.ENOSPC, errno.EROFS, errno.EPERM, errno.EACCES, errno.ENOENT, errno.EMFILE]
)
@pytest.mark.parametrize("call", ["open", "mkdir", "posix_fallocate", "mmap"])
def test_what_the_file_system_refuses_is_said_once_and_messages_go_over_sockets(
    error: int, call: str, capfd: pytest.CaptureFixture[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """And once it refuses no more, memory is shared again, unless it was full."""

    def refuse(path: object, *_: Any, **__: Any) -> Any:
        if call != "open" or str(path).startswith(str(tmp_path)):
            raise OSError(error, os.strerror(error))
        return opened(path, *_, **__)  # type: ignore[arg-type]

    opened = os.open
    monkeypatch.setattr(memory, "SHARED", tmp_path / "shm")
    if call != "mkdir":
        (tmp_path / "shm").mkdir()
    sides = 2 if call in {"open", "mkdir"} else 1  # who only receives has an empty file
    with a_quiet_pair(capfd, said=sides) as pair, monkeypatch.context() as patch:
        if call == "mmap":
            patch.setattr(memory.mmap, "mmap", refuse)
        elif call != "mkdir":
            patch.setattr(os, call, refuse)
        traffic = Traffic(pair)
        traffic.send(image(), image(), image())
        patch.undo()
        (tmp_path / "shm").mkdir(exist_ok=True)
        for number in range(3):
            traffic.send(image(LARGE, number), image(LARGE, number + 1))
        shared_file = tmp_path / "shm" / FOLDER.name / file_of(traffic.talker).name
        assert (shared_file.stat().st_size > 0) == (call != "posix_fallocate")


def test_only_private_sessions_lend_and_borrow() -> None:
    """Over a router, access control could keep nobody from sending notices."""
    with connected("queries") as pair:
        traffic = Traffic(pair)
        traffic.send(image(), image())
        assert [shared(each) for each in pair.processes] == [-1, -1]


@pytest.mark.parametrize("value", ["-1", "1.5", "64M", "²"])
def test_wrong_sizes_are_said(value: str, capfd: pytest.CaptureFixture[str]) -> None:
    assert read_memory({"ZENOH_SHM_ALLOC_SIZE": value}) == read_memory({})
    error = capfd.readouterr().err
    assert error == (
        f"rmw_local: ZENOH_SHM_ALLOC_SIZE is {value!r}, expected a whole number of bytes: assuming 67108864\n"
    )


class Ears:
    """The shared memory of a session that listens to two topics, and what it hears of each."""

    def __init__(self) -> None:
        import zenoh
        from rmw_local.notices import Repeated
        from rmw_local.transports.background import Background
        from rmw_local.transports.zenoh.presence import Gate
        from rmw_local.transports.zenoh.shared_memory import SharedMemory

        config = zenoh.Config()
        for path in ("scouting/multicast/enabled", "scouting/gossip/enabled"):
            config.insert_json5(path, "false")
        config.insert_json5("listen/endpoints", "[]")
        self.session = zenoh.open(config)
        self.malformed = Repeated("{count} malformed{s}: {why}")
        self.shared_memory = SharedMemory(
            self.session, Gate(), Background(), 7, self.malformed, is_private=True
        )
        self.heard: list[tuple[str, bytes, int]] = []
        for gid, key in ((CAMERA_GID, CAMERA), (COMMAND_GID, COMMAND)):
            self.shared_memory.listen(
                gid, key, lambda data, number, *_, k=key: self.heard.append((k, data, number))
            )
        self.id = str(self.session.zid())

    def notice(self, payload: bytes, key: str = "", owner: str = "aa") -> None:
        """Hear of a loan, whoever says so."""
        key = f"{key or CAMERA}/ifgen_memory/{self.id}/{owner}"
        self.shared_memory._on_notice(cast("Any", SimpleNamespace(key_expr=key, payload=Payload(payload))))

    def close(self) -> None:
        self.shared_memory.finish()
        self.session.close()
        self.shared_memory.close()


class Payload(bytes):
    def to_bytes(self) -> bytes:  # type: ignore[override]
        return self


CAMERA, COMMAND = "7/camera/Image/RIHS01_1", "7/cmd_vel/Twist/RIHS01_2"
CAMERA_GID, COMMAND_GID = b"c" * 16, b"v" * 16
ATTACHMENT = struct.pack("<qqB16s", 3, 1, 16, b"p" * 16)


@pytest.fixture
def ears(pool: Pool) -> Iterator[Ears]:
    pytest.importorskip("zenoh")
    made = Ears()
    yield made
    made.close()


def packed(loan: Loan | None, place: int = 0, *gids: bytes) -> bytes:
    from rmw_local.transports.zenoh import shared_memory

    assert loan is not None
    return shared_memory.pack(loan, place, list(gids or (CAMERA_GID,)))


def test_a_notice_is_believed_as_far_as_the_table_of_the_file_says_so(
    ears: Ears, pool: Pool, capfd: pytest.CaptureFixture[str]
) -> None:
    """Whoever sends it cannot say where a message is, how long it is, or which topic it belongs to."""
    loan = pool.lend(b"image", 2, CAMERA.encode(), ATTACHMENT)
    assert loan is not None
    wrong: list[tuple[bytes, str, str]] = [
        (packed(loan._replace(ticket=bytes(16))), CAMERA, "aa"),  # as it is where nothing is lent
        (packed(Loan(bytes(16), 200)), CAMERA, "aa"),
        (packed(loan._replace(ticket=b"x" * 16)), CAMERA, "aa"),
        (packed(loan._replace(line=1)), CAMERA, "aa"),
        (packed(loan._replace(line=65535)), CAMERA, "aa"),
        (packed(loan, 2), CAMERA, "aa"),
        (packed(loan, 65535), CAMERA, "aa"),
        (packed(loan, 0, COMMAND_GID), COMMAND, "aa"),
        (packed(loan, 0, CAMERA_GID), COMMAND, "aa"),
        *((packed(loan), CAMERA, owner) for owner in ("nobody", "..", "0", "f" * 33, "ab", ears.id)),
        *(((packed(loan) * 2)[:length], CAMERA, "aa") for length in (0, 1, 35, 37, 53)),
        (packed(loan, 0, *[CAMERA_GID] * 5000), CAMERA, "aa"),
    ]
    file = pool._folder / "aa"
    before = file.read_bytes()
    for number, (notice, key, owner) in enumerate(wrong, 1):
        ears.notice(notice, key, owner)
        assert (ears.malformed.count, ears.heard) == (number, []), (notice[:36], key, owner)
    assert file.read_bytes() == before, "nothing is written because of a notice that is wrong"
    assert capfd.readouterr().err.count("malformed") <= 2, "one line a second"
    ears.notice(packed(loan, 0, CAMERA_GID, COMMAND_GID, CAMERA_GID))
    assert ears.heard == [(CAMERA, b"image", 3)]
    ears.notice(packed(loan))
    assert len(ears.heard) == 1, "a notice that comes again brings nothing"
    ears.notice(packed(loan, 1))
    assert len(ears.heard) == 2


def test_any_notice_is_read_or_refused(ears: Ears, pool: Pool) -> None:
    """Whatever comes raises nothing, and only what was lent is heard, where it belongs, and once."""
    drawn = random.Random(1)
    read = 0
    for _ in range(300):
        loan = pool.lend(b"x" * 1000, 3, CAMERA.encode(), ATTACHMENT)
        assert loan is not None
        ears.heard.clear()
        for _ in range(10):
            notice = bytearray(packed(loan, drawn.randrange(4), drawn.choice((CAMERA_GID, COMMAND_GID))))
            for _ in range(drawn.randrange(3)):
                notice[drawn.randrange(len(notice))] = drawn.choice((0, 1, 2, 255, drawn.randrange(256)))
            if not drawn.randrange(5):
                del notice[drawn.randrange(len(notice)) :]
            key = drawn.choice((CAMERA, CAMERA, COMMAND, "", "7", "\x1b]0;x\x07", "é" * 300))
            owner = drawn.choice(("aa", "aa", "aa", "bb", "", "..", "a/a", "\n", ears.id))
            ears.notice(bytes(notice), key, owner)
        assert set(ears.heard) <= {(CAMERA, b"x" * 1000, 3)}
        assert len(ears.heard) <= 3
        read += len(ears.heard)
        for place in range(3):
            ears.notice(packed(loan, place))
    assert ears.malformed.count > 1000
    assert read > 20


class Forged:
    """Files that may be found in the place of one that a session lends."""

    table = struct.Struct("<16sQQHHH")
    loan = Loan(b"t" * 16, 0)

    @classmethod
    def content(cls, offset: int = 16384, length: int = 5, size: int = 20000, heads: int = 0) -> bytes:
        line = cls.table.pack(cls.loan.ticket, offset, length, 1, heads, 0)
        return (line.ljust(16384, b"\0") + b"\0hello").ljust(size, b"\0")[:size]


@pytest.mark.parametrize(
    ("mode", "content"),
    [
        (0o644, Forged.content()),
        (0o666, Forged.content()),
        (0o600, b""),
        (0o600, b"x"),
        (0o600, Forged.content(size=16383)),
        (0o600, Forged.content(offset=2**64 - 1)),
        (0o600, Forged.content(length=2**64 - 1)),
        (0o600, Forged.content(length=2**40)),
        (0o600, Forged.content(offset=19999)),
        (0o600, Forged.content(heads=65535)),
    ],
)
def test_a_file_that_lies_is_not_read(pool: Pool, borrower: Borrower, mode: int, content: bytes) -> None:
    path = pool._folder / "bb"
    path.write_bytes(Forged.content())
    path.chmod(0o600)
    assert borrower.read("bb", Forged.loan, 0) == (b"", b"hello"), "as one that does not"
    borrower.forget("bb")
    path.write_bytes(content)
    path.chmod(mode)
    assert borrower.read("bb", Forged.loan, 0) is None
    assert path.read_bytes() == content


@pytest.mark.parametrize("kind", ["link", "folder", "fifo", "socket", "missing"])
def test_what_is_no_file_is_not_opened(pool: Pool, borrower: Borrower, tmp_path: Path, kind: str) -> None:
    path = pool._folder / "bb"
    if kind == "link":
        (tmp_path / "elsewhere").write_bytes(Forged.content())
        path.symlink_to(tmp_path / "elsewhere")
    elif kind == "folder":
        path.mkdir()
    elif kind == "fifo":
        os.mkfifo(path, 0o600)
    elif kind == "socket":
        with socket.socket(socket.AF_UNIX) as bound:
            bound.bind(str(path))
    assert borrower.read("bb", Forged.loan, 0) is None
    assert not pool.can_read("bb")


def test_a_file_that_shrinks_is_not_read_beyond_its_end(pool: Pool, borrower: Borrower) -> None:
    """To read there would end the process."""
    loans = [pool.lend(b"x" * 100_000, 2) for _ in range(2)]
    assert loans[0] is not None
    assert loans[1] is not None
    assert borrower.read("aa", loans[0], 0) == (b"", b"x" * 100_000)
    os.truncate(pool._folder / "aa", 20_000)
    assert borrower.read("aa", loans[1], 0) is None
    os.truncate(pool._folder / "aa", 0)
    assert borrower.read("aa", loans[0], 1) is None


def test_a_message_can_be_read_until_all_have_read_it(pool: Pool, borrower: Borrower) -> None:
    first = pool.lend(b"x" * 400_000, 2)
    second = pool.lend(b"y" * 400_000, 1)
    assert first is not None
    assert second is not None
    assert pool.lend(bytes(400_000), 1) is None, "the file is full"
    assert borrower.read("aa", first, 1) == (b"", b"x" * 400_000)
    assert pool.lend(bytes(400_000), 1) is None, "one has yet to read it"
    assert borrower.read("aa", first, 0) == (b"", b"x" * 400_000)
    assert pool.lend(bytes(400_000), 1) is not None
    assert borrower.read("aa", first, 0) is None, "it is lent again"
    assert borrower.read("aa", second, 0) == (b"", b"y" * 400_000)


def test_who_never_reads_does_not_keep_it_for_ever(
    pool: Pool, borrower: Borrower, monkeypatch: pytest.MonkeyPatch
) -> None:
    lost = pool.lend(b"x" * 800_000, 1)
    assert lost is not None
    assert pool.lend(bytes(800_000), 1) is None
    with monkeypatch.context() as patch:
        patch.setattr(memory, "time", Later)
        assert pool.lend(bytes(800_000), 1) is not None
    assert borrower.read("aa", lost, 0) is None


class Later:
    """A clock, long after."""

    @staticmethod
    def monotonic() -> float:
        return 1e12


def test_the_file_grows_while_it_is_read(pool: Pool, borrower: Borrower) -> None:
    sizes = [10, 5000, 70_000, 300_000, 500_000]
    loans = [pool.lend(bytes([number]) * size, 1) for number, size in enumerate(sizes)]
    for number, (size, loan) in enumerate(zip(sizes, loans, strict=True)):
        assert loan is not None
        assert borrower.read("aa", loan, 0) == (b"", bytes([number]) * size)


def test_threads_lend_and_read_at_the_same_time(pool: Pool, borrower: Borrower) -> None:
    failed: list[object] = []
    lent: list[int] = []

    def work(number: int) -> None:
        for round_ in range(150):
            data = bytes([number, round_]) * (500 + 700 * number + 13 * round_)
            loan = pool.lend(data, 1)
            if loan is not None:
                lent.append(number)
                if borrower.read("aa", loan, 0) != (b"", data):
                    failed.append((number, round_))

    threads = [threading.Thread(target=work, args=(number,)) for number in range(6)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert not failed
    assert len(lent) == 900


def test_only_files_of_dead_processes_are_removed(pool: Pool, tmp_path: Path) -> None:
    folder = tmp_path / FOLDER.name
    (folder / "dead").write_bytes(b"left")
    other = Pool("bb", 1 << 20)
    assert names(folder) == {"aa", "bb"}
    other.remove_orphan("aa")
    assert other.can_read("aa")
    child = os.fork()
    if not child:
        os._exit(0 if pool._file == -1 and pool._memory is None else 1)
    assert os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]) == 0
    pool.close()
    assert pool.lend(b"late", 1) is None
    assert names(folder) == {"bb"}
    other.close()


def test_a_message_that_is_still_on_its_way_is_there_when_its_publisher_ends(
    pool: Pool, borrower: Borrower
) -> None:
    loan = pool.lend(b"last words", 1)
    assert loan is not None
    end = threading.Thread(target=pool.close)
    end.start()
    assert borrower.read("aa", loan, 0) == (b"", b"last words")
    end.join()
    assert not pool.can_read("aa")


def test_serialised_messages_take_the_same_way(pair: Pair) -> None:
    traffic = Traffic(pair)
    traffic.publisher.publish(serialize_message(image()))
    pair.until(lambda: all(traffic.heard))
    assert shared(traffic.talker) >= LARGE
