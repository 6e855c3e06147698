"""The command `ifgen run`, whose options may stand after a program, too, where everybody types them first."""

from __future__ import annotations

import os
import sys
from collections.abc import Collection, Mapping, Sequence
from contextlib import redirect_stdout, suppress
from difflib import get_close_matches
from importlib import invalidate_caches
from pathlib import Path
from typing import Final, Literal, cast

import click
from click.core import ParameterSource
from ifgen.command_kit.options import transport_option
from ifgen.config.settings import settle
from ifgen.diagnostics import Diagnostic, UsageError
from ifgen.signals import delay_interrupt

from ifgen_tools import completion

_TRANSPORTS: Final = ("local", "rclpy", "auto")
_FLAGS: Final = ("--lockstep", "--generate")
_DISTRO: Final = "IFGEN_ROS_DISTRO"
_PROFILES: Final = ("jazzy", "kilted", "lyrical")
_PROFILE_OF: Final = {**{name: name for name in _PROFILES}, "rolling": "lyrical"}
"""By the values of `ros_distro` in [tool.ifgen]; those before Jazzy have none of their own."""
_ENDS: Final = ("--", "--ros-args")


@click.command(
    context_settings={
        "ignore_unknown_options": True,
        "allow_interspersed_args": False,
        "help_option_names": ["-h", "--help"],
    },
    epilog="Example: ifgen run --transport local talker.py : listener.py",
)
@transport_option
@click.option(
    "--lockstep",
    "in_lockstep",
    is_flag=True,
    help="One virtual time for all programs: the same run every time (local transport).",
)
@click.option(
    "--ros-distro",
    type=click.Choice(list(_PROFILES)),
    envvar=_DISTRO,
    help="The ROS 2 whose rclpy the local one follows (jazzy, if [tool.ifgen] does not say).",
)
@click.option("--generate", "generate_first", is_flag=True, help="Do `ifgen generate` first.")
@click.option("--of-launch", is_flag=True, hidden=True)  # which has said already who runs elsewhere
@click.argument(
    "program",
    metavar="FILE|-m MODULE|PACKAGE NODE [ARGS]...",
    nargs=-1,
    type=click.UNPROCESSED,
    shell_complete=completion.programs,
)
def run(
    transport: Literal["local", "rclpy", "auto"],
    in_lockstep: bool,
    ros_distro: str | None,
    generate_first: bool,
    of_launch: bool,
    program: tuple[str, ...],
) -> int:
    """Run programs written for rclpy, with `:` between them.

    Each runs in a process of its own. When the last one ends, the others are interrupted as by Ctrl-C. For
    example: `ifgen run server.py : client.py 41 1`. Arguments after FILE or MODULE belong to the program,
    including --ros-args, except options of this command that the FILE does not mention.

    PACKAGE is a generated one, sources in this folder or in src, or one that is installed. A FILE of that
    name comes first.
    """
    with delay_interrupt(""):
        from ifgen_tools.running.run import is_one_of_several, split  # late: `--help` does without
        from ifgen_tools.running.run import run as run_programs

        is_part = of_launch or is_one_of_several()
        words, late = _late_options(() if is_part else program)
        settings = settle()
    if profile := ros_distro or _PROFILE_OF.get(str(settings.config.ros_distro)):
        os.environ[_DISTRO] = profile  # the program and others that it starts read it
    transport = cast("Literal['local', 'rclpy', 'auto']", late.get("--transport", transport))
    in_lockstep, generate_first = in_lockstep or "--lockstep" in late, generate_first or "--generate" in late
    if generate_first:
        context = click.get_current_context()
        generate = cast("click.Group", context.find_root().command).get_command(context, "generate")
        assert generate is not None, "a command of ifgen's own"
        with redirect_stdout(sys.stderr):  # stdout is the programs'
            context.invoke(generate)
        invalidate_caches()  # Python may have looked into the folders already
    with delay_interrupt(""):
        programs = split(program if is_part else words, settings.output)
    return run_programs(programs, transport, settings.output, in_lockstep=in_lockstep, tells=not is_part)


def _late_options(program: Sequence[str]) -> tuple[Sequence[str], Mapping[str, str]]:
    """Take options of `ifgen run` from the words after the first program, and say so."""
    context = click.get_current_context()
    options = {"--transport": "transport", "--lockstep": "in_lockstep", "--generate": "generate_first"}
    given = [
        option
        for option, name in options.items()
        if context.get_parameter_source(name) is ParameterSource.COMMANDLINE
    ]
    words, late = take_late_options(program, given)
    if (transport := late.get("--transport", "auto")) not in _TRANSPORTS:
        expected = f"{', '.join(_TRANSPORTS[:-1])} or {_TRANSPORTS[-1]}"
        advice = "put `--` before the arguments of the program if it has an option of this name"
        raise UsageError(
            [Diagnostic("no-transport", f"there is no transport '{transport}', only {expected}", help=advice)]
        )
    if late:
        taken = " ".join(" ".join(filter(None, each)) for each in late.items())
        print(
            f"note: `ifgen run` takes {taken} as its own: the place of its options is before the program",
            file=sys.stderr,
        )
    return words, late


def take_late_options(words: Sequence[str], given: Collection[str]) -> tuple[list[str], dict[str, str]]:
    """Separate the words of programs from options of `ifgen run` that are among them; returns both.

    `--transport` with a transport or a word spelled like one, `--lockstep` and `--generate` count, up to
    `--` or `--ros-args` of each program. None counts that is among those `given` before the programs, or
    that the file of its program has in quotes: then it is the program's.
    """
    left: list[str] = []
    found: dict[str, str] = {}
    text: str | None = None  # of the program whose arguments are being read
    is_open = True
    rest = iter(range(len(words)))
    for index in rest:
        word = words[index]
        name, equals, value = word.partition("=")
        if text is None or word == ":":
            text, is_open = (None, True) if word == ":" else (_text_of(word), True)
        elif word in _ENDS:
            is_open = False
        elif is_open and name not in given and not _is_known(name, text):
            value = value if equals else "".join(words[index + 1 : index + 2])
            if name == "--transport" and get_close_matches(value, _TRANSPORTS, n=1):
                found[name] = value
                if not equals:
                    next(rest)
                continue
            if word in _FLAGS:
                found[word] = ""
                continue
        left.append(word)
    return left, found


def _is_known(option: str, text: str) -> bool:
    return f"'{option}" in text or f'"{option}' in text


def _text_of(program: str) -> str:
    with suppress(OSError, ValueError):
        if Path(program).is_file():
            return Path(program).read_text(encoding="utf-8", errors="replace")
    return ""
