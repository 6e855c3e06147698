"""`ifgen bag convert`, `cut`, `check` and `migrate`: the bag that was read stays as it was."""

from __future__ import annotations

import errno
import sys
import textwrap
from pathlib import Path
from typing import Any

import pytest
from ifgen.dynamic import class_from_text
from ifgen_runtime import adapters
from ifgen_runtime.bag import Bag, Recorder
from ifgen_runtime.bag.writer import BagWriter
from mcap.writer import Writer as McapWriter

from tests.cli.conftest import Run

OLD = "float64 voltage\nfloat32 charge\nuint8 status\n"
SAME = "float64 voltage\nfloat64 charge\nuint8 status\nfloat64[] cells\n"
LESS = "float64 voltage\nfloat32 charge\nint32 cycles\n"


def contents(path: Path | str) -> list[Any]:
    with Bag(path, strict=True) as bag:
        return [(recorded.topic, recorded.received, recorded.data) for recorded in bag]


@pytest.mark.parametrize(
    ("output", "options"),
    [
        ("copy.db3", []),
        ("copy.mcap", ["--compression-format", "zstd"]),
        ("copy", ["-s", "sqlite3", "--compression-mode", "message", "--compression-format", "zstd"]),
        ("copy", ["-s", "sqlite3", "--compression-mode", "file", "--compression-format", "zstd"]),
        ("copy", ["-b", "100"]),
    ],
    ids=range(5),
)
def test_formats(ifgen: Run, drive: Path, output: str, options: list[str]) -> None:
    before = contents(drive)
    assert ifgen("bag", "convert", drive, "-o", output, *options).out == f"wrote {output}: 21 messages\n"
    with Bag(output, strict=True) as copy, Bag(drive) as bag:
        assert copy.topics["/mode"].qos == bag.topics["/mode"].qos
        assert copy.topics["/mode"].type_hash == bag.topics["/mode"].type_hash
        assert [recorded.message for recorded in copy] == [recorded.message for recorded in bag]
    back = ifgen("bag", "convert", output, "-o", "back.mcap")
    assert back.code == 0, back.err
    assert contents("back.mcap") == before == contents(drive)


@pytest.mark.parametrize(
    ("options", "first", "count"),
    [
        (["--start", "0.5", "--end", "1.0"], 5, 5),
        (["--start", "-0.3"], 16, 4),
        (["--end", "@1700000000.2", "--topics", "/position"], 0, 2),
    ],
    ids=range(3),
)
def test_cuts(ifgen: Run, drive: Path, options: list[str], first: int, count: int) -> None:
    assert ifgen("bag", "cut", drive, "-o", "part.mcap", *options).code == 0
    with Bag("part.mcap", strict=True) as bag:
        assert [point.x for point in bag["/position"]] == [0.1 * i for i in range(first, first + count)]


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["cut", "drive", "-o", "a.mcap", "--start", "noon"], "--start 'noon' is no time"),
        (["cut", "drive", "-o", "a.mcap", "--topics", "/none"], "nothing of drive is chosen"),
        (["cut", "drive", "-o", "drive"], "drive exists already"),
        (["convert", "drive"], "missing option '-o'"),
        (["convert", "nowhere", "-o", "a.mcap"], "nowhere: there is no such file or folder"),
        (
            ["convert", "drive", "-o", "a.db3", "--compression-mode", "file", "--compression-format", "zstd"],
            "a.db3 is a single file, and cannot be compressed as a whole",
        ),
    ],
    ids=range(6),
)
def test_mistakes(ifgen: Run, drive: Path, tmp_path: Path, arguments: list[str], said: str) -> None:
    outcome = ifgen("bag", *arguments)
    assert outcome.code in {1, 2}
    assert said in " ".join(outcome.err.split())
    assert sorted(path.name for path in tmp_path.iterdir()) == ["drive"]


