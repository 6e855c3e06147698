"""Commands that other distributions add by entry points."""

from __future__ import annotations

import re
from collections.abc import Iterator
from importlib.metadata import entry_points

import click
import pytest
from ifgen.cli import plugins

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
    others = {name: plugins.Plugin(name=name, value=value) for name, value in values.items()}
    monkeypatch.setattr(plugins, "_others", lambda: others)
    yield


@pytest.mark.usefixtures("added")
def test_they_are_run_listed_and_suggested(ifgen: Run) -> None:
    done = ifgen("greet")
    assert (done.code, done.out, done.err) == (0, "hello\n", "")
    assert re.search(r"^  greet +Say hello\.$", ifgen("--help").out, re.MULTILINE)
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


def test_ours_are_read_as_importlib_reads_them(monkeypatch: pytest.MonkeyPatch) -> None:
    """So that a command of ours takes no 20 ms more, and a format of the file that changes does not hide them."""
    read = {name: plugin.value for name, plugin in plugins._own().items()}
    installed = entry_points(group="ifgen.commands")
    assert read == {
        point.name: point.value for point in installed if point.dist and point.dist.name == "ifgen-ros"
    }
    assert "generate" in read
    monkeypatch.setattr(plugins, "_own", dict)  # where the metadata is of another version
    plugins._others.cache_clear()  # an earlier test has asked
    assert plugins.command("generate") is not None
    plugins._others.cache_clear()
