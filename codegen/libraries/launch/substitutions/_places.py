"""Files and folders."""

from __future__ import annotations

import os
import shutil
from collections.abc import Iterable
from pathlib import Path

from launch.launch_context import LaunchContext
from launch.logging import launch_config
from launch.some_substitutions_type import SomeSubstitutionsType
from launch.substitution import Substitution
from launch.substitutions.substitution_failure import SubstitutionFailure
from launch.utilities import described, normalize_to_list_of_substitutions, perform_substitutions


class PathJoinSubstitution(Substitution):
    """Parts of a path with separators between them."""

    def __init__(self, substitutions: Iterable[SomeSubstitutionsType]) -> None:
        self.substitutions = [normalize_to_list_of_substitutions(each) for each in substitutions]

    def describe(self) -> str:
        """Return the parts."""
        return f"PathJoin({', '.join(map(described, self.substitutions))})"

    def perform(self, context: LaunchContext) -> str:
        """Return the path."""
        parts = (perform_substitutions(context, each) for each in self.substitutions)
        return os.path.join(*parts)  # noqa: PTH118 - a Path would drop the slash at the end

    def __truediv__(self, part: SomeSubstitutionsType) -> PathJoinSubstitution:
        """Add a part."""
        return PathJoinSubstitution([*self.substitutions, part])


class PathSubstitution(PathJoinSubstitution):
    """A path that grows by `/`."""

    def __init__(self, path: SomeSubstitutionsType) -> None:
        super().__init__([path])


class _OfThisFile(Substitution):
    def _path(self, context: LaunchContext) -> Path:
        path = context.get_locals_as_dict().get("current_launch_file_path")
        if path is None:
            raise SubstitutionFailure(f"{type(self).__name__} used outside of a launch file")
        return Path(path)

    def describe(self) -> str:
        """Return its name."""
        return f"{type(self).__name__}()"


class ThisLaunchFile(_OfThisFile):
    """The path of the launch file that contains it."""

    def perform(self, context: LaunchContext) -> str:
        """Return the absolute path. Raises SubstitutionFailure."""
        return str(self._path(context))


class ThisLaunchFileDir(_OfThisFile):
    """The folder of the launch file that contains it."""

    def perform(self, context: LaunchContext) -> str:
        """Return the absolute path. Raises SubstitutionFailure."""
        return str(self._path(context).parent)


class LaunchLogDir(Substitution):
    """The folder of the log files of this launch."""

    def describe(self) -> str:
        """Return its name."""
        return f"{type(self).__name__}()"

    def perform(self, context: LaunchContext) -> str:
        """Return the absolute path."""
        return launch_config.log_dir


class FindExecutable(Substitution):
    """A program on PATH."""

    def __init__(self, *, name: SomeSubstitutionsType) -> None:
        self.name = normalize_to_list_of_substitutions(name)

    def describe(self) -> str:
        """Return its name."""
        return f"FindExec({described(self.name)})"

    def perform(self, context: LaunchContext) -> str:
        """Return the path of the program. Raises SubstitutionFailure."""
        name = perform_substitutions(context, self.name)
        found = shutil.which(name, path=context.environment.get("PATH"))
        if found is None:
            raise SubstitutionFailure(f"executable '{name}' not found on the PATH")
        return found


class FileContent(Substitution):
    """The text in a file."""

    def __init__(self, path: SomeSubstitutionsType) -> None:
        self.path = normalize_to_list_of_substitutions(path)

    def describe(self) -> str:
        """Return the path."""
        return f"FileContent({described(self.path)})"

    def perform(self, context: LaunchContext) -> str:
        """Return the text. Raises SubstitutionFailure."""
        path = perform_substitutions(context, self.path)
        try:
            return Path(path).read_text(encoding="utf-8")
        except (OSError, UnicodeDecodeError) as error:
            raise SubstitutionFailure(f"cannot read '{path}': {error}") from None
