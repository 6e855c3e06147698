"""Finds generators, installed ones and programs, and gives their options values."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import replace
from functools import cache
from importlib.metadata import EntryPoint, entry_points
from importlib.util import find_spec
from pathlib import Path
from typing import Any

from ifgen.config.customization import Target
from ifgen.diagnostics import Diagnostic, InputError, Label, Span, did_you_mean
from ifgen.generators import GROUP, Generator, Option, Request
from ifgen.generators.protocol import generate_request
from ifgen.model import VERSION
from ifgen.pipeline.generators.programs import failure, program

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
    place = target.place("command" if target.command else "use")
    found = program(target, ask) if target.command else named(target.use or "", place)
    ours, theirs = VERSION.split("."), found.model.split(".")
    if theirs[0] != ours[0] or not theirs[-1].isdigit() or int(theirs[-1]) > int(ours[-1]):
        message = f"generator '{found.name}' needs model {found.model}, and ifgen has model {VERSION}"
        raise InputError([failure(place, message, "update ifgen, or use another version of it")])
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
    own = () if target.templates is None else (target.templates,)
    if target.command:
        named_files = (target.base / word for word in target.command)
        return (*own, *(path for path in named_files if path.is_file()))
    try:
        return (*own, *find(target).sources)
    except InputError:  # the run will say so
        return own


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
            message = f"generator '{generator.name}' has no option '{name}'"
            yield _wrong_option(target, name, message, advice)
        elif expected := _expected(option, value):
            message = f"option '{name}' of generator '{generator.name}' must be {expected}"
            yield _wrong_option(target, name, message, option.help or None)


def _expected(option: Option, value: object) -> str | None:
    """The words for a right value; None if it is one."""
    if option.choices:
        *others, last = (f'"{choice}"' for choice in option.choices)
        return None if value in option.choices else f"{', '.join(others)} or {last}" if others else last
    if isinstance(value, _TYPES[option.type]) and (option.type == "boolean" or not isinstance(value, bool)):
        return None
    return _WORDS.get(option.type, f"{'an' if option.type[0] in 'aeiou' else 'a'} {option.type}")


def _wrong_option(target: Target, name: str, message: str, help: str | None) -> Diagnostic:
    span = target.place("options", name)
    return Diagnostic("configuration", message, None if span is None else Label(span), help=help)