def test_a_full_disk_leaves_nothing(
    ifgen: Run, drive: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def refuse(*_: Any) -> None:
        raise OSError(errno.ENOSPC, "No space left on device")

    monkeypatch.setattr(BagWriter, "write", refuse)
    outcome = ifgen("bag", "convert", drive, "-o", "copy")
    help = "make room, or name a place on another disk with -o"
    assert outcome.err == f"error: copy cannot be written: the disk is full\n  = help: {help}\n"
    assert [path.name for path in tmp_path.iterdir()] == ["drive"]


def test_a_whole_bag(ifgen: Run, drive: Path) -> None:
    outcome = ifgen("bag", "check", drive, "--transport", "local")
    assert (outcome.code, outcome.out) == (0, f"{drive} is whole: 21 messages of 2 topics\n")


def test_a_damaged_bag(ifgen: Run, drive: Path) -> None:
    file = drive / "drive_0.mcap"
    file.write_bytes(file.read_bytes()[:-100])
    outcome = ifgen("bag", "check", drive, "--transport", "local")
    assert outcome.code == 1
    assert "damaged at byte" in outcome.err


@pytest.fixture
def battery(tmp_path: Path) -> Path:
    """A bag of the old definition, and folders with later ones."""
    cls = class_from_text("robot_msgs/msg/Battery", OLD)
    path = tmp_path / "old.mcap"
    with Recorder(path) as recorder:
        for index in range(3):
            recorder.write("/battery", cls(voltage=0.1 * index, charge=0.5, status=2), 1000 + index)
    for name, text in (("same", SAME), ("less", LESS)):
        folder = tmp_path / name / "robot_msgs/msg"
        folder.mkdir(parents=True)
        (folder / "Battery.msg").write_text(text)
    return path


def migrate(ifgen: Run, *arguments: str | Path) -> Any:
    return ifgen("bag", "migrate", *arguments, "--transport", "local")


def test_compatible_fields_are_converted(ifgen: Run, battery: Path, tmp_path: Path) -> None:
    before = battery.read_bytes()
    outcome = migrate(ifgen, battery, "-o", "new.mcap", "--to", tmp_path / "same")
    assert outcome.out == "wrote new.mcap: 3 messages, 1 of 1 types converted\n", outcome.err
    with Bag("new.mcap", strict=True) as bag:
        messages = list(bag["/battery"])
    assert [message.voltage for message in messages] == [0.0, 0.1, 0.2]
    assert {(message.charge, message.status, len(message.cells)) for message in messages} == {(0.5, 2, 0)}
    assert battery.read_bytes() == before


def test_definitions_in_definitions(ifgen: Run, tmp_path: Path) -> None:
    """Texts that follow each other in a bag are those of the messages that a message has."""
    others = {"robot_msgs/msg/Cell": "float32 voltage\n"}
    text = "std_msgs/Header header\nCell[] cells\n"
    cls = class_from_text("robot_msgs/msg/Pack", text, others=others)
    (cell,) = (each for each in cls.__nested__ if each.__name__ == "Cell")
    with Recorder("old.mcap") as recorder:
        recorder.write("/pack", cls(cells=[cell(voltage=0.5)]))
    folder = tmp_path / "new/robot_msgs/msg"
    folder.mkdir(parents=True)
    (folder / "Cell.msg").write_text("float64 voltage\n")
    (folder / "Pack.msg").write_text("Cell[] cells\nstd_msgs/Header header\n")
    outcome = migrate(ifgen, "old.mcap", "-o", "new.mcap", "--to", tmp_path / "new")
    assert outcome.out == "wrote new.mcap: 1 message, 1 of 1 types converted\n", outcome.err
    with Bag("new.mcap", strict=True) as bag:
        (pack,) = bag["/pack"]
    assert [cell.voltage for cell in pack.cells] == [0.5]


def test_what_would_be_lost(ifgen: Run, battery: Path, tmp_path: Path) -> None:
    said = [
        "robot_msgs/msg/Battery: field by field",
        "  robot_msgs/msg/Battery.status: lost: the new definition has no such field",
        "  robot_msgs/msg/Battery.cycles: left at its default: `cycles` is new, and has no default",
    ]
    checked = migrate(ifgen, battery, "--check", "--to", tmp_path / "less")
    assert (checked.code, checked.out.splitlines()) == (1, said)
    refused = migrate(ifgen, battery, "-o", "new.mcap", "--to", tmp_path / "less")
    assert refused.code == 1
    assert refused.err.startswith("error: 2 fields would be lost or left at their defaults\n")
    assert not (tmp_path / "new.mcap").exists()
    assert migrate(ifgen, battery, "-o", "new.mcap", "--to", tmp_path / "less", "--lossy").code == 0
    with Bag("new.mcap", strict=True) as bag:
        assert [(m.voltage, m.cycles) for m in bag["/battery"]] == [(0.0, 0), (0.1, 0), (0.2, 0)]


def test_there_is_no_place(ifgen: Run, battery: Path, tmp_path: Path) -> None:
    refused = migrate(ifgen, battery, "--to", tmp_path / "same")
    assert (refused.code, refused.err) == (
        1,
        "error: there is no place to write to\n  = help: name one with -o, or use --check\n",
    )


def test_a_definition_that_nobody_understands(ifgen: Run, tmp_path: Path) -> None:
    writer = McapWriter(str(tmp_path / "old.mcap"))
    writer.start("ros2", "a test")
    schema = writer.register_schema("std_msgs/msg/String", "ros2msg", b"")
    channel = writer.register_channel("/a", "cdr", schema, {"topic_type_hash": "RIHS01_" + 64 * "5"})
    writer.add_message(channel, 1, b"\0\1\0\0", 1)
    writer.finish()
    refused = migrate(ifgen, "old.mcap", "-o", "new.mcap")
    assert refused.code == 1
    assert refused.err.startswith(
        "error: the bag has no definition of std_msgs/msg/String that can be understood\n"
        "  = help: name adapters that have RIHS01_5555"
    )


def test_references_that_lead_nowhere(ifgen: Run, battery: Path) -> None:
    refused = migrate(ifgen, battery, "--check", "--to", "no_such_revision")
    assert refused.code == 1
    assert "no_such_revision" in refused.err


def test_adapters_that_cannot_be_imported(ifgen: Run, battery: Path) -> None:
    refused = migrate(ifgen, battery, "--check", "--adapters", "no_such_module")
    assert refused.err.startswith("error: the adapters no_such_module cannot be imported: No module named")


def test_what_nobody_knows_stays(ifgen: Run, battery: Path) -> None:
    outcome = migrate(ifgen, battery, "-o", "new.mcap")
    assert outcome.code == 0, outcome.err
    assert contents("new.mcap") == contents(battery)


@pytest.fixture
def texts(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A bag of std_msgs/msg/String with another field, and an adapter that knows what to do with it."""
    cls = class_from_text("std_msgs/msg/String", "string text")
    path = tmp_path / "texts.mcap"
    with Recorder(path) as recorder:
        for index, text in enumerate(("walk", "stop")):
            recorder.write("/mode", cls(text=text), 1000 + index)
    (tmp_path / "of_texts.py").write_text(
        textwrap.dedent("""
            import ifgen.dynamic
            from ifgen_runtime.adapters import Adapter, register
            from std_msgs.msg import String
            Old = ifgen.dynamic.class_from_text("std_msgs/msg/String", "string text")
            register(Adapter(Old, String, lambda old: String(data={"walk": "on", "stop": "off"}[old.text])))
        """)
    )
    monkeypatch.setattr(sys, "path", list(sys.path))
    monkeypatch.setattr(adapters, "_registered", {})
    monkeypatch.delitem(sys.modules, "of_texts", raising=False)
    return path


def test_adapters_convert(ifgen: Run, texts: Path) -> None:
    outcome = migrate(ifgen, texts, "-o", "new.mcap", "--adapters", "of_texts")
    assert outcome.out == "wrote new.mcap: 2 messages, 1 of 1 types converted\n", outcome.err
    with Bag("new.mcap", strict=True) as bag:
        assert [message.data for message in bag["/mode"]] == ["on", "off"]


def test_an_adapter_that_fails(ifgen: Run, texts: Path, tmp_path: Path) -> None:
    module = tmp_path / "of_texts.py"
    module.write_text(module.read_text().replace('"stop": "off"', ""))
    outcome = migrate(ifgen, texts, "-o", "new.mcap", "--adapters", "of_texts")
    assert outcome.code == 1
    assert outcome.err.startswith("error: a message of /mode cannot be converted: KeyError: 'stop'\n")
    assert not (tmp_path / "new.mcap").exists()
