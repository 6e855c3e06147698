"""Each thing that may be wrong with a recording has its sentence. Most files here are put together byte by byte."""

from __future__ import annotations

import os
import re
import sqlite3
import warnings
import zlib
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from ifgen_runtime.bag import Bag, BagError, BagWarning, Recorder, compression
from ifgen_runtime.bag.compression import Undecodable, decompress
from ifgen_runtime.bag.mcap import layout as mcap_layout
from ifgen_runtime.bag.mcap.writer import McapWriter

MAGIC = b"\x89MCAP0\r\n"
HEADER, FOOTER, SCHEMA, CHANNEL, MESSAGE, CHUNK, CHUNK_INDEX, DATA_END = 1, 2, 3, 4, 5, 6, 8, 15


def record(opcode: int, content: bytes) -> bytes:
    return bytes([opcode]) + len(content).to_bytes(8, "little") + content


def text(word: str) -> bytes:
    return len(word).to_bytes(4, "little") + word.encode()


def numbers(*pairs: tuple[int, int]) -> bytes:
    return b"".join(value.to_bytes(size, "little") for value, size in pairs)


DEFINITION = record(
    SCHEMA, numbers((1, 2)) + text("std_msgs/msg/String") + text("ros2msg") + text("string data")
)
LOG = record(CHANNEL, numbers((0, 2), (1, 2)) + text("/log") + text("cdr") + text(""))
HELLO = record(MESSAGE, numbers((0, 2), (0, 4), (5, 8), (5, 8)) + b"\0\1\0\0\2\0\0\0a\0")


def chunk(
    content: bytes, size: int | None = None, compressed: str = "", data_size: int | None = None
) -> bytes:
    about = numbers((5, 8), (5, 8), (len(content) if size is None else size, 8), (0, 4)) + text(compressed)
    return record(
        CHUNK, about + (len(content) if data_size is None else data_size).to_bytes(8, "little") + content
    )


def without_summary(*records: bytes) -> bytes:
    end = record(DATA_END, bytes(4)) + record(FOOTER, bytes(20)) + MAGIC
    return MAGIC + record(HEADER, text("ros2") + text("a test")) + b"".join(records) + end


def said_of(path: Path, data: bytes) -> list[str]:
    """The warnings that come while a file is read as far as it can be."""
    path.write_bytes(data)
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        with Bag(path) as bag:
            list(bag)
    return [str(warning.message).removeprefix(f"{path}: ") for warning in caught]


@pytest.mark.parametrize(
    ("records", "said"),
    [
        ([record(SCHEMA, bytes(10))], "a schema has the number 0; 0 messages are before it"),
        ([DEFINITION, LOG, HELLO, record(CHANNEL, b"\1")], "a field reaches beyond the end of its record; 1 messages"),
        ([DEFINITION, LOG, record(MESSAGE, bytes(5))], "a message is shorter than it can be; 0 messages"),
        ([DEFINITION, LOG, chunk(record(MESSAGE, bytes(5)))], "a message is shorter than it can be; 0 messages"),
        ([chunk(b"\3\1")], "the head of a record reaches beyond the end; 0 messages"),
        ([chunk(record(SCHEMA, bytes(30))[:-1])], "a record reaches beyond the end; 0 messages"),
        ([chunk(HELLO, data_size=10**6)], "the data of a chunk reaches beyond its end; 0 messages"),
        ([chunk(HELLO, compressed="zip")], "it is compressed with 'zip', and ifgen knows zstd and lz4; 0 messages"),
        ([chunk(HELLO, size=7)], f"it holds {len(HELLO)} bytes, and says that it holds 7; 0 messages"),
        ([chunk(HELLO, size=2**40, compressed="zstd")], "its 1,099,511,627,776 bytes are more than the 2,147,483,648"),
        ([b"\3" + (10**6).to_bytes(8, "little")], "a record of 1,000,000 bytes reaches beyond the end of the file"),
    ],
    ids=range(11),
)  # fmt: skip
def test_records(tmp_path: Path, records: list[bytes], said: str) -> None:
    (found,) = said_of(tmp_path / "a.mcap", without_summary(*records))
    assert re.match(r"damaged at byte \d+: ", found)
    assert said in found


def test_a_file_that_ends_within_the_head_of_a_record(tmp_path: Path) -> None:
    (found,) = said_of(tmp_path / "a.mcap", MAGIC + b"\3\1\0")
    assert found == "damaged at byte 8: a record reaches beyond the end of the file; 0 messages are before it"


