"""Completion at TAB: names of types, packages, rules and templates that fit.

click completes commands, options and files. For another kind of name, decorate a function with `completing`
and pass it as `shell_complete=` to the argument that takes such a name. A shell asks at every TAB, so read as
little as possible.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Generator, Iterable, Iterator
from contextlib import contextmanager
from functools import wraps
from pathlib import Path
from typing import TYPE_CHECKING, TypeAlias

import click

from ifgen.diagnostics import InputError

if TYPE_CHECKING:
    from click.shell_completion import CompletionItem

    from ifgen.reading.packages import PackageFiles

# Late imports: a shell waits at each Tab, and most completions need none of these.

Items: TypeAlias = "list[CompletionItem]"
Complete: TypeAlias = Callable[[click.Context, click.Parameter, str], Items]


def completing(names: Callable[[click.Context, str], Iterable[str]]) -> Complete:
    """Turn a function that yields candidates for a text into a completion callback of click.

    Whatever is wrong is no completion: in the middle of a line, nobody can do anything about it.
    """

    @wraps(names)
    def complete(context: click.Context, _: click.Parameter, typed: str) -> Items:
        from click.shell_completion import CompletionItem  # only a shell that asks needs it

        try:
            with _silence():
                found = dict.fromkeys(names(context, typed))
        except (Exception, KeyboardInterrupt):
            return []
        return [CompletionItem(name) for name in found if name.startswith(typed)]

    return complete


@contextmanager
def _silence() -> Generator[None]:
    """Drop what is written to stderr, also by libraries in C."""
    stderr, nowhere = os.dup(2), os.open(os.devnull, os.O_WRONLY)
    os.dup2(nowhere, 2)
    os.close(nowhere)
    try:
        yield
    finally:
        os.dup2(stderr, 2)
        os.close(stderr)


def _packages(context: click.Context, typed: str) -> Iterator[PackageFiles]:
    """The packages whose types may begin with what is typed."""
    from ifgen.config.settings import settle
    from ifgen.reading.packages import find_packages
    from ifgen.reading.search_path import SearchPath

    settings = settle(None, None, context.params.get("include"))
    try:
        packages = find_packages(settings.paths)
    except InputError:  # something else is wrong there
        packages = ()
    search = SearchPath(packages, settings.include)
    for name in search.package_names():
        if name.startswith(typed.partition("/")[0]) and (package := search.package(name)):
            yield package


def _types(packages: Iterable[PackageFiles], folder: str = "") -> Iterator[str]:
    for package in packages:
        files = (file for file in package.known_files() if folder in ("", file.folder))
        yield from sorted(f"{package.name}/{file.folder}/{file.name}" for file in files)


@completing
def types(context: click.Context, typed: str) -> Iterator[str]:
    """Names of types: `std_msgs/msg/String`."""
    return _types(_packages(context, typed))


@completing
def message_types(context: click.Context, typed: str) -> Iterator[str]:
    """Names of messages."""
    return _types(_packages(context, typed), "msg")


@completing
def service_types(context: click.Context, typed: str) -> Iterator[str]:
    """Names of services' types."""
    return _types(_packages(context, typed), "srv")


@completing
def action_types(context: click.Context, typed: str) -> Iterator[str]:
    """Names of actions' types."""
    return _types(_packages(context, typed), "action")


@completing
def packages(context: click.Context, typed: str) -> Iterator[str]:
    """Names of packages that have types."""
    return (package.name for package in _packages(context, typed))


@completing
def types_and_packages(context: click.Context, typed: str) -> Iterator[str]:
    """Names of packages that have types, and of these."""
    there = list(_packages(context, typed))
    yield from (package.name for package in there)
    yield from _types(there)


@completing
def rules(_: click.Context, __: str) -> Iterable[str]:
    """Rules that a diagnostic may name."""
    from ifgen.config import rulebook

    return rulebook.rules()


def revisions(context: click.Context, parameter: click.Parameter, typed: str) -> Items:
    """Branches and tags of the repository here; files and folders if none begins like this."""
    return _revisions(context, parameter, typed) or files(context, parameter, typed)


@completing
def _revisions(_: click.Context, __: str) -> Iterable[str]:
    from ifgen.reading.revisions import names

    return names(Path())


@completing
def templates(_: click.Context, __: str) -> Iterator[str]:
    """Templates of ifgen's, the folders of them, and `all`."""
    from ifgen import resources

    folder = resources.templates()
    names = sorted(path.relative_to(folder).as_posix() for path in folder.rglob("*.j2"))
    yield from ("all", *dict.fromkeys(Path(name).parts[0] for name in names), *names)


def files(_: click.Context, __: click.Parameter, typed: str) -> Items:
    """Files, which the shell itself completes."""
    from click.shell_completion import CompletionItem

    return [CompletionItem(typed, type="file")]
