"""Reports endpoints in two processes that met and whose definitions differ."""

from __future__ import annotations

import _thread
from collections import deque
from collections.abc import Callable, Iterable, Iterator
from typing import TYPE_CHECKING, Final
from weakref import WeakKeyDictionary

from rmw_local.notices import say

if TYPE_CHECKING:
    from ifgen_runtime.mismatch.reporting import Definition
    from ifgen_runtime.mismatch.type_description_client import Definitions

    from rmw_local.domain import Domain
    from rmw_local.graph import GraphNode
    from rmw_local.mismatch.encounter import Encounter, Party
    from rmw_local.transports.background import Background
    from rmw_local.transports.interface import Transport

_MOST_PENDING: Final = 1000
"""The number of encounters with other definitions that wait to be reported."""


class Reporter:
    """Asks for the other definitions, and warns, on a thread that lives while there is something to report.

    It is a thread of its own because listeners and loggers are code of users, and answers take time.
    """

    def __init__(self, domain: Domain, transport: Transport, background: Background) -> None:
        self._background = background
        self._pending: deque[Encounter] = deque(maxlen=_MOST_PENDING)
        self._lock = _thread.allocate_lock()  # not threading's, which virtual time exchanges
        self._is_reporting = self._is_over = False
        self._definitions: Definitions | None = None  # once there is something to ask
        self._domain = domain
        self._transport = transport
        self._actions: WeakKeyDictionary[GraphNode, WeakKeyDictionary[GraphNode, set[str]]]
        self._actions = WeakKeyDictionary()

    def report(self, encounters: Iterable[Encounter]) -> None:
        """Report them later."""
        with self._lock:
            self._pending.extend(encounters)
            begins = bool(self._pending) and not (self._is_reporting or self._is_over)
            self._is_reporting = self._is_reporting or begins
        if begins:
            self._background.start(self._report_all)

    def close(self) -> None:
        """Say nothing more, once the warning that is being made is finished."""
        self._is_over = True

    def _report_all(self) -> None:
        # Late, and here: definitions hardly ever differ.
        from rmw_local.transports.type_descriptions import definitions, question

        if self._definitions is None:
            self._definitions = definitions(self._domain, self._transport, lambda: self._is_over)
        answers = self._definitions
        while batch := self._taken():
            answers.ask(question(each.theirs) for each in batch)
            for encounter in self._without_repetitions(batch):
                self._report(encounter, lambda party: answers.get(question(party)))

    def _taken(self) -> list[Encounter]:
        """All that is to be reported; with nothing, the thread ends."""
        with self._lock:
            batch = [] if self._is_over else list(self._pending)
            self._pending.clear()
            self._is_reporting = bool(batch)
        return batch

    def _report(self, encounter: Encounter, elsewhere: Callable[[Party], Definition | None]) -> None:
        from rmw_local.mismatch.reporting import report  # late: only nodes that differ need it

        if self._is_over or encounter.mine.node.participant.has_ended:
            return
        try:
            report([encounter], elsewhere)
        except Exception as error:  # code of users: the next warning is to come, whatever it does
            say(f"a listener for definitions that differ failed with {error!r}")

    def _without_repetitions(self, batch: Iterable[Encounter]) -> Iterator[Encounter]:
        """All but further parts of an action of which a pair of nodes has been reported."""
        from rmw_local.mismatch.reporting import part_of_action  # late: as above

        for encounter in sorted(batch, key=lambda each: part_of_action(each)[1]):
            action, _ = part_of_action(encounter)
            if action:
                by_peer = self._actions.setdefault(encounter.mine.node, WeakKeyDictionary())
                reported = by_peer.setdefault(encounter.theirs.node, set())
                if action in reported:
                    continue
                reported.add(action)
            yield encounter
