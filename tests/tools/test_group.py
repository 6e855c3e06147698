"""How tools end."""

from __future__ import annotations

import signal
import sys

import click
import pytest
from ifgen.cli import plugins
from ifgen.command_kit.tool import ToolError, ToolGroup
from ifgen.signals import Terminated

from tests.cli.conftest import Run


class ExternalShutdownException(Exception):
    """Called as rclpy's, which is the one that counts."""


RAISED: dict[str, BaseException] = {
    "ctrl-c": KeyboardInterrupt(),
    "term": Terminated(),
    "shutdown": ExternalShutdownException(),
    "mistake": ToolError("This is wrong.", "do that"),
}


SIGNALS = {"SIGINT": signal.SIGINT, "SIGTERM": signal.SIGTERM}


@click.group(cls=ToolGroup)
def tool() -> None:
    """A tool."""


@tool.command()
@click.argument("what")
def end(what: str) -> None:
    """End in one way or another."""
    if what in RAISED:
        raise RAISED[what]
    if what in SIGNALS:
        signal.raise_signal(SIGNALS[what])
    elif what == "half made":
        HalfMade(signal.SIGTERM)
    elif what == "import":
        try:
            signal.raise_signal(signal.SIGINT)
        except KeyboardInterrupt:
            raise ImportError("initialization failed") from None


class HalfMade:
    """The signal comes in its constructor, so that its finaliser misses an attribute."""

    def __init__(self, number: int) -> None:
        signal.raise_signal(number)
        self.handle = number

    def __del__(self) -> None:
        assert self.handle


@pytest.mark.parametrize(
    ("what", "code", "said"),
    [
        ("well", 0, ""),
        ("ctrl-c", 2, ""),
        ("term", 15, ""),
        ("shutdown", 15, ""),
        ("SIGINT", 2, ""),
        ("SIGTERM", 15, ""),
        ("import", 2, ""),
        ("half made", 15, ""),
        ("mistake", 1, "error: this is wrong\n  = help: do that\n"),
    ],
)
def test_ends(ifgen: Run, monkeypatch: pytest.MonkeyPatch, what: str, code: int, said: str) -> None:
    monkeypatch.setattr(plugins, "names", lambda: ["tool"])
    # pytest's own keeps what it hears to itself.
    monkeypatch.setattr(sys, "unraisablehook", sys.__unraisablehook__)
    monkeypatch.setattr(plugins, "command", lambda name: tool if name == "tool" else None)
    done = ifgen("tool", "end", what)
    assert (done.code, done.out, done.err) == (code, "", said)
