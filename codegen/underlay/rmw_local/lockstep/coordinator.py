"""The coordinator of a lockstep run: rounds, and the time, of all its processes.

A round ends when no process has anything more to do. What they have sent is exchanged then, and those who
get something run one more round at the same time. If nobody gets anything, time passes to the earliest
deadline of all.
"""

from __future__ import annotations

import multiprocessing
import os
import pickle
import socket
import time
from collections.abc import Callable, Generator, Sequence
from contextlib import contextmanager, suppress
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, Final

from rmw_local.lockstep import LockstepError
from rmw_local.lockstep.participant import take_part
from rmw_local.lockstep.side import Channel

if TYPE_CHECKING:
    from rmw_local.lockstep.side import Change
    from rmw_local.lockstep.transport import Item

_START: Final = 120.0  # [s], real, that a process may take until its program begins
_FAREWELL: Final = 5.0  # [s], real, that processes have for their ends
_HASHES: Final = "PYTHONHASHSEED"
_SECOND: Final = 1_000_000_000  # [ns]
# Programs that always answer each other at once would stop time. From this number of rounds on, each further
# one takes some.
_ROUNDS: Final = 10_000
_ROUND_TAKES: Final = 100_000  # [ns]


@dataclass(slots=True)
class _Process:
    """A process, as the coordinator sees it."""

    number: int
    name: str
    process: Any
    channel: Channel
    runs: bool = True  # it has not yet said that it has nothing more to do
    keeps: bool = False  # it has sent something to itself
    deadline: int | None = None  # [ns, steady]
    mail: list[list[Item]] = field(default_factory=list["list[Item]"])
    ending: tuple[Any, int, str] | None = None  # its result, exit code, and what is wrong


