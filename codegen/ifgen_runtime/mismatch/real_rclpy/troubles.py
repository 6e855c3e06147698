"""Received bytes that their type does not explain: the C extension counts them, and here it is said why."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

from ifgen_runtime.field_types import type_name
from ifgen_runtime.mismatch.real_rclpy.endpoints import Endpoint
from ifgen_runtime.mismatch.remembered import Once
from ifgen_runtime.type_support import register


class Troubles:
    """Compares the counts of each class that is received with those of the last time."""

    def __init__(self) -> None:
        self._counts: dict[type[Any], tuple[int, int, int]] = {}
        self._said = Once()

    def note(self, endpoint: Endpoint) -> None:
        """Watch the classes that an endpoint receives from now on."""
        for part in endpoint.parts:
            if not part.written and part.cls not in self._counts:
                self._counts[part.cls] = (0, 0, 0)

    def look(self, endpoints: Iterable[Endpoint]) -> None:
        """Say once for each endpoint, or for each of its senders that are known to differ, what is wrong."""
        for cls, before in tuple(self._counts.items()):
            now = register.troubles(cls)
            if now != before:
                self._counts[cls] = now
                self._tell(cls, before, now, endpoints)

    def _tell(
        self,
        cls: type[Any],
        before: tuple[int, int, int],
        now: tuple[int, int, int],
        endpoints: Iterable[Endpoint],
    ) -> None:
        dropped, with_rest, rest = now[0] - before[0], now[1] - before[1], now[2]
        receiving = [e for e in endpoints if any(p.cls is cls and not p.written for p in e.parts)]
        # One count is for all that receive the type: if somebody is known to differ, it is their messages.
        receiving = [endpoint for endpoint in receiving if endpoint.differing] or receiving
        for endpoint in receiving:
            of = " or ".join(endpoint.differing) or f"a {endpoint.others}"
            if dropped:
                messages = "a message" if dropped == 1 else f"{dropped} messages"
                self._say(endpoint, f"{messages} of {of} did not fit {type_name(cls)}, and were dropped")
            if with_rest:
                number = "1 byte" if rest == 1 else f"{rest} bytes"
                text = f"{number} of a message of {of} were left over after {type_name(cls)}"
                self._say(endpoint, f"{text}. The message was delivered", "rest")

    def _say(self, endpoint: Endpoint, text: str, kind: str = "dropped") -> None:
        node = endpoint.node
        if node is None or not self._said.is_new((endpoint.name, endpoint.role, kind, endpoint.differing)):
            return
        reason = "The definitions of the type differ"
        if not endpoint.differing:
            reason = "Probably they were made with another definition of the type"
        where = f"{endpoint.kind} '{endpoint.name}'"
        node.get_logger().warning(f"{where}: {text}. {reason}. This is said once.")
