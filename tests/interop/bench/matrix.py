"""Runs the checks of every implementation: ours is a node on the local transport, with a router between."""

from __future__ import annotations

import os
import re
import socket
import sys
import tempfile
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import ExitStack
from importlib.util import find_spec
from pathlib import Path
from typing import Any, Final

from ifgen import resources
from ifgen.diagnostics import InputError
from ifgen_tools.running.router import Router, open_router

from tests.interop.bench import definitions, samples
from tests.interop.bench.bridged import Bridged
from tests.interop.bench.environments import python_of
from tests.interop.bench.exchange import Absent, Actor, Failed, Lacking, Program
from tests.interop.bench.features import Task, tasks
from tests.interop.bench.outcomes import Cell, Check, Feature, Outcome, Row
from tests.interop.bench.peers import Peer

_PROGRAMS: Final = Path(__file__).parent / "programs"
_DOMAINS: Final = 101  # those that DDS has ports for on every system, besides 0
_TRIES: Final = 5
_SETTINGS: Final = ("ZENOH_", "RMW_", "ROS_", "DORA_")
_OF_WHEELS: Final = ("_ROS_WHEELS_BOOTSTRAP_COMPLETE", "LD_LIBRARY_PATH")
"""The wheels of ROS set these for the interpreter that has them; another one has others."""

Report = Callable[[str], None]


class Matrix:
    """A router with what all programs need. Use it with `with`."""

    def __init__(self, pythons: Mapping[str, str], report: Report = lambda line: None) -> None:
        """`pythons` are interpreters by the name of what they have."""
        self._pythons = dict(pythons)
        self._report = report
        self._exit = ExitStack()

    def __enter__(self) -> Matrix:
        folder = self._exit.enter_context(tempfile.TemporaryDirectory())
        shapes, hashes = definitions.install(samples.TYPES, Path(folder))
        router, address = _own_router()
        self._exit.callback(router.close)
        self._hashes = hashes
        self._setting: dict[str, Any] = {
            "router": address,
            "domain": 1 + os.getpid() % _DOMAINS,
            "definitions": folder,
            "folder": folder,
            "work": str(_work_folder()),
            "shapes": shapes,
            "hashes": hashes,
        }
        return self

    def __exit__(self, *_: object) -> None:
        self._exit.close()

    def rows(self, peers: Sequence[Peer], features: Sequence[Feature]) -> Iterator[Row]:
        """The row of each implementation, when it is done."""
        for peer in peers:
            versions: dict[str, str] = {}
            absent: list[Check] = []  # if it is, all features have this check
            cells: list[Cell] = []
            for feature in features:
                checks = _lacking(peer, feature) or absent
                if not checks:
                    try:
                        checks = self._checks(peer, feature, versions)
                    except Absent as error:
                        checks = absent = [Check("", Outcome.ABSENT, str(error))]
                cells.append(Cell(peer.name, feature, tuple(checks)))
            yield Row(peer.name, versions, tuple(cells))

    def _checks(self, peer: Peer, feature: Feature, versions: dict[str, str]) -> list[Check]:
        """Do the checks of a feature. Raises Absent."""
        self._report(f"{peer.name}: {feature}")
        stage = _Stage(lambda: self._ours(peer), lambda: self._theirs(peer))
        try:
            return [
                self._check(task, stage, peer, feature, versions)
                for task in tasks(feature, peer.types, self._hashes)
            ]
        finally:
            stage.close()

    def _check(
        self, task: Task, stage: _Stage, peer: Peer, feature: Feature, versions: dict[str, str]
    ) -> Check:
        """Do one check. Raises Absent."""
        known = peer.known.get((feature, task.name))
        try:
            ours, theirs = stage.actors()
            versions.update(theirs.versions)
            if refusal := peer.refusal(theirs.versions.get(peer.distribution, "")):
                raise Absent(refusal)
            task.run(ours, theirs)
        except Lacking as error:
            return Check(task.name, Outcome.LACKING, str(error))
        except Failed as error:
            stage.close()  # whoever fell silent, or is gone, is of no more use
            if known is None or not re.search(known.error, str(error)):
                return Check(task.name, Outcome.FAILS, str(error))
            return Check(task.name, Outcome.LACKING, f"{known.reason} ({error})")
        if known is not None and not known.sometimes:
            return Check(task.name, Outcome.FAILS, f"it works, and is listed as known: {known.reason}")
        return Check(task.name, Outcome.WORKS)

    def _ours(self, peer: Peer) -> Program:
        """Our node: on the local transport, or on real rclpy for a peer on DDS. Raises Absent and Failed."""
        transport = "rclpy" if peer.on_dds else "local"
        missing = [name for name in ("rclpy", "ifgen_native") if peer.on_dds and find_spec(name) is None]
        if missing:
            raise Absent(f"there is no module '{missing[0]}' for our node")
        program = str(_PROGRAMS / "rclpy_program.py")
        words = [sys.executable, "-m", "ifgen", "run", "--transport", transport, program]
        address = self._setting["router"].removeprefix("tcp/")
        return self._program("our node", words, "ours", ROS_STATIC_PEERS="" if peer.on_dds else address)

    def _theirs(self, peer: Peer) -> Actor:
        node = re.sub(r"\W", "_", peer.name.lower())
        if not peer.bridge:
            return self._peer(peer.name, peer.program, node)
        try:
            bridge = self._peer("dora-rs", peer.bridge, "bridge")
        except Absent as error:
            raise Absent(f"dora-rs is to be the bridge, and {error}") from None
        try:
            return Bridged(self._peer(peer.name, peer.program, node), bridge)
        except BaseException:
            bridge.close()
            raise

    def _peer(self, name: str, program: str, node: str) -> Program:
        words = [python_of(name, self._pythons), str(_PROGRAMS / program)]
        try:
            return self._program(name, words, node)
        except OSError as error:
            raise Absent(f"{words[0]}: {error.strerror}") from None

    def _program(self, name: str, words: Sequence[str], node: str, **variables: str) -> Program:
        kept = {key: value for key, value in os.environ.items() if not key.startswith(_SETTINGS)}
        if _OF_WHEELS[0] in kept:
            kept = {key: value for key, value in kept.items() if key not in _OF_WHEELS}
        own = {
            "ROS_DOMAIN_ID": str(self._setting["domain"]),
            "ROS_AUTOMATIC_DISCOVERY_RANGE": "LOCALHOST",
            "ROS_LOG_DIR": self._setting["folder"],
            "RMW_IMPLEMENTATION": "rmw_fastrtps_cpp",
        }
        return Program(name, words, {**self._setting, "node": node}, {**kept, **own, **variables})


