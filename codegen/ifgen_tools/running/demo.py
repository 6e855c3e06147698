"""`ifgen demo`: the humanoid that walks through generated interfaces."""

from __future__ import annotations

import sys
from importlib import import_module
from importlib.util import find_spec
from pathlib import Path
from typing import Literal

import click
from click.core import ParameterSource
from ifgen import resources
from ifgen.activation import ActivationError, put_on_path
from ifgen.command_kit.options import EXISTING_FILE, OUTPUT_FILE
from ifgen.config import installing
from ifgen.diagnostics import Diagnostic, UsageError

_PICTURES = (".gif", ".mp4", ".png")
_GREATEST = 2**63 - 1  # integer of a parameter


def _complete(context: click.Context, parameter: click.Parameter, start: str) -> list[str]:
    """Complete the names of the scenarios that come with the robot."""
    paths = (resources.humanoid() / "config/scenarios").glob(f"{start}*.yaml")
    return sorted(path.stem for path in paths)


@click.command(
    context_settings={"help_option_names": ["-h", "--help"]},
    epilog="Example: ifgen demo --scenario walk --headless",
)
@click.option(
    "--scenario",
    metavar="NAME",
    default="all",
    show_default=True,
    shell_complete=_complete,
    help="What to show: all, dance, obstacles, people, push, stop, walk, or a .yaml file of yours.",
)
@click.option("--idle", is_flag=True, help="No scenario: the robot stands, and waits for other programs.")
@click.option("--without", metavar="NODE", multiple=True, help="Leave out a node; may be repeated.")
@click.option(
    "--replace",
    metavar="NODE=PLACE",
    multiple=True,
    help="Your own node instead: a .py file or a module; may be repeated.",
)
@click.option(
    "--transport",
    type=click.Choice(["local", "rclpy"]),
    default="local",
    show_default=True,
    help="Our rclpy (local) in one process, or the real one in several.",
)
@click.option("--headless", is_flag=True, help="No window and no page, and as fast as possible.")
@click.option(
    "--record", metavar="FILE", type=OUTPUT_FILE, help="Write an animation (.gif, .mp4) or a picture (.png)."
)
@click.option("--web", is_flag=True, help="Serve a page on 127.0.0.1 instead of a window, until Ctrl-C.")
@click.option(
    "--port",
    type=click.IntRange(0, 65535),
    default=8000,
    show_default=True,
    help="Port of the page; 0: any free one.",
)
@click.option(
    "--host",
    metavar="ADDRESS",
    help="Address of the page for other machines, such as 0.0.0.0; its URL then has a token.",
)
@click.option(
    "--realtime",
    is_flag=True,
    help="No faster than real time, as with a window or page; on real rclpy also not in lockstep.",
)
@click.option(
    "--camera/--no-camera",
    default=None,
    help="Whether it sees, which takes time; by default on the local transport, and where obstacles are.",
)
@click.option(
    "--seed",
    type=click.IntRange(0, _GREATEST),
    default=0,
    show_default=True,
    help="Seed of the sensors' noise.",
)
@click.option("--model", metavar="FILE", type=EXISTING_FILE, help="Your own humanoid, as MJCF.")
@click.option(
    "--joint-map", metavar="FILE", type=EXISTING_FILE, help="Which of its joints is which, as YAML."
)
def demo(  # one for each option
    scenario: str,
    idle: bool,
    without: tuple[str, ...],
    replace: tuple[str, ...],
    transport: Literal["local", "rclpy"],
    headless: bool,
    record: Path | None,
    web: bool,
    port: int,
    host: str | None,
    realtime: bool,
    camera: bool | None,
    seed: int,
    model: Path | None,
    joint_map: Path | None,
) -> int:
    """Let the humanoid walk, dance, be pushed and stop.

    The robot plans its footsteps, and MuJoCo (the extra `sim`) simulates it. Each part of it is a node that
    exchanges only messages with the others. On a machine with a display, a window shows it.
    """
    context = click.get_current_context()
    if problem := _problem(context, record):
        raise click.UsageError(problem, context)
    _prepare(transport)
    # MuJoCo and the nodes take a second or two to import: nobody should wonder meanwhile.
    what = "idle" if idle else f"scenario {Path(scenario).stem}"
    print(f"waking up the humanoid: {what}, seed {seed}")
    sys.stdout.flush()
    # Found by name: the toolkit does not depend on its examples.
    humanoid = import_module("humanoid.show.demo")
    options = humanoid.Options(
        scenario=scenario,
        idle=idle,
        without=without,
        replace=replace,
        transport=transport,
        record=record,
        web=port if web else None,
        host=host or "",
        window=not headless and not web,
        realtime=realtime,
        seed=seed,
        camera=camera,
        model=model,
        joint_map=joint_map,
    )
    code: int = humanoid.main(options)
    return code


def _problem(context: click.Context, record: Path | None) -> str:
    """The mistake in a combination of valid options, or an empty text."""
    given = {
        name for name in context.params if context.get_parameter_source(name) is not ParameterSource.DEFAULT
    }
    for one, other in (("headless", "web"), ("idle", "scenario")):
        if {one, other} <= given:
            return f"--{one} cannot be used with --{other}"
    for option, needs in (("port", "web"), ("host", "web"), ("joint_map", "model")):
        if option in given and needs not in given:
            return f"--{option.replace('_', '-')} needs --{needs}"
    if record is None:
        return ""
    if record.suffix.lower() not in _PICTURES:
        return "--record needs a file that ends in .gif, .mp4 or .png"
    # A scenario takes a minute: what cannot be written should be said before.
    if not record.parent.is_dir():
        return f"--record: there is no folder {record.parent}"
    return ""


def _prepare(transport: Literal["local", "rclpy"]) -> None:
    """Let the demo find what it needs. Raises UsageError with what is missing."""
    humanoid = resources.humanoid()
    if not humanoid.is_dir():
        raise UsageError([Diagnostic("no-demo", f"the humanoid is not in {humanoid}")])
    if find_spec("mujoco") is None:
        advice = f"run `{installing.add_extra('sim')}`"
        raise UsageError([Diagnostic("no-mujoco", "the demo needs MuJoCo", help=advice)])
    sys.path.insert(0, str(humanoid))
    try:
        put_on_path(transport, None)
    except ActivationError as error:
        raise UsageError([Diagnostic("no-transport", str(error))]) from None
