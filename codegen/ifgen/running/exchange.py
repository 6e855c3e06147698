"""Replaces a function or attribute while a `with` block runs."""

from __future__ import annotations

from collections.abc import Generator
from contextlib import contextmanager
from typing import Any


@contextmanager
def exchanged(*exchanges: tuple[Any, str, Any]) -> Generator[None]:
    """Set each `(owner, name, new)`, and set what was there before at the end."""
    real = [(owner, name, getattr(owner, name)) for owner, name, _ in exchanges]
    try:
        for owner, name, new in exchanges:
            setattr(owner, name, new)
        yield
    finally:
        for owner, name, old in real:
            setattr(owner, name, old)
