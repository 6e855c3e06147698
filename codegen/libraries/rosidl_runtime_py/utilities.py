"""Classes of interfaces by their names, such as `std_msgs/msg/String`."""

from __future__ import annotations

from importlib import import_module
from typing import Any

__all__ = ["get_action", "get_interface", "get_message", "get_namespaced_type", "get_service"]


def get_namespaced_type(full_name: str) -> Any:
    """Return the NamespacedType of a full name. Raises ValueError unless it has three parts."""
    from rosidl_parser.definition import NamespacedType  # most programs ask for classes only

    *namespaces, name = _parts(full_name)
    return NamespacedType(namespaces, name)


def get_interface(identifier: str) -> Any:
    """Return the class of an interface.

    Raises ValueError for a malformed name, ModuleNotFoundError for a package that is not there, and
    AttributeError for an interface that is not in it.
    """
    package, kind, name = _parts(identifier)
    return getattr(import_module(f"{package}.{kind}"), name)


def get_message(identifier: str) -> Any:
    """Return the class of a message, as `get_interface`; ValueError for another kind of interface."""
    return _of_kind(identifier, "msg", "message")


def get_service(identifier: str) -> Any:
    """Return the class of a service, as `get_interface`; ValueError for another kind of interface."""
    return _of_kind(identifier, "srv", "service")


def get_action(identifier: str) -> Any:
    """Return the class of an action, as `get_interface`; ValueError for another kind of interface."""
    return _of_kind(identifier, "action", "action")


def _of_kind(identifier: str, folder: str, kind: str) -> Any:
    parts = identifier.split("/")
    if len(parts) != 3 or parts[1] != folder:
        raise ValueError(
            f"Expected the full name of {'an' if kind == 'action' else 'a'} {kind}, got '{identifier}'"
        )
    return get_interface(identifier)


def _parts(full_name: str) -> list[str]:
    parts = full_name.split("/")
    if len(parts) != 3 or not all(parts):
        raise ValueError(f"expected a name such as 'std_msgs/msg/String', got '{full_name}'")
    return parts
