"""`ifgen bag info`."""

from __future__ import annotations

import json
import os
import resource
import struct
import time
from pathlib import Path

import pytest
from ifgen_runtime.bag import Definition, Recorder
from ifgen_runtime.bag.mcap.records import HEAD, MAGIC, Opcode
from mcap.writer import Writer as McapWriter

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


def test_requests_and_responses(ifgen: Run) -> None:
    """As rosbag2 counts them: a call is one, whoever tells of it."""
    with Recorder("calls.mcap") as recorder:
        recorder.add_topic("/add/_service_event", Definition("a/srv/Add_Event"))
        for kind, client, number in [
            (0, 1, 1),
            (1, 1, 1),
            (2, 1, 1),
            (3, 1, 1),
            (0, 1, 2),
            (0, 2, 1),
            (2, 2, 1),
        ]:
            event = struct.pack("<4xB3xiI16s4xq", kind, 5, 6, bytes([client]), number)
            recorder.write_serialized("/add/_service_event", event + bytes(8), number)
    line = "Service: /add | Type: a/srv/Add | {} | Serialization Format: cdr\n"
    assert line.format("Event Count: 7") in ifgen("bag", "info", "calls.mcap").out
    assert line.format("Request Count: 3 | Response Count: 2") in ifgen("bag", "info", "calls.mcap", "-v").out


def without_summary(*chunks: tuple[bytes, int]) -> bytes:
    """A file of chunks of these bytes, which say that they unpack to so many."""
    records = [MAGIC, HEAD.pack(Opcode.HEADER, 8), bytes(8)]
    for content, size in chunks:
        head = struct.pack("<QQQII4sQ", 0, 1, size, 0, 4, b"zstd", len(content))
        records += [HEAD.pack(Opcode.CHUNK, len(head) + len(content)), head, content]
    return b"".join(records)


def packed(content: bytes, times: int) -> bytes:
    zstandard = pytest.importorskip("zstandard")
    stream = zstandard.ZstdCompressor().compressobj(size=len(content) * times)
    parts = [stream.compress(content) for _ in range(times)]
    return b"".join([*parts, stream.flush()])


