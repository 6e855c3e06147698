"""The thread that looks at the graph of a context: who meets one of our endpoints with another definition.

It polls, since rclpy has no public graph event. A look counts the others of each endpoint, which takes a
microsecond, and reads their infos where the count has changed. Besides, it reads those of some endpoints in
turn: one may have left while another came. What a look costs decides when the next one is.

It never holds a lock while it calls rclpy, and DDS calls nothing of Python's under its own locks. So looking
cannot deadlock with what the program's threads do.
"""

from __future__ import annotations

import atexit
import os
import threading
import time
import weakref
from collections.abc import Iterable, Iterator
from typing import Any, Final

from rclpy.exceptions import InvalidHandle

from ifgen_runtime.mismatch.policy import OnTypeMismatch
from ifgen_runtime.real_rclpy.endpoints import Endpoint, Part
from ifgen_runtime.real_rclpy.peers import Peer, applied, differs, peers
from ifgen_runtime.real_rclpy.reporting import Meeting, Reporter, UnreadableBytes

_PERIOD: Final = 0.25
"""Seconds between two looks, at least."""

_SHARE: Final = 50
"""The pause after a look, in times that the look took: 2 % of one core at most."""

_CHANGED_BUDGET: Final = 0.008
"""Seconds that one look spends on endpoints whose others have changed; the rest waits for the next."""

_TURN_BUDGET: Final = 0.0005
"""Seconds that one look spends on endpoints in turn."""

_NAMELESS: Final = 2
"""How many looks wait for the name of a node: it comes a little later than its endpoints."""

_NAMED: Final = 3
"""How many nodes a warning about bytes names."""

_NO_ACTIONS: Final = "Actions are not adapted on real rclpy"
_NO_ADAPTER: Final = "No adapter fits"
_MIXED: Final = "The {0.others}s have several definitions, and this rclpy does not tell whose a message is"

_LEAVING: Final = 2.0
"""Seconds that the interpreter waits for the thread when it exits."""


class Watch:
    """Watches the endpoints of one context, until it is shut down."""

    def __init__(self, context: Any) -> None:
        self._context = context
        self._nodes: dict[int, _Node] = {}  # by the identity of rclpy's
        self._turn = 0
        self._stop = threading.Event()
        self._reporter = Reporter(context, self._stop)
        self._unreadable = UnreadableBytes()
        self._thread = threading.Thread(target=self._run, name="ifgen type mismatch", daemon=True)
        self._thread.start()
        context.on_shutdown(self._stop.set)

    def note(self, node: Any, endpoint: Endpoint) -> None:
        """Watch an endpoint of a node from now on. Any thread may call it."""
        known = self._nodes.get(id(node))
        if known is None or known.node() is not node:
            known = self._nodes[id(node)] = _Node(endpoint.node_of)
        known.endpoints.append(endpoint)

    def endpoints_of(self, node: Any) -> list[Endpoint]:
        """The endpoints of a node that exist."""
        known = self._nodes.get(id(node))
        return [] if known is None else [endpoint for endpoint in known.endpoints if endpoint.is_alive()]

    def stop(self) -> None:
        """End the thread, and wait for that."""
        self._stop.set()
        self._thread.join(_LEAVING)

    def _run(self) -> None:
        pause = _PERIOD
        while not self._stop.wait(pause) and self._context.ok():
            began = time.thread_time()
            try:
                self._look()
                pause = max(_PERIOD, _SHARE * (time.thread_time() - began))
                self._reporter.report(self._endpoints())
            except Exception as error:  # a thread has nobody to raise to, and the next look may succeed
                self._reporter.complain(error)
        _watches.pop(self._context, None)

    def _endpoints(self) -> list[Endpoint]:
        return [endpoint for node in tuple(self._nodes.values()) for endpoint in node.endpoints]

    def _look(self) -> None:
        """Look once: at endpoints whose others have changed, and at some of the rest."""
        changed: list[Endpoint] = []
        for key, node in tuple(self._nodes.items()):
            if not node.count(changed):
                del self._nodes[key]
        # Where both sides are in this process, the one that receives speaks.
        changed.sort(key=lambda endpoint: not endpoint.receives)
        self._meet_some(changed, _CHANGED_BUDGET)
        endpoints = self._endpoints()
        self._turn = self._turn % len(endpoints) if endpoints else 0
        self._turn += self._meet_some(endpoints[self._turn :] + endpoints[: self._turn], _TURN_BUDGET)
        self._unreadable.look(endpoints)

    def _meet_some(self, endpoints: Iterable[Endpoint], budget: float) -> int:
        """Read whom endpoints meet, for `budget` [s]; returns how many it was."""
        until = time.monotonic() + budget
        met = 0
        for endpoint in endpoints:
            if time.monotonic() > until:
                break
            met += 1
            try:
                self._meet(endpoint)
            except InvalidHandle:  # destroyed meanwhile
                continue
            except Exception as error:  # whatever is wrong with one, the others are looked at
                self._reporter.complain(error)
        return met

    def _meet(self, endpoint: Endpoint) -> None:
        """Read whom an endpoint meets. Raises InvalidHandle where its node has been destroyed."""
        node = endpoint.node
        if node is None or not endpoint.is_alive():
            self._forget(endpoint)
            return
        count = getattr(node.handle, endpoint.count_by)(endpoint.counted)
        others: list[tuple[Part, Peer]] = []
        if count:  # infos take ten times as long
            others = [(part, peer) for part in endpoint.parts for peer in peers(node, part)]
        if endpoint.guard is not None:
            endpoint.guard.see(others)
        is_mixed = endpoint.guard is not None and endpoint.guard.must_agree and _are_mixed(others)
        others = [(part, peer) for part, peer in others if differs(peer, part) or not peer.type_hash]
        if endpoint.tries < _NAMELESS and not all(peer.node for _, peer in others):
            endpoint.tries += 1
            return
        if endpoint.seen < 0:
            self._unreadable.note(endpoint)
        endpoint.tries, endpoint.seen = 0, count
        endpoint.differing = _names(others) or endpoint.differing
        for part, peer in _first_parts(others):
            hashes = [(of, found.type_hash) for of, found in others if found.node == peer.node]
            policy, reason = applied(endpoint.policy, endpoint.role, hashes), ""
            if endpoint.policy is OnTypeMismatch.ADAPT and policy is OnTypeMismatch.REFUSE:
                reason = _NO_ACTIONS if endpoint.kind == "action" else _NO_ADAPTER
            elif policy is OnTypeMismatch.ADAPT and is_mixed:
                policy, reason = OnTypeMismatch.REFUSE, _MIXED.format(endpoint)
            self._reporter.note(Meeting(endpoint, part, peer, policy, reason))

    def _forget(self, endpoint: Endpoint) -> None:
        for node in tuple(self._nodes.values()):
            if endpoint in node.endpoints:
                node.endpoints.remove(endpoint)
        if endpoint.guard is not None:
            endpoint.guard.end()


