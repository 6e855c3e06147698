"""Advice for a test that imports something from a transport when none is set."""

from __future__ import annotations

import os
from collections.abc import Iterator

_WAY = """run `pytest --transport local` (or rclpy, auto, both),
or write `transport = "local"` under [tool.pytest.ini_options]"""


def hint(error: BaseException | None) -> str | None:
    """Advice for a missing module that is in the project's output folder, or comes with ifgen."""
    for name in _missing(error):
        # Imported here: most test runs have nothing to do with ROS.
        from ifgen import resources
        from ifgen.config.settings import settle
        from ifgen.diagnostics import UsageError

        try:
            output = settle().output
        except UsageError:
            continue
        if (output / name).is_dir():
            return f"'{name}' is in {os.path.relpath(output)}: {_WAY}"
        folders = (resources.underlay(), resources.bundled_generated(), resources.libraries())
        if any((folder / name).is_dir() for folder in folders):
            return f"'{name}' comes with ifgen: {_WAY}"
    return None


def _missing(error: BaseException | None) -> Iterator[str]:
    while error is not None:
        if isinstance(error, ModuleNotFoundError) and error.name:
            yield error.name.partition(".")[0]
        error = error.__cause__ or error.__context__
