"""The list of interfaces of a package: in CMakeLists.txt, or in the ament index after installation.

rosidl generates only the files that are passed to `rosidl_generate_interfaces`. The extension determines the
kind of a file, not its folder: `srvs/Pause.srv` is the type `srv/Pause`.
"""

from __future__ import annotations

import os
import re
from collections.abc import Sequence, Set
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Final

from ifgen.diagnostics import Diagnostic, Label, Source, Span
from ifgen.reading import storage
from ifgen.reading.listed_file import EXTENSIONS, GENERATE, ListedFile

if TYPE_CHECKING:
    from ifgen.reading.cmake.interpreter import Followed
    from ifgen.reading.cmake.values import Doubt

# Late imports: to follow a list is worth its imports only where there is one.

FILE: Final = "CMakeLists.txt"

INDEX: Final = Path("ament_index", "resource_index", "rosidl_interfaces")
"""The folder, in `share`, with the lists of installed packages by name."""

PARTS: Final = ("Request", "Response", "Event", "Goal", "Result", "Feedback")
"""The suffixes that ROS adds to the name of a service or an action to name its parts."""

_CALL: Final = re.compile(rf"^[^#\n]*?\b(?P<name>{GENERATE})\s*\(", re.MULTILINE | re.IGNORECASE)
_FOLLOWED: Final = ("include", "add_subdirectory")
_SHOWN: Final = 5


@dataclass(frozen=True, slots=True)
class InterfaceList:
    """The interface files that a package names, each once, and the diagnostics about the list.

    `span` is the place where the package names them. `dependencies` are the packages that it names with them;
    None if that is unknown. `is_whole` is true if there are no others, as far as is known.
    """

    paths: tuple[Path, ...]
    diagnostics: tuple[Diagnostic, ...] = ()
    span: Span | None = None
    dependencies: tuple[str, ...] | None = None
    checks_group: bool = False
    is_whole: bool = True

    @property
    def is_wrong(self) -> bool:
        """Whether something is wrong with it."""
        return any(diagnostic.severity == "error" for diagnostic in self.diagnostics)


def of_installed(root: Path, index: str) -> InterfaceList:
    """The list of an installed package, whose folder is in `share`, in its text in the ament index."""
    paths = [root / line for line in index.splitlines() if line.endswith(EXTENSIONS)]
    whole = {(path.suffix[1:], path.stem) for path in paths}
    return InterfaceList(
        tuple(path for path in paths if storage.is_file(path) and not _is_made_of(path, whole))
    )


def _is_made_of(path: Path, whole: Set[tuple[str, str]]) -> bool:
    """True for a file that ROS generated from an installed one: an .idl file, or a part of a service."""
    if path.suffix == ".idl":
        return (path.parent.name, path.stem) in whole
    name, _, part = path.stem.rpartition("_")
    is_part = path.suffix == ".msg" and path.parent.name != "msg" and part in PARTS
    return is_part and not whole.isdisjoint({("srv", name), ("action", name)})


def of_source(
    root: Path, source: Source, lies_there: Sequence[Path], shares: Sequence[Path]
) -> InterfaceList | None:
    """The list in the CMakeLists.txt of a package; None if there is none in it.

    `lies_there` are the interface files in the package's folders, `shares` where packages are installed.
    """
    lower = source.text.lower()
    if GENERATE not in lower and not (lies_there and any(word in lower for word in _FOLLOWED)):
        return _never_called(source, lies_there)
    from ifgen.reading.cmake.interpreter import follow

    followed = follow(source, root.absolute(), shares)
    if followed.calls:
        return _listed(root, followed, lies_there)
    if followed.unsure is not None:
        return _unclear(lies_there, followed.unsure)
    return _never_called(source, lies_there)