def bomb(name: str) -> None:
    """A small file that unpacks to very much."""
    mega = bytes(2**20)
    path = Path(name)
    if name == "zeros.mcap":
        path.write_bytes(without_summary((packed(mega, 200), 200 * 2**20)))
    elif name == "chunks.mcap":
        path.write_bytes(without_summary(*[(packed(mega, 16), 16 * 2**20)] * 60))
    elif name == "records.mcap":
        tiny = HEAD.pack(0x7E, 0) * (2**20 // 9)
        path.write_bytes(without_summary(*[(packed(tiny, 1), len(tiny))] * 60))
    elif name == "file.db3.zstd":
        path.write_bytes(packed(mega, 200))
    elif name == "types.mcap":
        writer = McapWriter(name)
        writer.start("ros2", "a test")
        for index in range(2000):
            schema = writer.register_schema(f"a/msg/T{index}", "ros2msg", b"string data\n")
            writer.register_channel(f"/t{index}", "cdr", schema, {"offered_qos_profiles": "- depth: 1\n"})
        writer.finish()
    else:
        path.mkdir()
        (path / "a_0.mcap").write_bytes(without_summary())
        names = "".join(f"  - {index}\n" for index in range(10_000))
        (path / "metadata.yaml").write_text(f"rosbag2_bagfile_information:\n  relative_file_paths:\n{names}")


@pytest.mark.parametrize(
    "name", ["zeros.mcap", "chunks.mcap", "records.mcap", "file.db3.zstd", "types.mcap", "names"]
)
def test_small_bags_that_unpack_to_very_much(ifgen: Run, name: str) -> None:
    bomb(name)
    begin, before = time.process_time(), resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    outcome = ifgen("bag", "info", name)
    assert time.process_time() - begin < 2
    assert resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before < 150_000  # [kB]
    assert ("without `unlimited`" in outcome.err) == (name not in {"types.mcap", "names"})
    assert outcome.code == (name == "file.db3.zstd")


def test_a_limit_is_lifted(ifgen: Run) -> None:
    size = 40 * 2**20
    record = HEAD.pack(0x7E, size - HEAD.size) + bytes(size - HEAD.size)
    Path("zeros.mcap").write_bytes(without_summary((packed(record, 1), size)))
    outcome = ifgen("bag", "info", "zeros.mcap")
    assert "its chunks unpack to more than 33,5" in outcome.err
    assert "more than ifgen reads of a file of this size without `unlimited`" in outcome.err
    Path("zeros.mcap.zstd").write_bytes(packed(Path("zeros.mcap").read_bytes(), 1))
    for name in ("zeros.mcap", "zeros.mcap.zstd"):
        assert "without `unlimited`" not in ifgen("bag", "info", name, "--unlimited").err


@pytest.mark.parametrize("verb", ["info", "check", "convert", "cut", "migrate", "play"])
def test_what_is_no_file(ifgen: Run, drive: Path, verb: str) -> None:
    os.mkfifo("pipe")
    Path("loop").symlink_to("loop")
    more = ["-o", "copy.mcap"] if verb in {"convert", "cut", "migrate"} else []
    for path, said in [("pipe", "it is a pipe, and a file or a folder"), ("/dev/zero", "it is a device")]:
        assert said in ifgen("bag", verb, path, *more).err
    assert "there is no such file or folder" in ifgen("bag", verb, "loop", *more).err
    if verb == "info":
        (drive / "metadata.yaml").unlink()
        os.mkfifo(drive / "metadata.yaml")
        os.mkfifo(drive / "drive_1.mcap")
        assert ifgen("bag", verb, drive).code == 0


STEERING = "\x1b]0;owned\x07\x9b31m\N{RIGHT-TO-LEFT OVERRIDE}"


def test_nothing_steers_the_terminal(ifgen: Run) -> None:
    """Whatever a bag has in its names and texts."""
    with Recorder("evil.mcap") as recorder:
        for encoding in ("cdr", STEERING):
            topic, kind = f"/a{STEERING}\n/b{encoding}", f"a{STEERING}/msg/B{encoding}"
            recorder.add_topic(topic, Definition(kind, STEERING, "ros2msg", f"string {STEERING}\n"))
            recorder.write_serialized(topic, b"\0\1\0\0\xff\xff\xff\xff", 1)
        recorder.add_topic(f"/{STEERING}/_service_event", Definition(f"a/srv/{STEERING}_Event"))
    Path("cut.mcap").write_bytes(Path("evil.mcap").read_bytes()[:-9])
    for name in ("evil.mcap", "cut.mcap"):
        for words in (
            *(["info", name], ["info", name, "-v"], ["info", name, "-t"], ["info", name, "--json"]),
            *(["check", name, "--transport", "local"], ["play", name, "--transport", "local"]),
            *(
                ["convert", name, "-o", f"{name}.db3"],
                ["cut", name, "-o", f"2{name}", "--topics", f"/{STEERING}"],
            ),
            ["migrate", name, "--check", "--transport", "local"],
        ):
            outcome = ifgen("bag", *words)
            for text in (outcome.out, outcome.err):
                assert not [each for each in text if each != "\n" and not each.isprintable()], words


@pytest.mark.parametrize(
    ("verb", "name"),
    [("convert", "x.bag"), ("cut", "x.MCAP"), ("migrate", "x.db"), ("record", "x.mcap.zstd")],
)
def test_names_of_files_that_nobody_writes(ifgen: Run, drive: Path, verb: str, name: str) -> None:
    outcome = ifgen("bag", verb, "-a" if verb == "record" else drive, "-o", name)
    assert outcome.code == 2
    assert outcome.err.startswith(
        f"error: {name} is the name of a file, and ifgen writes none that ends in ."
    )
    assert not Path(name).exists()
