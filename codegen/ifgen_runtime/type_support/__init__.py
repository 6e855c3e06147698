"""Where generated classes get their type support from: the objects that real rclpy hands to the middleware.

Nothing here is needed without rclpy. A provider is installed by whatever can make type supports (a native
extension); without one, classes keep their None and rclpy says that type support is missing.
"""

from __future__ import annotations

import logging
from collections.abc import Callable, Mapping
from typing import Any, TypeAlias

Provider: TypeAlias = Callable[[type], Mapping[str, Any]]
"""Gives the metaclass attributes of a message, service or action class (`_TYPE_SUPPORT` and, for messages,
`_CREATE_ROS_MESSAGE`, `_CONVERT_FROM_PY`, `_CONVERT_TO_PY` and `_DESTROY_ROS_MESSAGE`); raises ImportError
with the reason where it cannot."""

_providers: list[Provider] = []


def install(provider: Provider) -> None:
    """Ask this provider from now on, before those installed earlier."""
    _providers.insert(0, provider)


def import_type_support(interface: type) -> None:
    """Set the type support attributes on the metaclass of a class, or leave them None and log why."""
    reason = "no provider of type supports is installed"
    for provider in _providers:
        try:
            attributes = provider(interface)
        except ImportError as error:
            reason = str(error)
            continue
        for name, value in attributes.items():
            setattr(type(interface), name, value)
        return
    package, folder, _ = interface.__module__.split(".")
    logger = logging.getLogger(f"{package}.{folder}.{interface.__name__}")
    logger.debug("Failed to import needed modules for type support: %s", reason)
