"""The commands: they read options, call the toolkit and print. Slow imports wait for their command.

With click rather than typer, which validates with pydantic and so takes 140 ms of CPU more for each command.
"""

from __future__ import annotations

import os
import sys
from collections.abc import Iterator, Sequence
from io import TextIOWrapper
from typing import Final

import click
from click.core import ParameterSource

from ifgen import resources
from ifgen.cli import plugins
from ifgen.command_kit import terminal
from ifgen.diagnostics import printable
from ifgen.signals import Terminated

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
        if isinstance(stop, Terminated) or not plugins.ends_as_tools_do(words):
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
    """The commands that entry points name. Each is imported when it is its turn."""

    def list_commands(self, ctx: click.Context) -> list[str]:
        return plugins.names()

    def get_command(self, ctx: click.Context, cmd_name: str) -> click.Command | None:
        return plugins.command(cmd_name)

    def resolve_command(
        self, ctx: click.Context, args: list[str]
    ) -> tuple[str | None, click.Command | None, list[str]]:
        """As click does, but the commands that are elsewhere are suggested too."""
        name = args[0]
        if not (ctx.resilient_parsing or name.startswith("-") or self.get_command(ctx, name)):
            from ifgen.command_kit.tool import did_you_mean  # late: only a mistake needs it

            near = did_you_mean(name, self.list_commands(ctx), cutoff=0.6)
            meant = f" D{near[1:]}" if near else ""
            raise click.UsageError(f"No such command {name!r}.{meant}", ctx)
        return super().resolve_command(ctx, args)


@click.group(cls=_Commands, context_settings={"help_option_names": ["-h", "--help"]})
@click.version_option(resources.VERSION, "-V", "--version", message="ifgen %(version)s")
def commands() -> None:
    """ROS 2 interfaces as typed Python packages, with nothing to compile."""


@click.command("completion", epilog="Example: ifgen completion bash > ifgen.bash")
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
