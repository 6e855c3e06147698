"""Programs that do what they are told, and all that they may do instead."""

from __future__ import annotations

import os
import sys
from collections.abc import Iterator
from contextlib import closing, contextmanager
from importlib.metadata import version
from pathlib import Path

import pytest

from tests.interop.bench import exchange
from tests.interop.bench.exchange import Absent, Failed, Lacking, Program

ACTOR = str(Path(__file__).parent / "actors.py")


@contextmanager
def program(how: str) -> Iterator[Program]:
    words = [sys.executable, ACTOR, how]
    with closing(Program("the actor", words, {"node": "actor"}, os.environ)) as started:
        yield started


def test_it_says_its_versions_and_does_what_it_is_told() -> None:
    with program("obeys") as actor:
        assert actor.node == "actor"
        assert actor.versions == {"pytest": version("pytest"), "imaginary": ""}
        assert actor.do("send", topic="/a", value={"data": "0.1, ä"}) is None
        assert actor.do("received", topic="/a", count=1, seconds=0.0) == [{"data": "0.1, ä"}]
        with pytest.raises(Lacking, match="it has no actions"):
            actor.do("act", action="/a")
        with pytest.raises(Failed, match="the actor: TypeError: "):
            actor.do("received", nonsense=1)
        assert actor.do("received", topic="/a", count=0, seconds=0.0) == []


@pytest.mark.parametrize(
    ("how", "kind", "words"),
    [
        ("absent", Absent, "there is no module 'imaginary'"),
        ("refuses", Failed, "the actor: RuntimeError: the router did not"),
        ("no program", Failed, "the actor ended with exit code 7"),
    ],
)
def test_what_does_not_start(how: str, kind: type[Exception], words: str) -> None:
    with pytest.raises(kind) as raised, program(how):
        pass
    assert str(raised.value) == words


def test_what_never_answers_is_given_up(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(exchange, "_TO_START", 0.2)
    monkeypatch.setattr(exchange, "_TO_END", 0.2)
    with pytest.raises(Failed, match=r"the actor did not answer within 0\.2 s"), program("silent"):
        pass


def test_a_crash_has_its_signal_and_its_last_word() -> None:
    with program("crashes") as actor, pytest.raises(Failed) as raised:
        actor.do("send", topic="/a", value={})
    assert str(raised.value) == "the actor ended by SIGSEGV: a last word"


def test_a_hanging_program_is_killed(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(exchange, "_TO_ANSWER", 0.2)
    monkeypatch.setattr(exchange, "_TO_END", 0.2)
    with program("hangs") as actor, pytest.raises(Failed, match=r"did not answer within 0\.2 s"):
        actor.do("send", topic="/a", value={})
