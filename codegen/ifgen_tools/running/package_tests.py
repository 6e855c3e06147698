"""`ifgen test`: the tests of a package, by pytest."""

from __future__ import annotations

import os
import subprocess
import sys
from importlib.util import find_spec
from pathlib import Path
from typing import Final

import click
from ifgen.config import installing
from ifgen.config.settings import settle
from ifgen.diagnostics import Diagnostic, UsageError

from ifgen_tools import completion
from ifgen_tools.running import packages

_FOLDERS: Final = ("test", "tests")


@click.command(
    context_settings={
        "ignore_unknown_options": True,
        "allow_interspersed_args": False,
        "help_option_names": ["-h", "--help"],
    },
    epilog="Example: ifgen test battery_monitor -k contract",
)
@click.option(
    "--transport",
    type=click.Choice(["local", "rclpy", "auto", "both"]),
    default="auto",
    envvar="IFGEN_TRANSPORT",
    help="Our rclpy (local), the real one (rclpy), the real one if it is installed (auto), or both in turn.",
)
@click.argument("package", shell_complete=completion.packages_to_run)
@click.argument("arguments", metavar="[ARGS]...", nargs=-1, type=click.UNPROCESSED)
def test(transport: str, package: str, arguments: tuple[str, ...]) -> int:
    """Run the tests of a package with pytest.

    PACKAGE is a generated one, sources in this folder or in src, or one that is installed with its tests. All
    ARGS go to pytest. The exit code is that of pytest.
    """
    output = settle().output
    folder = _tests_of(package, output)
    if find_spec("pytest") is None:
        raise UsageError(
            [Diagnostic("no-pytest", "there is no pytest here", help=f"run `{installing.add_extra('test')}`")]
        )
    command = [sys.executable, "-m", "pytest", f"--transport={transport}", str(folder), *arguments]
    return subprocess.call(command, env=_with_sources(package, output))


def _with_sources(name: str, output: Path) -> dict[str, str]:
    """The environment, in which a package that is sources can be imported, and those beside it."""
    found = packages.find(name, output)
    if found is None or found.prefix is not None or found.share.parent == output.resolve():
        return dict(os.environ)
    beside = packages.source_folders([found.share / "package.xml"])
    path = [str(found.share), *filter(None, [os.environ.get("PYTHONPATH")]), *map(str, beside)]
    return {**os.environ, "PYTHONPATH": os.pathsep.join(dict.fromkeys(path))}


def _tests_of(name: str, output: Path) -> Path:
    """The folder of tests of a package. Raises UsageError."""
    found = packages.find(name, output)
    roots = [output / name, *([] if found is None else [found.share])]
    folders = [root / each for root in roots for each in _FOLDERS]
    for folder in folders:
        if folder.is_dir():
            return folder
    if found is None and not (output / name).is_dir():
        raise UsageError([packages.missing(name, output)])
    advice = f"ifgen looked for {' and '.join(_FOLDERS)} in {', '.join(dict.fromkeys(map(str, roots)))}"
    raise UsageError([Diagnostic("no-tests", f"the package '{name}' has no tests", help=advice)])
