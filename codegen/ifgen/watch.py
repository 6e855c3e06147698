"""`ifgen generate --watch`: generates again when an interface, a template or the configuration changes."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import watchfiles
from watchfiles import Change

from ifgen.settings import Settings

_INPUTS = {".msg", ".srv", ".action"}
_NAMES = {"package.xml", "pyproject.toml"}


def watch(settle: Callable[[], Settings | None], generate: Callable[[Settings], object]) -> None:
    """Generate now and after every change, until Ctrl-C.

    Both functions report what is wrong themselves; `settle` gives None for a configuration that is wrong, and
    the last good one tells what to look at until it is mended.
    """
    settings = None
    while True:
        new = settle()
        if new is not None:
            settings = new
            generate(settings)
        if settings is None or not _wait_for_change(settings):
            return


def _wait_for_change(settings: Settings) -> bool:
    """Wait; False if there is nothing to wait for any more, because of Ctrl-C."""
    roots = [*settings.paths, *settings.include]
    extra = [path for path in (settings.templates, settings.file) if path is not None]

    def matters(_: Change, changed: str) -> bool:
        path = Path(changed)
        if settings.templates is not None and path.is_relative_to(settings.templates.absolute()):
            return True
        return path.suffix in _INPUTS or path.name in _NAMES

    # step: how long it must be quiet, for editors write more than once
    for _ in watchfiles.watch(*roots, *extra, watch_filter=matters, step=50, raise_interrupt=False):
        return True
    return False
