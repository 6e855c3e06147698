"""The commands: they read options, call the toolkit and print. Slow imports wait for their command.

With click rather than typer, which validates with pydantic and so takes 140 ms of CPU more for each command.
"""

from __future__ import annotations

import os
import sys
from collections.abc import Iterator, Sequence
from importlib import import_module
from io import TextIOWrapper
from pathlib import Path
from typing import TYPE_CHECKING, Final

import click
from click.core import ParameterSource

from ifgen import resources
from ifgen.cli import further
from ifgen.command_kit import completion, terminal
from ifgen.command_kit.options import (
    EXISTING,
    format_option,
    include_option,
    quiet_option,
    strict_option,
)
from ifgen.config.settings import settle
from ifgen.diagnostics import Diagnostic, printable, shown_path
from ifgen.signals import Terminated, sigterm_raises

if TYPE_CHECKING:
    from ifgen.pipeline.inspection import Findings
    from ifgen.reading.search_path import SearchPath

# Late imports: each command loads what it needs, so that the others start fast.

_SIGINT: Final = 2

_COMPLETE = "_IFGEN_COMPLETE"
"""Set by the scripts when they ask for completions; `bash_source` and the like, for a script itself."""


def main(arguments: Sequence[str] | None = None) -> int:
    """Run a command line, by default that of this process, and return its exit code."""
    terminal.open_closed_streams()
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, TextIOWrapper):  # names of files may hold what the terminal cannot show
            stream.reconfigure(errors="backslashreplace")
    return terminal.exit_code_of(lambda: _dispatch(arguments))


def _dispatch(arguments: Sequence[str] | None) -> int:
    if instruction := os.environ.get(_COMPLETE):  # a shell asks what could come next
        from click.shell_completion import shell_complete

        return shell_complete(commands, {}, "ifgen", _COMPLETE, instruction)
    words = list(sys.argv[1:] if arguments is None else arguments)
    if words[:1] == ["help"]:
        words = [*words[1:], "--help"]
    elif words == ["-v"]:
        words = ["--version"]
    try:
        # Not `commands.main`, which has its own way with Ctrl-C.
        with commands.make_context("ifgen", words) as context:
            code: int | None = commands.invoke(context)
            return code or 0
    except KeyboardInterrupt as stop:
        if isinstance(stop, Terminated) or not further.ends_as_tools_do(words):
            raise
        return _SIGINT  # before the command has heard it, or after
    except click.exceptions.Exit as ending:  # --help and --version
        return ending.exit_code
    except click.exceptions.NoArgsIsHelpError as error:
        print(error.format_message(), file=sys.stderr)
        return error.exit_code
    except click.ClickException as error:
        print(printable("\n".join(_told(error))), file=sys.stderr)
        return error.exit_code


def _told(error: click.ClickException) -> Iterator[str]:
    """An error of click in the form of our own errors."""
    message, _, meant = error.format_message().partition(" Did you mean ")
    if near := getattr(error, "possibilities", None):
        message, meant = error.message, " or ".join(map(repr, near))
    message = " ".join(message.split()).rstrip(".")  # lists of choices have a line for each
    if isinstance(error, click.BadParameter) and (variable := _variable_of(error)):
        message = f"the environment variable {variable} has an invalid value: {error.message.rstrip('.')}"
    first = message[:1].lower() if message[1:2].islower() else message[:1]
    yield f"error: {first}{message[1:]}"
    if isinstance(error, click.NoSuchOption):
        meant = meant or _CALLED_OTHERWISE.get(error.option_name, "")
    help = f"did you mean {meant.rstrip('?')}? " if meant else getattr(error, "help", "")
    if isinstance(error, click.UsageError) and error.ctx is not None:
        help += f"see `{error.ctx.command_path} --help`"
    if help:
        yield f"  = help: {help}"


def _variable_of(error: click.BadParameter) -> str:
    """The environment variable that has a wrong value; empty if the value was on the command line."""
    option, context = error.param, error.ctx
    if option is None or context is None:
        return ""
    is_of_environment = context.get_parameter_source(option.name) is ParameterSource.ENVIRONMENT
    return str(option.envvar) if is_of_environment else ""


