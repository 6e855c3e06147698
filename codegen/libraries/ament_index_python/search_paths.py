"""The installation prefixes that are searched."""

import os

from ament_index_python import _without_ros
from ament_index_python.constants import AMENT_PREFIX_PATH_ENV_VAR


def get_search_paths() -> list[str]:
    """Return the prefixes in AMENT_PREFIX_PATH that exist, in its order.

    Without that variable, returns the prefix of Python, where pip installs the index of a package. Upstream
    has no such rule. Raises EnvironmentError if there is neither.
    """
    prefixes = os.environ.get(AMENT_PREFIX_PATH_ENV_VAR)
    if prefixes:
        return [prefix for prefix in prefixes.split(os.pathsep) if prefix and os.path.exists(prefix)]
    if installed := _without_ros.prefixes():
        return installed
    raise OSError(f"Environment variable '{AMENT_PREFIX_PATH_ENV_VAR}' is not set or empty")
