"""The services of a player, under the names that rosbag2's has: `~/pause`, `~/set_rate` and others."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

from ifgen_tools.bag.rosbag2_interfaces import answering, service

if TYPE_CHECKING:
    from rclpy.node import Node

    from ifgen_tools.bag.playing.player import Player

_S = 10**9


def offer_services(node: Node, player: Player) -> None:
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
    for name, (type_name, answer) in answers.items():
        node.create_service(service(type_name), f"~/{name}", answering(answer))


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
