"""Runs descriptions: visits their entities, hands events to handlers, and ends everything in the end."""

from __future__ import annotations

import asyncio
import contextlib
import signal
import threading
from collections import deque
from collections.abc import Callable, Generator, Iterable, Sequence
from dataclasses import dataclass
from types import FrameType
from typing import TYPE_CHECKING, Final

from launch._errors import LaunchError, explained
from launch._process import Supervision, Watchdog
from launch.event import Event
from launch.events import ExecutionComplete, IncludeLaunchDescription, Shutdown
from launch.events.process import ProcessTargetedEvent, ShutdownProcess, SignalProcess
from launch.launch_context import LaunchContext, ProcessToStart
from launch.launch_description_entity import LaunchDescriptionEntity
from launch.logging import get_logger, launch_config, log_launch_config

if TYPE_CHECKING:
    from launch.action import Action
    from launch.actions import ExecuteLocal
    from launch.launch_description import LaunchDescription

Call = Callable[[], None]

_MAX_DEPTH: Final = 150
"""Entities within entities; more of them are files that include each other."""
_SIGKILL: Final = getattr(signal, "SIGKILL", 9)


@dataclass(eq=False)
class TimedCall:
    """A call that is still to come."""

    call: Call | None
    until_shutdown: bool

    def cancel(self) -> None:
        """Do not make it."""
        self.call = None

    def fire(self) -> None:
        """Make it now, unless it was made or cancelled."""
        call, self.call = self.call, None
        if call is not None:
            call()


