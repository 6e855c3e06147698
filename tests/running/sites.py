"""Routers and the programs that meet there."""

from __future__ import annotations

import json
import os
from pathlib import Path

from tests.running.machines import Machine
from tests.running.terminals import PEER, Command, Terminal


class Site:
    """Routers and programs in one domain."""

    def __init__(self, domain: int, folder: Path) -> None:
        self.folder = folder
        self.environment = {
            **{name: value for name, value in os.environ.items() if not name.startswith("ZENOH_")},
            "ROS_DOMAIN_ID": str(domain),
            "ROS_LOG_DIR": str(folder),
            "PYTHONUNBUFFERED": "1",
            "ZENOH_ROUTER_CHECK_ATTEMPTS": "1",
        }
        self._running: list[Command] = []

    def router(self, *words: str, on: Machine | None = None) -> Command:
        """A router that has said where it listens."""
        router = Command(self.environment, "router", *words, before=on.enter if on else ())
        self._running.append(router)
        router.until("listening on")
        return router

    def program(self, *words: str, at: str, on: Machine | None = None, **more: str) -> Terminal:
        """A program that reaches others at a router only."""
        environment = self.environment | {"ROS_STATIC_PEERS": at} | more
        program = Terminal(environment, *words, before=on.enter if on else ())
        self._running.append(program)
        return program

    def peer(
        self, name: str, role: str, router: str, *words: str, on: Machine | None = None, **more: str
    ) -> Terminal:
        """The peer, as such a program."""
        return self.program(PEER, name, role, *words, at=router, on=on, **more)

    def configuration(self, name: str, **settings: object) -> str:
        """Write a file with a configuration of Zenoh."""
        path = self.folder / f"{name}.json5"
        path.write_text(json.dumps(settings))
        return str(path)

    def close(self) -> None:
        for each in self._running:
            each.process.kill()
            each.process.wait()
