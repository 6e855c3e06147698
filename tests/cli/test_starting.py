"""The moment before the command line runs."""

from __future__ import annotations

import signal
import sys
from importlib.abc import MetaPathFinder
from importlib.machinery import ModuleSpec

import pytest
from ifgen import __main__ as program

COMMAND_LINE = "ifgen.cli.main"


class Impatient(MetaPathFinder):
    """Somebody who presses Ctrl-C while the command line is imported."""

    def find_spec(self, fullname: str, path: object, target: object = None) -> ModuleSpec | None:
        if fullname == COMMAND_LINE:
            raise KeyboardInterrupt
        return None


def test_ctrl_c_before_it_begins(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    monkeypatch.delitem(sys.modules, COMMAND_LINE, raising=False)
    monkeypatch.setattr(sys, "meta_path", [Impatient(), *sys.meta_path])
    before = signal.getsignal(signal.SIGINT)
    try:
        assert program.main() == 130
    finally:  # ignored by now, as it would be in the programs that later tests start
        signal.signal(signal.SIGINT, before)
    assert capsys.readouterr().err == ""
