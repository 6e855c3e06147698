"""`ifgen generate --watch`: generates again when an interface, a template or the configuration changes."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import watchfiles
from watchfiles import Change

from ifgen.settings import Settings
from ifgen.terminal import exit_code_of

_INPUTS = {".msg", ".srv", ".action"}
_NAMES = {"package.xml", "pyproject.toml"}


def watch(settle: Callable[[], Settings], generate: Callable[[Settings], int]) -> int:
    """Generate now and after every change, until Ctrl-C; then the exit code is 0.

    Failures are reported, and mended by the next change. While the configuration is wrong, the last good one
    tells what to look at; without one there is nothing to watch.
    """
    settings: list[Settings] = []

    def generate_once() -> int:
        settings[:] = [settle()]
        return generate(settings[0])

    while True:
        code = exit_code_of(generate_once)
        if not settings:
            return code
        if not _changed(settings[0]):
            return 0


def _changed(settings: Settings) -> bool:
    """Wait for a change; False after Ctrl-C."""
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
