"""Publishers of an AsyncNode. `rclpy_asyncio` has them."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rclpy.impl.reexports import reexport

if TYPE_CHECKING:
    from rclpy_asyncio import AsyncPublisher as AsyncPublisher  # noqa: PLC0414 - programs import it from here
else:
    __getattr__ = reexport(__name__)
