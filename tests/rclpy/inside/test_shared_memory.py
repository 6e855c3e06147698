"""Large messages go to other processes through memory where both sides can, and never get lost where not."""

from __future__ import annotations

import errno
import os
import random
import sys
import threading
from collections.abc import Iterator
from pathlib import Path
from typing import Any

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


@pytest.mark.parametrize("value", ["-1", "1.5", "64M", "²"])
def test_wrong_sizes_are_said(value: str, capfd: pytest.CaptureFixture[str]) -> None:
    assert read_memory({"ZENOH_SHM_ALLOC_SIZE": value}) == read_memory({})
    error = capfd.readouterr().err
    assert error == (
        f"rmw_local: ZENOH_SHM_ALLOC_SIZE is {value!r}, expected a whole number of bytes: assuming 67108864\n"
    )


def test_notices_of_others_are_not_trusted(pair: Pair, capfd: pytest.CaptureFixture[str]) -> None:
    import zenoh
    from rmw_local.transports.zenoh import attachments, lending

    traffic = Traffic(pair)
    traffic.send(image())
    listener = pair.processes[1]
    transports = [each.link._transport for each in pair.processes]  # type: ignore[union-attr]
    talker, other = (each._id for each in transports)
    session: zenoh.Session = transports[0]._session
    key = f"7/image/any/hash/ifgen_memory/{other}"
    attachment = attachments.pack(1, 1, bytes(16))

    def send(owner: str, notice: bytes, attached: bytes | None = attachment) -> None:
        before = transports[1].malformed.count
        session.put(f"{key}/{owner}", notice, attachment=attached)
        pair.until(lambda: transports[1].malformed.count == before + 1)

    good = lending.pack(Loan(bytes(8), 0, 100, 1), 0, [bytes(16)])
    for length in (0, 1, len(good) - 1, len(good) + 1):
        send(talker, (good * 2)[:length])
    send(talker, good)
    send(talker, good, None)
    send(talker, lending.pack(Loan(bytes(8), 0, 2**64 - 1, 1), 0, []))
    send(talker, lending.pack(Loan(bytes(8), 2**64 - 1, 1, 65535), 0, []))
    send(talker, lending.pack(Loan(bytes(8), 0, 1, 1), 1, []))
    for owner in ("nobody", "..", "0", "f" * 33):
        send(owner, good)
    capfd.readouterr()
    traffic.send(image())
    assert listener.link is not None


def test_any_notice_is_read_or_refused(pool: Pool, borrower: Borrower) -> None:
    pytest.importorskip("zenoh")
    from rmw_local.transports.zenoh import lending

    drawn = random.Random(1)
    real = pool.lend(b"x" * 1000, 3)
    assert real is not None
    good = lending.pack(real, 2, [bytes(16), bytes(16)])
    read = 0
    for _ in range(3000):
        notice = bytearray(good)
        for _ in range(drawn.randrange(4)):
            notice[drawn.randrange(len(notice))] = drawn.choice((0, 1, 127, 128, 255, drawn.randrange(256)))
        if not drawn.randrange(5):
            del notice[drawn.randrange(len(notice)) :]
        try:
            loan, place, gids = lending.unpack(bytes(notice))
        except ValueError:
            continue
        data = borrower.read(drawn.choice(("aa", "aa", "bb")), loan, place)
        assert data is None or len(data) == loan.length <= 1 << 20
        assert len(gids) == (len(notice) - 28) // 16
        read += data is not None
    assert read > 300


def test_a_message_can_be_read_until_all_have_read_it(pool: Pool, borrower: Borrower) -> None:
    first = pool.lend(b"x" * 400_000, 2)
    second = pool.lend(b"y" * 400_000, 1)
    assert first is not None
    assert second is not None
    assert pool.lend(bytes(400_000), 1) is None, "the file is full"
    assert borrower.read("aa", first, 1) == b"x" * 400_000
    assert pool.lend(bytes(400_000), 1) is None, "one has yet to read it"
    assert borrower.read("aa", first, 0) == b"x" * 400_000
    assert pool.lend(bytes(400_000), 1) is not None
    assert borrower.read("aa", first, 0) is None, "it is lent again"
    assert borrower.read("aa", second, 0) == b"y" * 400_000


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
        assert borrower.read("aa", loan, 0) == bytes([number]) * size
        assert borrower.read("aa", loan._replace(length=1 << 30), 0) is None


def test_threads_lend_and_read_at_the_same_time(pool: Pool, borrower: Borrower) -> None:
    failed: list[object] = []
    lent: list[int] = []

    def work(number: int) -> None:
        for round_ in range(150):
            data = bytes([number, round_]) * (500 + 700 * number + 13 * round_)
            loan = pool.lend(data, 1)
            if loan is not None:
                lent.append(number)
                if borrower.read("aa", loan, 0) != data:
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
    other.bury("aa")
    assert other.is_near("aa")
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
    assert borrower.read("aa", loan, 0) == b"last words"
    end.join()
    assert not pool.is_near("aa")


def test_serialised_messages_take_the_same_way(pair: Pair) -> None:
    traffic = Traffic(pair)
    traffic.publisher.publish(serialize_message(image()))
    pair.until(lambda: all(traffic.heard))
    assert shared(traffic.talker) >= LARGE
