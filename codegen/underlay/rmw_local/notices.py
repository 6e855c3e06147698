"""Words of the middleware: lines for whoever reads a program's stderr, and the reasons of errors."""

from __future__ import annotations

import _thread
import sys
from collections.abc import Sequence

from ifgen_runtime.errors import printable

from rmw_local import timing

_SECOND = 1_000_000_000  # [ns]
_PART_OF_ACTION = "/_action/"


def say(text: str) -> None:
    """Print one line on stderr, if there is one (pythonw has none)."""
    if sys.stderr is not None:
        sys.stderr.write(f"rmw_local: {text}\n")


class Repeated:
    """Something that may happen often, and is said at most once a second: others must not fill a log.

    `text` has holes for `{count}`, a plural `{s}` and the reason `{why}` of the last time.
    """

    def __init__(self, text: str) -> None:
        self.count = 0
        """The number of times that it happened."""
        self._text = text
        self._untold = 0
        self._told: int | None = None  # in which second
        self._lock = _thread.allocate_lock()  # not threading's, which virtual time exchanges

    def add(self, why: str = "") -> None:
        """Count one more, and say all since the last line, unless that was less than a second ago."""
        second = timing.monotonic_ns() // _SECOND
        with self._lock:
            self.count += 1
            self._untold += 1
            if second == self._told:
                return
            self._told = second
            count, self._untold = self._untold, 0
        say(self._text.format(count=count, s="" if count == 1 else "s", why=printable(why)))


class Drops(Repeated):
    """Counts the payloads of one type that could not be read; `type_name` is `pkg/kind/Name`."""

    def __init__(self, type_name: str) -> None:
        name = type_name.replace("/", "::")
        super().__init__(
            f"dropped {{count}} malformed message{{s}} of type {name} "
            "(does a publisher have another definition of it?)"
        )


def no_response(service: str, nodes: Sequence[str], reason: str) -> str:
    """Say why there will be no response, and what to do. Without a `reason`, the servers are gone."""
    action, is_part, part = service.partition(_PART_OF_ACTION)
    what = f"{part} of action '{action}'" if is_part else f"service '{service}'"
    wait = "wait_for_server" if is_part else "wait_for_service"
    where = " and ".join(sorted(set(nodes)))
    gone = "was destroyed, has ended, or is not reached any more"
    return (
        f"{what}: no response will come from {where}: {reason or f'the server {gone}'}. "
        f"Wait with `client.{wait}()`, then ask again."
    )
