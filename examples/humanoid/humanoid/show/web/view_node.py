"""A node that shows the robot on the page, and does what the page's visitors command.

It subscribes only while somebody watches: what nobody sees costs nothing.
"""

from __future__ import annotations

import io
import time
from collections import deque
from collections.abc import Mapping
from concurrent.futures import Future
from functools import partial
from importlib import import_module
from pathlib import Path
from queue import SimpleQueue
from typing import Any

from ifgen_tools.graph.connections import Graph, of_endpoints
from ifgen_tools.ros_graph import FRAMEWORK_TOPICS, is_hidden, read
from PIL import Image as Pictures
from rcl_interfaces.msg import Log, Parameter, ParameterType, ParameterValue
from rcl_interfaces.srv import SetParameters
from rclpy.clock import Clock
from rclpy.clock_type import ClockType
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy
from rclpy.serialization import deserialize_message
from sensor_msgs.msg import Image

from ...planning.choreography import DANCES
from ...robot.scene import board
from ..audience import Audience
from ..scenarios import names
from .commands import Commands
from .heard import Heard, Rates
from .readings import READINGS, Reading, line_of
from .server import LOOPBACK, Document, PageServer

_LATEST = QoSProfile(depth=1, reliability=ReliabilityPolicy.BEST_EFFORT)
_EVERY = QoSProfile(depth=50)
_LATCHED = QoSProfile(
    depth=1, reliability=ReliabilityPolicy.RELIABLE, durability=DurabilityPolicy.TRANSIENT_LOCAL
)
_PERIOD = 0.04  # s between moments on the page
_LOOK = 1.0  # s between checks of rates and of the graph
_ALONE = 2.0  # s without a visitor after which nothing is listened to
_ANSWER = 8.0  # s that the robot has to answer a command
_PICTURE = "sensor_msgs/msg/Image"
_CAMERA = "/head_camera/image_raw"
_LINES = 40  # of the log


