"""The subject of `interface proto`: a message with the default values of its type."""

from __future__ import annotations

from typing import Any, Literal

from ifgen_tools.session import activate
from ifgen_tools.types import interface_class


def prototype(name: str, transport: Literal["local", "rclpy", "auto"]) -> Any:
    """A message, the request of a service or the goal of an action, with default values. Raises ToolError."""
    activate(transport)
    folder = name.split("/")[1] if name.count("/") == 2 else "msg"
    cls = interface_class(name, folder if folder in {"srv", "action"} else "msg")
    part = {"srv": "Request", "action": "Goal"}.get(folder)
    return getattr(cls, part)() if part else cls()
