"""`ifgen bag info`."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from tests.cli.conftest import Run


@pytest.fixture(autouse=True)
def utc(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("time.localtime", __import__("time").gmtime)


def test_what_is_in_a_bag(ifgen: Run, drive: Path) -> None:
    lines = ifgen("bag", "info", "drive").out.splitlines()
    size = (drive / "drive_0.mcap").stat().st_size / 1024
    assert lines == [
        "",
        "Files:             drive_0.mcap",
        f"Bag size:          {size:.1f} KiB",
        "Storage id:        mcap",
        "ROS Distro:        unknown",
        "Duration:          1.900000000s",
        "Start:             Nov 14 2023 22:13:20.000000000 (1700000000.000000000)",
        "End:               Nov 14 2023 22:13:21.900000000 (1700000001.900000000)",
        "Messages:          21",
        "Topic information: Topic: /mode | Type: std_msgs/msg/String | Count: 1 | Serialization Format: cdr",
        "                   Topic: /position | Type: geometry_msgs/msg/Point | Count: 20 | Serialization Format: cdr",
        "Service:           0",
        "Service information:",
    ]


def test_names_of_topics(ifgen: Run, drive: Path) -> None:
    assert ifgen("bag", "info", "drive", "-t").out == "/mode\n/position\n"


def test_json(ifgen: Run, drive: Path) -> None:
    found = json.loads(ifgen("bag", "info", "drive", "--json").out)
    assert (found["messages"], found["storage"], found["damage"]) == (21, "mcap", [])
    mode, position = found["topics"]
    assert (mode["name"], mode["type"], mode["count"]) == ("/mode", "std_msgs/msg/String", 1)
    assert mode["qos"][0]["durability"] == "transient_local"
    assert position["hashes"][0].startswith("RIHS01_")


def test_no_bag(ifgen: Run, tmp_path: Path) -> None:
    outcome = ifgen("bag", "info", "nowhere")
    help = "name a .mcap or .db3 file, or a folder that `bag record` made"
    said = f"error: nowhere: there is no such file or folder\n  = help: {help}\n"
    assert (outcome.code, outcome.err) == (1, said)
    (tmp_path / "empty").mkdir()
    assert "there is no .mcap and no .db3 file in the folder" in ifgen("bag", "info", "empty").err


def test_what_is_cut_off_is_read_up_to_there(ifgen: Run, drive: Path) -> None:
    file = drive / "drive_0.mcap"
    file.write_bytes(file.read_bytes()[:-100])
    outcome = ifgen("bag", "info", "drive")
    assert outcome.code == 0
    assert "Count: 20" in outcome.out
    assert outcome.err.startswith("warning: drive/drive_0.mcap: damaged at byte ")
