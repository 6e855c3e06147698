"""Things that upstream may still change."""

from __future__ import annotations

from .events_executor import EventsExecutor

__all__ = ["EventsExecutor"]