@pytest.fixture
def sound(tmp_path: Path) -> bytes:
    """A file with a summary: two chunks of a message each."""
    from std_msgs.msg import String

    path = tmp_path / "sound.mcap"
    with Recorder(path, chunk_size=1, compression="none") as recorder:
        for index in range(2):
            recorder.write("/log", String(data=f"message {index}"), index)
    return path.read_bytes()


TAIL = 9 + 20 + 8
"""Bytes of a footer and of the magic at the end."""


def footer(data: bytes) -> tuple[int, int, int]:
    at = len(data) - TAIL + 9
    return tuple(int.from_bytes(data[at + a : at + b], "little") for a, b in ((0, 8), (8, 16), (16, 20)))  # type: ignore[return-value]


def resummed(data: bytes, change: Callable[[bytearray], None]) -> bytes:
    """The file with another summary, whose checksum fits."""
    begin, offsets, _ = footer(data)
    summary = bytearray(data[begin : len(data) - TAIL])
    change(summary)
    head = record(FOOTER, numbers((begin, 8), (offsets, 8), (0, 4)))[:-4]
    crc = zlib.crc32(head, zlib.crc32(summary))
    return data[:begin] + bytes(summary) + head + crc.to_bytes(4, "little") + MAGIC


def set_at(data: bytes, place: int, value: bytes) -> bytes:
    return data[:place] + value + data[place + len(value) :]


def test_summaries(tmp_path: Path, sound: bytes) -> None:
    """All messages are read without it."""
    path, begin = tmp_path / "a.mcap", footer(sound)[0]
    index = sound.index(bytes([CHUNK_INDEX]), begin)

    def said(data: bytes) -> str:
        found = said_of(path, data)
        with warnings.catch_warnings(action="ignore"), Bag(path) as bag:
            assert [message.data for message in bag["/log"]] == ["message 0", "message 1"]
        return found[0].partition(": ")[2].removesuffix("; 2 messages are before it")

    assert said_of(path, sound) == []
    assert said(set_at(sound, len(sound) - TAIL, b"\1")) == "the footer is not where it should be"
    far = set_at(sound, len(sound) - TAIL + 9, (10**9).to_bytes(8, "little"))
    assert said(far) == "the summary is not where the footer says"
    assert said(set_at(sound, begin + 20, b"?")) == "the checksum of the summary does not fit its content"

    def nowhere(summary: bytearray) -> None:
        place = index - begin + 9 + 16
        summary[place : place + 8] = (3).to_bytes(8, "little")

    assert said(resummed(sound, nowhere)) == "the summary says that a chunk is where none can be"

    def too_long(summary: bytearray) -> None:
        summary[1:9] = (10**6).to_bytes(8, "little")

    assert said(resummed(sound, too_long)) == "a record reaches beyond the end"

    def torn(summary: bytearray) -> None:
        summary += b"\x0b\1"

    assert said(resummed(sound, torn)) == "the head of a record reaches beyond the end"


def test_chunks_that_the_summary_has(tmp_path: Path, sound: bytes) -> None:
    path = tmp_path / "a.mcap"
    first = next(
        place
        for place in range(8, len(sound))
        if sound[place] == CHUNK and sound[place + 9 : place + 25] == bytes(16)
    )
    lost = "; the messages of this part are lost"
    assert said_of(path, set_at(sound, first, b"\x7f")) == [
        f"damaged at byte {first}: there is no chunk where the summary says{lost}"
    ]
    content = sound.index(b"\5", sound.index(b"string data"))
    assert said_of(path, set_at(sound, content + 1, b"\xff")) == [
        f"damaged at byte {first}: the checksum of a chunk does not fit its content{lost}"
    ]
    unchecked = set_at(set_at(sound, first + 9 + 24, bytes(4)), content + 1, b"\xff")
    (found,) = said_of(path, unchecked)
    assert re.fullmatch(
        rf"damaged at byte {first}: byte \d+ of a chunk's content is not what the format says", found
    )


