"""`ifgen bag play` in virtual time."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable, Generator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any

import pytest
import rclpy
from geometry_msgs.msg import Point
from ifgen_runtime import serialize
from ifgen_runtime.bag import OfferedQoS, Recorder
from ifgen_tools.bag.keys import DOWN, RIGHT, SPACE, UP
from ifgen_tools.bag.services import service
from mcap.writer import Writer as McapWriter
from rclpy.executors import ExternalShutdownException, SingleThreadedExecutor
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile
from rmw_local.virtual_time import START, virtual_time
from rosgraph_msgs.msg import Clock
from std_msgs.msg import String

from tests.cli.conftest import Run

from .conftest import START as BAG_START

LATCHED = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)


class Listener:
    """A node that notes what it hears, and when [s]."""

    def __init__(self, node: Node) -> None:
        self.node = node
        self.heard: list[tuple[float, str, Any]] = []

    def hear(self, topic: str, of: type[Any], field: str, qos: QoSProfile | int = 10) -> None:
        def note(message: Any) -> None:
            self.heard.append(((time.time_ns() - START) / 1e9, topic, getattr(message, field)))

        self.node.create_subscription(of, topic, note, qos)

    @property
    def values(self) -> list[Any]:
        return [value for _, _, value in self.heard]


def spin(executor: SingleThreadedExecutor) -> None:
    """Spin until the context is shut down."""
    with suppress(ExternalShutdownException):
        executor.spin()


@contextmanager
def listening() -> Generator[Listener]:
    """A listener in a thread of its own, in virtual time."""
    with virtual_time():
        context = rclpy.Context()
        rclpy.init(args=[], context=context)
        node = rclpy.create_node("listener", context=context)
        executor = SingleThreadedExecutor(context=context)
        executor.add_node(node)
        thread = threading.Thread(target=spin, args=(executor,))
        thread.start()
        yield Listener(node)
        time.sleep(0.1)
        context.shutdown()
        thread.join()
        node.destroy_node()


def test_messages_come_as_they_were_recorded(ifgen: Run, drive: Path) -> None:
    with listening() as listener:
        listener.hear("/position", Point, "x")
        listener.hear("/mode", String, "data", LATCHED)
        assert ifgen("bag", "play", drive, "--transport", "local").code == 0
    assert [value for _, topic, value in listener.heard if topic == "/mode"] == ["walk"]
    times = [time for time, topic, _ in listener.heard if topic == "/position"]
    assert times == pytest.approx([0.1 * index for index in range(20)], abs=1e-6)
    assert [v for _, topic, v in listener.heard if topic == "/position"] == [
        0.1 * index for index in range(20)
    ]


@pytest.mark.parametrize("count", [9, pytest.param(99, marks=pytest.mark.slow)])
def test_every_run_is_the_same_bit_for_bit(ifgen: Run, drive: Path, count: int) -> None:
    def run() -> list[Any]:
        with listening() as listener:
            listener.hear("/position", Point, "x")
            listener.hear("/clock", Clock, "clock")
            ifgen("bag", "play", drive, "--transport", "local", "--clock", "30", "--rate", "1.7")
        return listener.heard

    first = run()
    assert len(first) > 50
    assert [run() for _ in range(count)] == [first] * count


def test_parts_rates_and_remaps(ifgen: Run, drive: Path) -> None:
    options = ["--start-offset", "0.5", "--playback-duration", "0.3", "-r", "0.5", "-d", "2"]
    with listening() as listener:
        listener.hear("/there", Point, "x")
        ifgen(
            "bag", "play", drive, "--transport", "local", *options, "--remap", "/position:=/there", "/a:=/b"
        )
    assert listener.values == [0.5, 0.1 * 6, 0.1 * 7, 0.1 * 8]
    assert [time for time, _, _ in listener.heard] == pytest.approx([2.0, 2.2, 2.4, 2.6], abs=1e-6)


def test_chosen_topics(ifgen: Run, drive: Path) -> None:
    with listening() as listener:
        listener.hear("/position", Point, "x")
        listener.hear("/mode", String, "data", LATCHED)
        ifgen("bag", "play", drive, "--transport", "local", "--topics", "/mode", "/other")
    assert listener.values == ["walk"]


def test_the_clock_tells_the_time_of_the_bag(ifgen: Run, drive: Path) -> None:
    with listening() as listener:
        listener.hear("/clock", Clock, "clock")
        ifgen("bag", "play", drive, "--transport", "local", "--clock-topics", "/mode")
    assert [(clock.sec, clock.nanosec) for clock in listener.values] == [(1_700_000_000, 0)]


def call(listener: Listener, name: str, type_name: str, **fields: Any) -> Any:
    """The response of a service of the player; the listener's thread spins."""
    client = listener.node.create_client(service(type_name), f"/rosbag2_player/{name}")
    assert client.wait_for_service(timeout_sec=5)
    return client.call(service(type_name).Request(**fields), timeout_sec=5)


