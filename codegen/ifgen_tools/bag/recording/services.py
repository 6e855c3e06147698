"""The services of a recorder, under the names that rosbag2's has: `~/pause`, `~/snapshot` and others."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any, Protocol

from ifgen_tools.bag.rosbag2_interfaces import answering, service

if TYPE_CHECKING:
    from ifgen_runtime.bag.writer import BagWriter
    from rclpy.node import Node

    from ifgen_tools.bag.recording.recorder import TopicRecorder


class Controlled(Protocol):
    """A recording that others control."""

    topics: TopicRecorder
    writer: BagWriter

    def snapshot(self) -> bool:
        """Write what has been kept."""
        ...


def offer_services(node: Node, recording: Controlled) -> None:
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
    for name, (type_name, answer) in answers.items():
        node.create_service(service(type_name), f"~/{name}", answering(answer))