class Coordinator:
    """Runs programs, each in a process, until the last one ends."""

    def __init__(
        self, programs: Sequence[Callable[[], Any]], names: Sequence[str], seed: int, patience: float
    ) -> None:
        self._now = 0  # [ns], steady
        self._rounds = 0
        self._has_begun = False
        self._patience = patience
        self._changes: list[tuple[int, Change]] = []  # by the number of the process that they come from
        self._gone: list[int] = []
        named = list(zip(names, programs, strict=True))
        for name, program in named:
            _check(name, program)
        with _same_hashes():
            self._all = [_start(number, *each, seed) for number, each in enumerate(named)]

    def run(self) -> Any:
        """Run them; returns what the last one does. Raises LockstepError."""
        try:
            for each in self._all:
                each.channel.be_patient(_START)
                self._receive(each)
                each.channel.be_patient(self._patience)
            self._has_begun = True
            while self._all[-1].ending is None:
                self._finish_round()
                if self._all[-1].ending is None:
                    self._begin_round()
        except BaseException as error:
            self._end_others(str(error) if isinstance(error, LockstepError) else "")
            raise
        else:
            self._end_others("")
        finally:
            self._clean_up()
        assert self._all[-1].ending is not None
        return self._all[-1].ending[0]

    # A round

    def _finish_round(self) -> None:
        for each in self._all:
            if each.runs:
                self._hear(each)
        if self._changes or self._gone:
            self._introduce()

    def _hear(self, each: _Process) -> None:
        """Wait until a process has nothing more to do, or ends."""
        what, *rest = self._receive(each)
        each.runs = False
        if what == "ended":
            each.ending, changes, mail = rest
            self._gone.append(each.number)
            _, code, why = rest[0]
            if code:
                raise LockstepError(f"{each.name} ended the run at {self._clock()}: {why}", code)
        else:
            each.deadline, now, each.keeps, changes, mail = rest
            self._now = max(self._now, now)
        self._changes += [(each.number, change) for change in changes]
        self._post(mail)

    def _introduce(self) -> None:
        """Tell all processes who has come and gone, and take what newcomers have missed."""
        changes, gone = self._changes, self._gone
        self._changes, self._gone = [], []
        present = self._present()
        for each in present:
            new = [change for number, change in changes if number != each.number]
            self._send(each, "graph", new, gone)
        for each in present:
            _, mail = self._receive(each)
            self._post(mail)
            each.keeps = True  # whoever waits for a change of the graph goes on

    def _begin_round(self) -> None:
        """Let those go on who have something to do, now or as soon as anybody has."""
        present = self._present()
        able = [each for each in present if each.keeps or each.mail]
        self._rounds = self._rounds + 1 if able else 0
        if self._rounds > _ROUNDS:
            self._now += _ROUND_TAKES
        elif not able:
            deadlines = [each.deadline for each in present if each.deadline is not None]
            if not deadlines:
                names = ", ".join(each.name for each in present)
                raise LockstepError(
                    f"nothing will ever happen again after {self._clock()}: each program waits for another "
                    f"one, without a timeout: {names}"
                )
            self._now = max(self._now, min(deadlines))
        for each in present:
            if each.keeps or each.mail or (each.deadline is not None and each.deadline <= self._now):
                mail, each.mail = each.mail, []
                each.runs, each.keeps = True, False
                self._send(each, "go", self._now, mail)

    def _post(self, mail: dict[int, list[Item]]) -> None:
        for number, items in mail.items():
            self._all[number].mail.append(items)

    def _present(self) -> list[_Process]:
        return [each for each in self._all if each.ending is None]

    def _clock(self) -> str:
        return f"{self._now / _SECOND:.3f} s"

    # What may go wrong

    def _send(self, each: _Process, *what: Any) -> None:
        try:
            each.channel.send(what)
        except OSError:
            self._lose(each)

    def _receive(self, each: _Process) -> Any:
        try:
            return each.channel.receive()
        except TimeoutError:
            each.process.kill()
            raise LockstepError(
                f"{each.name} has been busy at {self._clock()} for {self._patience:g} s of real time: it "
                "computes without end, or waits for something outside of the run, such as a socket"
            ) from None
        except (EOFError, OSError):
            self._lose(each)

    def _lose(self, each: _Process) -> None:
        each.process.join(_FAREWELL)
        code = each.process.exitcode
        how = f"killed by signal {-code}" if code is not None and code < 0 else f"gone with exit code {code}"
        when = f"at {self._clock()}" if self._has_begun else "before it began: can its process import it?"
        raise LockstepError(f"{each.name} was {how} {when}") from None

    def _end_others(self, why: str) -> None:
        """End those who are still there, with the reason if the run has failed."""
        left = [each for each in self._present() if each.process.is_alive()]
        for each in left:
            with suppress(OSError):
                each.channel.send(("end", why))
        end = time.monotonic() + _FAREWELL
        for each in left:
            each.process.join(max(end - time.monotonic(), 0.0))
            code = each.process.exitcode
            if code and not why:
                raise LockstepError(f"{each.name} ended with exit code {code} when it was interrupted")
            if code is None and not why:
                raise LockstepError(f"{each.name} did not end within {_FAREWELL:g} s after the last program")

    def _clean_up(self) -> None:
        for each in self._all:
            each.process.kill()
            each.process.join()
            each.channel.close()


@contextmanager
def _same_hashes() -> Generator[None]:
    """Let processes that start in this block have the same order in sets, in every run."""
    is_chosen = _HASHES in os.environ
    os.environ.setdefault(_HASHES, "0")
    try:
        yield
    finally:
        if not is_chosen:
            del os.environ[_HASHES]


def _check(name: str, program: Callable[[], Any]) -> None:
    try:
        pickle.dumps(program)
    except (pickle.PicklingError, AttributeError, TypeError) as error:
        raise LockstepError(f"{name} cannot be called in another process: {error}") from None


def _start(number: int, name: str, program: Callable[[], Any], seed: int) -> _Process:
    here, there = socket.socketpair()
    process = multiprocessing.get_context("spawn").Process(
        target=take_part, args=(there, number, name, seed, program), name=name
    )
    process.start()
    there.close()
    return _Process(number, name, process, Channel(here))
