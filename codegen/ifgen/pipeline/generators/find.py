"""Finds generators, installed ones and programs, and gives their options values."""

from __future__ import annotations

import json
import os
import signal
import subprocess
from collections.abc import Callable, Iterator, Mapping
from contextlib import suppress
from dataclasses import replace
from functools import cache
from importlib.metadata import EntryPoint, entry_points
from importlib.util import find_spec
from pathlib import Path
from typing import Any

from ifgen.config.customization import Target
from ifgen.diagnostics import Diagnostic, InputError, Label, Span, did_you_mean, printable, shorten
from ifgen.generators import GROUP, Finding, Generator, Option, Request, Response, protocol
from ifgen.generators.protocol import describe_request, generate_request
from ifgen.model import VERSION

_MOST_SHOWN = 1000
_TYPES: Mapping[str, tuple[type, ...]] = {
    "boolean": (bool,),
    "integer": (int,),
    "number": (int, float),
    "string": (str,),
    "array": (list,),
    "object": (dict,),
}
_WORDS = {"boolean": "true or false", "array": "a list", "object": "a table"}


@cache
def installed() -> Mapping[str, EntryPoint]:
    """The entry points of installed generators, by name. Nothing is loaded."""
    return {found.name: found for found in entry_points(group=GROUP)}


def find(target: Target, ask: Callable[[Request], str] = generate_request) -> Generator:
    """The generator of a target. Raises InputError if it cannot be had, or needs another model.

    `ask` writes the request to a program.
    """
    found = _program(target, ask) if target.command else named(target.use or "", target.span)
    ours, theirs = VERSION.split("."), found.model.split(".")
    if theirs[0] != ours[0] or not theirs[-1].isdigit() or int(theirs[-1]) > int(ours[-1]):
        message = f"generator '{found.name}' needs model {found.model}, and ifgen has model {VERSION}"
        raise InputError([failure(target.span, message, "update ifgen, or use another version of it")])
    return found


def named(name: str, span: Span | None = None) -> Generator:
    """The installed generator of this name. Raises InputError if there is none, or it cannot be loaded."""
    entry_point = installed().get(name)
    if entry_point is None:
        advice = did_you_mean(name, installed()) or "`ifgen generators list` names all there are"
        raise InputError([failure(span, f"there is no generator '{name}'", advice)])
    package = entry_point.dist.name if entry_point.dist else "a package"
    try:
        found = entry_point.load()
    except Exception as error:  # whatever somebody's module raises
        message = f"generator '{name}' of {package} cannot be loaded: {type(error).__name__}: {error}"
        raise InputError([failure(span, message)]) from error
    if not isinstance(found, Generator):
        message = f"generator '{name}' of {package} cannot be loaded: {entry_point.value} is no Generator"
        raise InputError([failure(span, message)])
    return replace(found, sources=(*found.sources, *_sources(entry_point)))


def _sources(entry_point: EntryPoint) -> tuple[Path, ...]:
    """The folder of the module of an entry point."""
    spec = find_spec(entry_point.module)
    if spec is None or spec.origin is None:
        return ()
    path = Path(spec.origin)
    return (path.parent if path.name == "__init__.py" else path,)


def sources(target: Target) -> tuple[Path, ...]:
    """The files and folders whose change means that a target has to be made again."""
    if target.command:
        named_files = (target.base / word for word in target.command)
        return tuple(path for path in named_files if path.is_file())
    try:
        return find(target).sources
    except InputError:  # the run will say so
        return ()


def _program(target: Target, ask: Callable[[Request], str]) -> Generator:
    answer, _ = _ask(target, describe_request(), "describe")
    try:
        found = protocol.described(answer, target.name)
    except ValueError as error:
        message = _failed(target, f"cannot describe itself: {error}")
        raise InputError([failure(target.span, message)]) from None

    def generate(request: Request) -> Response:
        return _generate(target, ask(request))

    return replace(found, generate=generate)


def _generate(target: Target, request: str) -> Response:
    answer, said = _ask(target, request, "generate")
    try:
        response = protocol.response(answer)
    except ValueError as error:
        message = _failed(target, f"answered what ifgen does not understand: {error}")
        raise InputError([failure(target.span, message, said and f"it said: {said}")]) from None
    if said:
        note = Finding(None, f"its program said: {said}", "warning")
        response = replace(response, findings=(*response.findings, note))
    return response


