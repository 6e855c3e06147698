"""Recordings that are cut off, damaged or made up: read up to the damage, with the place of it."""

from __future__ import annotations

import re
import sqlite3
import warnings
from pathlib import Path
from typing import Any

import pytest
from ifgen_runtime import serialize
from ifgen_runtime.bag import Bag, BagError, BagWarning, Recorder
from mcap.reader import make_reader
from mcap.writer import CompressionType
from mcap.writer import Writer as McapWriter
from rosbags.rosbag2 import StoragePlugin, Writer
from rosbags.typesys import Stores, get_typestore

from .fuzzing import run

COUNT = 60


def recorded(path: Path, **options: Any) -> Path:
    from std_msgs.msg import String

    with Recorder(path, chunk_size=500, **options) as recorder:
        for index in range(COUNT):
            recorder.write("/log", String(data=f"message {index:03}"), received=index)
    return path


def by_the_library(path: Path, **options: Any) -> Path:
    """A file without checksums."""
    writer = McapWriter(str(path), 300, CompressionType.NONE, enable_crcs=False, **options)
    writer.start("ros2", "a test")
    schema = writer.register_schema("std_msgs/msg/String", "ros2msg", b"string data\n")
    channel = writer.register_channel("/log", "cdr", schema)
    for index in range(COUNT):
        writer.add_message(channel, index, b"\0\1\0\0\2\0\0\0a\0", index)
    writer.finish()
    return path


def database(folder: Path) -> Path:
    store = get_typestore(Stores.ROS2_JAZZY)
    with Writer(folder, version=9, storage_plugin=StoragePlugin.SQLITE3) as writer:
        log = writer.add_connection("/log", "std_msgs/msg/String", typestore=store)
        for index in range(COUNT):
            writer.write(log, index, b"\0\1\0\0\2\0\0\0a\0")
    return next(folder.glob("*.db3"))


def texts(bag: Bag) -> list[str]:
    return [message.data for message in bag["/log"]] if "/log" in bag else []


def test_a_file_cut_off_anywhere(tmp_path: Path) -> None:
    path = recorded(tmp_path / "run.mcap")
    whole = path.read_bytes()
    with path.open("rb") as file:
        summary = make_reader(file).get_summary()
    assert summary is not None
    ends = [index.chunk_start_offset + index.chunk_length for index in summary.chunk_indexes]
    everything = [f"message {index:03}" for index in range(COUNT)]
    per_chunk = [sum(each.message_index_offsets.keys() == {0} for each in summary.chunk_indexes), len(ends)]
    assert per_chunk[0] == per_chunk[1] > 3
    found_before = -1
    for size in range(9, len(whole), 7):
        path.write_bytes(whole[:size])
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always")
            with Bag(path) as bag:
                found = texts(bag)
        assert found == everything[: len(found)]
        assert len(found) >= found_before, "a longer file has not fewer messages"
        assert (len(found) == COUNT) is (size >= ends[-1])
        found_before = len(found)
        (warning,) = caught
        assert warning.category is BagWarning
        assert warning.filename == __file__
        assert re.search(
            rf"damaged at byte [\d,]+: .*; {len(found)} messages are before it", str(warning.message)
        )


@pytest.mark.parametrize("compression", ["zstd", "lz4", "none"])
def test_a_damaged_chunk_is_left_out(tmp_path: Path, compression: Any) -> None:
    path = recorded(tmp_path / "run.mcap", compression=compression)
    data = bytearray(path.read_bytes())
    with path.open("rb") as file:
        summary = make_reader(file).get_summary()
    assert summary is not None
    chunk = sorted(summary.chunk_indexes, key=lambda each: each.chunk_start_offset)[1]
    data[chunk.chunk_start_offset + 100] ^= 0x55
    path.write_bytes(data)
    place = rf"run.mcap: damaged at byte {chunk.chunk_start_offset:,}: .*; the messages of this part are lost"
    with Bag(path) as bag, pytest.warns(BagWarning, match=place):
        found = texts(bag)
    lost = {f"message {index:03}" for index in range(chunk.message_start_time, chunk.message_end_time + 1)}
    assert {f"message {index:03}" for index in range(COUNT)} - set(found) == lost
    assert str(bag.damage[0]).startswith(f"{path}: damaged at byte {chunk.chunk_start_offset:,}: ")
    with Bag(path, strict=True) as bag, pytest.raises(BagError, match=place):
        texts(bag)


