"""`ifgen interop`: its table, its options and its exit codes."""

from __future__ import annotations

import json
import sys
from collections.abc import Iterator, Sequence
from typing import Any

import pytest
from ifgen.cli.main import main
from ifgen.interop import environments, matrix
from ifgen.interop.outcomes import Cell, Check, Feature, Outcome, Row
from ifgen.interop.peers import PEERS, Peer

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


@pytest.fixture
def found(monkeypatch: pytest.MonkeyPatch) -> Iterator[type[Found]]:
    monkeypatch.setattr(matrix, "Matrix", Found)
    yield Found
    Found.cells = ()


def test_the_table_fits_a_terminal(found: type[Found], capsys: pytest.CaptureFixture[str]) -> None:
    found.cells = ((WORKS,), (WORKS, LACKS), (LACKS,))
    assert main(["interop"]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert max(map(len, lines)) <= 80
    assert lines[0].split() == ["topic", "service", "action", "param", "graph", "kept", "image", "buffer"]
    words = "zenoh-ros2-sdk 10.11.12 ok part - ok part - ok part"
    assert lines[2].split() == words.split()
    assert "No rmw_zenoh_cpp was run: no wheel of it exists." in lines
    assert any(line.startswith("  service (from us), action (from us), graph (from us)") for line in lines)


def test_what_is_not_installed_can_be(found: type[Found], capsys: pytest.CaptureFixture[str]) -> None:
    found.cells = ((Check("", Outcome.ABSENT, "there is no module 'pyzeros'"),),)
    assert main(["interop", "--peer", "pyzeros"]) == 0
    told = capsys.readouterr().out
    assert "Not installed, or too old: pyzeros.\n`ifgen interop --install` makes" in told


def test_what_should_work_and_does_not_is_an_error(
    found: type[Found], capsys: pytest.CaptureFixture[str]
) -> None:
    found.cells = ((WORKS, Check("to us", Outcome.FAILS, "no message")),)
    assert main(["interop", "--peer", "pyzeros", "--feature", "topic", "--format", "json"]) == 1
    assert json.loads(capsys.readouterr().out) == [
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
def test_an_interpreter_that_cannot_be_is_refused(python: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["interop", "--python", python]) == 2
    assert "expected one of dora-rs, " in capsys.readouterr().err


def test_the_command_knows_all_peers_and_features() -> None:
    from ifgen.cli.running import interop

    assert tuple(peer.name for peer in PEERS) == interop._PEERS
    assert list(Feature) == list(interop._FEATURES)


def test_what_pip_cannot_install_is_said_once(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Any, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(environments.resources, "cache_folder", lambda: tmp_path)
    monkeypatch.setattr(environments.venv, "create", lambda folder, **_: None)
    failing = tmp_path / "python"
    failing.write_text("#!/bin/sh\necho 'ERROR: No matching distribution' >&2\nexit 1\n")
    failing.chmod(0o755)
    monkeypatch.setattr(environments, "_python", lambda name: failing)
    assert main(["interop", "--peer", "pyzeros", "--install"]) == 1
    said = capsys.readouterr().err
    assert "pyzeros could not be installed: ERROR: No matching distribution" in said
    assert "Traceback" not in said


def test_help_fits(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["interop", "--help"]) == 0
    assert max(map(len, capsys.readouterr().out.splitlines())) <= 80
