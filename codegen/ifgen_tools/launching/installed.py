"""`ifgen launch` by the launch that a ROS or a checkout of the user has, in place of ours.

It finds packages by the index of ament alone. What only ifgen finds (generated packages, sources) is in an
index of its own, in a temporary folder, with programs that are `ifgen run`.
"""

from __future__ import annotations

import os
import shlex
import sys
import tempfile
from collections.abc import Iterator, Sequence
from importlib.machinery import PathFinder
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ifgen import resources
from ifgen.command_kit.tool import ToolError

from ifgen_tools.running import packages

# Late imports: `launch`, which is found once the transport is chosen.

if TYPE_CHECKING:
    from launch import LaunchDescription

_PREFIXES = "AMENT_PREFIX_PATH"


def folder() -> Path | None:
    """The folder of the user's own `launch` on sys.path; None if there is none."""
    spec = PathFinder.find_spec("launch")
    place = Path(spec.origin).parent if spec is not None and spec.origin else None
    is_theirs = place is not None and place.parent != resources.libraries()
    return place if is_theirs and place is not None and (place / "launch_service.py").is_file() else None


def run(
    path: str, given: Sequence[str], *, output: Path, transport: str, show_args: bool, prints: bool
) -> int:
    """Do what `ros2 launch` does; returns its exit code. Raises ToolError for a file that cannot be read."""
    from launch import LaunchContext, LaunchDescription, LaunchService
    from launch.actions import IncludeLaunchDescription
    from launch.launch_description_sources import AnyLaunchDescriptionSource

    source = AnyLaunchDescriptionSource(path)
    with tempfile.TemporaryDirectory(prefix="ifgen-launch-") as index:
        os.environ[_PREFIXES] = os.pathsep.join(filter(None, (index, os.environ.get(_PREFIXES))))
        os.environ["PYTHONPATH"] = os.pathsep.join(filter(None, sys.path))
        _fill(Path(index), Path(path), output, transport)
        if show_args or prints:
            try:
                description = source.get_launch_description(LaunchContext(argv=list(given)))
            except Exception as error:
                raise ToolError(f"{path} cannot be read: {error}") from error
            print("\n".join(_arguments(description) if show_args else _tree(description)))
            return 0
        service = LaunchService(argv=list(given))
        arguments: Any = [tuple(word.split(":=", 1)) for word in given]
        included: Any = IncludeLaunchDescription(source, launch_arguments=arguments)
        service.include_launch_description(LaunchDescription([included]))
        code: int = service.run()
        return code


def _tree(description: LaunchDescription) -> list[str]:
    from launch import LaunchIntrospector

    return [LaunchIntrospector().format_launch_description(description)]


def _arguments(description: Any) -> Iterator[str]:
    yield "Arguments (pass arguments as '<name>:=<value>'):"
    arguments = description.get_launch_arguments()
    for argument in arguments:
        default = argument.default_value
        texts = None if default is None else "".join(each.describe() for each in default)
        yield f"\n    '{argument.name}':\n        {argument.description}"
        if texts is not None:
            yield f"        (default: {texts})"
    if not arguments:
        yield "\n  No arguments."


def _fill(index: Path, file: Path, output: Path, transport: str) -> None:
    """Write an index of the packages that only ifgen finds."""
    for name in packages.names(output):
        package = packages.find(name, output, [file.absolute()])
        if package is None or package.prefix is not None:
            continue
        for folder in ("share/ament_index/resource_index/packages", f"lib/{name}"):
            (index / folder).mkdir(parents=True, exist_ok=True)
        (index / "share/ament_index/resource_index/packages" / name).touch()
        (index / "share" / name).symlink_to(package.share.absolute())
        for program in package.executables:
            words = [sys.executable, "-m", "ifgen", "run", "--of-launch", "--transport", transport]
            script = index / "lib" / name / program
            script.write_text(
                f'#!/bin/sh\nexec {shlex.join([*words, name, program])} "$@"\n', encoding="utf-8"
            )
            script.chmod(0o755)
