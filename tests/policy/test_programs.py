"""Real programs at a router with the rules of `ifgen policy router`."""

from __future__ import annotations

import json
import socket
from collections.abc import Iterator
from pathlib import Path

import pytest
from ifgen.cli import main

from tests.running.sites import Site
from tests.running.terminals import Terminal

from .conftest import DOMAIN, HERE

pytest.importorskip("zenoh")
NAMES = ("driver", "mapper", "mover", "planner", "camera", "stranger")
PROGRAMS = str(HERE / "programs.py")


@pytest.fixture
def site(tmp_path: Path) -> Iterator[Site]:
    made = Site(DOMAIN, tmp_path)
    yield made
    made.close()


@pytest.mark.slow
def test_the_robot_runs_and_strangers_do_not(
    site: Site, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    words = (str(HERE / "robot.launch.py"), str(HERE / "robot"), "--domain", str(DOMAIN), "--by", "users")
    assert main.main(["policy", "router", *words]) == 0
    rules = json.loads(capsys.readouterr().out)
    users = tmp_path / "users"
    users.write_text("".join(f"/robot/{name}:secret\n" for name in NAMES))
    with socket.create_server(("127.0.0.1", 0)) as server:
        endpoint = f"tcp/127.0.0.1:{server.getsockname()[1]}"
    rules["listen"] = {"endpoints": [endpoint]}
    rules["transport"] = {"auth": {"usrpwd": {"dictionary_file": str(users)}}}
    file = tmp_path / "router.json5"
    file.write_text(json.dumps(rules))
    site.router("--config", str(file))

    def program(name: str) -> Terminal:
        override = f'transport/auth/usrpwd/user="/robot/{name}";transport/auth/usrpwd/password="secret"'
        return site.program(PROGRAMS, name, at=endpoint, ZENOH_CONFIG_OVERRIDE=override)

    stranger = program("stranger")
    stranger.until("here")
    for name in ("driver", "mapper", "mover"):
        program(name)
    planner = program("planner")
    planner.until_all(
        "map of 1.0", "service reset", "feedback 1", "action 1 1", "nodes driver mapper mover planner"
    )
    assert "map false" not in planner.so_far()
    assert not any(line.startswith("scan") for line in stranger.so_far())
