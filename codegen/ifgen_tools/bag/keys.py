"""The keys of a terminal, one at a time, while a command runs."""

from __future__ import annotations

import os
import select
import sys
from collections.abc import Callable, Generator, Mapping
from contextlib import contextmanager, suppress
from typing import Final

SPACE, RIGHT, UP, DOWN = " ", "\x1b[C", "\x1b[A", "\x1b[B"
_NAMES: Final = {SPACE: "SPACE", RIGHT: "right arrow", UP: "up arrow", DOWN: "down arrow"}
_LONGEST: Final = 64


class Keyboard:
    """Calls what belongs to the keys that were pressed since the last look."""

    def __init__(self, actions: Mapping[str, tuple[str, Callable[[], object]]], is_open: bool) -> None:
        self._actions = actions
        self._is_open = is_open

    @property
    def legend(self) -> str:
        """Which key does what, in a line; empty if nobody can press one."""
        if not self._is_open:
            return ""
        return ", ".join(f"{_NAMES[key]}: {what}" for key, (what, _) in self._actions.items())

    def look(self) -> None:
        """Do what was asked for; waits for nobody."""
        if not self._is_open or not select.select([sys.stdin], [], [], 0)[0]:
            return
        text = os.read(sys.stdin.fileno(), _LONGEST).decode(errors="replace")
        if not text:  # the terminal is gone
            self._is_open = False
        while text:
            key = next((key for key in self._actions if text.startswith(key)), "")
            if key:
                self._actions[key][1]()
            text = text[len(key) or 1 :]


@contextmanager
def keyboard(
    actions: Mapping[str, tuple[str, Callable[[], object]]], *, is_wanted: bool = True
) -> Generator[Keyboard]:
    """The keys of the terminal, if there is one: for each, what it does in words, and what to call.

    Keys are not shown meanwhile, and Ctrl-C still works.
    """
    restore = _listen() if is_wanted else None
    if restore is None:
        yield Keyboard(actions, is_open=False)
        return
    try:
        yield Keyboard(actions, is_open=True)
    finally:
        restore()


def _listen() -> Callable[[], None] | None:
    """Let single keys come in; returns what takes that back, None if there is no terminal for us."""
    with suppress(ImportError, OSError, ValueError):
        import termios  # not on Windows
        import tty

        if sys.stdin is not None and sys.stdin.isatty() and _is_in_foreground():
            descriptor = sys.stdin.fileno()
            before = termios.tcgetattr(descriptor)
            tty.setcbreak(descriptor)
            return lambda: termios.tcsetattr(descriptor, termios.TCSADRAIN, before)
    return None


def _is_in_foreground() -> bool:
    """Whether the terminal is ours: a job in the background would be stopped for touching it."""
    return os.tcgetpgrp(sys.stdin.fileno()) == os.getpgrp()
