"""Parameter files whose texts have substitutions."""

from __future__ import annotations

from pathlib import Path

from launch.launch_context import LaunchContext


def filled(path: str, context: LaunchContext) -> str:
    """Return the text of a file with its substitutions performed. Raises RuntimeError."""
    try:
        text = Path(path).read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError) as error:
        raise RuntimeError(f"cannot read the parameter file '{path}': {error}") from None
    return context.host.fill(text, path)
