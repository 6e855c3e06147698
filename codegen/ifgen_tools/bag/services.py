"""Services of `bag play` and `bag record`: those that control them, and calls of those that a bag recorded.

The former are those of rosbag2_interfaces, under its names. Nobody has to generate that package: the
classes are made of these definitions when they are needed. Type hashes are those of ROS, because they
depend on names and types only.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import cache
from typing import TYPE_CHECKING, Any, Final, Protocol

from ifgen.command_kit.tool import ToolError
from ifgen_runtime.bag.definitions import decoder
from ifgen_runtime.codec import serialize

from ifgen_tools.bag.files import warn
from ifgen_tools.bag.options import SERVICE_EVENTS
from ifgen_tools.calling import class_on_the_wire, known_class

if TYPE_CHECKING:
    from ifgen_runtime.bag.writer import BagWriter
    from rclpy.node import Node
    from rclpy.task import Future

    from ifgen_tools.bag.player import Player
    from ifgen_tools.bag.recorder import TopicRecorder
    from ifgen_tools.session import Session


_S: Final = 10**9
_DEFINITIONS: Final = {
    "Burst": "uint64 num_messages  # 0: all that are left\n---\nuint64 actually_burst",
    "GetRate": "---\nfloat64 rate",
    "IsPaused": "---\nbool paused",
    "Pause": "---",
    "Play": (
        "builtin_interfaces/Time start_offset\nbuiltin_interfaces/Duration playback_duration\n"
        "builtin_interfaces/Time playback_until_timestamp\n---\nbool success"
    ),
    "PlayNext": "---\nbool success",
    "Resume": "---",
    "Seek": "builtin_interfaces/Time time\n---\nbool success",
    "SetRate": "float64 rate\n---\nbool success",
    "Snapshot": "---\nbool success",
    "SplitBagfile": "---",
    "Stop": "---",
    "TogglePaused": "---",
}


@cache
def service(name: str) -> Any:
    """The class of a service of rosbag2_interfaces."""
    # Most of the command line has no use for classes made at run time.
    from ifgen.dynamic import class_from_text

    return class_from_text(f"rosbag2_interfaces/srv/{name}", _DEFINITIONS[name] + "\n")


class Recording(Protocol):
    """A recording that others control."""

    topics: TopicRecorder
    writer: BagWriter

    def snapshot(self) -> bool:
        """Write what has been kept."""
        ...


def offer_recorder_services(node: Node, recording: Recording) -> None:
    """Let others control a recording, by services of a node."""

    def pause(is_paused: bool) -> dict[str, Any]:
        recording.topics.is_paused = is_paused
        return {}

    def split(_: Any) -> dict[str, Any]:
        if recording.writer.is_folder:
            recording.writer.split()
        return {}

    answers: dict[str, tuple[str, Callable[[Any], dict[str, Any]]]] = {
        "pause": ("Pause", lambda _: pause(True)),
        "resume": ("Resume", lambda _: pause(False)),
        "is_paused": ("IsPaused", lambda _: {"paused": recording.topics.is_paused}),
        "snapshot": ("Snapshot", lambda _: {"success": recording.snapshot()}),
        "split_bagfile": ("SplitBagfile", split),
    }
    _offer(node, answers)


def offer_player_services(node: Node, player: Player) -> None:
    """Let others control a player, by services of a node."""
    answers: dict[str, tuple[str, Callable[[Any], dict[str, Any]]]] = {
        "pause": ("Pause", _does(player.pause)),
        "resume": ("Resume", _does(player.resume)),
        "toggle_paused": ("TogglePaused", _does(player.toggle)),
        "is_paused": ("IsPaused", lambda _: {"paused": player.clock.is_paused}),
        "get_rate": ("GetRate", lambda _: {"rate": player.clock.rate}),
        "set_rate": ("SetRate", lambda request: {"success": player.set_rate(request.rate)}),
        "play_next": ("PlayNext", lambda _: {"success": player.step(1) > 0}),
        "burst": ("Burst", lambda request: {"actually_burst": player.step(request.num_messages)}),
        "seek": ("Seek", lambda request: {"success": player.seek(_nanoseconds(request.time))}),
        "play": ("Play", lambda request: {"success": _play(player, request)}),
        "stop": ("Stop", _does(player.stop)),
    }
    _offer(node, answers)


def _offer(node: Node, answers: dict[str, tuple[str, Callable[[Any], dict[str, Any]]]]) -> None:
    """Make services: each has a type, and a function from a request to the fields of the response."""
    for name, (type_name, answer) in answers.items():
        node.create_service(service(type_name), f"~/{name}", _responding(answer))


def _responding(answer: Callable[[Any], dict[str, Any]]) -> Callable[[Any, Any], Any]:
    def respond(request: Any, response: Any) -> Any:
        for field, value in answer(request).items():
            setattr(response, field, value)
        return response

    return respond


def _does(action: Callable[[], None]) -> Callable[[Any], dict[str, Any]]:
    """An answer without fields, of a service that does something."""

    def answer(_: Any) -> dict[str, Any]:
        action()
        return {}

    return answer


def _play(player: Player, request: Any) -> bool:
    """Start over with a part of the recording, unless it plays already."""
    if player.is_playing and not player.clock.is_paused:
        return False
    duration, until = _nanoseconds(request.playback_duration), _nanoseconds(request.playback_until_timestamp)
    return player.start_over(
        _nanoseconds(request.start_offset), duration if duration > 0 else None, until if until > 0 else None
    )


def _nanoseconds(time: Any) -> int:
    return int(time.sec) * _S + int(time.nanosec)


_READY: Final = 3.0
"""Seconds that servers have to be there before the first request."""

_LAST: Final = 1.0
"""Seconds that servers have to answer after the last one."""


class Requester:
    """Calls one service: `send` takes its recorded events, and sends the requests in them."""

    def __init__(self, session: Session, topic: str, event_class: type[Any], event_type: int) -> None:
        """Find the service, as its server defines it. Raises ToolError if nobody can say how."""
        self.name = session.node.resolve_service_name(topic.removesuffix(SERVICE_EVENTS))
        type_name = _type_name(event_class)
        cls = class_on_the_wire(session, "service", self.name, known_class(type_name, "service"))
        self._request_class: Any = getattr(cls, "Request")  # noqa: B009 - of any service
        self._client = session.node.create_client(cls, self.name)
        self._decode = decoder(event_class, views=False)
        self._event_type = event_type
        self._pending: list[Future[Any]] = []
        self._said: set[str] = set()

    def is_ready(self) -> bool:
        """Whether the server is there."""
        return self._client.service_is_ready()

    def is_idle(self) -> bool:
        """Whether all requests have been answered."""
        self._pending = [future for future in self._pending if not future.done()]
        return not self._pending

    def send(self, data: bytes) -> None:
        """Send the request of a serialized event, if it is one of the kind that is wanted."""
        event = self._decode(data)
        if event.info.event_type != self._event_type:
            return
        if not event.request:
            self._say("its events have no contents: introspection told only when it was called")
        elif not self.is_ready():
            self._say("nobody serves it")
        elif (request := self._fitting(event.request[0])) is not None:
            future = self._client.call_async(request)
            future.add_done_callback(lambda done: done.exception())  # a server that goes is no concern here
            self._pending.append(future)

    def _fitting(self, request: Any) -> Any:
        """A request of the server's class, None if that has another definition."""
        cls = self._request_class
        if isinstance(request, cls):
            return request
        if getattr(cls, "__type_hash__", None) != getattr(type(request), "__type_hash__", None):
            self._say("its server has another definition; `ifgen bag check` says what differs")
            return None
        return decoder(cls, views=False)(serialize(request))

    def _say(self, why: str) -> None:
        if why not in self._said:
            self._said.add(why)
            warn(f"requests of {self.name} are not sent: {why}")


def wait_for_servers(session: Session, requesters: Sequence[Requester]) -> None:
    """Wait a moment until all servers are there."""
    session.wait_for(lambda: all(each.is_ready() for each in requesters), _READY)


def wait_for_answers(session: Session, requesters: Sequence[Requester]) -> None:
    """Wait a moment until all requests are answered, so that they have arrived."""
    session.wait_for(lambda: all(each.is_idle() for each in requesters), _LAST)


def requester(session: Session, topic: str, event_class: type[Any], event_type: int) -> Requester | None:
    """A Requester, None if there can be none, which is said on stderr."""
    try:
        return Requester(session, topic, event_class, event_type)
    except ToolError as error:
        service = topic.removesuffix(SERVICE_EVENTS)
        warn(f"requests of {service} are not sent: {error.message}")
        return None


def _type_name(event_class: type[Any]) -> str:
    """`pkg/srv/Name` of the class of its events."""
    package, folder = event_class.__module__.split(".")[:2]
    return f"{package}/{folder}/{event_class.__name__.removesuffix('_Event')}"
