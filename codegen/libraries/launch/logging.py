"""Loggers for launch files: Python's own, which print as the launch does."""

import logging
from typing import Final

_OF_LAUNCH: Final = "launch"


def get_logger(name: str | None = None) -> logging.Logger:
    """Return the logger of this name, by default the one of the launch."""
    return logging.getLogger(
        _OF_LAUNCH if name is None else f"{_OF_LAUNCH}.{name}".replace("launch.launch", "launch")
    )