def _lacking(peer: Peer, feature: Feature) -> list[Check]:
    reason = peer.lacking.get(feature)
    return [] if reason is None else [Check("", Outcome.LACKING, reason)]


class _Stage:
    """Both sides of a check, which start when they are needed, and again after they were closed."""

    def __init__(self, ours: Callable[[], Actor], theirs: Callable[[], Actor]) -> None:
        self._start = (theirs, ours)  # the one that may be absent first
        self._actors: list[Actor] = []

    def actors(self) -> tuple[Actor, Actor]:
        """Our side and the other one. Raises Absent and Failed."""
        for start in self._start[len(self._actors) :]:
            self._actors.append(start())
        theirs, ours = self._actors
        return ours, theirs

    def close(self) -> None:
        """End both."""
        while self._actors:
            self._actors.pop().close()


def _work_folder() -> Path:
    """The folder in which programs run: pyzeros leaves what it compiles there, which takes a minute."""
    folder = resources.cache_folder() / "interop/work"
    folder.mkdir(parents=True, exist_ok=True)
    return folder


def _own_router() -> tuple[Router, str]:
    """A router on a port of this machine that nobody uses, and its address."""
    for left in reversed(range(_TRIES)):
        with socket.socket() as free:
            free.bind(("127.0.0.1", 0))
            address = f"tcp/127.0.0.1:{free.getsockname()[1]}"
        try:
            return open_router((address,), variables={}), address
        except InputError:  # somebody else was faster
            if not left:
                raise
    raise AssertionError("unreachable")