_CALLED_OTHERWISE: Final = {"--dry-run": "'--check'"}
"""Options that other programs have, and what ours are called."""


class _Commands(click.Group):
    """The commands of this module, those with a module of their own, and those of entry points.

    Each is imported when it is its turn.
    """

    # What starts programs is of the tools, and yet here: to look for an entry point takes 12 to 15 ms.
    elsewhere: Final = (
        *("adapt", "breaking", "demo", "diff", "generate", "init", "lock", "new"),
        *("paths", "router", "rules", "run", "templates", "test", "typings"),
    )
    module_of: Final = {
        "adapt": "ifgen.cli.evolution.adapt",
        "breaking": "ifgen.cli.evolution.differences",
        "demo": "ifgen_tools.running.demo",
        "diff": "ifgen.cli.evolution.differences",
        "lock": "ifgen.cli.evolution.lock",
        "paths": "ifgen.cli.editors",
        "router": "ifgen_tools.running.router",
        "run": "ifgen_tools.running.commands",
        "test": "ifgen_tools.running.package_tests",
        "typings": "ifgen.cli.editors",
    }
    """The modules that are not called as their command."""

    def list_commands(self, ctx: click.Context) -> list[str]:
        return sorted({*super().list_commands(ctx), *self.elsewhere, *further.names()})

    def get_command(self, ctx: click.Context, cmd_name: str) -> click.Command | None:
        if cmd_name not in self.elsewhere:
            return super().get_command(ctx, cmd_name) or further.command(cmd_name)
        module = import_module(self.module_of.get(cmd_name, f"ifgen.cli.{cmd_name}"))
        command: click.Command = getattr(module, cmd_name)
        return command

    def resolve_command(
        self, ctx: click.Context, args: list[str]
    ) -> tuple[str | None, click.Command | None, list[str]]:
        """As click does, but the commands that are elsewhere are suggested too."""
        name = args[0]
        if not (ctx.resilient_parsing or name.startswith("-") or self.get_command(ctx, name)):
            from difflib import get_close_matches

            near = " or ".join(map(repr, get_close_matches(name, self.list_commands(ctx))))
            meant = f" Did you mean {near}?" if near else ""
            raise click.UsageError(f"No such command {name!r}.{meant}", ctx)
        return super().resolve_command(ctx, args)


@click.group(cls=_Commands, context_settings={"help_option_names": ["-h", "--help"]})
@click.version_option(resources.VERSION, "-V", "--version", message="ifgen %(version)s")
def commands() -> None:
    """ROS 2 interfaces as typed Python packages, with nothing to compile."""


@commands.command(epilog="Example: ifgen check interfaces --strict")
@click.argument("paths", metavar="[PATH]...", nargs=-1, type=EXISTING)
@include_option
@format_option
@strict_option
@quiet_option
@click.option("--fix", is_flag=True, help="Fix what follows from a finding alone, then check again.")
@click.option("--diff", is_flag=True, help="Show what --fix would change, and write nothing.")
def check(
    paths: tuple[Path, ...],
    include: tuple[Path, ...],
    format_: str,
    strict: bool | None,
    quiet: bool,
    fix: bool,
    diff: bool,
) -> int:
    """Look for mistakes, and write nothing, except with --fix.

    Checks interfaces, node descriptions, and your own node modules. --fix adds dependencies to package.xml
    and CMakeLists.txt, and writes `pkg/Type` for `pkg::Type`.

    PATH is a package, a folder of packages, or one .msg, .srv, .action, .idl or .nodl.yaml file. The default
    is the paths in [tool.ifgen] of pyproject.toml. A parameter file (.yaml) is compared with what the nodes
    of the other paths, or of the default, declare.
    """
    from ifgen.pipeline.inspection import inspect, split_parameter_files

    paths, parameter_files = split_parameter_files(paths)
    settings = settle(paths, None, include, strict=strict).with_paths()
    while True:
        findings = inspect(
            *settings.paths,
            include=settings.include,
            output=settings.output,
            ros_distro=settings.custom.ros_distro,
            exclude=settings.exclude,
            parameter_files=parameter_files,
        )
        told = settings.policy.told(findings.diagnostics)
        if diff or not fix or not _fix(told):
            break
    if diff:
        from ifgen.pipeline.fixing import fixed

        terminal.print_changes((path, *texts) for path, texts in fixed(told).items())
    return terminal.print_findings(told, format_, "" if quiet else f"{_looked_at(findings)}: no mistakes")


