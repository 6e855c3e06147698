"""Things that upstream may still change."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rclpy.impl.reexports import reexport

from .events_executor import EventsExecutor

if TYPE_CHECKING:
    from rclpy_asyncio import AsyncClient as AsyncClient
    from rclpy_asyncio import AsyncClock as AsyncClock
    from rclpy_asyncio import AsyncNode as AsyncNode
    from rclpy_asyncio import AsyncPublisher as AsyncPublisher
    from rclpy_asyncio import AsyncService as AsyncService
    from rclpy_asyncio import AsyncSubscription as AsyncSubscription
    from rclpy_asyncio import AsyncTimer as AsyncTimer
else:
    __getattr__ = reexport(__name__)

__all__ = ["EventsExecutor"]
