"""Bags with cuts and flipped bits: every message that is read is one that was written, or the damage is said."""

from __future__ import annotations

import random
import re
import warnings
from collections.abc import Iterator
from pathlib import Path
from typing import Any, TypeAlias

import pytest
from ifgen_runtime.bag import Bag, BagError, BagWarning, Definition
from ifgen_runtime.bag.topics import Channel
from ifgen_runtime.bag.writer import BagWriter, Format
from mcap.reader import make_reader
from mcap.writer import CompressionType
from mcap.writer import Writer as McapWriter

Message: TypeAlias = tuple[str, int, bytes]

TOPICS = [
    Channel(name, Definition("std_msgs/msg/String", "", "ros2msg", "string data\n")) for name in ("/a", "/b")
]
SIZES = (5, 40, 900, 4_000, 9_000, 30_000)
"""Bytes of messages: on pages with others, and over several pages."""


def messages(count: int) -> list[Message]:
    chance = random.Random(25)
    # No zeros, which SQLite has in place of bytes that are missing.
    return [
        (
            f"/{'ab'[index % 2]}",
            index,
            bytes(4) + bytes(chance.choices(range(1, 256), k=chance.choice(SIZES))),
        )
        for index in range(count)
    ]


def written(path: Path, format: Format, count: int = 40) -> list[Message]:
    """Write a bag, and return what is in it."""
    found = messages(count)
    with BagWriter(path, format, is_folder=path.suffix == "") as writer:
        for channel in TOPICS:
            writer.add(channel)
        for topic, received, data in found:
            writer.write(TOPICS[topic == "/b"], received, received, data)
    return found


