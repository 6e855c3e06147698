"""Gives each program in company its own configuration of Python's logging: levels, handlers, filters.

Programs share loggers, as they share the modules that use them. But each program has its own settings of a
logger.
"""

from __future__ import annotations

import logging
from collections.abc import Callable
from copy import copy
from typing import Any

from ifgen.running.companion import current

# The settings of each logger, and its original ones.
_SETTINGS: dict[str, Callable[[], Any]] = {
    "level": lambda: logging.NOTSET,
    "handlers": list,
    "filters": list,
    "disabled": bool,
    "propagate": lambda: True,
    "_cache": dict,
}


class OwnLogging:
    """Does so while it is entered."""

    def __enter__(self) -> OwnLogging:
        for name, first in _SETTINGS.items():
            setattr(logging.Logger, name, _OwnSetting(name, first))
        logging.Manager._disable = _OwnSetting("_disable", int)  # type: ignore[attr-defined]
        return self

    def __exit__(self, *_: object) -> None:
        for name in _SETTINGS:
            delattr(logging.Logger, name)
        del logging.Manager._disable  # type: ignore[attr-defined]


class _OwnSetting:
    """An attribute of loggers that is what the current program has made of it."""

    def __init__(self, name: str, first: Callable[[], Any]) -> None:
        self._name = name
        self._first = first

    def __get__(self, logger: Any, owner: type) -> Any:
        if logger is None:
            return self
        companion = current()
        process: dict[str, Any] = logger.__dict__
        if companion is None:
            return process.setdefault(self._name, self._first())
        values, key = companion.attributes, (logger, self._name)
        if key not in values:
            values[key] = copy(process.get(self._name, self._first()))
        return values[key]

    def __set__(self, logger: Any, value: Any) -> None:
        companion = current()
        if companion is None:
            vars(logger)[self._name] = value
        else:
            companion.attributes[logger, self._name] = value