class LaunchService:
    """One launch. `include_launch_description` says what to do, and `run` does it in this thread."""

    def __init__(
        self, *, argv: Iterable[str] | None = None, noninteractive: bool = False, debug: bool = False
    ) -> None:
        self._context = LaunchContext(argv=list(argv or ()), noninteractive=noninteractive)
        self._context.host = self
        if debug:
            launch_config.level = 10
        self._log = get_logger()
        self._watchdog = Watchdog()
        self._calls: deque[Call] = deque()
        self._timed: list[TimedCall] = []
        self._ends: list[Call] = []
        self._running: list[Supervision] = []
        self._wake: asyncio.Event | None = None
        self._task: asyncio.Task[None] | None = None
        self._depth = 0
        self._interruptions = 0
        self._has_failed = False
        self.exit_code = 0
        """The highest exit code of a process that died by itself; 1 after a mistake in the description."""

    @property
    def context(self) -> LaunchContext:
        """The state of this launch."""
        return self._context

    @property
    def event_loop(self) -> asyncio.AbstractEventLoop | None:
        """The loop that the launch runs in, once it does."""
        return self._context.asyncio_loop

    @property
    def task(self) -> asyncio.Task[None] | None:
        """The task that the launch runs in, while it does."""
        return self._task

    def include_launch_description(self, launch_description: LaunchDescription) -> None:
        """Visit a description, now or as soon as the launch runs."""
        self.emit(IncludeLaunchDescription(launch_description))

    def emit_event(self, event: Event) -> None:
        """Let the handlers have an event; from any thread."""
        self.emit(event)

    def shutdown(self, force_sync: bool = False) -> None:
        """End the launch; from any thread."""
        self.emit(Shutdown(reason="LaunchService.shutdown() called"))

    def run(self, *, shutdown_when_idle: bool = True) -> int:
        """Run to the end, and return 0, or 1 after a mistake in a description."""
        return asyncio.run(self.run_async(shutdown_when_idle=shutdown_when_idle))

    async def run_async(self, *, shutdown_when_idle: bool = True) -> int:
        """Run to the end in the loop of the caller, as `run`."""
        if self._task is not None:
            raise RuntimeError("this launch runs already")
        self._context.asyncio_loop = asyncio.get_running_loop()
        self._wake = asyncio.Event()
        self._context.is_shutdown = False
        self._task = asyncio.current_task()
        try:
            with self._signals():
                log_launch_config(logger=self._log)
                await self._run(shutdown_when_idle)
        finally:
            self._close()
        return int(self._has_failed)

    @contextlib.contextmanager
    def _signals(self) -> Generator[None]:
        """Take the signals that end programs, where this is the thread that gets them."""
        is_main = threading.current_thread() is threading.main_thread()
        numbers = _ending_signals() if is_main else []
        before = {number: signal.signal(number, self._on_signal) for number in numbers}
        try:
            yield
        finally:
            for number, earlier in before.items():
                signal.signal(number, earlier)

    def _close(self) -> None:
        """End what is left, and remove the temporary files."""
        self._task = None
        for each in self._running:
            each.signal(_SIGKILL)
        self._watchdog.close()
        for end in self._ends:
            end()
        self._context.files.close()
        launch_config.close()

    async def _run(self, shutdown_when_idle: bool) -> None:
        assert self._wake is not None, "it is made before"
        while not (self._context.is_shutdown and await self._stays_idle()):
            if self._calls:
                self._make(self._calls.popleft())
                if len(self._calls) % 8 == 0:  # tasks of coroutines are to go on, too
                    await asyncio.sleep(0)
                continue
            if shutdown_when_idle and not self._context.is_shutdown and await self._stays_idle():
                self._make(lambda: self._shut_down(Shutdown(reason="idle")))
                continue
            self._wake.clear()
            if not self._calls:
                await self._wake.wait()

    def _make(self, call: Call) -> None:
        try:
            call()
        except LaunchError as error:
            self.fail(error)
        except Exception as error:  # of a handler or of a condition that users wrote
            self.fail(explained(error))

    async def _stays_idle(self) -> bool:
        """Whether there is nothing to do, also after what follows from tasks that have just ended."""
        if not self._is_idle():
            return False
        await asyncio.sleep(0)
        return self._is_idle()

    def _is_idle(self) -> bool:
        waits = any(timed.call is not None for timed in self._timed)
        return not (self._running or self._calls or waits or self._context.pending_futures())

    def fail(self, error: LaunchError) -> None:
        """Report an error of the description, and end the launch."""
        self._log.error(error.message)
        if error.help:
            self._log.error(f"  = help: {error.help}")
        self.exit_code = 1
        self._has_failed = True
        if not self._context.is_shutdown:
            self._shut_down(Shutdown(reason="an error in the launch description"))

    def visit(self, entities: Sequence[LaunchDescriptionEntity]) -> None:
        """Visit entities, and what they return, in their order. Raises LaunchError."""
        self._depth += 1
        try:
            for entity in entities:
                try:
                    following = entity.visit(self._context)
                except Exception as error:
                    raise explained(error, entity.place) from error
                if following and self._depth > _MAX_DEPTH:
                    raise LaunchError("launch files include each other without an end", entity.place)
                self.visit(following or ())
        finally:
            self._depth -= 1

    def post(self, call: Call) -> None:
        """Make a call after what is going on; from any thread, and from handlers of signals."""
        self._calls.append(call)
        loop = self._context.asyncio_loop
        if loop is not None and self._wake is not None:
            with contextlib.suppress(RuntimeError):  # the loop is closed: nobody waits any more
                loop.call_soon_threadsafe(self._wake.set)

    def later(self, seconds: float | None, call: Call, *, until_shutdown: bool) -> TimedCall:
        """Make a call when so much time has passed, in the file that asks for it; None: when it is fired."""
        local = self._context.get_locals()

        def make() -> None:
            self._context.push_locals()
            self._context.extend_locals(local)
            try:
                call()
            finally:
                self._context.pop_locals()

        timed = TimedCall(make, until_shutdown)
        self._timed = [*(each for each in self._timed if each.call is not None), timed]
        if seconds is not None:
            asyncio.get_running_loop().call_later(seconds, self.post, timed.fire)
        return timed

    def at_end(self, call: Call) -> None:
        """Make a call when the launch is over."""
        self._ends.append(call)

    def emit(self, event: Event) -> None:
        """Let the handlers have an event, after what is going on."""
        if isinstance(event, Shutdown):
            self.post(lambda: None if self._context.is_shutdown else self._shut_down(event))
        else:
            self.post(lambda: self.handle(event))

    def handle(self, event: Event) -> None:
        """Let the handlers have an event now. Raises LaunchError."""
        if isinstance(event, IncludeLaunchDescription):
            self.visit([event.launch_description])
        if isinstance(event, ProcessTargetedEvent):
            for each in tuple(self._running):
                if any(event.process_matcher(action) for action in each.actions):
                    self._reach(each, event)
        for handler in tuple(self._context.event_handlers):
            if handler.matches(event):
                self._context.push_locals()
                try:
                    self.visit(handler.handle(event, self._context) or ())
                finally:
                    self._context.pop_locals()

    def _reach(self, process: Supervision, event: ProcessTargetedEvent) -> None:
        name = process.plan.name
        if isinstance(event, ShutdownProcess):
            process.stop(quietly=False)
        elif isinstance(event, SignalProcess):
            get_logger(name).info(f"sending signal '{event.signal_name}' to process[{name}]")
            process.signal(event.signal)

    def completed(self, action: Action) -> None:
        """Tell whoever waits for the end of an action."""
        event = ExecutionComplete(action=action)
        if self._context.would_handle_event(event):
            self.emit(event)

    def start(self, actions: Sequence[ExecuteLocal], process: ProcessToStart) -> None:
        """Start the process of one action, or of several. Raises LaunchError."""
        supervision = Supervision(self._context, actions, process, self._watchdog, self._ended)
        supervision.start()
        self._running.append(supervision)

    def _ended(self, process: Supervision) -> None:
        """Note that a process has come to its end, and is not respawned."""
        if process in self._running:
            self._running.remove(process)
        if process.is_stopping:  # a slow end must not hide what ended the launch
            self.exit_code = self.exit_code or process.failure
        else:
            self.exit_code = max(self.exit_code, process.failure)

    def _shut_down(self, event: Shutdown) -> None:
        self._context.is_shutdown = True
        for timed in self._timed:
            if timed.until_shutdown:
                timed.cancel()
        for future in self._context.pending_futures():
            future.cancel()
        try:
            self.handle(event)
        finally:
            for each in tuple(self._running):
                each.stop(quietly=event.due_to_sigint)

    def _on_signal(self, number: int, frame: FrameType | None) -> None:
        self.post(lambda: self._interrupt(signal.Signals(number)))

    def _interrupt(self, number: signal.Signals) -> None:
        self._interruptions += 1
        if self._interruptions == 1:
            if number == signal.SIGINT:
                text = "user interrupted with ctrl-c (SIGINT)"
            else:
                text = f"ended by {number.name}"
                self.exit_code = max(self.exit_code, 128 + number)
            self._log.warning(text)
            if not self._context.is_shutdown:
                self._shut_down(Shutdown(reason=text, due_to_sigint=True))
            return
        harder = signal.SIGTERM if self._interruptions == 2 else _SIGKILL
        self._log.warning(f"interrupted again: sending signal {int(harder)} to all processes")
        for each in tuple(self._running):
            each.signal(harder)


def _ending_signals() -> list[signal.Signals]:
    names = ("SIGINT", "SIGTERM", "SIGHUP", "SIGQUIT")
    found = [getattr(signal, name) for name in names if hasattr(signal, name)]
    return [number for number in found if signal.getsignal(number) is not signal.SIG_IGN]