class WebView(Node):
    """Shows robot, footsteps, goals, topics and nodes on a page, whose visitors can command the robot.

    With `port` 0 the system chooses one; `page.url` is the address. `audience` plays the events of scenarios;
    `scenario` is the one that the robot was started with. It changes nothing unless a visitor commands it.
    """

    def __init__(
        self,
        port: int = 0,
        host: str = LOOPBACK,
        audience: Audience | None = None,
        scenario: str = "",
    ) -> None:
        super().__init__("web_view")
        self._heard: dict[str, Heard] = {}
        self._lines: deque[list[Any]] = deque(maxlen=_LINES)
        self._line = 0
        self._warned: dict[str, str] = {}
        self._simulated: float | None = None  # not known until the clock is heard
        self._rates = Rates()
        self._seen = time.monotonic()  # when somebody last watched
        self._looked = 0.0
        self._picture = b""
        self._pictures = 0
        self._camera: Any = None  # the subscription to its pictures, while they are shown
        self._asked: SimpleQueue[tuple[Mapping[str, Any], Future[tuple[bool, str]]]] = SimpleQueue()
        self._commands = Commands(self, self._why, audience, scenario)
        # Also while nobody watches: a command that is refused is answered with the reason in the log.
        self.create_subscription(Log, "/rosout", self._on_log, _EVERY)
        self._stream = self.create_client(SetParameters, "/camera_driver/set_parameters")
        self.create_timer(_PERIOD, self._turn, clock=Clock(clock_type=ClockType.STEADY_TIME))
        self.page = PageServer(port, {"/camera.jpg": self._latest_picture}, self._ask, host)
        scenarios = sorted({*names(), *([Path(scenario).stem] if scenario else [])}) if audience else []
        self.page.show("setup", {"dances": list(DANCES), "scenarios": scenarios, "board": board()})

    def destroy_node(self) -> None:
        """Close the page too."""
        self.page.close()
        super().destroy_node()

    def _ask(self, command: Mapping[str, Any]) -> tuple[bool, str]:
        """Let the node do a command, and wait for its answer: the server's threads call this."""
        answered: Future[tuple[bool, str]] = Future()
        self._asked.put((command, answered))
        try:
            return answered.result(_ANSWER)
        except TimeoutError:
            return False, f"no answer from the robot within {_ANSWER:g} s"

    def _turn(self) -> None:
        """Do what was commanded, and show this moment."""
        while not self._asked.empty():
            command, answered = self._asked.get()
            answer = partial(_answer, answered)
            if command.get("do") == "camera":
                answer(*self._set_camera(command.get("on") is True))
            else:
                self._commands.do(command, answer)
        self._commands.tick()
        now = time.monotonic()
        if self.page.watchers:
            self._seen = now
            if not self._heard:
                self._listen()
            self._show()
            if now - self._looked >= _LOOK:
                self._looked = now
                self._look(now)
        elif self._heard and now - self._seen > _ALONE:
            self._listen_no_more()

    def _listen(self) -> None:
        for topic, reading in READINGS.items():
            qos = _LATCHED if reading.latched else _LATEST
            self._subscribe(topic, reading.kind, qos, reading)

    def _listen_no_more(self) -> None:
        for topic in self._heard.values():
            self.destroy_subscription(topic.subscription)
        self._heard.clear()
        self._simulated = None
        self._rates = Rates()
        self._set_camera(False)

    def _subscribe(
        self, topic: str, kind: type[Any], qos: QoSProfile, reading: Reading | None = None
    ) -> None:
        heard = self._heard[topic] = Heard(reading)
        heard.subscription = self.create_subscription(kind, topic, heard.hear, qos, raw=True)

    def _show(self) -> None:
        """Show what has arrived since the last time."""
        for topic in self._heard.values():
            reading = topic.reading
            if reading is None:
                continue
            for data in topic.take():
                try:
                    value = reading.read(deserialize_message(data, reading.kind))
                except ValueError:
                    continue  # garbage, which whoever acts on it refuses
                self._note(reading.channel, value)
                self.page.show(reading.channel, value)
        commands = self._commands
        self.page.show("run", {"paused": commands.paused, "speed": commands.speed})

    def _note(self, channel: str, value: Any) -> None:
        if channel == "time":
            self._simulated = value
        elif channel == "gait":
            self._commands.mode, self._commands.reason = value["mode"], value["reason"]
        elif channel == "task":
            self._commands.task = value["number"]
        elif channel == "obstacles":
            self._commands.obstacles = [thing["name"] for thing in value]

    def _on_log(self, message: Log) -> None:
        level, name, text = line_of(message)
        self._line += 1
        self._lines.append([self._line, level, name, text])
        if level != "info":
            self._warned[text.partition(": ")[0] + ": "] = text
        self.page.show("log", list(self._lines))

    def _why(self, beginning: str) -> str:
        """The last warning that began like this, without its beginning; it is then forgotten."""
        return self._warned.pop(beginning, "").removeprefix(beginning)

    def _look(self, now: float) -> None:
        """Check what is new in the graph, and measure the rates of all topics per simulated second."""
        for topic, types in self.get_topic_names_and_types():
            # Pictures would cost more than everything else.
            if topic in FRAMEWORK_TOPICS or is_hidden(topic) or len(types) != 1 or types[0] == _PICTURE:
                continue
            if topic not in self._heard and (kind := _message_class(types[0])) is not None:
                self._subscribe(topic, kind, _LATEST)
        counts = {name: topic.messages for name, topic in self._heard.items()}
        if self._simulated is not None:
            self._rates.count(now, self._simulated, counts)
        if (factor := self._rates.factor) is not None:
            self.page.show("factor", None if self._commands.paused else round(factor, 2))
        view = read(self).of_authors()
        graph = of_endpoints(view.nodes, view.endpoints)
        self.page.show("graph", _drawing(graph))
        kinds = {c.name: c.type_names[0] for c in graph.connections if c.kind == "topic"}
        if rates := self._rates.per_second():
            self.page.show(
                "topics",
                [[name, kinds[name], round(rates[name], 1)] for name in sorted(kinds) if name in rates],
            )

    def _set_camera(self, on: bool) -> tuple[bool, str]:
        """Show the pictures of the head camera, which take time to draw, or no more."""
        if on and self._camera is None:
            if not self.get_publishers_info_by_topic(_CAMERA):
                return False, f"nobody publishes {_CAMERA}: start the demo with --camera"
            self._camera = self.create_subscription(Image, _CAMERA, self._on_picture, _LATEST)
        elif not on and self._camera is not None:
            self.destroy_subscription(self._camera)
            self._camera = None
            self.page.show("picture", 0)
        else:
            return True, ""
        if on and self._stream.service_is_ready():  # off again it would make the robot blind
            value = ParameterValue(type=ParameterType.PARAMETER_BOOL, bool_value=on)
            self._stream.call_async(
                SetParameters.Request(parameters=[Parameter(name="streaming", value=value)])
            )
        return True, "the head camera is on" if on else "the head camera is off"

    def _on_picture(self, message: Image) -> None:
        if message.encoding != "rgb8" or not self.page.watchers:
            return
        size = (message.width, message.height)
        picture = Pictures.frombytes("RGB", size, bytes(message.data), "raw", "RGB", message.step)
        file = io.BytesIO()
        picture.save(file, "JPEG", quality=80)
        self._picture = file.getvalue()
        self._pictures += 1
        self.page.show("picture", self._pictures)

    def _latest_picture(self) -> Document:
        return ".jpg", self._picture


def _answer(answered: Future[tuple[bool, str]], accepted: bool, text: str) -> None:
    if not answered.done():
        answered.set_result((accepted, text))


def _drawing(graph: Graph) -> dict[str, Any]:
    """Nodes, and which of them talk to which over what."""
    links: dict[tuple[str, str], list[str]] = {}
    for connection in graph.connections:
        for source in connection.sources:
            for target in connection.targets:
                links.setdefault((source.node, target.node), []).append(connection.name)
    nodes = [name.lstrip("/") for name in graph.nodes]
    return {
        "nodes": nodes,
        "links": [[a.lstrip("/"), b.lstrip("/"), names] for (a, b), names in links.items() if a != b],
        "problems": list(graph.problems),
    }


def _message_class(type_name: str) -> Any:
    """The class of a type, or None where its package is not installed."""
    package, folder, name = type_name.split("/")
    try:
        return getattr(import_module(f"{package}.{folder}"), name)
    except (ImportError, AttributeError):
        return None
