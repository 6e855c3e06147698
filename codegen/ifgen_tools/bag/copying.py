"""Copies messages from bag to bag, as they are or converted: `ifgen bag convert` and `ifgen bag cut`."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from ifgen_runtime.bag.writer import BagWriter, Format, Limits, storage_of

from ifgen_tools.bag.output import whole
from ifgen_tools.bag.reading import reading
from ifgen_tools.bag.saying import show, warn
from ifgen_tools.bag.selection import Selection, selection
from ifgen_tools.errors import ToolError

if TYPE_CHECKING:
    from ifgen_runtime.bag import Bag
    from ifgen_runtime.bag.topics import Channel, Definition

_S = 10**9


@dataclass(frozen=True, slots=True)
class Passage:
    """The channel that messages are copied to, and what converts their bytes, if anything does."""

    channel: Channel
    convert: Callable[[bytes], bytes] | None = None


@dataclass(frozen=True, slots=True)
class Part:
    """The part to copy: topics, received from `start` to before `end` [ns]; None is no limit."""

    choice: Selection
    start: int | None = None
    end: int | None = None


def everything() -> Selection:
    """The choice of all that a bag has."""
    return selection(all_topics=True, all_services=True, include_hidden=True)


def written(
    bag: Bag,
    output: Path,
    format: Format,
    part: Part,
    passage: Callable[[Channel], Passage],
    limits: Limits | None = None,
) -> int:
    """Write a part of a bag to a new place, all of it or nothing; returns how many messages that are."""
    is_folder = storage_of(output) is None
    if not is_folder and format.outer:
        raise ToolError(
            f"{output} is a single file, and cannot be compressed as a whole", help="name a folder"
        )
    chosen = [topic.name for topic in bag.topics.values() if part.choice.takes(topic.name, topic.type_name)]
    if not chosen:
        raise ToolError(f"nothing of {bag.path} is chosen", help="`ifgen bag info` shows its topics")
    if bag.attachments:
        warn(f"{bag.attachments:,} attachments of {bag.path} are not copied")
    with (
        whole(output) as place,
        BagWriter(place, format, is_folder, limits or Limits(), name=output.name) as writer,
    ):
        _copy(bag, writer, part, chosen, passage)
    return writer.count


def _copy(
    bag: Bag, writer: BagWriter, part: Part, topics: list[str], passage: Callable[[Channel], Passage]
) -> None:
    passages: dict[tuple[str, Definition], Passage] = {}
    by_channel: dict[Channel, Passage] = {}
    for channel in bag.channels:
        if channel.topic in topics:
            key = channel.topic, channel.definition
            if key not in passages:
                passages[key] = passage(channel)
                writer.add(passages[key].channel)
            by_channel[channel] = passages[key]
    for received, published, channel, data in bag.entries(*topics, start=part.start, end=part.end):
        target = by_channel[channel]
        if target.convert is not None:
            data = _converted(data, target.convert, channel.topic)  # noqa: PLW2901 - the same message
        writer.write(target.channel, received, published, data)


def _converted(data: bytes, convert: Callable[[bytes], bytes], topic: str) -> bytes:
    try:
        return convert(data)
    except Exception as error:  # of an adapter, which is code of users, or of bytes that are no message
        raise ToolError(
            f"a message of {topic} cannot be converted: {type(error).__name__}: {error}",
            help="nothing was written. Mend the adapter, or leave the topic out with `ifgen bag cut`",
        ) from None


def convert(path: Path, output: Path, format: Format, limits: Limits, *, unlimited: bool = False) -> int:
    """Write a bag in another format."""
    with reading(path, unlimited=unlimited) as bag:
        count = written(bag, output, format, Part(everything()), Passage, limits)
    show(f"wrote {output}: {count:,} message{'s' * (count != 1)}")
    return 0


def cut(
    path: Path,
    output: Path,
    format: Format,
    choice: Selection,
    start: str,
    end: str,
    *,
    unlimited: bool = False,
) -> int:
    """Write a part of a bag."""
    with reading(path, unlimited=unlimited) as bag:
        part = Part(choice, _time(bag, start, "--start"), _time(bag, end, "--end"))
        count = written(bag, output, format, part, Passage)
    show(f"wrote {output}: {count:,} message{'s' * (count != 1)}")
    return 0


def _time(bag: Bag, text: str, option: str) -> int | None:
    """The time [ns] of a text: seconds from the start, from the end if negative, or `@` since 1970."""
    if not text:
        return None
    try:
        seconds = float(text.removeprefix("@"))
        nanoseconds = round(seconds * _S)
    except (ValueError, OverflowError):
        help = "write seconds from the start (12.5), from the end (-3), or since 1970 (@1718006400.5)"
        raise ToolError(f"{option} {text!r} is no time", help=help) from None
    if text.startswith("@"):
        return nanoseconds
    base = bag.end if text.startswith("-") else bag.start
    return (base or 0) + nanoseconds
