"""The terminal and its keys: taken over for the view, and given back whatever happens."""

from __future__ import annotations

import os
import re
import select
import signal
import sys
import termios
import tty
from collections.abc import Generator
from contextlib import contextmanager, suppress
from types import FrameType
from typing import TYPE_CHECKING, Any, Final

if TYPE_CHECKING:
    from rich.text import Text

_ENTER: Final = "\x1b[?1049h\x1b[?25l"  # another screen, no cursor
_LEAVE: Final = "\x1b[?25h\x1b[?1049l"
_HOME: Final = "\x1b[H"
_LINE_END: Final = "\x1b[K"
_MOST_AT_ONCE: Final = 1024  # bytes of keys
_NAMED: Final = {
    "\x1b[A": "up",
    "\x1b[B": "down",
    "\x1b[C": "right",
    "\x1b[D": "left",
    "\x1bOA": "up",  # in the mode that some programs leave behind
    "\x1bOB": "down",
    "\x1bOC": "right",
    "\x1bOD": "left",
    "\x1b[H": "home",
    "\x1b[F": "end",
    "\x1bOH": "home",
    "\x1bOF": "end",
    "\x1b[1~": "home",
    "\x1b[4~": "end",
    "\x1b[5~": "page up",
    "\x1b[6~": "page down",
    "\x1b[Z": "backtab",
    "\t": "tab",
    "\r": "enter",
    "\n": "enter",
    "\x7f": "backspace",
    "\b": "backspace",
    "\x04": "q",  # Ctrl-D
    "\x1b": "escape",
}
_TOKEN: Final = re.compile(r"\x1b\[[0-9;?]*[ -/]*[@-~]|\x1bO[A-Za-z]|\x1b|.", re.DOTALL)


class Terminal:
    """The terminal while it is taken. `wake` ends a wait from any thread."""

    def __init__(self) -> None:
        from rich.console import Console  # rich is slow to import, and only needed here

        self._console = Console(file=sys.stdout, highlight=False, markup=False)
        self._input = sys.stdin.fileno()
        self._reader, self._writer = os.pipe()
        os.set_blocking(self._reader, False)
        os.set_blocking(self._writer, False)
        self._settings: list[Any] = termios.tcgetattr(self._input)

    @property
    def size(self) -> tuple[int, int]:
        """Columns and lines, as they are now."""
        try:
            size = os.get_terminal_size(sys.stdout.fileno())
        except OSError:
            return 80, 24
        return max(size.columns, 1), max(size.lines, 1)

    def wake(self) -> None:
        """End a wait."""
        with suppress(BlockingIOError):  # enough of them are waiting already
            os.write(self._writer, b"\0")

    def wait(self, seconds: float) -> bytes:
        """Wait for keys, for a wake or for a signal; returns the bytes of the keys.

        Raises EOFError if the terminal is gone.
        """
        ready, _, _ = select.select([self._input, self._reader], [], [], seconds)
        if self._reader in ready:
            with suppress(BlockingIOError):
                os.read(self._reader, _MOST_AT_ONCE)
        if self._input not in ready:
            return b""
        try:
            data = os.read(self._input, _MOST_AT_ONCE)
        except OSError:
            raise EOFError from None
        if not data:
            raise EOFError
        return data

    def show(self, picture: Text) -> None:
        """Draw a picture of the whole screen."""
        console = self._console
        console.width = self.size[0]
        with console.capture() as captured:
            console.print(picture, end="", no_wrap=True, overflow="crop")
        lines = captured.get().split("\n")
        self._write(_HOME + f"{_LINE_END}\r\n".join(lines) + _LINE_END)

    def take(self) -> None:
        """Take the terminal over: keys come one by one and are not echoed."""
        tty.setcbreak(self._input, termios.TCSANOW)
        self._write(_ENTER)

    def give_back(self) -> None:
        """Leave it as it was."""
        with suppress(OSError):  # it may be gone
            self._write(_LEAVE)
        with suppress(termios.error):
            termios.tcsetattr(self._input, termios.TCSANOW, self._settings)

    def close(self) -> None:
        """Let go of what is not the terminal's."""
        os.close(self._reader)
        os.close(self._writer)

    def pause(self, number: int, frame: FrameType | None) -> None:
        """Stop as Ctrl-Z says, with the terminal given back, and go on when the shell says so."""
        self.give_back()
        os.kill(os.getpid(), signal.SIGSTOP)
        self.take()

    def wakeup_descriptor(self) -> int:
        """Where Python writes when a signal comes."""
        return self._writer

    def _write(self, text: str) -> None:
        encoding = sys.stdout.encoding or "utf-8"
        data = text.encode(encoding, "replace")
        while data:
            data = data[os.write(sys.stdout.fileno(), data) :]


@contextmanager
def taken() -> Generator[Terminal]:
    """The terminal, taken over until the block ends, however it does."""
    terminal = Terminal()
    handlers = {signal.SIGWINCH: lambda *_: None, signal.SIGTSTP: terminal.pause}
    earlier = {number: signal.signal(number, handler) for number, handler in handlers.items()}
    earlier_descriptor = signal.set_wakeup_fd(terminal.wakeup_descriptor(), warn_on_full_buffer=False)
    try:
        terminal.take()
        yield terminal
    finally:
        terminal.give_back()
        signal.set_wakeup_fd(earlier_descriptor)
        for number, handler in earlier.items():
            signal.signal(number, handler)
        terminal.close()


def keys(data: bytes) -> list[str]:
    """The names of keys, or what they print; those without a meaning are left out."""
    found: list[str] = []
    for token in _TOKEN.findall(data.decode("utf-8", "replace")):
        key = _NAMED.get(token, token if len(token) == 1 and token.isprintable() else "")
        if key:
            found.append(key)
    return found
