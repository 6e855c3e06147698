"""What several commands take: types of arguments, and options with their help."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import click

EXISTING = click.Path(exists=True, path_type=Path)
EXISTING_FILE = click.Path(exists=True, dir_okay=False, path_type=Path)
FOLDER = click.Path(exists=True, file_okay=False, path_type=Path)
OUTPUT_FOLDER = click.Path(file_okay=False, path_type=Path)
OUTPUT_FILE = click.Path(dir_okay=False, path_type=Path)


def include(command: Callable[..., Any]) -> Callable[..., Any]:
    """`-I DIR`, which may be repeated."""
    help = "Find dependencies in this folder too; may be repeated."
    return click.option("-I", "--include", metavar="DIR", multiple=True, type=FOLDER, help=help)(command)


def strict(command: Callable[..., Any]) -> Callable[..., Any]:
    """`--strict` and `--no-strict`."""
    help = "Count warnings as errors: the exit code is 1."
    return click.option("--strict/--no-strict", default=None, help=help)(command)


def quiet(command: Callable[..., Any]) -> Callable[..., Any]:
    """`-q`."""
    return click.option("-q", "--quiet", is_flag=True, help="Print diagnostics only.")(command)


def format_(command: Callable[..., Any]) -> Callable[..., Any]:
    """`--format text|json|github`, for diagnostics."""
    help = "For people (text), tools (json) or annotations on GitHub."
    choice = click.Choice(["text", "json", "github"])
    return click.option("--format", "format_", type=choice, default="text", help=help)(command)
