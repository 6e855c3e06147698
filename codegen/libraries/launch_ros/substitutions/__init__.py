# Values of parameters are Any.
# pyright: reportUnknownArgumentType=false, reportUnknownLambdaType=false
# pyright: reportUnknownMemberType=false, reportUnknownVariableType=false
"""Texts about packages and nodes."""

from __future__ import annotations

import shlex

from launch.launch_context import LaunchContext, Packages
from launch.some_substitutions_type import SomeSubstitutionsType
from launch.substitution import Substitution
from launch.substitutions import PathJoinSubstitution, PathSubstitution, SubstitutionFailure
from launch.utilities import described, normalize_to_list_of_substitutions, perform_substitutions

__all__ = [
    "ExecutableInPackage",
    "FindPackage",
    "FindPackagePrefix",
    "FindPackageShare",
    "Parameter",
]


class FindPackage(PathSubstitution):
    """The base of what finds a package; `/` makes a path inside it."""

    def __init__(self, package: SomeSubstitutionsType) -> None:
        super().__init__([])
        self.package = normalize_to_list_of_substitutions(package)

    def describe(self) -> str:
        """Return the package."""
        return f"{type(self).__name__}(pkg={described(self.package)})"

    def find(self, package_name: str) -> str:
        """Return the folder of a package that is installed, or whose sources can be found.

        Raises PackageNotFoundError, a KeyError, or LaunchError.
        """
        return self.find_in(LaunchContext().packages, package_name)

    def find_in(self, packages: Packages, name: str) -> str:
        """Return the folder of a package that a launch finds."""
        raise NotImplementedError(f"{type(self).__name__} does not define find_in()")

    def perform(self, context: LaunchContext) -> str:
        """Return the folder. Raises PackageNotFoundError, a KeyError, or LaunchError."""
        return self.find_in(context.packages, perform_substitutions(context, self.package))

    def __truediv__(self, path: SomeSubstitutionsType) -> PathJoinSubstitution:
        """Return a path inside it."""
        return PathJoinSubstitution([self, path])


class FindPackagePrefix(FindPackage):
    """The folder that a package is installed in."""

    def find_in(self, packages: Packages, name: str) -> str:
        """Return it."""
        return packages.prefix(name)


class FindPackageShare(FindPackage):
    """The folder of shared files of a package."""

    def find_in(self, packages: Packages, name: str) -> str:
        """Return it."""
        return packages.share(name)


class ExecutableInPackage(Substitution):
    """An executable of a package, as words that a shell understands."""

    def __init__(self, executable: SomeSubstitutionsType, package: SomeSubstitutionsType) -> None:
        self.executable = normalize_to_list_of_substitutions(executable)
        self.package = normalize_to_list_of_substitutions(package)

    def describe(self) -> str:
        """Return the package and the executable."""
        return f"ExecInPkg(pkg={described(self.package)}, exec={described(self.executable)})"

    def words(self, context: LaunchContext) -> list[str]:
        """Return the words that start it. Raises SubstitutionFailure."""
        package = perform_substitutions(context, self.package)
        return list(context.packages.executable(package, perform_substitutions(context, self.executable)))

    def perform(self, context: LaunchContext) -> str:
        """Return the words that start it, as one text. Raises SubstitutionFailure."""
        return shlex.join(self.words(context))


class Parameter(Substitution):
    """The value of a parameter that SetParameter has set before."""

    def __init__(self, name: SomeSubstitutionsType, *, default: SomeSubstitutionsType | None = None) -> None:
        self.name = normalize_to_list_of_substitutions(name)
        self.default = None if default is None else normalize_to_list_of_substitutions(default)

    def describe(self) -> str:
        """Return its name."""
        return f"Parameter({described(self.name)})"

    def perform(self, context: LaunchContext) -> str:
        """Return its value as a text. Raises SubstitutionFailure."""
        name = perform_substitutions(context, self.name)
        for given in reversed(context.launch_configurations.get("global_params", [])):
            if isinstance(given, tuple) and given[0] == name:
                return str(given[1])
        if self.default is None:
            raise SubstitutionFailure(f"no SetParameter before has set the parameter '{name}'")
        return perform_substitutions(context, self.default)
