"""Contexts that keep to their process: a run that repeats exactly must not meet others."""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager
from importlib.util import find_spec

_RANGE = "ROS_AUTOMATIC_DISCOVERY_RANGE"


@contextmanager
def alone() -> Iterator[None]:
    """Keep contexts that start in this block to their process, on the local transport.

    Real rclpy would then not even find nodes of the same process.
    """
    if find_spec("rmw_local") is None:
        yield
        return
    before = os.environ.get(_RANGE)
    os.environ[_RANGE] = "OFF"
    try:
        yield
    finally:
        if before is None:
            del os.environ[_RANGE]
        else:
            os.environ[_RANGE] = before