def test_services_control_the_player(ifgen: Run, drive: Path) -> None:
    said: list[Any] = []

    def control(listener: Listener) -> None:
        said.append(call(listener, "is_paused", "IsPaused").paused)
        said.append(call(listener, "play_next", "PlayNext").success)
        said.append(call(listener, "burst", "Burst", num_messages=3).actually_burst)
        said.append(call(listener, "set_rate", "SetRate", rate=-1.0).success)
        call(listener, "stop", "Stop")

    with listening() as listener:
        listener.hear("/position", Point, "x")
        thread = threading.Thread(target=control, args=(listener,))
        thread.start()
        ifgen("bag", "play", drive, "--transport", "local", "--start-paused")
        thread.join()
    assert said == [True, True, 3, False]
    assert listener.values == [0.0, 0.1, 0.2]


def edit(path: Path, change: Callable[[str], str]) -> Path:
    path.write_text(change(""))
    return path


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["nowhere"], "nowhere: there is no such file or folder"),
        (["drive", "--start-offset", "3"], "--start-offset 3 is after the end: the bag is 1.900 s long"),
        (["drive", "--topics", "/none"], "nothing of drive is played"),
        (["text.mcap"], "text.mcap: this is no MCAP file"),
        (["drive", "--qos-profile-overrides-path", "text.mcap"], "text.mcap has no topics"),
        (["empty.mcap"], "empty.mcap has no messages"),
    ],
    ids=range(6),
)
def test_mistakes(ifgen: Run, drive: Path, tmp_path: Path, arguments: list[str], said: str) -> None:
    edit(tmp_path / "text.mcap", lambda _: "This is text.")
    Recorder(tmp_path / "empty.mcap").close()
    outcome = ifgen("bag", "play", *arguments, "--transport", "local")
    assert outcome.code == 1
    assert said in " ".join(outcome.err.split())


@pytest.mark.parametrize(
    ("text", "said"),
    [
        (
            "/a: {reliability: always}",
            "the QoS of /a is wrong: reliability is one of system_default, reliable,",
        ),
        ("/a: {reliabilty: reliable}", "the QoS of /a is wrong: there is no policy 'reliabilty'"),
        ("/a: {depth: -1}", "the QoS of /a is wrong: depth cannot be -1"),
        ("/a: {deadline: 5}", "deadline has to be {sec: SECONDS, nsec: NANOSECONDS}, not 5"),
        ("/a: {deadline: {sec: -1, nsec: 0}}", "the QoS of /a is wrong: deadline cannot be negative"),
        ("/a: reliable", "the QoS of /a has no policies"),
        ("/a: [", "qos.yaml cannot be read as YAML: while parsing a flow node"),
    ],
)
def test_mistakes_in_overrides(ifgen: Run, drive: Path, tmp_path: Path, text: str, said: str) -> None:
    edit(tmp_path / "qos.yaml", lambda _: text)
    options = ["--qos-profile-overrides-path", "qos.yaml", "--transport", "local"]
    outcome = ifgen("bag", "play", drive, *options)
    assert outcome.code == 1
    assert said in " ".join(outcome.err.split())
    assert (
        "help: each topic has its policies below it, as in `/scan: {reliability: best_effort" in outcome.err
    )


