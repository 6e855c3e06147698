"""`ifgen completion`, and what a shell gets: names of types, packages, rules and templates that fit.

click completes commands, options and files. Another kind of name is one more function here, and
`shell_complete=` at the argument that takes it. They are asked at every TAB, so they read as little as they
can, and whatever is wrong is no completion.
"""

from __future__ import annotations

import glob
import os
from collections.abc import Callable, Iterable, Iterator
from functools import wraps
from pathlib import Path
from typing import TYPE_CHECKING, TypeAlias

import click

from ifgen.diagnostics import InputError

if TYPE_CHECKING:
    from click.shell_completion import CompletionItem

    from ifgen.reading.packages import PackageFiles

# Late imports: a shell waits at each Tab, and most completions need none of these.

VARIABLE = "_IFGEN_COMPLETE"
"""Set by the scripts when they ask for completions; `bash_source` and the like, for a script itself."""


@click.command(epilog="Example: ifgen completion bash > ifgen.bash")
@click.argument("shell", type=click.Choice(["bash", "zsh", "fish"]))
@click.pass_context
def completion(context: click.Context, shell: str) -> int:
    """Print a script for completion in a shell.

    It completes commands, options, files, and names: of types, packages, rules and templates, and of the
    nodes, topics, services, actions and parameters that run.

    \b
    bash: into ~/.local/share/bash-completion/completions/ifgen
    zsh:  into a folder of $fpath, as _ifgen
    fish: into ~/.config/fish/completions/ifgen.fish

    Or `eval "$(ifgen completion bash)"` in ~/.bashrc, which takes a moment whenever a shell starts.
    """  # noqa: D301 - the backspace is for click, which keeps the lines after it as they are
    from click.shell_completion import ShellComplete, get_completion_class

    kind = get_completion_class(shell)
    assert kind is not None, "one of click's own"
    # Not the class's own `source`, which for bash starts one to look at its version.
    print(ShellComplete.source(kind(context.find_root().command, {}, "ifgen", VARIABLE)))
    return 0


def complete(command: click.Command) -> int:
    """Answer a script that asks, by way of the environment."""
    from click.shell_completion import shell_complete

    return shell_complete(command, {}, "ifgen", VARIABLE, os.environ[VARIABLE])


_Items: TypeAlias = "list[CompletionItem]"
_Complete: TypeAlias = Callable[[click.Context, click.Parameter, str], _Items]


def _completing(names: Callable[[click.Context, str], Iterable[str]]) -> _Complete:
    """Turn a function that yields candidates for a text into a completion callback of click."""

    @wraps(names)
    def complete(context: click.Context, _: click.Parameter, typed: str) -> _Items:
        from click.shell_completion import CompletionItem  # only a shell that asks needs it

        try:
            return [CompletionItem(name) for name in names(context, typed) if name.startswith(typed)]
        except (InputError, OSError):
            return []

    return complete


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


def _types(package: PackageFiles) -> list[str]:
    return sorted(f"{package.name}/{file.folder}/{file.name}" for file in package.known_files())


@_completing
def types(context: click.Context, typed: str) -> Iterator[str]:
    """Names of types: `std_msgs/msg/String`."""
    for package in _packages(context, typed):
        yield from _types(package)


@_completing
def types_and_packages(context: click.Context, typed: str) -> Iterator[str]:
    """Names of packages that have types, and of these."""
    packages = list(_packages(context, typed))
    yield from (package.name for package in packages)
    for package in packages:
        yield from _types(package)


@_completing
def rules(_: click.Context, __: str) -> Iterable[str]:
    """Rules that a diagnostic may name."""
    from ifgen.config import rulebook

    return rulebook.rules()


def revisions(context: click.Context, parameter: click.Parameter, typed: str) -> _Items:
    """Branches and tags of the repository here; files and folders if none begins like this."""
    return _revisions(context, parameter, typed) or files(context, parameter, typed)


@_completing
def _revisions(_: click.Context, __: str) -> Iterable[str]:
    from ifgen.reading.revisions import names

    return names(Path())


@_completing
def templates(_: click.Context, __: str) -> Iterator[str]:
    """Templates of ifgen's, the folders of them, and `all`."""
    from ifgen import resources

    folder = resources.templates()
    names = sorted(path.relative_to(folder).as_posix() for path in folder.rglob("*.j2"))
    yield from ("all", *dict.fromkeys(Path(name).parts[0] for name in names), *names)


def files(_: click.Context, __: click.Parameter, typed: str) -> _Items:
    """Files, which the shell itself completes."""
    from click.shell_completion import CompletionItem

    return [CompletionItem(typed, type="file")]


def programs(context: click.Context, parameter: click.Parameter, typed: str) -> _Items:
    """Files and packages, or the nodes of a package that is the word before, for `ifgen run`."""
    from click.shell_completion import CompletionItem

    names = _programs(context, parameter, typed)
    if names and _present(context):
        return names
    # bash completes files itself only where there is nothing else.
    here = sorted(file.name for file in Path().glob(f"{glob.escape(typed)}*") if file.is_file())
    if not here:
        return [*files(context, parameter, typed), *names]
    users = [name for name in names if name.value not in _names_of_demo()]
    return [CompletionItem(name) for name in here] + users if users else files(context, parameter, typed)


def _present(context: click.Context) -> list[str]:
    """The words of the program that is being typed."""
    words: list[str] = list(context.params.get("program") or ())
    while ":" in words:
        words = words[words.index(":") + 1 :]
    return words


@_completing
def _programs(context: click.Context, typed: str) -> Iterable[str]:
    from ifgen.config.settings import settle
    from ifgen.running.finding import packages as finding

    output, words = settle().output, _present(context)
    if not words:
        begun = _users_first(name for name in finding.names(output) if name.startswith(typed))
        return [name for name in begun if (found := finding.find(name, output)) and found.executables]
    package = finding.find(words[0], output) if len(words) == 1 and not Path(words[0]).exists() else None
    return sorted(package.executables) if package else ()


@_completing
def packages(_: click.Context, typed: str) -> Iterable[str]:
    """Names of packages that are generated, sources here, or installed."""
    from ifgen.config.settings import settle
    from ifgen.running.finding import packages as finding

    return _users_first(name for name in finding.names(settle().output) if name.startswith(typed))


def _users_first(names: Iterable[str]) -> list[str]:
    """The names of packages without those of our demo, unless there are no others."""
    found = list(names)
    return [name for name in found if name not in _names_of_demo()] or found


def _names_of_demo() -> frozenset[str]:
    from ifgen import resources
    from ifgen.config.settings import settle

    nodes = resources.bundled_nodes()
    if not nodes.is_dir() or settle().output.resolve() == nodes.resolve():
        return frozenset()
    return frozenset(folder.name for folder in nodes.iterdir())
