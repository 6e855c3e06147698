"""Installed packages: their prefixes, and their folders of shared files."""

import os
import re
import warnings
from pathlib import Path

from ament_index_python import _without_ros
from ament_index_python.resources import get_resources, has_resource
from ament_index_python.search_paths import get_search_paths


class PackageNotFoundError(KeyError):
    """No prefix has the package."""


def get_packages_with_prefixes() -> dict[str, str]:
    """Return all installed packages: the prefix of each, by name. Raises EnvironmentError."""
    return get_resources("packages")


def get_package_prefix(package_name: str) -> str:
    """Return the prefix that a package is installed in, such as `/opt/ros/jazzy`.

    Raises PackageNotFoundError, and ValueError if no package can have that name (REP-127).
    """
    if re.fullmatch("[a-zA-Z0-9][a-zA-Z0-9_-]+", package_name) is None:
        raise ValueError(f"'{package_name}' is not a valid package name")
    try:
        searched = get_search_paths()
    except OSError as error:
        # Upstream raises the OSError. Programs do not expect it: where there is a ROS, the variable is set.
        raise PackageNotFoundError(f"package '{package_name}' not found: {error}") from None
    prefix = has_resource("packages", package_name)
    if prefix is False:
        raise PackageNotFoundError(f"package '{package_name}' not found, searching: {searched}")
    return prefix


def get_package_share_directory(package_name: str, print_warning: bool = True) -> str:
    """Return the folder of a package's shared files, such as `/opt/ros/jazzy/share/rclpy`.

    Without AMENT_PREFIX_PATH, a package that is not installed, but lies on `sys.path` as sources do, has its
    shared files beside its package.xml; upstream has no such rule. Warns if the folder does not exist, unless
    that is turned off. Raises what `get_package_prefix` raises.
    """
    path = _share(package_name)
    if print_warning and not os.path.exists(path):
        warnings.warn(f"Share directory for {package_name} ({path}) does not exist.", stacklevel=2)
    return path


def get_package_share_path(package_name: str, print_warning: bool = True) -> Path:
    """Return `get_package_share_directory` as a path."""
    path = Path(_share(package_name))
    if print_warning and not path.exists():
        warnings.warn(f"Share path for {package_name} ({path}) does not exist.", stacklevel=2)
    return path


def _share(package_name: str) -> str:
    try:
        return os.path.join(get_package_prefix(package_name), "share", package_name)
    except PackageNotFoundError:
        if source := _without_ros.source_folder(package_name):
            return source
        raise
