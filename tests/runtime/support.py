"""Message packages that are importable for a while, apart from others of the same names."""

from __future__ import annotations

import importlib
import sys
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path


@contextmanager
def imported_from(folder: Path | None, packages: Iterable[str]) -> Iterator[None]:
    """Import these packages from a folder, or where Python finds them. Forget them afterwards."""
    names = set(packages)

    def loaded() -> list[str]:
        return [name for name in sys.modules if name.partition(".")[0] in names]

    before = {name: sys.modules.pop(name) for name in loaded()}
    if folder is not None:
        sys.path.insert(0, str(folder))
    try:
        yield
    finally:
        if folder is not None:
            sys.path.remove(str(folder))
        for name in loaded():
            del sys.modules[name]
        sys.modules.update(before)
        importlib.invalidate_caches()
