"""A program that is told what to do, in a process of its own, and never for longer than its time."""

from __future__ import annotations

import contextlib
import json
import queue
import signal
import subprocess
import threading
from collections import deque
from collections.abc import Mapping, Sequence
from typing import Any, Final, Protocol

_TO_START: Final = 120.0  # [s]; pyzeros compiles codecs first
_TO_ANSWER: Final = 60.0  # [s], on top of what a command says itself
_TO_END: Final = 5.0  # [s]
_LAST_LINES: Final = 5


class Failed(Exception):
    """A program did something else than it was told: it fell silent, ended, or says what went wrong."""


class Lacking(Exception):
    """A program says that its implementation has nothing of the kind."""


class Absent(Exception):
    """The modules that a program needs are not installed."""


class Actor(Protocol):
    """Somebody who does what is told."""

    node: str
    """The name of its node, which is in the root namespace."""
    versions: dict[str, str]

    def do(self, command: str, **arguments: Any) -> Any:
        """Do something. Raises Failed and Lacking."""
        ...

    def close(self) -> None:
        """End it."""
        ...


class Program:
    """A process that has answered once, with its versions."""

    def __init__(
        self, name: str, words: Sequence[str], setting: Mapping[str, Any], variables: Mapping[str, str]
    ) -> None:
        """Start it, in the folder `work` of its setting, if there is one.

        Raises Absent, Failed, and OSError where there is no such interpreter.
        """
        self.node: str = setting["node"]
        self._name = name
        self._process = subprocess.Popen(
            [*words, json.dumps(setting)],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            env=dict(variables),
            cwd=setting.get("work"),
            start_new_session=True,  # so that Ctrl-C is ours alone
        )
        self._answers: queue.Queue[bytes] = queue.Queue()
        self._said: deque[str] = deque(maxlen=_LAST_LINES)
        self._readers = [
            threading.Thread(target=target, daemon=True) for target in (self._read, self._read_errors)
        ]
        for reader in self._readers:
            reader.start()
        try:
            self.versions: dict[str, str] = self._answer(_TO_START)
        except BaseException:
            self.close()
            raise

    def do(self, command: str, **arguments: Any) -> Any:
        """Do something. Raises Failed and Lacking."""
        assert self._process.stdin is not None
        line = json.dumps({"do": command, **arguments}).encode()
        try:
            self._process.stdin.write(line + b"\n")
            self._process.stdin.flush()
        except OSError:
            raise Failed(self._ending()) from None
        return self._answer(_TO_ANSWER + arguments.get("seconds", 0.0))

    def close(self) -> None:
        """End it, by force if need be."""
        assert self._process.stdin is not None
        with contextlib.suppress(OSError):
            self._process.stdin.close()
        try:
            self._process.wait(_TO_END)
        except subprocess.TimeoutExpired:
            self._process.kill()
            self._process.wait()
        for reader in self._readers:
            reader.join(_TO_END)

    def _answer(self, seconds: float) -> Any:
        try:
            line = self._answers.get(timeout=seconds)
        except queue.Empty:
            raise Failed(f"{self._name} did not answer within {seconds:g} s") from None
        if not line:
            raise Failed(self._ending())
        try:
            answer = json.loads(line)
        except ValueError:
            raise Failed(f"{self._name} answered {line[:60]!r}") from None
        if "absent" in answer:
            raise Absent(f"there is no module {answer['absent']!r}")
        if "cannot" in answer:
            raise Lacking(answer["cannot"])
        if "failed" in answer:
            raise Failed(f"{self._name}: {answer['failed']}")
        return answer["value"]

    def _read(self) -> None:
        assert self._process.stdout is not None
        for line in self._process.stdout:
            self._answers.put(line)
        self._answers.put(b"")

    def _read_errors(self) -> None:
        assert self._process.stderr is not None
        for line in self._process.stderr:
            self._said.append(line.decode(errors="replace").strip())

    def _ending(self) -> str:
        """How it ended, with the last words on stderr."""
        try:
            code = self._process.wait(_TO_END)
        except subprocess.TimeoutExpired:
            return f"{self._name} closed its output"
        self._readers[1].join(_TO_END)
        how = f"with exit code {code}"
        if code < 0:
            with contextlib.suppress(ValueError):
                how = f"by {signal.Signals(-code).name}"
        words = next((line for line in reversed(self._said) if line), "")
        return f"{self._name} ended {how}" + (f": {words[:200]}" if words else "")
