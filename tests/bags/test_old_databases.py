"""Databases from before ROS 2 Iron, and what lies beside databases."""

from __future__ import annotations

import sqlite3
from pathlib import Path

import pytest
from ifgen_runtime import serialize
from ifgen_runtime.bag import Bag, BagError, Recorder

HUMBLE_QOS = """- history: 3
  depth: 0
  reliability: 1
  durability: 2
  deadline:
    sec: 9223372036
    nsec: 854775807
  lifespan:
    sec: 9223372036
    nsec: 854775807
  liveliness: 1
  liveliness_lease_duration:
    sec: 9223372036
    nsec: 854775807
  avoid_ros_namespace_conventions: false"""


def humble(path: Path, type_name: str = "std_msgs/msg/String", journal: str = "delete") -> sqlite3.Connection:
    """A database with the tables of Humble, and two messages."""
    from std_msgs.msg import String

    made = sqlite3.connect(path)
    made.execute(f"PRAGMA journal_mode = {journal}")
    made.execute(
        "CREATE TABLE topics(id INTEGER PRIMARY KEY, name TEXT NOT NULL, type TEXT NOT NULL, "
        "serialization_format TEXT NOT NULL, offered_qos_profiles TEXT NOT NULL)"
    )
    made.execute(
        "CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id INTEGER NOT NULL, "
        "timestamp INTEGER NOT NULL, data BLOB NOT NULL)"
    )
    made.execute("INSERT INTO topics VALUES (1, '/log', ?, 'cdr', ?)", (type_name, HUMBLE_QOS))
    for time, text in ((7, "second"), (5, "first")):
        made.execute(
            "INSERT INTO messages(topic_id, timestamp, data) VALUES (1, ?, ?)",
            (time, serialize(String(data=text))),
        )
    made.commit()
    return made


def test_without_definitions_the_installed_class_is_used(tmp_path: Path) -> None:
    from std_msgs.msg import String

    humble(tmp_path / "old.db3").close()
    before = (tmp_path / "old.db3").read_bytes()
    with Bag(tmp_path / "old.db3", strict=True) as bag:
        assert list(bag["/log"]) == [String(data="first"), String(data="second")]
        (qos,) = bag.topics["/log"].qos
        assert (qos.history, qos.reliability, qos.durability, qos.deadline) == (
            "unknown",
            "reliable",
            "volatile",
            None,
        )
    assert (tmp_path / "old.db3").read_bytes() == before
    assert [path.name for path in tmp_path.iterdir()] == ["old.db3"]
    humble(tmp_path / "cows.db3", "farm_msgs/msg/Cow").close()
    with Bag(tmp_path / "cows.db3") as bag, pytest.raises(BagError, match="no installed package has it"):
        list(bag["/log"])


def test_messages_that_are_still_in_the_log_of_a_database(tmp_path: Path) -> None:
    being_written = humble(tmp_path / "live.db3", journal="wal")
    assert (tmp_path / "live.db3-wal").stat().st_size
    with Bag(tmp_path / "live.db3", strict=True) as bag:
        assert [message.data for message in bag["/log"]] == ["first", "second"]
    being_written.close()


def test_files_of_a_folder_whose_times_overlap(tmp_path: Path) -> None:
    from std_msgs.msg import String

    folder = tmp_path / "run"
    folder.mkdir()
    humble(folder / "run_0.db3").close()
    with Recorder(folder / "run_1.mcap") as recorder:
        for time in (4, 6, 8):
            recorder.write("/log", String(data=f"{time}"), received=time)
    with Recorder(folder / "run_2.mcap") as recorder:
        recorder.write("/log", String(data="later"), received=9)
    with Bag(folder, strict=True) as bag:
        assert [message.data for message in bag["/log"]] == ["4", "first", "6", "second", "8", "later"]
        assert (len(bag["/log"]), bag.start, bag.end) == (6, 4, 9)
