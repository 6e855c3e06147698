"""Runs programs of users: those that are generators, and those that format what generators make."""

from __future__ import annotations

import json
import os
import signal
import subprocess
from collections.abc import Callable, Iterable, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from fnmatch import fnmatchcase
from functools import partial
from threading import Thread
from typing import IO, Any, Final

from ifgen.config.customization import Target
from ifgen.diagnostics import Diagnostic, InputError, Label, Span, printable, shorten
from ifgen.generators import File, Finding, Generator, Request, Response, protocol
from ifgen.generators.protocol import describe_request
from ifgen.reading.storage import MAX_GENERATED

_MOST_SHOWN: Final = 1000


def failure(span: Span | None, message: str, help: str | None = None) -> Diagnostic:
    """A generator that cannot be used; `span` is the place to blame in the configuration."""
    return Diagnostic("generator", message, None if span is None else Label(span), help=help or None)


def program(target: Target, ask: Callable[[Request], str]) -> Generator:
    """The generator that a program is; `ask` writes a request to it. Raises InputError if it is none."""
    answer, _ = _ask(target, describe_request(), "describe")
    try:
        found = protocol.described(answer, target.name)
    except ValueError as error:
        raise _failed(target, f"cannot describe itself: {error}") from None

    def generate(request: Request) -> Response:
        return _generate(target, ask(request))

    return replace(found, generate=generate)


def _generate(target: Target, request: str) -> Response:
    answer, said = _ask(target, request, "generate")
    try:
        response = protocol.response(answer)
    except ValueError as error:
        message = f"answered what ifgen does not understand: {error}"
        raise _failed(target, message, said and f"it said: {said}") from None
    if said:
        note = Finding(None, f"its program said: {said}", "warning")
        response = replace(response, findings=(*response.findings, note))
    return response


def _ask(target: Target, request: str, what: str) -> tuple[Any, str]:
    """The answer of a program, and what it said on stderr. Raises InputError if it has none."""
    try:
        ended = _run(target.command, target, request)
    except OSError as error:
        reason = error.strerror or str(error)
        raise _failed(target, f"cannot be started: {target.command[0]}: {reason}") from None
    shown = f"it said: {ended.said}" if ended.said else None
    if ended.too_much:
        raise _failed(target, f"answered '{what}' with more than {MAX_GENERATED >> 20} MB", shown)
    if ended.code is None:
        advice = "; ".join(filter(None, (shown, "a larger `time_limit` gives it more time")))
        raise _failed(target, f"did not answer '{what}' within {target.time_limit:g} s", advice)
    if ended.code:
        raise _failed(target, f"ended with exit code {ended.code} when asked to {what}", shown)
    try:
        return json.loads(ended.output), ended.said
    except (ValueError, RecursionError):
        begin = shorten(" ".join(ended.output[:1000].decode(errors="replace").split()), 60)
        message = f"answered '{what}' with what is no JSON: {begin!r}"
        advice = shown or "it must write its answer to stdout, and nothing else"
        raise _failed(target, message, advice) from None


def _failed(target: Target, what: str, help: str | None = None) -> InputError:
    return InputError([failure(target.place("command"), f"generator '{target.name}' {what}", help)])


def formatted(target: Target, files: Iterable[File]) -> list[File]:
    """The files of a target as its formatters write them. Raises InputError for what these refuse."""
    given = list(files)
    if not target.format:
        return given
    from concurrent.futures import ThreadPoolExecutor  # of use to few

    with ThreadPoolExecutor(os.cpu_count()) as pool:
        return list(pool.map(partial(_formatted, target), given))


def _formatted(target: Target, file: File) -> File:
    pattern = next((each for each in target.format if fnmatchcase(file.path, each)), None)
    if pattern is None or not isinstance(file.content, str):
        return file
    name = f"the formatter of target '{target.name}'"
    command = [word.replace("{path}", str(target.out / file.path)) for word in target.format[pattern]]
    try:
        ended = _run(command, target, file.content)
        if ended.code == 0 and not ended.too_much:
            return File(file.path, ended.output.decode())
        how = "took too long" if ended.code is None else f"ended with exit code {ended.code}"
        message, advice = f"{name} {how} for {file.path}", ended.said and f"it said: {ended.said}"
    except OSError as error:
        message, advice = f"{name} cannot be started: {command[0]}: {error.strerror or error}", None
    except UnicodeDecodeError:
        message, advice = f"{name} wrote no UTF-8 for {file.path}", None
    raise InputError([failure(target.place("format", pattern), message, advice)])


@dataclass(frozen=True, slots=True)
class _Ended:
    """The end of a program: its output, what it said, and its exit code, None if it took too long."""

    output: bytes
    said: str
    code: int | None
    too_much: bool


def _run(command: Sequence[str], target: Target, text: str) -> _Ended:
    with subprocess.Popen(
        command,
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        cwd=target.base,
        start_new_session=True,  # so that what it starts ends with it
    ) as process:
        assert process.stdin and process.stdout and process.stderr, "they are pipes"
        output, said = _Reader(process, process.stdout), _Reader(process, process.stderr)
        writer = Thread(target=_write, args=(process.stdin, text.encode()), daemon=True)
        writer.start()
        try:
            code: int | None = process.wait(target.time_limit)
        except subprocess.TimeoutExpired:
            code = None
        finally:
            if process.returncode is None:  # Ctrl-C too
                _kill(process)
        for thread in (writer, output, said):
            thread.join(target.time_limit)  # what it started may have the pipes, and go on
            if thread.is_alive():
                code = None
                _kill(process)
                thread.join(1)  # or for ever: nothing waits for it any more
    words = printable(bytes(said.data[-4 * _MOST_SHOWN :]).decode(errors="replace")).strip()
    shown = words if len(words) <= _MOST_SHOWN else f"...{words[-_MOST_SHOWN:]}"
    return _Ended(bytes(output.data), shown, code, output.too_much or said.too_much)


def _write(stream: IO[bytes], data: bytes) -> None:
    with suppress(OSError), stream:  # it may end without having read
        stream.write(data)


class _Reader(Thread):
    """Reads a pipe to its end, and ends a program that writes too much."""

    def __init__(self, process: subprocess.Popen[bytes], stream: IO[bytes]) -> None:
        super().__init__(daemon=True)
        self.data = bytearray()
        self.too_much = False
        self._process, self._stream = process, stream
        self.start()

    def run(self) -> None:
        """Read."""
        with suppress(OSError, ValueError):
            while block := os.read(self._stream.fileno(), 1 << 16):
                self.data += block
                if len(self.data) > MAX_GENERATED:
                    self.too_much = True
                    _kill(self._process)
                    return


def _kill(process: subprocess.Popen[bytes]) -> None:
    with suppress(OSError):
        if hasattr(os, "killpg"):
            os.killpg(process.pid, signal.SIGKILL)
        else:
            process.kill()
