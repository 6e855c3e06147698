"""The node whose callbacks are coroutines of an event loop. `rclpy_asyncio` has it."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rclpy.impl.reexports import reexport

if TYPE_CHECKING:
    from rclpy_asyncio import AsyncNode as AsyncNode  # noqa: PLC0414 - programs import it from here
else:
    __getattr__ = reexport(__name__)
