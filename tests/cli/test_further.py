"""Commands that other distributions add by entry points."""

from __future__ import annotations

from collections.abc import Iterator
from importlib.metadata import EntryPoint

import click
import pytest
from ifgen.cli import further

from .conftest import Run


@click.command()
def greet() -> None:
    """Say hello."""
    print("hello")


@pytest.fixture
def added(monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    values = {
        "greet": f"{__name__}:greet",
        "broken": "no_such_module:command",
        "odd": "os:sep",
        "check": "os:sep",
    }
    found = {name: EntryPoint(name, value, "ifgen.commands") for name, value in values.items()}
    monkeypatch.setattr(further, "_entry_points", lambda: found)
    yield


@pytest.mark.usefixtures("added")
def test_they_are_run_listed_and_suggested(ifgen: Run) -> None:
    done = ifgen("greet")
    assert (done.code, done.out, done.err) == (0, "hello\n", "")
    assert "  greet       Say hello.\n" in ifgen("--help").out
    assert "did you mean 'greet'?" in ifgen("gret").err


@pytest.mark.usefixtures("added")
def test_own_commands_come_first(ifgen: Run) -> None:
    assert "Look for mistakes" in ifgen("check", "--help").out


@pytest.mark.usefixtures("added")
@pytest.mark.parametrize(
    ("name", "why"), [("broken", "No module named 'no_such_module'"), ("odd", "no click command")]
)
def test_one_that_cannot_be_loaded_says_why(ifgen: Run, name: str, why: str) -> None:
    done = ifgen(name, "--some", "words")
    assert done.code == 1
    assert done.err.startswith(f"error: the command '{name}' cannot be loaded from ")
    assert why in done.err
    assert "Cannot be loaded." in ifgen("--help").out