def _listed(root: Path, followed: Followed, lies_there: Sequence[Path]) -> InterfaceList:
    from ifgen.reading.cmake.values import Doubt, worse

    absolute = root.absolute()
    entries = [ListedFile(root, absolute, call, text) for call in followed.calls for text in call.files]
    found = [problem for entry in entries if (problem := entry.problem(followed.sources)) is not None]
    paths = {_plain(entry.path): entry.path for entry in entries if entry.is_usable}
    doubt = worse(*(call.doubt for call in followed.calls), followed.unsure)
    if any(entry.depends_on_build for entry in entries):
        doubt = worse(
            Doubt("a generator expression has no value yet", followed.calls[0].span, lost=True), doubt
        )
    if not entries and doubt is None:
        doubt = Doubt("no file is passed to it, which rosidl refuses", followed.calls[0].span, lost=True)
    left_out = [path for path in lies_there if _plain(path) not in paths]
    if doubt is not None and doubt.lost:
        paths |= {_plain(path): path for path in left_out}
        left_out = []
    if doubt is not None:
        found.append(_doubtful(doubt, len(paths)))
    if left_out:
        found.append(_left_out(root, left_out, followed.calls[0].span))
    known = all(call.dependencies_are_known for call in followed.calls)
    return InterfaceList(
        tuple(paths.values()),
        tuple(found),
        followed.calls[0].span,
        tuple(dict.fromkeys(name for call in followed.calls for name in call.dependencies))
        if known
        else None,
        any(call.checks_group for call in followed.calls),
        doubt is None or not doubt.lost,
    )


def _plain(path: Path) -> str:
    """A path for comparison: without `..`, but with its links."""
    return os.path.normpath(path)


def _doubtful(doubt: Doubt, count: int) -> Diagnostic:
    taken = "ifgen takes the one file" if count == 1 else f"ifgen takes the {count} files"
    if doubt.lost:
        message, taken = (
            "the list of interfaces is unknown",
            f"{taken} named there and in msg, srv and action",
        )
    else:
        message, taken = "the list of interfaces is uncertain", f"{taken} of the usual case"
    advice = f"{taken}. To have exactly the right files, name them in {GENERATE} itself"
    return Diagnostic(
        "unclear-list", f"{message}: {doubt.reason}", Label(doubt.span), help=advice, severity="warning"
    )


def _unclear(lies_there: Sequence[Path], doubt: Doubt) -> InterfaceList:
    """A list whose contents are unknown."""
    doubt = replace(doubt, lost=True)
    return InterfaceList(tuple(lies_there), (_doubtful(doubt, len(lies_there)),), is_whole=False)


def _left_out(root: Path, paths: Sequence[Path], span: Span) -> Diagnostic:
    return Diagnostic(
        "unlisted-interface",
        f"{_names(root, paths)} not passed to {GENERATE}, and left out",
        Label(span),
        help="add what is missing, or delete what is not used; a file that is named on the command line "
        "is generated all the same",
        severity="warning",
    )


def asked_for_all_the_same(
    root: Path, paths: Sequence[Path], listed: InterfaceList
) -> tuple[Diagnostic, ...]:
    """The diagnostics about files that were asked for by name, but are not in the list of their package."""
    if not paths or not listed.is_whole or listed.span is None:
        return ()
    message = f"{_names(root, paths)} not passed to {GENERATE}: colcon does not build it"
    advice = "add it to the list"
    return (Diagnostic("unlisted-interface", message, Label(listed.span), help=advice, severity="warning"),)


def _names(root: Path, paths: Sequence[Path]) -> str:
    names = [os.path.relpath(path, root) for path in paths[:_SHOWN]]
    more = f" and {len(paths) - _SHOWN} more" if len(paths) > _SHOWN else ""
    return f"{', '.join(names)}{more} {'is' if len(paths) == 1 else 'are'}"


def _never_called(source: Source, lies_there: Sequence[Path]) -> InterfaceList | None:
    """A package that generates nothing by CMake: all that lies there, with a warning if that is something."""
    if not lies_there:
        return None
    taken = "ifgen takes all files in msg, srv and action"
    if (call := _CALL.search(source.text)) is not None:
        message = f"{FILE} does not reach {GENERATE} by default: colcon builds no interfaces of this package"
        label = Label(Span(source, call.start("name"), call.end("name")), "not reached")
        advice = f"{taken}. If colcon should build them, look at the conditions before the call"
    else:
        message = f"{FILE} never calls {GENERATE}: colcon builds no interfaces of this package"
        label = Label(Span(source, 0, 0))
        advice = f"{taken}. Call {GENERATE}(${{PROJECT_NAME}} FILES...)"
    warning = Diagnostic("no-interface-list", message, label, help=advice, severity="warning")
    return InterfaceList(tuple(lies_there), (warning,), is_whole=False)
