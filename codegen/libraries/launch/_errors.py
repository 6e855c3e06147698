"""Errors in launch files: one line with the file, the line, and what is wrong."""

from __future__ import annotations

import traceback
from pathlib import Path

Place = tuple[str, int]
"""A file, and a line counted from 1."""

_OURS = ("launch", "launch_ros", "launch_xml", "launch_yaml", "ifgen_tools")
_LIBRARIES = Path(__file__).parents[1]


_AS_TEXT = {
    ".py": "ParameterValue(..., value_type=str) passes",
    ".xml": '`type="str"` in the `param` passes',
    ".launch": '`type="str"` in the `param` passes',
    ".yaml": "`type: str` in the `param` passes",
    ".yml": "`type: str` in the `param` passes",
}
"""The form that passes a text as it is, as launch_ros says it of Python, by the kind of launch file."""


class LaunchError(Exception):
    """A mistake in a launch file; `place` is None where no file can be blamed."""

    def __init__(self, message: str, place: Place | None = None, help: str = "") -> None:
        where = f"{_shown(place[0])}:{place[1]}: " if place else ""
        self.message = f"{where}{message}"
        self.help = help
        self.place = place
        super().__init__(self.message)


def _shown(name: str) -> str:
    """A path as people write it: without the working directory."""
    path, here = Path(name), Path.cwd()
    return str(path.relative_to(here)) if path.is_relative_to(here) else name


def explained(error: Exception, place: Place | None = None) -> LaunchError:
    """Return an exception of a description as an error with its place.

    The place is the last line of the user's in the traceback, else the given one: that of the entity.
    """
    if isinstance(error, LaunchError):
        return error if error.place is not None else LaunchError(error.message, place, error.help)
    if isinstance(error, SyntaxError):
        place = (error.filename, error.lineno) if error.filename and error.lineno else place
        return LaunchError(error.msg, place)
    own = _last_of_user(error)
    text = (str(error.args[0]) if isinstance(error, KeyError) and error.args else str(error)) or type(
        error
    ).__name__
    if isinstance(error, ImportError | AttributeError) and (refused := _refused(error)):
        return LaunchError(refused[0], own or place, refused[1])
    known = isinstance(error, RuntimeError | TypeError | ValueError | ImportError | NotImplementedError)
    place = own or place
    return LaunchError(_advised(text, place) if known else f"{type(error).__name__}: {text}", place)


def _advised(text: str, place: Place | None) -> str:
    """A text whose advice is for a launch file in Python, with that for the kind of file that it is about."""
    suffix = Path(place[0]).suffix if place else ".py"
    advice = _AS_TEXT.get(suffix)
    return text if advice is None else text.replace(_AS_TEXT[".py"], advice)


def _refused(error: ImportError | AttributeError) -> tuple[str, str] | None:
    """The message and the advice about a name that our packages do not have."""
    name = error.name or ""
    text = str(error)
    source = str(getattr(error.obj, "__name__", "")) if isinstance(error, AttributeError) else ""
    if isinstance(error, ImportError) and not isinstance(error, ModuleNotFoundError):
        source, _, name = (error.name or ""), None, text.partition("name '")[2].partition("'")[0]
    top = (source or name).partition(".")[0]
    if top not in _OURS:
        return None
    whole = f"{source}.{name}" if source else name
    if "`ifgen launch FILE`" in text:
        return text, ""
    return f"`ifgen launch` has no {whole}", "docs/launch.md lists what it runs; a ROS has all of launch"


def _last_of_user(error: BaseException) -> Place | None:
    for frame in reversed(traceback.extract_tb(error.__traceback__)):
        path = Path(frame.filename)
        ours = any(part in _OURS for part in path.parts[-4:]) and (
            "libraries" in path.parts or "ifgen_tools" in path.parts
        )
        standard = frame.filename.startswith("<") or Path(traceback.__file__).parent in path.parents
        installed = "site-packages" in path.parts or _LIBRARIES in path.parents
        if not (ours or standard or installed) and frame.lineno:
            return frame.filename, frame.lineno
    return None
