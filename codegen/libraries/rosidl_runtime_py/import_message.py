"""Classes of messages by the types of fields."""

from __future__ import annotations

from importlib import import_module
from typing import Any

__all__ = ["import_message_from_namespaced_type"]


def import_message_from_namespaced_type(message_type: Any) -> Any:
    """Return the class of a NamespacedType of rosidl_parser. Raises ImportError and AttributeError."""
    return getattr(import_module(".".join(message_type.namespaces)), message_type.name)
