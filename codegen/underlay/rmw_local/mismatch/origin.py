"""Messages whose bytes may be of another definition: where they come from, and how they are read.

They are marked with an `Origin` on their way. All others go without, so they cost nothing.
"""

from __future__ import annotations

import _thread
from collections import Counter
from collections.abc import Callable
from pathlib import Path
from traceback import extract_tb
from typing import TYPE_CHECKING, Any

from ifgen_runtime.mismatch.reporting import left_over

from rmw_local import observer, report
from rmw_local.message import DecodeError, MessageType, SerializationError, message_type

if TYPE_CHECKING:
    from ifgen_runtime.adapters import Adapter

    from rmw_local.graph import GraphNode

_ONCE = "This is said once."
_OURS = {"ifgen_runtime", "rmw_local"}  # folders whose code is not what failed
_PADDING = 4  # DDS fills messages up to a multiple of this


class Origin:
    """A peer whose messages are read with care, and the number of those that were not as expected.

    `kind` and `name` are those of a topic or a service. With an adapter, messages are of the version of its
    old class. `is_raw` says that the peer publishes bytes that somebody else made. Each kind of trouble is
    said once.
    """

    def __init__(
        self, kind: str, name: str, peer: GraphNode, adapter: Adapter | None = None, *, is_raw: bool = False
    ) -> None:
        self.counts: Counter[str] = Counter()
        self._name = name
        self._where = f"{kind} '{name}'"
        self._peer = peer.full_name
        self._is_raw = is_raw
        self._adapter = adapter
        self._theirs = None if adapter is None else message_type(adapter.old)
        self._lock = _thread.allocate_lock()  # not threading's, which virtual time exchanges

    def read(
        self, data: bytes, kind: MessageType, decode: Callable[[bytes], Any], receiver: GraphNode
    ) -> Any:
        """The message for a receiver of type `kind`, who reads bytes of its own version by `decode`.

        None if there is none: then it was counted, and said if it is the first.
        """
        adapter, theirs = self._adapter, self._theirs
        try:
            if adapter is None or theirs is None:
                message = decode(data)
                if not (self._is_raw and _is_whole(data, kind, message)):
                    self._look_for_rest(data, kind, receiver)
                return message
            old = theirs.deserialize(data)
        except DecodeError as error:
            text = f"A message of {self._peer} does not fit {kind.name}: {error}"
            self._drop("unreadable", text, self._likely_reason(), receiver)
            return None
        try:
            message = _checked(adapter.upgrade(old), kind.cls)
            if decode is not kind.deserialize:
                return decode(kind.serialize(message))  # with views, which are of bytes
        except Exception as error:  # user code: whatever it raises, other messages go on
            self._drop_unconverted(error, receiver)
            return None
        return message

    def downgraded(self, data: bytes, kind: MessageType, sender: GraphNode) -> bytes | None:
        """The bytes for the peer of what a sender of type `kind` sends; None as for `read`."""
        adapter, theirs = self._adapter, self._theirs
        assert adapter is not None and adapter.downgrade is not None and theirs is not None
        try:
            # From bytes, so that no adapter holds the message of a user.
            old = adapter.downgrade(kind.deserialize(data))
            return theirs.serialize(_checked(old, theirs.cls))
        except Exception as error:  # user code, as above
            self._drop_unconverted(error, sender)
            return None

    def _look_for_rest(self, data: bytes, kind: MessageType, receiver: GraphNode) -> None:
        from ifgen_runtime.codec.decoding import size_of  # late: few programs need it

        rest = len(data) - size_of(data, kind.cls)
        if rest <= 0 or (self._is_raw and rest < _PADDING and len(data) % _PADDING == 0):
            return
        if self._is_first("left over"):
            text = left_over(rest, self._peer, kind.name)
            report.say(receiver, f"{self._where}: {text}. {self._likely_reason()}{_ONCE}")

    def _likely_reason(self) -> str:
        if self._is_raw:
            return "It publishes bytes: they were probably made with another definition. "
        return "Its definition of the type differs. "

    def _drop_unconverted(self, error: Exception, node: GraphNode) -> None:
        files = [(Path(frame.filename), frame.lineno) for frame in extract_tb(error.__traceback__)]
        theirs = [f" ({file.name}:{line})" for file, line in files if not _OURS.intersection(file.parts)]
        place = theirs[-1] if theirs else ""
        text = f"The adapter for {self._peer} failed with {type(error).__name__}: {error}{place}"
        self._drop("not converted", text, "", node)

    def _drop(self, trouble: str, text: str, reason: str, node: GraphNode) -> None:
        watching = observer.current()
        if watching is not None:
            watching.undelivered(self._name, 1, f"{trouble}, from {self._peer}")
        if self._is_first(trouble):
            report.say(node, f"{self._where}: {text}. It was dropped. {reason}{_ONCE}")

    def _is_first(self, trouble: str) -> bool:
        with self._lock:
            self.counts[trouble] += 1
            return self.counts[trouble] == 1


def _is_whole(data: bytes, kind: MessageType, message: Any) -> bool:
    """Whether a message takes as many bytes as it was read from: a fast answer, mostly yes."""
    try:
        return len(kind.serialize(message)) == len(data)
    except SerializationError:  # half of a surrogate pair
        return False


def _checked(message: Any, cls: type[Any]) -> Any:
    if not isinstance(message, cls):
        raise TypeError(f"it returned {type(message).__name__}, expected {cls.__name__}")
    return message