def test_publishers_that_offered_different_things(ifgen: Run, tmp_path: Path) -> None:
    with Recorder(tmp_path / "two.mcap") as recorder:
        both = [OfferedQoS(reliability="reliable"), OfferedQoS(reliability="best_effort")]
        recorder.add_topic("/mode", String, both)
        recorder.write("/mode", String(data="walk"), START)
    with listening():
        outcome = ifgen("bag", "play", "two.mcap", "--transport", "local")
    assert outcome.err == "warning: publishers of /mode had different QoS: the default is used\n"


def test_a_type_that_nobody_knows(ifgen: Run, tmp_path: Path) -> None:
    """Its definition is neither in the bag nor installed: the rest is played."""
    writer = McapWriter(str(tmp_path / "bag.mcap"))
    writer.start("ros2", "a test")
    for topic, name, text in (
        ("/a", "nobody_msgs/msg/A", b""),
        ("/b", "std_msgs/msg/String", b"string data"),
    ):
        schema = writer.register_schema(name, "ros2msg" if text else "", text)
        channel = writer.register_channel(topic, "cdr", schema)
        writer.add_message(channel, START, serialize(String(data="b")), START)
    writer.finish()
    with listening() as listener:
        listener.hear("/b", String, "data")
        outcome = ifgen("bag", "play", "bag.mcap", "--transport", "local")
    assert (outcome.code, listener.values) == (0, ["b"])
    assert outcome.err.startswith(
        "warning: /a is not played: bag.mcap: there is no class for nobody_msgs/msg/A"
    )


def test_the_later_end_counts(ifgen: Run, drive: Path) -> None:
    until = ["--playback-duration", "0.3", "--playback-until-nsec", str(BAG_START + 500_000_000)]
    with listening() as listener:
        listener.hear("/position", Point, "x")
        ifgen("bag", "play", drive, "--transport", "local", *until)
    assert len(listener.values) == 6


class Keys:
    """Somebody at the terminal: what is pressed each time that the player looks."""

    legend = ""

    def __init__(self, actions: dict[str, tuple[str, Callable[[], object]]], pressed: list[str]) -> None:
        self._actions, self._pressed = actions, pressed

    def look(self) -> None:
        if self._pressed:
            self._actions[self._pressed.pop(0)][1]()


def test_keys_say_what_they_did(ifgen: Run, drive: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    pressed = [RIGHT, SPACE, RIGHT, UP, DOWN, SPACE]

    @contextmanager
    def keyboard(actions: Any, **_: Any) -> Generator[Keys]:
        yield Keys(actions, pressed)

    monkeypatch.setattr("ifgen_tools.bag.play.keyboard", keyboard)
    with listening() as listener:
        listener.hear("/position", Point, "x")
        outcome = ifgen("bag", "play", drive, "--transport", "local")
    lines = outcome.err.splitlines()
    assert lines[0] == "SPACE pauses: after that, the right arrow publishes the next message"
    assert lines[1].startswith("paused at 0.")
    assert lines[2:] == ["rate 1.10", "rate 1.00", "playing"]
    assert len(listener.values) == 20


def test_a_topic_of_two_types(ifgen: Run) -> None:
    """A participant has one type for each topic: the rest is played."""
    with Recorder("two.mcap") as recorder:
        recorder.write("/goal", String(data="kitchen"), BAG_START)
        recorder.write("/mode", String(data="walk"), BAG_START)
        recorder.add_topic("/mode", Point)
        recorder.write_serialized("/mode", serialize(Point()), BAG_START + 1)
    with listening() as listener:
        listener.hear("/goal", String, "data")
        listener.hear("/mode", String, "data")
        outcome = ifgen("bag", "play", "--transport", "local", "two.mcap")
    assert outcome.code == 0
    assert "warning: /mode is not played: " in outcome.err
    assert "incompatible type geometry_msgs/msg/Point" in outcome.err
    assert sorted(listener.values) == ["kitchen", "walk"]