def test_files_that_change_while_they_are_read(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """They are larger than what is read ahead."""
    from std_msgs.msg import String

    path = tmp_path / "large.mcap"
    with Recorder(path, compression="none") as recorder:
        recorder.write("/log", String(data="walk" * 10_000), 1)
    whole = path.read_bytes()
    with (
        Bag(path) as bag,
        pytest.warns(BagWarning, match="the file has become shorter; the messages of this"),
    ):
        os.truncate(path, 40)
        assert list(bag) == []
    path.write_bytes(whole)
    says = "a record of [0-9,]+ bytes is larger than the 100 that ifgen reads at once"
    with Bag(path) as bag, monkeypatch.context() as patched, pytest.warns(BagWarning, match=says):
        patched.setattr(mcap_layout, "LARGEST", 100)
        assert list(bag) == []
    with Bag(path) as bag, pytest.warns(BagWarning, match="the file cannot be read: Input/output error"):
        source: Any = bag._store.recording.sources[0]
        source._file.file.close()
        monkeypatch.setattr(source._file, "file", Broken())
        assert list(bag) == []


class Broken:
    """A file on a disk that fails."""

    def seek(self, _: int) -> None:
        raise OSError(5, "Input/output error")

    def close(self) -> None:
        """Nothing to close."""


def test_what_cannot_be_opened(tmp_path: Path, sound: bytes, monkeypatch: pytest.MonkeyPatch) -> None:
    database = tmp_path / "a.db3"
    database.write_bytes(b"SQLite format 3\0" + bytes(200))
    (tmp_path / "notes.txt").write_text("walk")
    with pytest.raises(
        BagError, match=r"notes\.txt: this is no bag: a \.mcap or \.db3 file, or a folder with them"
    ):
        Bag(tmp_path / "notes.txt")
    (tmp_path / "a.mcap.zstd").write_bytes(b"walk")
    with pytest.raises(BagError, match=r"a\.mcap\.zstd: this is no file compressed with zstd: "):
        Bag(tmp_path / "a.mcap.zstd")
    whole, opened = Path.open, set[Path]()

    def second(self: Path, *arguments: Any, **options: Any) -> Any:
        if self in opened:
            raise PermissionError(13, "Permission denied")
        opened.add(self)
        return whole(self, *arguments, **options)

    monkeypatch.setattr(Path, "open", second)  # the first look is at what kind of file it is
    for path in (tmp_path / "sound.mcap", database):
        with pytest.raises(BagError, match=rf"{path.name}: cannot be opened: Permission denied"):
            Bag(path)


def test_one_bad_file_of_a_folder_is_left_out(tmp_path: Path, sound: bytes) -> None:
    folder = tmp_path / "bag"
    folder.mkdir()
    (folder / "bag_0.mcap").write_bytes(sound)
    (folder / "bag_1.mcap").write_bytes(b"walk")
    says = r"bag_1\.mcap: damaged: the file is left out: .*bag_1\.mcap: this is no MCAP file"
    with pytest.warns(BagWarning, match=says), Bag(folder) as bag:
        assert len(list(bag)) == 2


def test_databases_of_others(tmp_path: Path) -> None:
    path = tmp_path / "a.db3"

    def made(topics: str, row: str) -> None:
        path.unlink(missing_ok=True)
        with sqlite3.connect(path) as database:
            database.execute(f"CREATE TABLE topics ({topics})")
            database.execute("CREATE TABLE messages (id INTEGER PRIMARY KEY, topic_id, timestamp, data)")
            if row:
                database.execute("INSERT INTO topics VALUES (1, '/log', 'std_msgs/msg/String', 'cdr')")
                database.execute(f"INSERT INTO messages VALUES ({row})")
                database.execute("INSERT INTO messages VALUES (2, 1, 5, x'00010000020000006100')")
        database.close()

    made("id, word", "")
    with pytest.raises(BagError, match=r"a\.db3: this is no bag: its table of topics has other columns"):
        Bag(path)
    made("id, name, type, serialization_format, more AS (hex(zeroblob(9)))", "")
    with pytest.raises(BagError, match=r"a\.db3: this is no bag: columns of its table topics are computed"):
        Bag(path)
    for row in ("1, 1, 'noon', x'00'", "1, 1, 4, NULL"):
        made("id, name, type, serialization_format", row)
        with pytest.warns(BagWarning, match="message 1 has no time, or no content"), Bag(path) as bag:
            assert [message.data for message in bag["/log"]] == ["a"]


@pytest.mark.parametrize(
    ("kind", "data", "size", "said"),
    [
        ("", b"abc", 2, "it holds 3 bytes, and says that it holds 2"),
        (
            "",
            b"abc",
            2**40,
            "its 1,099,511,627,776 bytes are more than the 2,147,483,648 that ifgen reads at once",
        ),
        ("gzip", b"abc", None, "it is compressed with 'gzip', and ifgen knows zstd and lz4"),
        ("zstd", b"abc", None, "zstd: "),
        ("zstd", "5", 9, "it holds 5 bytes, and says that it holds 9"),
        ("zstd", "stream", 9, "it holds more than 9 bytes"),
        ("lz4", b"abc", None, "lz4: "),
        ("lz4", "cut", None, "lz4: it ends too early"),
    ],
)
def test_compression(kind: str, data: bytes | str, size: int | None, said: str) -> None:
    if isinstance(data, str):
        data = compressed(data)
    with pytest.raises(Undecodable, match=re.escape(said)):
        decompress(kind, data, size)


def compressed(how: str) -> bytes:
    import lz4.frame
    import zstandard

    if how == "cut":
        return lz4.frame.compress(b"walk" * 100)[:-20]  # type: ignore[no-any-return]
    if how == "stream":  # does not say how long it is
        stream = zstandard.ZstdCompressor(write_content_size=False).compressobj()
        return bytes(stream.compress(b"walk" * 100) + stream.flush())
    return bytes(zstandard.ZstdCompressor().compress(b"walks"))


def test_a_full_folder_for_temporary_files(
    tmp_path: Path, sound: bytes, monkeypatch: pytest.MonkeyPatch
) -> None:
    import zstandard

    path = tmp_path / "a.mcap.zstd"
    path.write_bytes(zstandard.ZstdCompressor().compress(sound))

    def full(*_: Any) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(zstandard, "ZstdDecompressor", type("Full", (), {"read_to_iter": full}))
    monkeypatch.setattr(compression.tempfile, "tempdir", str(tmp_path))
    says = (
        rf"a\.mcap\.zstd: cannot be decompressed into {tmp_path}, which has [\d,]+ bytes free: No space left"
    )
    with pytest.raises(BagError, match=says):
        Bag(path)
    assert list(tmp_path.glob("ifgen-bag-*")) == []


def test_a_file_has_room_for_so_many_topics(tmp_path: Path) -> None:
    writer = McapWriter(tmp_path / "a.mcap", "none", 2**20, 1.0)
    for _ in range(65_535):
        writer.add_schema("a/msg/B", "ros2msg", "")
    with pytest.raises(BagError, match="an MCAP file has room for 65,535 definitions"):
        writer.add_schema("a/msg/B", "ros2msg", "")
    for _ in range(65_536):
        writer.add_channel(1, "/a", "cdr", {})
    with pytest.raises(BagError, match="an MCAP file has room for 65,536 channels"):
        writer.add_channel(1, "/a", "cdr", {})
    writer.close()


def test_places_where_nothing_can_be_written(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "file").touch()
    with pytest.raises(BagError, match=r"a\.mcap: cannot be written: Not a directory"):
        Recorder(tmp_path / "file/a.mcap")
    with pytest.raises(BagError, match="bag: the folder cannot be made: Not a directory"):
        Recorder(tmp_path / "file/bag")

    def refuse(*_: Any) -> None:
        raise PermissionError(13, "Permission denied")

    recorder = Recorder(tmp_path / "bag")
    with monkeypatch.context() as patched:
        patched.setattr(Path, "replace", refuse)
        with pytest.raises(BagError, match=r"metadata\.yaml: cannot be written: Permission denied"):
            recorder.close()
    with monkeypatch.context() as patched:
        patched.setattr(Path, "unlink", refuse)
        with pytest.raises(BagError, match="file: cannot be overwritten: Permission denied"):
            Recorder(tmp_path / "file", overwrite=True)


STEERING = "\x1b]0;owned\x07\x9b31m\N{RIGHT-TO-LEFT OVERRIDE}"


@pytest.mark.parametrize("strict", [False, True])
def test_a_file_does_not_steer_the_terminal_of_a_script(tmp_path: Path, strict: bool) -> None:
    """What a script prints of a warning, an error or the list of damage has nothing of the file that could."""
    path = tmp_path / "drive.mcap"
    topic = f"/{STEERING}".encode()
    names = len(topic).to_bytes(4, "little") + topic + text("cdr") + text("")
    log = record(CHANNEL, numbers((0, 2), (1, 2)) + names)
    short = record(MESSAGE, numbers((0, 2), (0, 4), (5, 8), (5, 8)) + b"\0\1\0\0\2\0\0\0")
    path.write_bytes(without_summary(DEFINITION, log, short))
    said: list[object] = []
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        try:
            with Bag(path, strict=strict) as bag:
                list(bag[topic.decode()])
                said += [*bag.damage, *(each.text for each in bag.damage)]
        except BagError as error:
            said.append(error)
    said += [warning.message for warning in caught]
    assert len(said) == (1 if strict else 3)
    for each in map(str, said):
        assert "owned" in each
        assert each.isprintable()


def test_lines_of_an_error_stay_lines() -> None:
    assert str(BagError("two\x1b\nlines")) == "two?\nlines"
    assert issubclass(BagWarning, UserWarning)
