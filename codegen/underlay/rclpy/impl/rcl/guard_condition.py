"""Guard conditions: flags that wake the threads that wait for them."""

from __future__ import annotations

from rmw_local.ready import ReadySource

from .context import Context
from .destroyable import Destroyable
from .errors import CONTEXT_NOT_VALID, RCLError


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