def test_strict_reading_of_what_was_cut_off(tmp_path: Path) -> None:
    path = recorded(tmp_path / "run.mcap")
    path.write_bytes(path.read_bytes()[:-100])
    with pytest.raises(BagError, match=r"run\.mcap: damaged at byte"):
        Bag(path, strict=True)


def test_a_message_that_is_none_of_its_type(tmp_path: Path) -> None:
    from std_msgs.msg import String

    path = tmp_path / "run.mcap"
    with Recorder(path) as recorder:
        recorder.add_topic("/log", String)
        recorder.write_serialized("/log", b"\0\1\0\0\xff\0\0\0", 1)
        recorder.write("/log", String(data="sound"), 2)
    with (
        Bag(path) as bag,
        pytest.warns(BagWarning, match=r"a message of /log cannot be read: String\.data: "),
    ):
        assert texts(bag) == ["sound"]
    with Bag(path) as bag, pytest.raises(BagError, match=r"a message of /log cannot be read: String\.data: "):
        next(iter(bag)).message  # noqa: B018 - the property raises


def test_a_damaged_database(tmp_path: Path) -> None:
    path = database(tmp_path / "bag")
    data = bytearray(path.read_bytes())
    data[1024:] = bytes(len(data) - 1024)
    path.write_bytes(data)
    with pytest.raises(BagError, match=r"bag\.db3: this database cannot be read: "):
        Bag(path)
    path.write_bytes(b"SQLite format 3\0" + bytes(100))
    with pytest.raises(BagError, match=r"bag\.db3"):
        Bag(path)


def large_database(folder: Path, size: int = 300) -> tuple[Path, list[str]]:
    """A database of many pages, and the texts in it."""
    from std_msgs.msg import String

    written = [f"message {index:03} {'x' * size}" for index in range(100)]
    store = get_typestore(Stores.ROS2_JAZZY)
    with Writer(folder, version=9, storage_plugin=StoragePlugin.SQLITE3) as writer:
        log = writer.add_connection("/log", "std_msgs/msg/String", typestore=store)
        for index, text in enumerate(written):
            writer.write(log, index, bytes(serialize(String(data=text))))
    return next(folder.glob("*.db3")), written


def test_a_database_cut_off_anywhere(tmp_path: Path) -> None:
    """By pages: what the messages before the cut are is read."""
    path, written = large_database(tmp_path / "bag")
    whole = path.read_bytes()
    page = int.from_bytes(whole[16:18], "big")
    counts: list[int] = []
    for size in range(page * 8, len(whole), page):  # the first pages have the tables
        path.write_bytes(whole[:size])
        with pytest.warns(BagWarning, match="bytes are missing at its end; "), Bag(path) as bag:
            found = texts(bag)
        assert found == written[: len(found)]
        counts.append(len(found))
    assert counts == sorted(counts)
    assert 0 < counts[0] < 30
    assert counts[-1] > 90
    path.write_bytes(whole[: page * 8 + 77])  # within a page, whose other messages are nowhere
    with pytest.warns(BagWarning, match="bytes are missing at its end; "), Bag(path) as bag:
        assert set(written[: counts[0]]) <= set(texts(bag)) <= set(written)


