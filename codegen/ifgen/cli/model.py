"""`ifgen model`: the interfaces and nodes as one JSON document, for programs in any language."""

from __future__ import annotations

import json
import sys
from pathlib import Path
from typing import TYPE_CHECKING

import click

from ifgen.command_kit.options import EXISTING, WithDepsCommand, include_option, with_deps_option
from ifgen.config.settings import settle

if TYPE_CHECKING:
    from ifgen.reading.search_path import WithDeps

# Late imports: the stages take longest to load.


@click.command(cls=WithDepsCommand, epilog="Example: ifgen model interfaces | jq '.types[].type_hash'")
@click.argument("paths", metavar="[PATH]...", nargs=-1, type=EXISTING)
@include_option
@with_deps_option
@click.option("--exclude", metavar="PATTERN", multiple=True, help="Leave out a package, or demo_msgs/msg/*.")
@click.option("--schema", is_flag=True, help="Print the JSON schema of the document instead.")
def model(
    paths: tuple[Path, ...],
    include: tuple[Path, ...],
    with_deps: WithDeps | None,
    exclude: tuple[str, ...],
    schema: bool,
) -> int:
    """Print interfaces and nodes as JSON.

    This is what generators of other languages get: docs/model.md describes it. What is only needed by others
    is in it, too, with `generate: false`.

    PATH is a package, a folder of packages, or one .msg, .srv, .action, .idl or .nodl.yaml file. The default
    is the paths in [tool.ifgen] of pyproject.toml.
    """
    from ifgen import model as public

    if schema:
        print(json.dumps(public.schema(), indent=1))
        return 0
    from ifgen.pipeline.model import load_model

    settings = settle(paths, None, include, with_deps, exclude=exclude).with_paths()
    loaded = load_model(
        *settings.paths, include=settings.include, with_deps=settings.with_deps, exclude=settings.exclude
    )
    sys.stdout.write(public.to_text(loaded))
    return 0