def read(path: Path) -> tuple[list[Message], list[str]]:
    """The messages, and the damage that was said; the error, if nothing can be read."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", BagWarning)
        try:
            with Bag(path) as bag:
                return [(each.topic, each.received, each.data) for each in bag], list(map(str, bag.damage))
        except BagError as error:
            return [], [str(error)]


def require_truth(path: Path, whole: list[Message], place: object) -> None:
    found, damage = read(path)
    if sorted(found) != sorted(whole):
        assert damage, f"{place}: {len(found)} of {len(whole)} messages, without a word"
        if any("not what was recorded" in each for each in damage):
            return  # a database that was compressed as a whole
        assert set(found) <= set(whole), f"{place}: a message that nobody wrote"


def test_databases_that_are_cut_off(tmp_path: Path) -> None:
    """A page that is there in part makes messages of zeros."""
    path = tmp_path / "a.db3"
    whole = written(path, Format("sqlite3"))
    data = path.read_bytes()
    pages = len(data) // 4096
    cuts = {4096 * page + inside for page in range(1, pages) for inside in (0, 3, 100 + 17 * page)}
    for size in sorted(cuts):
        path.write_bytes(data[:size])
        found, damage = read(path)
        assert set(found) <= set(whole), f"cut at {size}: a message that nobody wrote"
        assert damage, f"cut at {size}"
        if said := re.search(r"([\d,]+) messages are not affected", damage[0]):
            assert int(said[1].replace(",", "")) == len(found), f"cut at {size}"


def test_a_row_of_topics_that_is_cut_off(tmp_path: Path) -> None:
    """Definitions that were added late are on late pages."""
    path = tmp_path / "a.db3"
    text = "string data\n" + "# walk\n" * 2_000
    late = Channel("/late", Definition("std_msgs/msg/String", "RIHS01_0", "ros2msg", text))
    with BagWriter(path, Format("sqlite3"), is_folder=False) as writer:
        for topic, received, data in messages(20):
            writer.write(TOPICS[topic == "/b"], received, received, data)
        writer.flush()
        writer.write(late, 99, 99, bytes(9))
    data = path.read_bytes()
    end = data.rindex(b"# walk")
    for size in range(end - 12_000, end, 1_000):
        path.write_bytes(data[:size])
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", BagWarning)
            with Bag(path) as bag:
                assert bag.damage
                texts = {definition.text for topic in bag.topics.values() for definition in topic.definitions}
        assert texts <= {"string data\n", text, ""}, f"cut at {size}"


FORMATS = {
    "a.mcap": Format(),
    "b.mcap": Format(compression="zstd", chunk_size=5_000),
    "folder": Format("sqlite3", outer="message"),
    "whole": Format("sqlite3", outer="file"),
    "chunks": Format("mcap", outer="file", chunk_size=5_000),
}


@pytest.mark.parametrize("name", FORMATS)
def test_flipped_bits_and_cuts(tmp_path: Path, name: str) -> None:
    path = tmp_path / name
    whole = written(path, FORMATS[name], 25)
    assert read(path) == (whole, [])
    files = [path] if path.is_file() else sorted(path.iterdir())
    chance = random.Random(name)
    for file in files:
        data = file.read_bytes()
        is_database = file.suffix == ".db3"
        for place in chance.sample(range(len(data)), min(len(data), 25)):
            changed = bytearray(data)
            changed[place] ^= 1 << chance.randrange(8)
            if not is_database:  # its pages have no checksums; that of each message is checked below
                file.write_bytes(changed)
                require_truth(path, whole, f"{file.name}, bit at {place}")
            file.write_bytes(data[:place])
            require_truth(path, whole, f"{file.name}, cut at {place}")
        file.write_bytes(data)


def test_compressed_messages_have_checksums(tmp_path: Path) -> None:
    path = tmp_path / "bag"
    whole = written(path, FORMATS["folder"], 25)
    (file,) = path.glob("*.db3")
    data, chance = file.read_bytes(), random.Random(3)
    for _ in range(20):
        changed = bytearray(data)
        topic, received, content = chance.choice(whole[4:])
        at = data.find(content[-60:-40])
        if at < 0:
            continue
        changed[at + chance.randrange(20)] ^= 1 << chance.randrange(8)
        file.write_bytes(changed)
        require_truth(path, whole, f"{topic}, {received}")


def test_messages_that_are_compressed_without_metadata(tmp_path: Path) -> None:
    """As after a crash."""
    path = tmp_path / "bag"
    whole = written(path, FORMATS["folder"], 5)
    (path / "metadata.yaml").unlink()
    assert read(path) == (whole, [])


def by_the_library(path: Path, **options: Any) -> None:
    """A file of the library mcap."""
    writer = McapWriter(str(path), 300, CompressionType.NONE, **options)
    writer.start("ros2", "a test")
    schema = writer.register_schema("std_msgs/String", "ros2msg", b"string data\n")
    channel = writer.register_channel("/log", "cdr", schema)
    for index in range(30):
        writer.add_message(channel, index, b"\0\1\0\0\2\0\0\0a\0", index)
    writer.add_attachment(1, 2, "map.png", "image/png", b"a map of the house")
    writer.finish()


def variants() -> Iterator[dict[str, Any]]:
    yield {"use_chunking": False, "enable_data_crcs": True}
    yield {"enable_crcs": False, "enable_data_crcs": True}
    yield {"repeat_schemas": False}
    yield {"repeat_schemas": False, "repeat_channels": False}
    yield {"use_statistics": False}


@pytest.mark.parametrize("options", [*variants()], ids=str)
def test_files_of_the_library(tmp_path: Path, options: dict[str, Any]) -> None:
    path = tmp_path / "a.mcap"
    by_the_library(path, **options)
    with Bag(path, strict=True) as bag:
        assert [message.data for message in bag["/log"]] == ["a"] * 30
        (definition,) = bag.topics["/log"].definitions
        assert (definition.type_name, definition.text) == ("std_msgs/msg/String", "string data\n")
        assert bag.attachments == 1
    data = path.read_bytes()
    attachment = data.index(b"a map of")
    path.write_bytes(data[:attachment] + b"A" + data[attachment + 1 :])
    said = "map.png' does not fit its content" if options.get("enable_crcs", True) else "checksum of the data"
    assert any(said in each for each in read(path)[1])
    if "enable_data_crcs" in options:
        message = data.rindex(b"\2\0\0\0a\0")
        path.write_bytes(data[: message + 4] + b"b" + data[message + 5 :])
        assert any("the checksum of the data does not fit" in each for each in read(path)[1])
        with (
            Bag(path, strict=True) as bag,
            pytest.raises(BagError, match="the checksum of the data does not"),
        ):
            list(bag)


def test_a_definition_that_is_nowhere(tmp_path: Path) -> None:
    path = tmp_path / "a.mcap"
    writer = McapWriter(str(path), use_chunking=False)
    writer.start("ros2", "a test")
    channel = writer.register_channel("/log", "cdr", 7)
    writer.add_message(channel, 1, b"\0\1\0\0\2\0\0\0a\0", 1)
    writer.finish()
    assert any("the definition of the messages of /log is not in the file" in each for each in read(path)[1])


def test_messages_without_a_definition_stay_so(tmp_path: Path) -> None:
    path = tmp_path / "a.mcap"
    writer = McapWriter(str(path))
    writer.start("ros2", "a test")
    writer.add_message(writer.register_channel("/log", "json", 0), 1, b"{}", 1)
    writer.finish()
    with Bag(path, strict=True) as bag, BagWriter(tmp_path / "b.mcap", Format(), is_folder=False) as copy:
        for received, published, channel, data in bag.entries():
            copy.write(channel, received, published, data)
    with (tmp_path / "b.mcap").open("rb") as file:
        summary = make_reader(file).get_summary()
    assert summary is not None
    assert summary.schemas == {}
    assert [(channel.schema_id, channel.message_encoding) for channel in summary.channels.values()] == [
        (0, "json")
    ]


def test_bytes_of_definitions_are_copied(tmp_path: Path) -> None:
    """Those of other encodings are no text."""
    path, text = tmp_path / "a.mcap", bytes(range(256))
    writer = McapWriter(str(path))
    writer.start("", "a test")
    writer.add_message(
        writer.register_channel("/a", "protobuf", writer.register_schema("a.B", "protobuf", text)), 1, b"", 1
    )
    writer.finish()
    with Bag(path, strict=True) as bag:
        (channel,) = bag.channels
        with BagWriter(tmp_path / "b.mcap", Format(), is_folder=False) as copy:
            copy.add(channel)
        with pytest.raises(BagError, match="a database has no room for bytes that are no text"):
            BagWriter(tmp_path / "b.db3", Format("sqlite3"), is_folder=False).add(channel)
    with (tmp_path / "b.mcap").open("rb") as file:
        summary = make_reader(file).get_summary()
    assert summary is not None
    assert [schema.data for schema in summary.schemas.values()] == [text]


def test_two_definitions_without_hashes_are_not_made_one(tmp_path: Path) -> None:
    definitions = [Definition("a/msg/B", "", "ros2msg", f"uint{size} data\n") for size in (8, 16)]
    with (
        pytest.raises(BagError, match="room for one definition of a/msg/B without a hash, and there are two"),
        BagWriter(tmp_path / "a.db3", Format("sqlite3"), is_folder=False) as writer,
    ):
        for index, definition in enumerate(definitions):
            writer.add(Channel(f"/{index}", definition))
    hashed = [Definition("a/msg/B", f"RIHS01_{size}", "ros2msg", f"uint{size} data\n") for size in (8, 16)]
    with BagWriter(tmp_path / "b.db3", Format("sqlite3"), is_folder=False) as writer:
        for index, definition in enumerate(hashed):
            writer.add(Channel(f"/{index}", definition))
    with Bag(tmp_path / "b.db3", strict=True) as bag:
        assert [channel.definition for channel in bag.channels] == hashed
