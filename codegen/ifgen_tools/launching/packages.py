"""The packages that `ifgen launch` finds, and how their programs start: by `ifgen run`."""

from __future__ import annotations

import shutil
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Final

from ifgen.diagnostics import UsageError
from launch._errors import LaunchError
from launch.launch_context import Files, Start

from ifgen_tools.running import packages, processes

RUN: Final = (sys.executable, "-m", "ifgen", "run")
"""The beginning of the command of each program in Python."""


class UserPackages:
    """Finds generated packages in the output folder, sources, and what is installed."""

    def __init__(self, output_folder: Path, transport: str) -> None:
        self._output_folder = output_folder
        self._transport = transport
        self._near: list[Path] = []

    def near(self, path: str) -> None:
        """Note that a launch file is read: it can import the modules of sources around it."""
        self._near.append(Path(path).absolute())
        folders = map(str, packages.source_folders(self._near))
        sys.path += [folder for folder in folders if folder not in sys.path]

    def share(self, package: str) -> str:
        """Return the folder of shared files of a package. Raises LaunchError."""
        return str(self._package(package).share)

    def prefix(self, package: str) -> str:
        """Return the folder that a package is installed in. Raises LaunchError."""
        found = self._package(package)
        if found.prefix is None:
            raise LaunchError(f"the package '{package}' is not installed: its files are in {found.share}")
        return str(found.prefix)

    def _package(self, name: str) -> packages.Package:
        found = packages.find(name, self._output_folder, self._near)
        if found is None:
            diagnostic = packages.missing(name, self._output_folder)
            raise LaunchError(diagnostic.message, help=diagnostic.help or "")
        return found

    def executable(self, package: str, name: str) -> Sequence[str]:
        """Return the command of an executable of a package. Raises LaunchError."""
        try:
            found = packages.executable(package, name, self._output_folder, self._near)
        except UsageError as error:
            first = error.diagnostics[0]
            raise LaunchError(first.message, help=first.help or "") from None
        return self._command(found)

    def program(self, path: str, search: str | None) -> Sequence[str]:
        """Return the command of a program: a file, beside a launch file too, or one in these folders."""
        for file in (Path(path), *(near.parent / path for near in reversed(self._near))):
            if file.is_file():
                return self._command(packages.Executable(file.name, (str(file),), packages.is_python(file)))
        return [shutil.which(path, path=search) or path]

    def _command(self, found: packages.Executable) -> list[str]:
        if not found.is_python:
            return list(found.words)
        return [*RUN, "--of-launch", "--transport", self._transport, *found.words]

    def start(self, command: Sequence[str], files: Files) -> Start | None:
        """Return how to start `ifgen run`: quietly until it can be interrupted, and told when it may end."""
        if tuple(command[: len(RUN)]) != RUN:
            return None
        note = files.new("dismissed")
        return Start({processes.NOTE: note}, processes.signals_wait(), Path(note).touch)
