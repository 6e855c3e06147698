"""What users choose on the command line."""

from __future__ import annotations

import re

import pytest
from ifgen_tools.bag.options import Selection

from tests.cli.conftest import Run


@pytest.mark.parametrize(
    ("choice", "expected"),
    [
        (Selection(topics=["imu", "/_secret"]), ["/imu", "/_secret"]),
        (Selection(all_topics=True), ["/imu", "/robot/scan", "/rosout"]),
        (Selection(all_topics=True, include_hidden=True), ["/imu", "/robot/scan", "/rosout", "/_secret"]),
        (Selection(all_topics=True, exclude_topics=["/imu"]), ["/robot/scan", "/rosout"]),
        (Selection(all_topics=True, exclude_types=["rcl_interfaces/msg/Log"]), ["/imu", "/robot/scan"]),
        (Selection(regex=re.compile("scan|/ro")), ["/robot/scan", "/rosout"]),
        (Selection(regex=re.compile("ro"), exclude_regex=re.compile("out$")), ["/robot/scan"]),
        (Selection(types=["sensor_msgs/Imu"]), ["/imu"]),
        (Selection(services=["/add"]), ["/add/_service_event"]),
        (Selection(all_services=True, exclude_services=["add"]), []),
    ],
    ids=range(10),
)
def test_selection(choice: Selection, expected: list[str]) -> None:
    topics = {
        "/imu": "sensor_msgs/msg/Imu",
        "/robot/scan": "sensor_msgs/msg/LaserScan",
        "/rosout": "rcl_interfaces/msg/Log",
        "/_secret": "std_msgs/msg/String",
        "/add/_service_event": "example_interfaces/srv/AddTwoInts_Event",
    }
    assert [topic for topic, type_name in topics.items() if choice.takes(topic, type_name)] == expected


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        ("record", "nothing to record: name topics, or use -a"),
        ("record -a --max-bag-files 3", "--max-bag-files needs --max-bag-size or --max-bag-duration"),
        ("record -a --regex [", "'[' is no regular expression: unterminated character set"),
        ("record -a --compression-mode file", "--compression-mode needs --compression-format"),
        (
            "record -a -s sqlite3 --compression-format zstd",
            "--compression-format needs --compression-mode file or message with sqlite3",
        ),
        (
            "record -a --compression-mode message --compression-format zstd",
            "files are compressed with zstd; messages only in sqlite3 files. In MCAP files, --compression-format alone",
        ),
        ("record -a -o a.mcap -s sqlite3", "a.mcap is the name of a mcap file, and --storage is sqlite3"),
        ("record -a --custom-data colour", "'colour' is no KEY=VALUE"),
        ("record -a -s sqlite3 --storage-preset-profile zstd_fast", "zstd_fast is one of mcap"),
        ("record --topics -a", "option '--topics' requires at least one value"),
        ("play a --rate 0", "0.0 is not in the valid range (> 0.0)"),
        ("play a --remap /a /b", "'/a' is no remapping, such as /old:=/new"),
        (
            "play a --playback-until-sec 1 --playback-until-nsec 1",
            "--playback-until-sec and --playback-until-nsec exclude each other",
        ),
    ],
    ids=range(13),
)
def test_mistakes_on_the_command_line(ifgen: Run, arguments: str, said: str) -> None:
    outcome = ifgen("bag", *arguments.split())
    assert outcome.code == 2
    assert said in " ".join(outcome.err.split())
