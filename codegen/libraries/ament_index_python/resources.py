"""Resources of the index: a file for each, in a folder for each type."""

import os
from collections.abc import Iterator
from typing import Literal

from ament_index_python.constants import RESOURCE_INDEX_SUBFOLDER
from ament_index_python.search_paths import get_search_paths


class InvalidResourceTypeNameError(ValueError):
    """A type of resources has a name with a path separator."""


class InvalidResourceNameError(ValueError):
    """A resource has a name with a path separator."""


def get_resource(resource_type: str, resource_name: str) -> tuple[str, str]:
    """Return the content of a resource, and the prefix that it is in.

    Raises LookupError if no prefix has it, OSError if it cannot be read, EnvironmentError if there are no
    prefixes to search, and an InvalidResource...Error for names with path separators.
    """
    found = has_resource(resource_type, resource_name)
    if found is False:
        raise LookupError(f"Could not find the resource '{resource_name}' of type '{resource_type}'")
    try:
        # In the encoding of the locale, as upstream.
        with open(os.path.join(_folder(found, resource_type), resource_name)) as file:
            return file.read(), found
    except OSError as error:
        raise OSError(
            f"Could not open the resource '{resource_name}' of type '{resource_type}':\n{error}"
        ) from error


def get_resources(resource_type: str) -> dict[str, str]:
    """Return the resources of a type: the prefix of each, by name.

    Raises EnvironmentError if there are no prefixes to search, and InvalidResourceTypeNameError.
    """
    _check_type(resource_type)
    found: dict[str, str] = {}
    for prefix in get_search_paths():
        for entry in _entries(_folder(prefix, resource_type)):
            if not entry.is_dir():
                found.setdefault(entry.name, prefix)
    return found


def get_resource_types() -> set[str]:
    """Return the types of the resources in all prefixes. Raises EnvironmentError if there are none."""
    prefixes = get_search_paths()
    return {entry.name for prefix in prefixes for entry in _entries(_folder(prefix)) if entry.is_dir()}


def has_resource(resource_type: str, resource_name: str) -> str | Literal[False]:
    """Return the first prefix that has a resource, or False.

    Raises EnvironmentError if there are no prefixes to search, and an InvalidResource...Error for names with
    path separators.
    """
    _check_type(resource_type, resource_name)
    if _has_separator(resource_name):
        raise InvalidResourceNameError(f"Resource name '{resource_name}' is invalid")
    for prefix in get_search_paths():
        if os.path.isfile(os.path.join(_folder(prefix, resource_type), resource_name)):
            return prefix
    return False


def _check_type(resource_type: str, resource_name: str | None = None) -> None:
    assert resource_type, "The resource type must not be empty"
    assert resource_name is None or resource_name, "The resource name must not be empty"
    if _has_separator(resource_type):
        raise InvalidResourceTypeNameError(f"Resource type '{resource_type}' is invalid")


def _has_separator(name: str) -> bool:
    return "/" in name or "\\" in name


def _folder(prefix: str, *resource_type: str) -> str:
    return os.path.join(prefix, RESOURCE_INDEX_SUBFOLDER, *resource_type)


def _entries(folder: str) -> Iterator[os.DirEntry[str]]:
    """The entries of a folder of the index, which may not exist; names with a dot in front do not count."""
    if os.path.isdir(folder):
        with os.scandir(folder) as entries:
            yield from (entry for entry in entries if not entry.name.startswith("."))
