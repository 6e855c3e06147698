"""A testee: a program that answers requests, one line each."""

from __future__ import annotations

import os
import re
import selectors
import subprocess
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from threading import Thread
from typing import IO, Final, Literal

from ifgen.command_kit.tool import ToolError

Verdict = Literal["ok", "refused", "skip", "fail", "crash", "timeout"]
_VERDICTS: Final[tuple[Verdict, ...]] = ("ok", "refused", "skip", "fail")
_FIRST_REPLY: Final = 60.0  # seconds, for a program that compiles or loads first


@dataclass(frozen=True, slots=True)
class Reply:
    """The answer to a request: what kind of answer, and what follows it."""

    verdict: Verdict
    data: str = ""

    @property
    def text(self) -> str:
        """One line."""
        return f"{self.verdict} {self.data}".rstrip()


@dataclass(frozen=True, slots=True)
class Request:
    """A question for a testee."""

    op: str
    type_name: str
    arguments: tuple[str, ...] = ()


class Testee:
    """A program that is started when it is first asked, and again after it crashed."""

    def __init__(self, command: Sequence[str], timeout: float) -> None:
        self._command = command
        self._timeout = timeout
        self._process: subprocess.Popen[bytes] | None = None
        self._buffer = b""
        self._next = 0

    def hello(self) -> dict[str, str]:
        """Start the program, and return what it says of itself. ToolError if it is no testee."""
        reply = self.ask("hello", "-", timeout=_FIRST_REPLY)
        parts = (word.partition("=") for word in reply.data.split())
        pairs = {key: value for key, _, value in parts}
        if reply.verdict != "ok" or pairs.get("protocol") != "1":
            help = "docs/conformance.md has the protocol; a testee must reply `ok ID protocol=1 language=...`"
            raise ToolError(f"{self._command[0]} does not answer `hello`: {reply.text}", help)
        return pairs

    def ask(self, op: str, type_name: str, *arguments: str, timeout: float | None = None) -> Reply:
        """Send one request, and return the reply. A program that crashed or was too slow is ended."""
        timeout = timeout or self._timeout
        if self._process is None:
            self._process = self._start()
            if op != "hello":
                self.ask("hello", "-", timeout=_FIRST_REPLY)
        self._next += 1
        request = " ".join((op, str(self._next), type_name, *arguments))
        assert self._process.stdin is not None
        try:
            self._process.stdin.write(request.encode() + b"\n")
            self._process.stdin.flush()
            line = self._line(timeout)
        except BrokenPipeError:
            line = ""
        if line is None:
            self.close()
            return Reply("timeout", f"no reply within {timeout:g} s")
        if not line:
            code = self.close()
            return Reply("crash", f"exit code {code}")
        return self._parsed(line)

    def ask_all(self, requests: Sequence[Request]) -> list[Reply]:
        """Send requests without waiting between them. Those from a crash on are asked again, one by one."""
        if self._process is None:
            self.hello()
        process = self._process
        assert process is not None and process.stdin is not None
        lines = [
            " ".join((request.op, str(number), request.type_name, *request.arguments))
            for number, request in enumerate(requests, self._next + 1)
        ]
        writer = Thread(target=_write, args=(process.stdin, "\n".join((*lines, "")).encode()))
        writer.start()
        replies: list[Reply] = []
        while len(replies) < len(requests) and self._process is process:
            if not (line := self._line(self._timeout)):
                break
            self._next += 1
            replies.append(self._parsed(line))  # which ends the program if the line is no reply
        if len(replies) < len(requests):
            process.kill()  # before its pipe is closed: a program that hangs would keep the writer
        writer.join()
        if len(replies) < len(requests):
            self.close()
        rest = requests[len(replies) :]
        return replies + [self.ask(request.op, request.type_name, *request.arguments) for request in rest]

    def _parsed(self, line: str) -> Reply:
        word, _, rest = line.partition(" ")
        id_, _, data = rest.partition(" ")
        if word not in _VERDICTS or id_ != str(self._next):
            self.close()  # one answer too many, or a print that does not belong there
            return Reply("fail", f"not a reply to request {self._next}: {line[:80]!r}")
        return Reply(word, data)

    def _start(self) -> subprocess.Popen[bytes]:
        self._buffer = b""
        try:
            return subprocess.Popen(self._command, stdin=subprocess.PIPE, stdout=subprocess.PIPE)
        except OSError as error:
            raise ToolError(f"cannot start {self._command[0]}: {error.strerror}") from None

    def _line(self, timeout: float) -> str | None:
        """The next line without its end; empty at the end of the output, None if there is none in time."""
        process = self._process
        assert process is not None and process.stdout is not None
        with selectors.DefaultSelector() as selector:
            selector.register(process.stdout, selectors.EVENT_READ)
            while b"\n" not in self._buffer:
                if not selector.select(timeout):
                    return None
                data = os.read(process.stdout.fileno(), 1 << 16)
                if not data:
                    return ""
                self._buffer += data
        line, _, self._buffer = self._buffer.partition(b"\n")
        return line.decode("ascii", "replace").rstrip("\r") or " "

    @property
    def peak(self) -> int:
        """The most memory that the program has had so far, in bytes; 0 where the system does not say."""
        status = Path(f"/proc/{self._process.pid}/status") if self._process else Path()
        if not status.is_file():
            return 0
        match = re.search(r"VmHWM:\s*(\d+) kB", status.read_text())
        return int(match[1]) * 1024 if match else 0

    def close(self) -> int | None:
        """End the program, and return its exit code if it ended by itself."""
        process, self._process = self._process, None
        if process is None:
            return None
        assert process.stdin is not None and process.stdout is not None
        with suppress(BrokenPipeError):
            process.stdin.close()
        try:
            return process.wait(1)
        except subprocess.TimeoutExpired:
            process.kill()
            process.wait()
            return None
        finally:
            process.stdout.close()


def _write(pipe: IO[bytes], data: bytes) -> None:
    """Send requests in a thread of its own; a program that ended does not take them."""
    with suppress(OSError, ValueError):
        pipe.write(data)
        pipe.flush()
