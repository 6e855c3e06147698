"""`ifgen completion`: what a shell needs to complete `ifgen` command lines."""

from __future__ import annotations

import os

import click
from click.shell_completion import ShellComplete, get_completion_class, shell_complete

VARIABLE = "_IFGEN_COMPLETE"
"""Set by the scripts when they ask for completions; `bash_source` and the like, for a script itself."""


@click.command()
@click.argument("shell", type=click.Choice(["bash", "zsh", "fish"]))
@click.pass_context
def completion(context: click.Context, shell: str) -> int:
    """Print a script for completion in a shell.

    It completes commands, options, files, and names of types, rules and templates.

    \b
    bash: into ~/.local/share/bash-completion/completions/ifgen
    zsh:  into a folder of $fpath, as _ifgen
    fish: into ~/.config/fish/completions/ifgen.fish

    Or `eval "$(ifgen completion bash)"` in ~/.bashrc, which takes a moment whenever a shell starts.
    """  # noqa: D301 - the backspace is for click, which keeps the lines after it as they are
    kind = get_completion_class(shell)
    assert kind is not None, "one of click's own"
    # Not the class's own `source`, which for bash starts one to look at its version.
    print(ShellComplete.source(kind(context.find_root().command, {}, "ifgen", VARIABLE)))
    return 0


def complete(command: click.Command) -> int:
    """Answer a script that asks, by way of the environment."""
    return shell_complete(command, {}, "ifgen", VARIABLE, os.environ[VARIABLE])
