"""Runs a scenario of several roles: all of them in this process, each in a thread, or one of them here.

A scenario is a file in `across/` with a dict `ROLES`, of functions that get a `Stage`. What they `say` is printed at
the end, role by role, so that it does not matter who was faster.

Usage: `python -c "import stage; stage.main()" ours|real FILE [ROLE=DESCRIPTOR]`. Without a role all of them play.
The descriptor is that of a socket to whoever presides over their meetings.
"""

from __future__ import annotations

import importlib.util
import runpy
import socket
import sys
import threading
import time
import traceback
from collections.abc import Callable, Iterable
from contextlib import suppress
from pathlib import Path
from typing import Any

PATIENCE = 20.0  # [s] for what another role does
_HERE, _FAILED = b".", b"!"
UNDERLAY = str(Path(__file__).parents[2] / "codegen/underlay")


class Stage:
    """What a role has: an executor for its nodes, and meetings with the other roles."""

    def __init__(self, role: str, end: socket.socket) -> None:
        from rclpy.executors import SingleThreadedExecutor  # late: which rclpy this is, is checked first

        self.role = role
        self.executor: Any = SingleThreadedExecutor()
        self.lines: list[str] = []
        self.has_failed = False
        self._nodes: list[Any] = []
        self._end = end

    def node(self, name: str, **options: Any) -> Any:
        """Make a node that spins whenever the role waits."""
        import rclpy

        return self.adopt(rclpy.create_node(name, **options))

    def adopt(self, node: Any) -> Any:
        """Let a node spin whenever the role waits."""
        self._nodes.append(node)
        self.executor.add_node(node)
        return node

    def say(self, *words: object) -> None:
        """Write a line of the transcript."""
        self.lines.append(" ".join((f"{self.role}:", *map(str, words))))

    def until(self, condition: Callable[[], Any], what: str = "it") -> None:
        """Spin until something is so; says when it did not come true."""
        end = time.monotonic() + PATIENCE
        while not condition():
            if time.monotonic() > end:
                raise AssertionError(f"{self.role}: {what} did not happen in {PATIENCE} s")
            self.executor.spin_once(timeout_sec=0.02)

    def result(self, future: Any) -> Any:
        """Spin until a future is done; returns its result."""
        self.until(future.done, "the end of a future")
        return future.result()

    def spin(self, seconds: float) -> None:
        """Spin for a time, for what the clock brings, or what must not come."""
        end = time.monotonic() + seconds
        while (left := end - time.monotonic()) > 0:
            self.executor.spin_once(timeout_sec=left)

    def meet(self) -> None:
        """Spin until all the other roles, but those that have ended, are at the same point."""
        self._end.send(_HERE)
        arrived: list[bytes] = []

        def has_come() -> bool:
            with suppress(BlockingIOError):
                arrived.append(self._end.recv(1, socket.MSG_DONTWAIT))
            return bool(arrived)

        self.until(has_come, "a meeting")
        if arrived == [b""]:
            raise AssertionError(f"{self.role}: another role has failed")

    def play(self, act: Callable[[Stage], None]) -> None:
        """Run the role, and destroy what it made."""
        try:
            act(self)
        except BaseException:
            traceback.print_exc()
            self.has_failed = True
            self._end.send(_FAILED)
        finally:
            self.executor.shutdown()
            for node in self._nodes:
                node.destroy_node()
            self._end.close()


def preside(ends: Iterable[socket.socket]) -> None:
    """Let roles go on whenever all that have not ended are at a meeting; end the play when one has failed."""
    present = dict.fromkeys(ends, _HERE)
    while present and _FAILED not in present.values():
        present = {end: word for end in present if (word := _word_of(end))}
        for end in present:
            with suppress(OSError):  # it was killed
                end.send(_HERE)
    for end in present:
        end.close()


def _word_of(end: socket.socket) -> bytes:
    try:
        return end.recv(1)
    except OSError:
        return b""


def main() -> None:
    """Play."""
    transport, path, *parts = sys.argv[1:]
    del sys.argv[1:]
    spec = importlib.util.find_spec("rclpy")
    found = str(spec.origin if spec else None)
    assert found.startswith(UNDERLAY) == (transport == "ours"), f"the wrong rclpy would be tested: {found}"
    import rclpy

    roles: dict[str, Callable[[Stage], None]] = runpy.run_path(path)["ROLES"]
    rclpy.init()
    if parts:
        role, _, descriptor = parts[0].partition("=")
        stages = [Stage(role, socket.socket(fileno=int(descriptor)))]
        stages[0].play(roles[role])
    else:
        stages = _play_all(roles)
    rclpy.shutdown()
    for stage in stages:
        print(*stage.lines, sep="\n")
    sys.exit(any(stage.has_failed for stage in stages))


def _play_all(roles: dict[str, Callable[[Stage], None]]) -> list[Stage]:
    pairs = [socket.socketpair() for _ in roles]
    chair = threading.Thread(target=preside, args=([ours for ours, _ in pairs],))
    chair.start()
    stages = [Stage(role, end) for role, (_, end) in zip(roles, pairs, strict=True)]
    players = [
        threading.Thread(target=stage.play, args=(act,))
        for stage, act in zip(stages, roles.values(), strict=True)
    ]
    for player in players:
        player.start()
    for player in (*players, chair):
        player.join()
    return stages
