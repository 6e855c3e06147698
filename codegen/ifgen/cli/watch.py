"""`ifgen generate --watch`: generates again when an interface, a template or the configuration changes."""

from __future__ import annotations

import contextlib
import logging
import sys
from collections.abc import Callable
from pathlib import Path

import watchfiles

from ifgen.cli.terminal import exit_code_of
from ifgen.config.settings import Settings
from ifgen.diagnostics import shown_path
from ifgen.reading.listed_file import EXTENSIONS
from ifgen.reading.packages import NODE_EXTENSIONS
from ifgen.signals import INTERRUPTED, TERMINATED

_INPUTS = (*EXTENSIONS, ".cmake", *NODE_EXTENSIONS)
_NAMES = {"package.xml", "pyproject.toml", "CMakeLists.txt"}


def watch(settle: Callable[[], Settings], generate: Callable[[Settings], int], *, quiet: bool = False) -> int:
    """Generate now and after every change, until Ctrl-C or SIGTERM; then the exit code is 0.

    Reports mistakes, which a later change may fix. While the configuration is wrong, watches the paths of the
    last valid one. A wrong configuration at the start raises UsageError.
    """
    settings: Settings | None = settle()
    logging.getLogger("watchfiles").setLevel(logging.ERROR)  # it would report Ctrl-C in its own words
    # Ctrl-C may come while it waits, which watchfiles sees, or at any other moment.
    with contextlib.suppress(KeyboardInterrupt):
        while settings is not None:
            settings = _generate_until_settings_change(settings, settle, generate, quiet)
    if not quiet:
        print("\nstopped watching" if sys.stdout.isatty() else "stopped watching")
    return 0


def _generate_until_settings_change(
    settings: Settings, settle: Callable[[], Settings], generate: Callable[[Settings], int], quiet: bool
) -> Settings | None:
    """The settings to go on with, or None after Ctrl-C."""
    paths = [*settings.paths, *settings.include]
    custom = settings.custom
    paths += [path for path in (*custom.folders, custom.filters, settings.file) if path is not None]
    current = [settings]

    def settle_and_generate() -> int:
        current[:] = [settle()]
        return generate(settings) if current == [settings] else 0

    def matters(_: watchfiles.Change, changed: str) -> bool:
        path = Path(changed)
        for own in (*custom.folders, custom.filters):
            if own is not None and path.is_relative_to(own.absolute()):
                return True
        return path.name in _NAMES or path.name.endswith(_INPUTS)

    started = False
    # The first, empty set says that watching has begun: it misses no change after that. `step` is the quiet
    # time before a set is reported, because editors write more than once.
    for changes in watchfiles.watch(
        *paths, watch_filter=matters, step=50, rust_timeout=100, yield_on_timeout=True, raise_interrupt=False
    ):
        if started and not changes:
            continue
        first, started = not started, True
        if settings.file is not None and any(Path(path) == settings.file for _, path in changes):
            return settings  # watch it again, because it may be another file with the same name
        if exit_code_of(settle_and_generate) in {INTERRUPTED, TERMINATED}:
            return None
        if current != [settings]:
            return current[0]
        if first and not quiet:
            watched = ", ".join(dict.fromkeys(shown_path(path) for path in paths))
            print(f"watching {watched}; Ctrl-C ends it", flush=True)
    return None
