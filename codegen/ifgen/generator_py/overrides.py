"""Templates of the user's: which there are, and what is wrong with them as files."""

from __future__ import annotations

import traceback
from collections.abc import Iterator
from difflib import get_close_matches
from pathlib import Path

import jinja2
import jinja2.meta

from ifgen import resources
from ifgen.customization import Customization, Output
from ifgen.diagnostics import Diagnostic, InterfaceError, Label
from ifgen.generator_py.places import at_line


def check_overrides(environment: jinja2.Environment, custom: Customization) -> None:
    """Raise InterfaceError for templates of the user's that do not parse or that nothing uses.

    One is used if it has the name of one of ours, if an output names it, or if another one that is used does.
    """
    ours = set(names(resources.templates()))
    problems: list[Diagnostic] = []
    used = ours | {output.template for output in custom.outputs}
    for folder in custom.folders:
        for name in names(folder):
            try:
                text = (folder / name).read_text(encoding="utf-8")
                tree = environment.parse(text, name, str(folder / name))
            except UnicodeDecodeError:
                problems.append(Diagnostic("template-syntax", f"{folder / name} is not UTF-8"))
            except jinja2.TemplateSyntaxError as error:
                label = at_line(folder / name, error.lineno, str(error.message))
                problems.append(Diagnostic("template-syntax", "this template cannot be used", label))
            else:
                used.update(filter(None, jinja2.meta.find_referenced_templates(tree)))
    unused = (
        (folder / name, name) for folder in custom.folders for name in names(folder) if name not in used
    )
    problems += (_unused(path, name, ours) for path, name in unused)
    known = {*ours, *(name for folder in custom.folders for name in names(folder))}
    problems += (_unknown(output, known) for output in custom.outputs if output.template not in known)
    if problems:
        raise InterfaceError(problems)


def explained(error: Exception, custom: Customization) -> InterfaceError | None:
    """What went wrong in a template or filter of the user's while it was used; None if it was elsewhere."""
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
    return InterfaceError([Diagnostic("template-error", f"this {what} cannot be used", label, used)])


def names(folder: Path) -> Iterator[str]:
    """The templates in a folder, by their paths in it with `/`."""
    for path in sorted(folder.rglob("*")):
        parts = path.relative_to(folder).parts
        if path.is_file() and not any(part.startswith(".") or part == "__pycache__" for part in parts):
            yield "/".join(parts)


def _unused(path: Path, name: str, ours: set[str]) -> Diagnostic:
    close = get_close_matches(name, ours, n=1)
    advice = f"did you mean {close[0]}?" if close else "`ifgen templates list` names those that there are"
    message = f"{path} replaces nothing: ifgen has no template {name}, and nothing of yours uses it"
    return Diagnostic("unused-template", message, help=advice)


def _unknown(output: Output, known: set[str]) -> Diagnostic:
    close = get_close_matches(output.template, known, n=1)
    advice = (
        f"did you mean {close[0]}?" if close else "templates are looked for in `templates` of [tool.ifgen]"
    )
    message = f"output '{output.name}' cannot be made: there is no template {output.template}"
    label = None if output.span is None else Label(output.span)
    return Diagnostic("unknown-template", message, label, help=advice)