def _ask(target: Target, request: str, what: str) -> tuple[Any, str]:
    """The answer of a program, and what it said on stderr. Raises InputError if it has none."""
    try:
        output, said, code = _run(target, request)
    except OSError as error:
        reason = error.strerror or str(error)
        message = _failed(target, f"cannot be started: {target.command[0]}: {reason}")
        raise InputError([failure(target.span, message)]) from None
    shown = f"it said: {said}" if said else None
    if code is None:
        message = _failed(target, f"did not answer '{what}' within {target.time_limit:g} s")
        advice = "; ".join(filter(None, (shown, "a larger `time_limit` gives it more time")))
        raise InputError([failure(target.span, message, advice)])
    if code:
        message = _failed(target, f"ended with exit code {code} when asked to {what}")
        raise InputError([failure(target.span, message, shown)])
    try:
        return json.loads(output), said
    except (ValueError, RecursionError):
        begin = shorten(" ".join(output.decode(errors="replace").split()), 60)
        message = _failed(target, f"answered '{what}' with what is no JSON: {begin!r}")
        advice = shown or "it must write its answer to stdout, and nothing else"
        raise InputError([failure(target.span, message, advice)]) from None


def _run(target: Target, request: str) -> tuple[bytes, str, int | None]:
    """The output of a program, what it said, and its exit code, None if it took too long."""
    with subprocess.Popen(
        target.command,
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        cwd=target.base,
        start_new_session=True,  # so that what it starts ends with it
    ) as process:
        try:
            output, said = process.communicate(request.encode(), timeout=target.time_limit)
            code: int | None = process.returncode
        except subprocess.TimeoutExpired:
            _kill(process)
            output, said = process.communicate()
            code = None
        except BaseException:  # Ctrl-C too
            _kill(process)
            raise
    text = printable(said.decode(errors="replace")).strip()
    return output, text if len(text) <= _MOST_SHOWN else f"...{text[-_MOST_SHOWN:]}", code


def _kill(process: subprocess.Popen[bytes]) -> None:
    with suppress(OSError):
        if hasattr(os, "killpg"):
            os.killpg(process.pid, signal.SIGKILL)
        else:
            process.kill()


def _failed(target: Target, what: str) -> str:
    return f"generator '{target.name}' {what}"


def failure(span: Span | None, message: str, help: str | None = None) -> Diagnostic:
    """A generator that cannot be used; `span` is the place of its target in the configuration."""
    return Diagnostic("generator", message, None if span is None else Label(span), help=help or None)


def option_values(target: Target, generator: Generator) -> dict[str, Any]:
    """A value for each option of a generator. Raises InputError for those that are wrong."""
    problems = list(_wrong_options(target, generator))
    if problems:
        raise InputError(problems)
    return {option.name: target.options.get(option.name, option.default) for option in generator.options}


def _wrong_options(target: Target, generator: Generator) -> Iterator[Diagnostic]:
    options = {option.name: option for option in generator.options}
    for name, value in target.options.items():
        option = options.get(name)
        if option is None:
            listed = f"its options are {', '.join(options)}" if options else "it has none"
            advice = did_you_mean(name, options) or listed
            yield _wrong_option(target, f"generator '{generator.name}' has no option '{name}'", advice)
        elif expected := _expected(option, value):
            message = f"option '{name}' of generator '{generator.name}' must be {expected}"
            yield _wrong_option(target, message, option.help or None)


def _expected(option: Option, value: object) -> str | None:
    """The words for a right value; None if it is one."""
    if option.choices:
        *others, last = (f'"{choice}"' for choice in option.choices)
        return None if value in option.choices else f"{', '.join(others)} or {last}" if others else last
    if isinstance(value, _TYPES[option.type]) and (option.type == "boolean" or not isinstance(value, bool)):
        return None
    return _WORDS.get(option.type, f"{'an' if option.type[0] in 'aeiou' else 'a'} {option.type}")


def _wrong_option(target: Target, message: str, help: str | None) -> Diagnostic:
    span = target.options_span or target.span
    return Diagnostic("configuration", message, None if span is None else Label(span), help=help)
