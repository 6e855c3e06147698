"""Gives each program in company its own configuration of Python's logging: levels, handlers, filters.

Loggers themselves are shared, as are the modules that use them: what a logger is set to depends on who asks.
"""

from __future__ import annotations

import logging
from collections.abc import Callable
from typing import Any

from ifgen.running.companion import current

# What each logger is set to, and what it is at first.
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
        if companion is None:
            return vars(logger).setdefault(self._name, self._first())
        key = logger, self._name
        found = companion.attributes.get(key, self)
        if found is self:
            found = vars(logger).get(self._name, self._first())
            found = found.copy() if isinstance(found, list | dict) else found
            companion.attributes[key] = found
        return found

    def __set__(self, logger: Any, value: Any) -> None:
        companion = current()
        if companion is None:
            vars(logger)[self._name] = value
        else:
            companion.attributes[logger, self._name] = value
