"""Errors in the user's templates or filters while they run."""

from __future__ import annotations

import traceback
from pathlib import Path

from ifgen.config.customization import Customization
from ifgen.diagnostics import Diagnostic, InputError
from ifgen.generator_py.templates.places import at_line


def explained(error: Exception, custom: Customization) -> InputError | None:
    """The error in one of the user's templates or filters while it ran; None if it was elsewhere."""
    own = [folder.absolute() for folder in (*custom.folders, custom.filters) if folder is not None]
    places: dict[Path, int] = {}
    for frame in reversed(traceback.extract_tb(error.__traceback__)):
        path = Path(frame.filename)
        if any(path.is_relative_to(folder) for folder in own):
            places.setdefault(path, frame.lineno or 1)
    if not places:
        return None
    (path, line), *callers = places.items()
    said = " ".join(str(error).split())
    label = at_line(path, line, f"{type(error).__name__}: {said}")
    used = tuple(at_line(caller, line, "used here") for caller, line in callers)
    what = "filter" if path == (custom.filters and custom.filters.absolute()) else "template"
    return InputError([Diagnostic("template-error", f"this {what} cannot be used", label, used)])