def _fix(told: Sequence[Diagnostic]) -> bool:
    """Fix what can be fixed of what was found; whether a file has changed."""
    from ifgen.pipeline.fixing import fixed
    from ifgen.writing import transaction

    texts = fixed(told)
    if texts:
        top = Path(os.path.commonpath([path.absolute().parent for path in texts]))
        with sigterm_raises():
            transaction.apply([(path.absolute(), after.encode()) for path, (_, after) in texts.items()], top)
        for path in texts:
            print(f"fixed {shown_path(path)}", file=sys.stderr)
    return bool(texts)


@commands.command(epilog="Example: ifgen show geometry_msgs/msg/Pose")
@click.argument("type_", metavar="TYPE|PACKAGE", shell_complete=completion.types_and_packages)
@include_option
@click.option("--json", "as_json", is_flag=True, help="Print the ROS type description instead.")
def show(type_: str, include: tuple[Path, ...], as_json: bool) -> int:
    """Print an interface with its nested types and its type hash.

    TYPE is a name such as geometry_msgs/msg/Pose, or Pose if only one type has that name. For a PACKAGE, it
    lists the names of its types.
    """
    from ifgen.pipeline import lookup

    search = _search(include)
    if names := lookup.types_in(type_, search):
        if as_json:
            message = f"--json describes one TYPE, and {type_} is a package"
            raise click.UsageError(message, click.get_current_context())
        print("\n".join(names))
        return 0
    described, registry = lookup.find_type(type_, search)
    if as_json:
        import json

        from ifgen.definition.type_description import describe

        print(json.dumps(describe(described, registry), indent=2))
    else:
        from ifgen.cli import show as showing

        print("\n".join(showing.lines(described, registry)))
    return 0


@commands.command("hash", epilog="Example: ifgen hash std_srvs/srv/Trigger")
@click.argument("names", metavar="[TYPE|PACKAGE]...", nargs=-1, shell_complete=completion.types_and_packages)
@include_option
def print_hashes(names: tuple[str, ...], include: tuple[Path, ...]) -> int:
    """Print type hashes, including those of derived types.

    TYPE is a name such as std_msgs/msg/String, PACKAGE one such as std_msgs. The default is every type that
    ifgen finds. If some types have no hash, because of mistakes, it reports them at the end and exits with 1.
    """
    from ifgen.definition.type_description import type_hash
    from ifgen.pipeline import lookup

    search = _search(include)
    described, registry, errors = lookup.find_what_can_be(names or search.package_names(), search)
    for found in described:
        print(f"{found.type_name} {type_hash(found, registry)}")
    terminal.print_diagnostics(errors, stderr=True)
    return int(bool(errors))


@commands.command("completion", epilog="Example: ifgen completion bash > ifgen.bash")
@click.argument("shell", type=click.Choice(["bash", "zsh", "fish"]))
@click.pass_context
def print_completion(context: click.Context, shell: str) -> int:
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
    print(ShellComplete.source(kind(context.find_root().command, {}, "ifgen", _COMPLETE)))
    return 0


def _looked_at(findings: Findings) -> str:
    counts = ((findings.interfaces, "interface"), (findings.nodes, "node"))
    what = " and ".join(terminal.counted(number, noun) for number, noun in counts if number)
    return f"{what} in {terminal.counted(findings.packages, 'package')}"


def _search(include: tuple[Path, ...]) -> SearchPath:
    """The search path for types by name, the configured paths first."""
    from ifgen.reading.packages import find_packages
    from ifgen.reading.search_path import SearchPath

    settings = settle(None, None, include)
    return SearchPath(find_packages(settings.paths), settings.include)
