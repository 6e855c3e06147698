"""`ifgen bag info`: what is in a bag."""

from __future__ import annotations

import json
import time
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

from ifgen_tools.bag.files import inline, reading, show
from ifgen_tools.bag.options import SERVICE_EVENTS, InfoOptions, is_service_event

if TYPE_CHECKING:
    from ifgen_runtime.bag import Bag
    from ifgen_runtime.bag.topics import Topic

_INDENT: Final = 19
_UNITS: Final = ("B", "KiB", "MiB", "GiB", "TiB")
_S: Final = 10**9
_EVENT: Final = 40
"""Bytes of a ServiceEventInfo: its type, time, client and sequence number."""

_RESPONSE, _LAST_KIND = 2, 3
"""The first and the last type of an event that is about a response; those below are about requests."""


def info(options: InfoOptions) -> int:
    """Print what is in a bag, as `ros2 bag info` does."""
    with reading(options.bag_path, unlimited=options.unlimited) as bag:
        topics = [topic for topic in bag.topics.values() if not is_service_event(topic.name)]
        services = [topic for topic in bag.topics.values() if is_service_event(topic.name)]
        if options.as_json:
            show(json.dumps(_document(bag), indent=2))
        elif options.topic_name:
            for topic in topics:
                show(inline(topic.name))
        else:
            show(_text(bag, topics, services, options.verbose))
    return 0


def _text(bag: Bag, topics: list[Topic], services: list[Topic], verbose: bool) -> str:
    lines = [
        ("Files:", _indented(inline(file.name) for file in bag.files)),
        ("Bag size:", file_size(sum(file.stat().st_size for file in bag.files))),
        ("Storage id:", storage(bag.files)),
        ("ROS Distro:", inline(bag.ros_distro) or "unknown"),
        ("Duration:", f"{_seconds((bag.end or 0) - (bag.start or 0))}s"),
        ("Start:", _time(bag.start or 0)),
        ("End:", _time(bag.end or 0)),
        ("Messages:", str(sum(topic.count for topic in topics))),
        ("Topic information:", _indented(_topic(topic, verbose) for topic in topics)),
        ("Service:", str(len(services))),
        ("Service information:", _indented(_service(bag, topic, verbose) for topic in services)),
    ]
    return "\n" + "\n".join(
        (f"{name:<{_INDENT}}{value}" if len(name) < _INDENT else f"{name} {value}").rstrip()
        for name, value in lines
    )


def _indented(lines: Any) -> str:
    return f"\n{' ' * _INDENT}".join(lines)


def _topic(topic: Topic, verbose: bool) -> str:
    text = (
        f"Topic: {inline(topic.name)} | Type: {inline(topic.type_name)} | Count: {topic.count} | "
        f"Serialization Format: {inline(topic.encoding)}"
    )
    if not verbose:
        return text
    hashes = ", ".join(inline(definition.type_hash) or "unknown" for definition in topic.definitions)
    return f"{text} | Type Hash: {hashes}"


def _service(bag: Bag, topic: Topic, verbose: bool) -> str:
    type_name = topic.type_name.removesuffix("_Event")
    count = f"Event Count: {topic.count}"
    if verbose:
        requests, responses = _calls(bag, topic.name)
        count = f"Request Count: {requests} | Response Count: {responses}"
    return (
        f"Service: {inline(topic.name.removesuffix(SERVICE_EVENTS))} | Type: {inline(type_name)} | "
        f"{count} | Serialization Format: {inline(topic.encoding)}"
    )


def _calls(bag: Bag, topic: str) -> tuple[int, int]:
    """How many requests and responses the events are about. Client and server may both tell of one."""
    found: tuple[set[bytes], set[bytes]] = set(), set()
    for _, _, _, data in bag.entries(topic):
        event = data[4 : 4 + _EVENT]  # after the head of CDR: the type, the time, then whose call it is
        if len(event) == _EVENT and event[0] <= _LAST_KIND:
            found[event[0] >= _RESPONSE].add(event[12:])
    return len(found[0]), len(found[1])


def storage(files: list[Path] | tuple[Path, ...]) -> str:
    """The name that rosbag2 has for the format of files."""
    return "sqlite3" if any(".db3" in file.suffixes for file in files) else "mcap"


def file_size(size: float) -> str:
    """A number of bytes as people read it: `9.6 KiB`."""
    unit = 0
    while size >= 1024 and unit < len(_UNITS) - 1:
        size, unit = size / 1024, unit + 1
    return f"{size:.{min(unit, 1)}f} {_UNITS[unit]}"


def _seconds(nanoseconds: int) -> str:
    return f"{nanoseconds // _S}.{nanoseconds % _S:09}"


def _time(nanoseconds: int) -> str:
    local = time.localtime(nanoseconds // _S)
    date = time.strftime("%b %e %Y %H:%M:%S", local)
    return f"{date}.{nanoseconds % _S:09} ({_seconds(nanoseconds)})"


def _document(bag: Bag) -> dict[str, Any]:
    return {
        "path": str(bag.path),
        "files": [file.name for file in bag.files],
        "size": sum(file.stat().st_size for file in bag.files),
        "storage": storage(bag.files),
        "start": bag.start,
        "end": bag.end,
        "messages": len(bag),
        "topics": [_topic_document(topic) for topic in bag.topics.values()],
        "damage": [str(damage) for damage in bag.damage],
    }


def _topic_document(topic: Topic) -> dict[str, Any]:
    return {
        "name": topic.name,
        "type": topic.type_name,
        "hashes": [definition.type_hash or None for definition in topic.definitions],
        "has_definition": all(definition.text for definition in topic.definitions),
        "count": topic.count,
        "encoding": topic.encoding,
        "qos": [{name: getattr(profile, name) for name in profile.__slots__} for profile in topic.qos],
    }
