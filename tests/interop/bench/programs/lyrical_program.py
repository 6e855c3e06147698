"""A simulated publisher of ROS 2 Lyrical, which is in no wheel: how it chooses keys for images.

After what its sources do (rmw_zenoh 0.10): the token of an endpoint that takes buffers has a further part
with its backends. A volatile publisher of a type with an unbounded `uint8[]` sends to nobody where it knows
of no subscription, to `<key>/_buf_cpu` where each one takes buffers, and to the key itself otherwise.
"""

from __future__ import annotations

import struct
import time
from importlib import import_module
from typing import TYPE_CHECKING, Any, ClassVar

if TYPE_CHECKING:
    from tests.interop.bench.programs.conversation import Value, converse, unpacked, zenoh_session
else:
    from conversation import Value, converse, unpacked, zenoh_session

_BUFFERS = "_buf_cpu"
_PARTS = 13  # of the token of an endpoint


class LyricalProgram:
    """A publisher of images, and tokens of subscriptions that take buffers."""

    lacks: ClassVar[dict[str, str]] = {}

    def __init__(self, setting: dict[str, Any]) -> None:
        self._hash: Any = import_module("xxhash").xxh3_128_intdigest
        self._session: Any = zenoh_session(setting)
        self._setting = setting
        self._tokens: list[Any] = []
        self._publishers: dict[str, tuple[str, bytes]] = {}
        self._number = 0

    def publish(self, topic: str, type: str, qos: Value) -> None:
        """Make a publisher, which takes buffers, as its token says."""
        token = self._announce("MP", topic, type, ["cpu"])
        gid = self._hash(token.encode()).to_bytes(16, "little")
        self._publishers[topic] = self._key(topic, type), gid

    def subscribe_with(self, topic: str, type: str, backends: str) -> None:
        """Announce a subscription that takes buffers; nobody reads them."""
        self._announce("MS", topic, type, [backends])

    def send(self, topic: str, value: Value) -> list[str]:
        """Publish an image, and return what was added to the key: nothing where nobody is there."""
        key, gid = self._publishers[topic]
        found = self._subscriptions(topic, key)
        if not found:
            return []
        suffix = _BUFFERS if all(len(token.split("/")) > _PARTS for token in found) else ""
        self._number += 1
        attachment = struct.pack("<qqB", self._number, time.time_ns(), len(gid)) + gid
        whole = f"{key}/{suffix}" if suffix else key
        self._session.put(whole, _image(value), attachment=attachment)
        return [suffix]

    def _subscriptions(self, topic: str, key: str) -> list[str]:
        """The tokens of the subscriptions to a topic, of its type and hash."""
        domain, (type_name, type_hash) = self._setting["domain"], key.split("/")[-2:]
        mangled = topic.replace("/", "%")
        pattern = f"@ros2_lv/{domain}/*/*/*/MS/*/*/*/{mangled}/{type_name}/{type_hash}/**"
        replies = self._session.liveliness().get(pattern, timeout=2.0)
        return [str(reply.ok.key_expr) for reply in replies if reply.ok is not None]

    def _key(self, topic: str, type_name: str) -> str:
        package, kind, name = type_name.split("/")
        type_hash = self._setting["hashes"][type_name]
        return f"{self._setting['domain']}{topic}/{package}::{kind}::dds_::{name}_/{type_hash}"

    def _announce(self, kind: str, topic: str, type_name: str, backends: list[str]) -> str:
        type_part, type_hash = self._key(topic, type_name).split("/")[-2:]
        place = f"@ros2_lv/{self._setting['domain']}/{self._session.info.zid()}/0/{len(self._tokens) + 1}"
        who = f"{kind}/%/%/{self._setting['node']}/{topic.replace('/', '%')}"
        token = "/".join([place, who, type_part, type_hash, "::,10:,:,:,,", ";".join(backends)])
        self._tokens.append(self._session.liveliness().declare_token(token))
        return token


def _image(value: Value) -> bytes:
    """The CDR of an image."""
    stamp = value["header"]["stamp"]
    data = bytearray(struct.pack("<BBBBiI", 0, 1, 0, 0, stamp["sec"], stamp["nanosec"]))
    _add_text(data, value["header"]["frame_id"])
    _align(data)
    data += struct.pack("<II", value["height"], value["width"])
    _add_text(data, value["encoding"])
    data += struct.pack("<B", value["is_bigendian"])
    _align(data)
    pixels = unpacked(value["data"])
    return bytes(data + struct.pack("<II", value["step"], len(pixels)) + pixels)


def _add_text(data: bytearray, text: str) -> None:
    _align(data)
    encoded = text.encode() + b"\0"
    data += struct.pack("<I", len(encoded)) + encoded


def _align(data: bytearray) -> None:
    data += bytes(-len(data) % 4)


if __name__ == "__main__":
    converse(LyricalProgram, ["eclipse-zenoh"])
