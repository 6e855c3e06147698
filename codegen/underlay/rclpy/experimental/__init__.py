"""Things that upstream may still change."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rclpy.impl.reexports import reexport

from .events_executor import EventsExecutor

if TYPE_CHECKING:
    from rclpy_asyncio import (
        AsyncClient,
        AsyncClock,
        AsyncNode,
        AsyncPublisher,
        AsyncService,
        AsyncSubscription,
        AsyncTimer,
    )
else:
    __getattr__ = reexport(__name__)

__all__ = ["EventsExecutor"]
