"""The end of a program: its exit code, and the output about an error."""

from __future__ import annotations

import importlib
import sys
import traceback
from pathlib import Path
from types import TracebackType

INTERRUPTED = 130
"""The exit code that a shell reports for a program that Ctrl-C ended."""

PATIENCE = 5.0
"""Seconds that interrupted programs have for ending, all at once."""

_HERE = Path(__file__).parent
_IMPORTING = {importlib.__file__, "<frozen importlib._bootstrap>", "<frozen importlib._bootstrap_external>"}
"""The files of Python's own part of an import, as frames name them."""


def exit_code(ending: BaseException | None) -> int:
    """The code that a process would end with whose program ended so; None: it came to its end."""
    if ending is None:
        return 0
    if isinstance(ending, KeyboardInterrupt):
        return INTERRUPTED
    if not isinstance(ending, SystemExit):
        return 1
    if ending.code is None:
        return 0
    return ending.code & 0xFF if isinstance(ending.code, int) else 1


def is_interruption(ending: BaseException | None) -> bool:
    """Whether it is what Ctrl-C ends a program with."""
    executors = sys.modules.get("rclpy.executors")
    kinds = (KeyboardInterrupt, *([executors.ExternalShutdownException] if executors else []))
    return isinstance(ending, kinds)


def tell(ending: BaseException) -> None:
    """Print what Python would at the end of a program: an error, or the words that it left with."""
    if isinstance(ending, SystemExit):
        if ending.code is not None and not isinstance(ending.code, int):
            print(ending.code, file=sys.stderr)
        return
    each: BaseException | None = ending
    while each is not None:
        each.__traceback__ = _without_ours(each.__traceback__)
        each = each.__cause__ or each.__context__
    hook = sys.excepthook
    if hook is not sys.__excepthook__ or sys.stderr is None or sys.stderr.isatty():
        hook(type(ending), ending, ending.__traceback__)
    else:
        # In one piece: another program may print as well.
        print("".join(traceback.format_exception(ending)), end="", file=sys.stderr, flush=True)


def _without_ours(trace: TracebackType | None) -> TracebackType | None:
    """A traceback without the frames of this package, which run a program and are no part of it."""
    outside = trace
    while outside is not None and (_is_ours(outside) or outside.tb_frame.f_code.co_filename in _IMPORTING):
        outside = outside.tb_next
    frame = outside
    while frame is not None:
        while frame.tb_next is not None and _is_ours(frame.tb_next):
            frame.tb_next = frame.tb_next.tb_next
        frame = frame.tb_next
    return outside


def _is_ours(trace: TracebackType) -> bool:
    """Whether a frame is one of this package."""
    return Path(trace.tb_frame.f_code.co_filename).parent == _HERE
