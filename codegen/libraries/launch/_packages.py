"""Packages and programs, as they are installed: by the index of ament, and by `ifgen run`."""

from __future__ import annotations

import shutil
import sys
from importlib.machinery import PathFinder
from pathlib import Path
from typing import TYPE_CHECKING

from launch._errors import LaunchError

if TYPE_CHECKING:
    from collections.abc import Sequence

    from launch.launch_context import Files, Start

_OUR_RCLPY = Path(__file__).parents[2] / "underlay" / "rclpy"


class InstalledPackages:
    """Finds what is installed; executables of sources are left to `ifgen run`, where there is one."""

    def __init__(self) -> None:
        self._near: list[Path] = []

    def near(self, path: str) -> None:
        """Note that a launch file is read: programs beside it can be found."""
        self._near.append(Path(path).absolute())

    def share(self, package: str) -> str:
        """Return the folder of shared files of a package. Raises PackageNotFoundError, a KeyError."""
        from ament_index_python import packages  # few descriptions ask for a package

        return packages.get_package_share_directory(package)

    def prefix(self, package: str) -> str:
        """Return the folder that a package is installed in. Raises PackageNotFoundError, a KeyError."""
        from ament_index_python import packages  # as above

        return packages.get_package_prefix(package)

    def executable(self, package: str, name: str) -> Sequence[str]:
        """Return the command of an executable of a package. Raises LaunchError."""
        try:
            file = Path(self.prefix(package), "lib", package, name)
        except LookupError:
            file = Path()
        if file.is_file():
            return [str(file)]
        if PathFinder.find_spec("ifgen") is None:
            raise LaunchError(f"the package '{package}' has no executable '{name}'")
        return [*_ifgen_run(), package, name]

    def program(self, path: str, search: str | None) -> Sequence[str]:
        """Return the command of a program: a file, beside a launch file too, or one in these folders."""
        file = self.file_of(path)
        if file is None:
            return [shutil.which(path, path=search) or path]
        if file.suffix == ".py" and PathFinder.find_spec("ifgen") is not None:
            return [*_ifgen_run(), str(file)]
        return [str(file)]

    def file_of(self, path: str) -> Path | None:
        """Return the file of a program, here or beside a launch file."""
        candidates = (Path(path), *(near.parent / path for near in reversed(self._near)))
        return next((file for file in candidates if file.is_file()), None)

    def start(self, command: Sequence[str], files: Files) -> Start | None:
        """Return None: programs start as any process does."""
        return None


def _ifgen_run() -> list[str]:
    """The command that runs Python programs, on the rclpy that this process would import."""
    spec = PathFinder.find_spec("rclpy")
    is_local = spec is not None and spec.origin is not None and Path(spec.origin).parent == _OUR_RCLPY
    return [sys.executable, "-m", "ifgen", "run", "--transport", "local" if is_local else "rclpy"]
