"""Stubs that type checkers need beyond the project: of rclpy, messages and libraries that come with ifgen."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

from ifgen import resources
from ifgen.diagnostics import Diagnostic, UsageError, shown_path
from ifgen.generator_py import stubs
from ifgen.pipeline.stages import GENERATOR
from ifgen.reading import manifest
from ifgen.writing import transaction, write
from ifgen.writing.write import Drift, OutputPackage, Written


def write_typings(directory: Path, output: Path) -> Written:
    """Write the stubs into a folder, beside packages generated into `output`, which have types themselves.

    Raises InterfaceError if a file in the way is not ours, and OSError; then nothing has been written.
    """
    _must_differ(directory, output)
    with transaction.locked(directory):
        return write.write(_packages(directory, output), directory, GENERATOR)


def typings_drift(directory: Path, output: Path) -> tuple[Drift, ...]:
    """The differences between a folder and the result of `write_typings`. Writes nothing."""
    _must_differ(directory, output)
    return write.drift(_packages(directory, output), directory)


def are_there(directory: Path) -> bool:
    """Whether the stubs have been written into a folder."""
    return (directory / "rclpy" / "__init__.pyi").is_file()


def _packages(directory: Path, output: Path) -> Iterator[OutputPackage]:
    yield OutputPackage("rclpy", stubs.of_rclpy(resources.underlay()))
    generated = resources.bundled_generated()
    for name in sorted(resources.packages_of_ros()):
        if not _is_generated(output / name):
            yield OutputPackage(name, stubs.of_messages(generated / name))
        elif _is_generated(directory / name):
            yield OutputPackage(name, {})  # from before the project had its own
    for folder in sorted(path.parent for path in resources.libraries().glob("*/__init__.py")):
        yield OutputPackage(folder.name, stubs.of_library(folder))


def _is_generated(folder: Path) -> bool:
    return (folder / manifest.NAME).is_file()


def _must_differ(directory: Path, output: Path) -> None:
    if directory.resolve() == output.resolve():
        message = f"packages are generated into {shown_path(directory)}, and Python would import stubs there"
        advice = "choose a folder for the stubs alone, such as `ifgen typings typings`"
        raise UsageError([Diagnostic("configuration", message, help=advice)])
