"""Bytes as they were before compression, never more of them than were promised."""

from __future__ import annotations

import os
import shutil
import tempfile
from pathlib import Path
from typing import Any, Final

from ifgen_runtime.bag.errors import UNPACKS, BagError, Damages, need

LARGEST: Final = 2**31
"""Bytes of a chunk or of a message that we are ready to read."""

ZSTD: Final = b"\x28\xb5\x2f\xfd"
"""The beginning of what is compressed with zstd."""

_PROMISE: Final = 2**26
"""Bytes that a compressed chunk may promise without more ado."""


class Undecodable(Exception):
    """The bytes are not what they say. It never leaves this package."""


def decompress(compression: str, data: bytes, size: int | None) -> bytes:
    """The bytes that were compressed with `zstd`, `lz4` or not at all.

    There have to be `size` of them, if that is known. Raises Undecodable if there are not, or if they are
    more than LARGEST; BagError if the library is missing.
    """
    if size is not None and size > LARGEST:
        raise Undecodable(f"its {size:,} bytes are more than the {LARGEST:,} that ifgen reads at once")
    if compression == "":
        found = data
    elif compression == "zstd":
        found = _zstd(data, size)
    elif compression == "lz4":
        found = _lz4(data, size)
    else:
        raise Undecodable(f"it is compressed with {compression[:40]!r}, and ifgen knows zstd and lz4")
    if size is not None and len(found) != size:
        raise Undecodable(f"it holds {len(found):,} bytes, and says that it holds {size:,}")
    return found


def _zstd(data: bytes, size: int | None) -> bytes:
    zstandard = need("zstandard", "reading what is compressed with zstd")
    try:
        said = zstandard.frame_content_size(data)
        if said >= 0 and size is not None and said != size:
            raise Undecodable(f"it holds {said:,} bytes, and says that it holds {size:,}")
        # The size in a frame is only a promise: the library takes that much memory in advance.
        if said > max(_PROMISE, 64 * len(data)) or said < 0:
            return _in_blocks(zstandard.ZstdDecompressor().decompressobj(), data, size)
        return bytes(zstandard.ZstdDecompressor().decompress(data))
    except zstandard.ZstdError as error:
        raise Undecodable(f"zstd: {error}") from None


def _in_blocks(stream: Any, data: bytes, size: int | None) -> bytes:
    """Decompress piece by piece, so that memory is taken for bytes that are really there."""
    found = bytearray()
    limit = LARGEST if size is None else size
    for start in range(0, len(data), 1 << 10):
        found += stream.decompress(data[start : start + (1 << 10)])
        if len(found) > limit:
            raise Undecodable(f"it holds more than {limit:,} bytes")
    return bytes(found)


def _lz4(data: bytes, size: int | None) -> bytes:
    frame = need("lz4.frame", "reading what is compressed with lz4")
    limit = LARGEST if size is None else size
    try:
        stream = frame.LZ4FrameDecompressor()
        found = bytes(stream.decompress(data, max_length=limit + 1))
        if not stream.eof and len(found) <= limit:
            raise Undecodable("lz4: it ends too early")
        return found
    except RuntimeError as error:
        raise Undecodable(f"lz4: {error}") from None


def decompressed_file(path: Path, damages: Damages) -> Path:
    """A temporary file with what a file holds that `ros2 bag record` compressed with zstd as a whole.

    What comes before damage is kept, and the damage noted. Raises BagError if nothing can be read, or the
    disk is full.
    """
    zstandard = need("zstandard", f"reading {path}")
    descriptor, name = tempfile.mkstemp(prefix="ifgen-bag-", suffix=path.with_suffix("").suffix)
    try:
        with os.fdopen(descriptor, "wb") as out, path.open("rb") as file:
            most = damages.most_unpacked(path.stat().st_size)
            try:
                for block in zstandard.ZstdDecompressor().read_to_iter(file):
                    if out.tell() + len(block) > most:
                        raise BagError(f"{path}: this unpacks to more than {most:,} bytes, {UNPACKS}")
                    out.write(block)
            except zstandard.ZstdError as error:
                if not out.tell():
                    raise BagError(f"{path}: this is no file compressed with zstd: {error}") from None
                damages.note(path, None, f"zstd: {error}; a message may be missing, or not what was recorded")
    except OSError as error:
        Path(name).unlink(missing_ok=True)
        folder = tempfile.gettempdir()
        free = shutil.disk_usage(folder).free
        text = f"cannot be decompressed into {folder}, which has {free:,} bytes free: {error.strerror}"
        raise BagError(f"{path}: {text}") from error
    except BagError:
        Path(name).unlink(missing_ok=True)
        raise
    return Path(name)
