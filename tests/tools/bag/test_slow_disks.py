"""`ifgen bag record` in a process of its own, on a disk that is slower than what comes."""

from __future__ import annotations

import os
import re
import signal
import subprocess
import sys
import time
import warnings
from pathlib import Path

import pytest
from ifgen_runtime.bag import Bag, BagWarning

RECORDER = """
import sys, time
from ifgen_runtime.bag.mcap import writer as mcap_writer
whole, rate = mcap_writer._write, float(sys.argv.pop(1))
def slow(file, parts):
    size = whole(file, parts)
    time.sleep(size / rate)
    return size
mcap_writer._write = slow
from ifgen.cli.main import main
sys.exit(main())
"""
"""The tool, with a disk of so many bytes a second."""

TALKER = """
import array, time
import rclpy
from rclpy.duration import Duration
from sensor_msgs.msg import Image, Imu
rclpy.init()
node = rclpy.create_node("talker")
publishers = [node.create_publisher(kind, name, 5000) for kind, name in ((Image, "camera"), (Imu, "imu"))]
image = Image(data=array.array("B", bytes(range(250)) * 4000))
while not all(publisher.get_subscription_count() for publisher in publishers):
    time.sleep(0.02)
begin, sent = time.monotonic(), [0, 0]
while (passed := time.monotonic() - begin) < 2:
    for index, (message, rate) in enumerate(((image, 200), (Imu(), 500))):
        if sent[index] < passed * rate:
            publishers[index].publish(message)
            sent[index] += 1
    time.sleep(0.0005)
for publisher in publishers:
    publisher.wait_for_all_acked(Duration(seconds=20))
print(*sent, flush=True)
time.sleep(100)
"""
"""200 MB of images a second beside 500 small messages; says how many it sent of each."""


def counts(said: str, words: str) -> dict[str, int]:
    found = re.findall(rf"([\d,]+) messages? of (\S+) w\w+ {words}", said)
    return {topic: int(count.replace(",", "")) for count, topic in found}


@pytest.mark.slow
@pytest.mark.alone
@pytest.mark.parametrize(
    ("transport", "number"),
    [
        *(("local", number) for number in (signal.SIGINT, signal.SIGTERM, signal.SIGKILL)),
        ("rclpy", signal.SIGINT),
    ],
)
def test_nothing_is_lost_without_a_word(tmp_path: Path, transport: str, number: signal.Signals) -> None:
    """At Ctrl-C all that was received is recorded; at SIGTERM, what takes longer than 5 s is counted."""
    if transport == "rclpy":
        pytest.importorskip("rclpy._rclpy_pybind11")
    (tmp_path / "recorder.py").write_text(RECORDER)
    (tmp_path / "talker.py").write_text(TALKER)
    rate = "60e6" if number == signal.SIGINT else "20e6"
    record = ["bag", "record", "--transport", transport, "-o", "drive.mcap", "/camera", "/imu"]
    run = [sys.executable, "-m", "ifgen", "run", "--transport", transport, "talker.py"]
    environment = {**os.environ, "ROS_LOG_DIR": str(tmp_path)}
    with (
        subprocess.Popen(
            [sys.executable, "recorder.py", rate, *record],
            cwd=tmp_path,
            env=environment,
            stderr=subprocess.PIPE,
            text=True,
        ) as recorder,
        subprocess.Popen(run, cwd=tmp_path, env=environment, stdout=subprocess.PIPE, text=True) as talker,
    ):
        try:
            assert talker.stdout is not None
            assert recorder.stderr is not None
            sent = dict(zip(("/camera", "/imu"), map(int, talker.stdout.readline().split()), strict=True))
            recorder.send_signal(number)
            begin = time.monotonic()
            said = recorder.stderr.read()
            recorder.wait(60)
            passed = time.monotonic() - begin
        finally:
            recorder.kill()
            talker.kill()
    with warnings.catch_warnings():
        warnings.simplefilter("error" if number != signal.SIGKILL else "ignore", BagWarning)
        with Bag(tmp_path / "drive.mcap") as bag:
            recorded = {topic: len(list(bag.recorded(topic))) for topic in bag.topics}
    lost, left = counts(said, "lost"), counts(said, "received, and not recorded")
    assert min(sent.values()) > 100
    if number == signal.SIGKILL:
        assert recorded["/imu"] + lost.get("/imu", 0) > 0.8 * sent["/imu"], "it does not wait for images"
        return
    for topic, count in sent.items():
        assert recorded[topic] + lost.get(topic, 0) + left.get(topic, 0) == count, (topic, said)
    assert left.keys() <= {"/camera"}, "small messages have their turns"
    if number == signal.SIGINT:
        assert not left
    else:
        assert passed < 10
