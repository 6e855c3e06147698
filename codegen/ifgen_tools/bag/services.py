"""The services by which others control what plays and records: those of rosbag2_interfaces, under its names.

Nobody has to generate that package: the classes are made of these definitions when they are needed. Type
hashes are those of ROS, because they depend on names and types only.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from typing import TYPE_CHECKING, Any, Final, Protocol

if TYPE_CHECKING:
    from ifgen_runtime.bag.writer import BagWriter
    from rclpy.node import Node

    from ifgen_tools.bag.player import Player
    from ifgen_tools.bag.recorder import TopicRecorder

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
