"""`make interop`: its table, its options and its exit codes."""

from __future__ import annotations

import json
import sys
from collections.abc import Iterator, Sequence
from typing import Any

import pytest
from click.testing import CliRunner, Result

from tests.interop.bench import __main__ as command
from tests.interop.bench import environments
from tests.interop.bench.outcomes import Cell, Check, Feature, Outcome, Row
from tests.interop.bench.peers import Peer

WORKS = Check("to us", Outcome.WORKS)
LACKS = Check(
    "from us", Outcome.LACKING, "it has no such thing, and says so in more words than fit into one line"
)


class Found:
    """A matrix with given outcomes."""

    cells: tuple[tuple[Check, ...], ...] = ()

    def __init__(self, pythons: dict[str, str], report: Any) -> None:
        self.pythons = pythons

    def __enter__(self) -> Found:
        return self

    def __exit__(self, *_: object) -> None:
        pass

    def rows(self, peers: Sequence[Peer], features: Sequence[Feature]) -> Iterator[Row]:
        for peer in peers:
            cells = [
                Cell(peer.name, each, self.cells[n % len(self.cells)]) for n, each in enumerate(features)
            ]
            yield Row(peer.name, {"x": "10.11.12"}, tuple(cells))


def run(*words: str) -> Result:
    return CliRunner().invoke(command.interop, words)


@pytest.fixture
def found(monkeypatch: pytest.MonkeyPatch) -> Iterator[type[Found]]:
    monkeypatch.setattr(command, "Matrix", Found)
    yield Found
    Found.cells = ()


def test_the_table_fits_a_terminal(found: type[Found]) -> None:
    found.cells = ((WORKS,), (WORKS, LACKS), (LACKS,))
    done = run()
    assert done.exit_code == 0
    lines = done.stdout.splitlines()
    assert max(map(len, lines)) <= 80
    assert lines[0].split() == ["topic", "service", "action", "param", "graph", "kept", "image", "buffer"]
    words = "zenoh-ros2-sdk 10.11.12 ok part - ok part - ok part"
    assert lines[2].split() == words.split()
    assert "No rmw_zenoh_cpp was run: no wheel of it exists." in lines
    assert any(line.startswith("  service (from us), action (from us), graph (from us)") for line in lines)


def test_what_is_not_installed_can_be(found: type[Found]) -> None:
    found.cells = ((Check("", Outcome.ABSENT, "there is no module 'pyzeros'"),),)
    done = run("--peer", "pyzeros")
    assert done.exit_code == 0
    assert "Not installed, or too old: pyzeros.\n`make interop INSTALL=1` makes" in done.stdout


def test_what_should_work_and_does_not_is_an_error(found: type[Found]) -> None:
    found.cells = ((WORKS, Check("to us", Outcome.FAILS, "no message")),)
    done = run("--peer", "pyzeros", "--feature", "topic", "--format", "json")
    assert done.exit_code == 1
    assert json.loads(done.stdout) == [
        {
            "peer": "pyzeros",
            "versions": {"x": "10.11.12"},
            "cells": [
                {
                    "peer": "pyzeros",
                    "feature": "topic",
                    "checks": [
                        {"name": "to us", "outcome": "works", "reason": ""},
                        {"name": "to us", "outcome": "fails", "reason": "no message"},
                    ],
                }
            ],
        }
    ]


@pytest.mark.parametrize("python", ["nobody=/bin/sh", "pyzeros", f"pyzeros={sys.prefix}/no"])
def test_an_interpreter_that_cannot_be_is_refused(python: str) -> None:
    done = run("--python", python)
    assert done.exit_code == 2
    assert "expected one of dora-rs, " in done.stderr


def test_the_command_knows_all_features() -> None:
    assert list(Feature) == list(command._FEATURES)


def test_what_pip_cannot_install_is_said_once(monkeypatch: pytest.MonkeyPatch, tmp_path: Any) -> None:
    monkeypatch.setattr(environments.resources, "cache_folder", lambda: tmp_path)
    monkeypatch.setattr(environments.venv, "create", lambda folder, **_: None)
    failing = tmp_path / "python"
    failing.write_text("#!/bin/sh\necho 'ERROR: No matching distribution' >&2\nexit 1\n")
    failing.chmod(0o755)
    monkeypatch.setattr(environments, "_python", lambda name: failing)
    done = run("--peer", "pyzeros", "--install")
    assert done.exit_code == 1
    assert "pyzeros could not be installed: ERROR: No matching distribution" in done.stderr
    assert isinstance(done.exception, SystemExit)


def test_help_fits() -> None:
    done = run("--help")
    assert done.exit_code == 0
    assert max(map(len, done.stdout.splitlines())) <= 80
