"""The context handle, one `init` to `shutdown`; guard conditions in it; and the signals that end it."""

from __future__ import annotations

import signal
import threading
import weakref
from types import FrameType

from ifgen_runtime import domains
from rmw_local.graph import Participant
from rmw_local.ready import ReadySource

from rclpy.impl import program

from .arguments import Arguments, parse_context_arguments, warn_of_unused
from .handle import CONTEXT_NOT_VALID, Destroyable, RCLError
from .structs import ScopedEnum

# Stands for "take the domain from the environment".
RCL_DEFAULT_DOMAIN_ID = 2**64 - 1


class Context(Destroyable):
    """The owner of nodes. `valid` is a plain attribute for speed: every publish reads it."""

    def __init__(self, args: list[str], domain_id: int) -> None:
        super().__init__()
        if not isinstance(args, list):
            raise TypeError(f"args must be a list of str, such as sys.argv, got {args!r}")
        if not isinstance(domain_id, int) or domain_id < 0:
            raise TypeError(f"domain_id must be an int of 0 or more, got {domain_id!r}")
        self.arguments: Arguments = parse_context_arguments(args)
        self.domain_id = _domain_of_environment() if domain_id == RCL_DEFAULT_DOMAIN_ID else domain_id
        self.participant = Participant(self.domain_id)
        self.program = program.current()
        self.valid = True
        self.program.contexts.add(self)
        if self.arguments.parameters:
            weakref.finalize(self, warn_of_unused, self.arguments)  # at the end of the process at the latest

    def ok(self) -> bool:
        """Whether it was not shut down."""
        return self.valid

    def get_domain_id(self) -> int:
        """The domain, while the context is valid."""
        if not self.valid:
            raise RCLError("Failed to get domain id: error not set")
        return self.domain_id

    def shutdown(self) -> None:
        """Make it invalid; everything that was made in it refuses to work from now on."""
        if not self.valid:
            raise RCLError("failed to shutdown: rcl_shutdown already called on the given context")
        self.invalidate()

    def invalidate(self) -> None:
        """Shut down, unless that has happened. Signal handlers call it too, so it takes no lock."""
        self.valid = False
        self.participant.has_ended = True

    def _on_destroy(self) -> None:
        self.invalidate()


def _domain_of_environment() -> int:
    try:
        return domains.of_environment()
    except ValueError as error:
        raise RCLError(f"failed to initialize rcl: {error}") from None


class GuardCondition(Destroyable, ReadySource):
    """A flag that is set by `trigger_guard_condition` and cleared by the wait that sees it."""

    def __init__(self, context: Context) -> None:
        Destroyable.__init__(self)
        ReadySource.__init__(self)
        if not context.valid:
            raise RCLError(f"failed to create guard_condition: {CONTEXT_NOT_VALID}")
        self.context = context
        self._triggered = False

    def trigger_guard_condition(self) -> None:
        """Set the flag; any thread, also from a signal handler."""
        if self._destroyed:
            raise RCLError("failed to trigger guard condition: guard_condition argument is null")
        self._triggered = True
        self.notify()

    def is_ready(self) -> bool:
        """Whether it was triggered since the last `take`."""
        return self._triggered

    def take(self) -> bool:
        """Clear the flag; True if it was set."""
        was, self._triggered = self._triggered, False
        return was


class SignalHandlerOptions(ScopedEnum):
    """The signals that rclpy handles; the values are bits."""

    NO = 0
    SIGINT = 1
    SIGTERM = 2
    ALL = 3


_SIGNALS = {1: signal.SIGINT, 2: signal.SIGTERM}


def install_signal_handlers(options: SignalHandlerOptions) -> None:
    """Handle these signals from now on; those handled already stay so."""
    here = program.current()
    here.signal_options |= options.value
    # Python hands signals to the main thread only.
    if threading.current_thread() is not threading.main_thread():
        return
    for bit, number in _SIGNALS.items():
        if options.value & bit and signal.getsignal(number) is not _handle:
            here.earlier_handlers[number] = signal.signal(number, _handle)
            here.signal_handler = _handle


def uninstall_signal_handlers() -> None:
    """Restore the handlers of before."""
    here = program.current()
    here.signal_options = 0
    if threading.current_thread() is not threading.main_thread():
        return
    for number, earlier in list(here.earlier_handlers.items()):
        if signal.getsignal(number) is _handle:  # else the program has replaced us: leave its handler alone
            signal.signal(number, earlier)
        del here.earlier_handlers[number]


def get_current_signal_handlers_options() -> SignalHandlerOptions:
    """Return which signals are handled."""
    return SignalHandlerOptions(program.current().signal_options)


def register_sigint_guard_condition(guard: GuardCondition) -> None:
    """Let signals trigger this guard condition."""
    guard.context.program.interrupt_guards.add(guard)


def unregister_sigint_guard_condition(guard: GuardCondition) -> None:
    """Take back `register_sigint_guard_condition`."""
    try:
        guard.context.program.interrupt_guards.remove(guard)
    except KeyError:
        raise ValueError("Guard condition was not registered") from None


def _handle(number: int, frame: FrameType | None) -> None:
    # The main thread may hold any lock of ours at this point, so nothing here takes one.
    here = program.current()
    here.invalidate_contexts()
    earlier = here.earlier_handlers.get(number)
    if callable(earlier):
        earlier(number, frame)