def test_a_database_that_lacks_its_end_says_so(tmp_path: Path) -> None:
    path, written = large_database(tmp_path / "bag")
    whole = path.read_bytes()
    path.write_bytes(whole[: len(whole) * 3 // 4])
    missing = len(whole) - len(whole) * 3 // 4
    says = rf"bag\.db3: damaged: {missing:,} bytes are missing at its end; (\d+) messages are not affected"
    with pytest.warns(BagWarning, match=says) as caught, Bag(path) as bag:
        found = texts(bag)
        assert bag.topics["/log"].count == len(found)
        assert (bag.start, bag.end) == (written.index(found[0]), written.index(found[-1]))
        middle = [message.data for message in bag["/log"].between(10, 20)]
        assert middle == [text for text in found if 10 <= written.index(text) < 20]
    assert f" {len(found)} messages" in str(caught[0].message)
    with pytest.raises(BagError, match=says):
        Bag(path, strict=True)


def test_a_damaged_page_of_a_database_is_passed_over(tmp_path: Path) -> None:
    path, written = large_database(tmp_path / "bag")
    data = bytearray(path.read_bytes())
    page = int.from_bytes(data[16:18], "big")
    place = data.index(b"message 050") // page * page
    data[place : place + page] = b"\x55" * page
    path.write_bytes(data)
    with pytest.warns(BagWarning, match=r"malformed; 8\d messages are not affected"), Bag(path) as bag:
        found = texts(bag)
    assert found[0] == written[0]
    assert found[-1] == written[-1]
    assert written[50] not in found


def test_a_damaged_message_of_a_database_is_left_out(tmp_path: Path) -> None:
    """Its content is on pages of its own."""
    path, written = large_database(tmp_path / "bag", 20_000)
    data = bytearray(path.read_bytes())
    page = int.from_bytes(data[16:18], "big")
    first = data.index(b"message 050") // page * page
    # The first page of its content names the next one: let that be none that there is.
    chain = next(
        place
        for place in range(first + page, len(data), page)
        if data[place + 4 : place + page] == b"x" * (page - 4)
    )
    data[chain : chain + 4] = (2**31 - 1).to_bytes(4, "big")
    path.write_bytes(data)
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        with Bag(path) as bag:
            found = texts(bag)
    assert len(found) == len(written) - 1
    assert [text for text in written if text in found] == found
    said = [str(each.message) for each in caught]
    assert any("malformed; 100 messages are not affected" in text for text in said)
    assert any(re.search(r"message 5\d cannot be read: ", text) for text in said), said


def test_a_database_that_computes_its_messages(tmp_path: Path) -> None:
    path = tmp_path / "endless.db3"
    with sqlite3.connect(path) as made:
        made.execute("CREATE TABLE topics (id INTEGER, name TEXT, type TEXT, serialization_format TEXT)")
        made.execute(
            "CREATE VIEW messages AS WITH RECURSIVE n(id) AS (SELECT 1 UNION ALL SELECT id + 1 FROM n) "
            "SELECT id, 1 AS topic_id, id AS timestamp, x'00' AS data FROM n"
        )
    made.close()
    with pytest.raises(BagError, match=r"endless\.db3: this is no bag: it has no table messages"):
        Bag(path)


def test_the_metadata_of_a_folder_names_what_is_not_there(tmp_path: Path) -> None:
    folder = recorded(tmp_path / "run")
    metadata = folder / "metadata.yaml"
    text = metadata.read_text()
    (tmp_path / "secret.mcap").write_bytes((folder / "run_0.mcap").read_bytes())
    for name, says in (
        ("../secret.mcap", "is outside the folder"),
        ("run_1.mcap", "there is no file 'run_1.mcap'"),
    ):
        metadata.write_text(text.replace("run_0.mcap", name))
        with pytest.warns(BagWarning, match=says), Bag(folder) as bag:
            assert len(texts(bag)) == COUNT
    metadata.write_text("a: [")
    with pytest.warns(BagWarning, match="The files of the folder are read without it"), Bag(folder) as bag:
        assert len(texts(bag)) == COUNT


def test_damage_of_any_kind(tmp_path: Path) -> None:
    sound = [recorded(tmp_path / f"{each}.mcap", compression=each) for each in ("zstd", "lz4", "none")]
    sound += [database(tmp_path / "bag"), by_the_library(tmp_path / "chunks.mcap")]
    sound += [by_the_library(tmp_path / "plain.mcap", use_chunking=False)]
    readable, longest = run(sound, tmp_path, range(400))
    assert readable > 100
    assert longest < 20.0
