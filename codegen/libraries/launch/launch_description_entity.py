"""The base of everything that a description contains."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from pathlib import Path
from types import FrameType
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from launch.launch_context import LaunchContext

_LIBRARIES = str(Path(__file__).parent.parent / "launch")


class LaunchDescriptionEntity:
    """Part of a description; `place` is the file and the line (from 1) that made it, for messages."""

    def __init__(self) -> None:
        frame: FrameType | None = sys._getframe(1)  # pyright: ignore[reportPrivateUsage]  # documented
        while frame is not None and frame.f_code.co_filename.startswith(_LIBRARIES):
            frame = frame.f_back
        self.place: tuple[str, int] | None = frame and (frame.f_code.co_filename, frame.f_lineno)

    def describe(self) -> str:
        """Return what it is, for people."""
        return self.__class__.__name__

    def describe_sub_entities(self) -> Sequence[LaunchDescriptionEntity]:
        """Return the entities inside that run whenever it does."""
        return []

    def describe_conditional_sub_entities(self) -> Sequence[tuple[str, Sequence[LaunchDescriptionEntity]]]:
        """Return the entities inside that run in some cases, with what the case is."""
        return []

    def visit(self, context: LaunchContext) -> Sequence[LaunchDescriptionEntity] | None:
        """Do it, and return what to visit next."""
        raise NotImplementedError(f"{type(self).__name__} does not define visit()")