class _Node:
    """The endpoints of one node."""

    def __init__(self, node: weakref.ref[Any]) -> None:
        self.node = node
        self.endpoints: list[Endpoint] = []

    def count(self, changed: list[Endpoint]) -> bool:
        """Collect the endpoints whose others have changed; False if the node is gone."""
        node = self.node()
        if node is None:
            return False
        try:
            handle = node.handle
            with handle:
                changed += [e for e in self.endpoints if getattr(handle, e.count_by)(e.counted) != e.seen]
        except InvalidHandle:
            return False
        return True


def _are_mixed(others: Iterable[tuple[Part, Peer]]) -> bool:
    """Whether those on one of the parts have several definitions."""
    hashes: dict[str, str] = {}
    return any(
        hashes.setdefault(part.topic, known) != known
        for part, peer in others
        for known in [peer.type_hash or part.type_hash]
    )


def _names(others: list[tuple[Part, Peer]]) -> tuple[str, ...]:
    return tuple(sorted({peer.node for _, peer in others if peer.node and peer.type_hash}))[:_NAMED]


def _first_parts(others: list[tuple[Part, Peer]]) -> Iterator[tuple[Part, Peer]]:
    """Of a service or an action, the first part that differs at each node: it is one mismatch."""
    parts: dict[str, Part] = {}
    for part, peer in others:
        if parts.setdefault(peer.node, part) is part:
            yield part, peer


_watches: dict[Any, Watch] = {}
_lock = threading.Lock()


def watch_of(context: Any) -> Watch:
    """The watch of a context, which starts with its first endpoint."""
    with _lock:
        if context not in _watches:
            _watches[context] = Watch(context)
        return _watches[context]


@atexit.register
def _leave() -> None:
    """End all threads while Python can still run them."""
    for watch in tuple(_watches.values()):
        watch.stop()


def _start_over() -> None:
    """In a forked child there are no threads."""
    _watches.clear()
    _lock.release()


os.register_at_fork(before=_lock.acquire, after_in_parent=_lock.release, after_in_child=_start_over)
