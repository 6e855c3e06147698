"""Bags on the disk: opened, written, and copied as they are or converted, for `bag convert` and `bag cut`.

A bag may have put anything into a text: nothing in it steers a terminal.
"""

from __future__ import annotations

import errno
import os
import shutil
import sys
import warnings
from collections.abc import Callable, Generator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

from ifgen.command_kit.tool import ToolError
from ifgen.diagnostics import printable
from ifgen_runtime.bag.writer import BagWriter, Format, Limits, storage_of

from ifgen_tools.bag.options import ConvertOptions, CutOptions, Selection

if TYPE_CHECKING:
    from ifgen_runtime.bag import Bag
    from ifgen_runtime.bag.topics import Channel, Definition


_S: Final = 10**9


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


EVERYTHING: Final = Selection(all_topics=True, all_services=True, include_hidden=True)


def write_part(
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


def convert(options: ConvertOptions) -> int:
    """Write a bag in another format."""
    output, format = options.require_output(), options.file_format()
    with reading(options.bag_path, unlimited=options.unlimited) as bag:
        count = write_part(bag, output, format, Part(EVERYTHING), Passage, Limits(options.max_bag_size))
    show(f"wrote {output}: {count:,} message{'s' * (count != 1)}")
    return 0


def cut(options: CutOptions) -> int:
    """Write a part of a bag."""
    output, format = options.require_output(), options.file_format()
    with reading(options.bag_path, unlimited=options.unlimited) as bag:
        start, end = _time(bag, options.start, "--start"), _time(bag, options.end, "--end")
        count = write_part(bag, output, format, Part(options.of_bag(), start, end), Passage)
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


# Late imports: most verbs of the command line read no bag.


def show(text: str) -> None:
    """Print what the user asked for."""
    print(printable(text))


def say(text: str) -> None:
    """Tell the user, beside what others may read from the output."""
    print(printable(text), file=sys.stderr, flush=True)


def warn(text: str) -> None:
    """Warn the user."""
    say(f"warning: {text}")


def inline(text: str) -> str:
    """A text without ends of lines."""
    return printable(text).replace("\n", "\N{SYMBOL FOR LINE FEED}")


@contextmanager
def reading(path: Path, *, unlimited: bool = False) -> Generator[Bag]:
    """An open bag. Raises ToolError for what is wrong with it; damage that it can skip is a warning."""
    from ifgen_runtime.bag import Bag, BagError, BagWarning

    def tell(message: Warning | str, category: type[Warning], *_: Any, **__: Any) -> None:
        if issubclass(category, BagWarning):
            warn(str(message))
        else:
            usual(message, category, *_, **__)

    with warnings.catch_warnings():
        warnings.simplefilter("always", BagWarning)
        usual, warnings.showwarning = warnings.showwarning, tell
        try:
            with Bag(path, unlimited=unlimited) as bag:
                yield bag
        except BagError as error:
            raise ToolError(str(error), help=_help(path, str(error))) from None


def _help(path: Path, error: str) -> str:
    from ifgen_runtime.bag.errors import UNPACKS

    if UNPACKS in error:
        return "if you trust it, read all of it with --unlimited"
    if not path.exists():
        return "name a .mcap or .db3 file, or a folder that `bag record` made"
    return ""


def require_new(path: Path) -> None:
    """Raise ToolError if something is there already."""
    if os.path.lexists(path):
        raise ToolError(f"{path} exists already", help="name another place with -o, or delete it first")


@contextmanager
def whole(path: Path) -> Generator[Path]:
    """A place to write to, which becomes `path` at the end of the block.

    Whatever goes wrong, nothing is left. Raises ToolError if the file system refuses.
    """
    require_new(path)
    place = path.with_name(f".{path.name}.{os.getpid()}{path.suffix}")
    with disk_errors(path):
        path.parent.mkdir(parents=True, exist_ok=True)
        try:
            yield place
            place.rename(path)
        except BaseException:
            if place.is_dir():
                shutil.rmtree(place, ignore_errors=True)
            else:
                for file in path.parent.glob(f"{place.name}*"):  # a database has others beside it
                    file.unlink(missing_ok=True)
            raise


@contextmanager
def disk_errors(path: Path) -> Generator[None]:
    """Raise ToolError for what the file system refuses while something is written to `path`."""
    import sqlite3

    from ifgen_runtime.bag.errors import BagError

    try:
        yield
    except BagError as error:
        cause = error.__cause__
        is_full = isinstance(cause, OSError) and cause.errno in _FULL
        raise ToolError(str(error), help=_FREE if is_full else "") from None
    except OSError as error:
        if error.errno in _FULL:
            raise ToolError(f"{path} cannot be written: the disk is full", help=_FREE) from None
        raise ToolError(f"{path} cannot be written: {error.strerror or error}") from None
    except sqlite3.Error as error:
        is_full = getattr(error, "sqlite_errorname", "") == "SQLITE_FULL"
        reason = "the disk is full" if is_full else str(error)
        raise ToolError(f"{path} cannot be written: {reason}", help=_FREE if is_full else "") from None


_FULL: Final = frozenset({errno.ENOSPC, errno.EDQUOT})
_FREE: Final = "make room, or name a place on another disk with -o"
