"""The settings of a command: options of the command line first, then `[tool.ifgen]`, then defaults."""

from __future__ import annotations

import os
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING

from ifgen.config.customization import Customization
from ifgen.config.silence import Policy
from ifgen.diagnostics import Diagnostic, UsageError
from ifgen.reading.storage import read_limited

if TYPE_CHECKING:
    from ifgen.config.kept import Configuration
    from ifgen.reading.search_path import WithDeps

_FILE = "pyproject.toml"


@dataclass(frozen=True, slots=True)
class Settings:
    """The interfaces, what to do with them, and the pyproject.toml that was read, if any."""

    paths: tuple[Path, ...]
    output: Path
    include: tuple[Path, ...]
    with_deps: WithDeps
    custom: Customization
    file: Path | None
    policy: Policy = field(default_factory=Policy)
    breaking: str = "source"
    adapters: Path = Path("adapters")
    exclude: tuple[str, ...] = ()

    def with_paths(self) -> Settings:
        """The same settings, for a command that needs paths. Raises UsageError if there are none."""
        if not self.paths:
            message = "there is nothing to work on: no PATH, and no paths in [tool.ifgen]"
            if self.file is None:
                message = (
                    f"there is nothing to work on: no PATH, and no {_FILE} with [tool.ifgen] here or above"
                )
            advice = "name a folder with interface packages, such as `ifgen generate interfaces`"
            raise UsageError([Diagnostic("no-path", message, help=advice)])
        return self

    def trusted(self) -> Settings:
        """The same settings, for a command that runs templates and filters.

        Raises UsageError if another user configured them. In a folder such as /tmp, anybody can put a
        pyproject.toml above the folders of others.
        """
        brings_code = self.custom.filters is not None or bool(self.custom.folders)
        if (
            brings_code
            and self.file is not None
            and self.file.parent != Path.cwd()
            and _is_of_others(self.file)
        ):
            message = f"{self.file} belongs to another user, and names templates or filters, which are code"
            advice = f"if you trust it, change to {self.file.parent}; else see `ifgen generate --isolated`"
            raise UsageError([Diagnostic("configuration", message, help=advice)])
        return self


def settle(  # noqa: PLR0913 - one for each option
    paths: Sequence[Path] | None = None,
    output: Path | None = None,
    include: Sequence[Path] | None = None,
    with_deps: WithDeps | None = None,
    templates: Path | None = None,
    tests: bool | None = None,
    strict: bool | None = None,
    *,
    isolated: bool = False,
    exclude: Sequence[str] = (),
) -> Settings:
    """Combine the options given (those that are not None or empty) with the configuration that holds here.

    With `isolated` there is none. Raises UsageError if that is wrong, or names what does not exist.
    """
    found = None if isolated else _find(Path.cwd())
    sourced = os.environ.get("ROS_DISTRO")
    custom = Customization(templates, tests=tests is not False, ros_distro=sourced)
    policy = Policy(strict=bool(strict))
    if found is not None:
        partial = bool(paths and found.paths)
        paths = paths or found.existing("paths", found.paths)
        include = (*(include or ()), *found.existing("include", found.include))
        exclude = (*exclude, *(() if partial else found.exclude))
        output = output or found.output
        with_deps = found.with_deps if with_deps is None else with_deps
        configured = found.existing("templates", (found.templates,)) if found.templates is not None else ()
        if found.filters is not None:
            found.existing("filters", (found.filters,))
        tests = found.tests if tests is None else tests
        behind = configured[0] if configured and templates is not None else None
        templates = templates or next(iter(configured), None)
        custom = Customization(
            templates,
            found.filters,
            found.outputs(),
            partial,
            tests,
            behind,
            found.distributions(),
            found.requirements,
            found.ros_distro or sourced,
        )
        strict = found.strict if strict is None else strict
        policy = Policy(found.ignore, found.per_file_ignores, found.file.parent, strict)
    return Settings(
        tuple(paths or ()),
        output or Path("generated"),
        tuple(include or ()),
        with_deps or False,
        custom,
        None if found is None else found.file,
        policy,
        "source" if found is None else found.breaking,
        Path("adapters") if found is None else found.adapters,
        tuple(exclude),
    )


def configured_paths() -> tuple[Path, ...]:
    """The paths in the configuration that holds here, whether they exist or not."""
    found = _find(Path.cwd())
    return found.paths if found is not None else ()


def _find(start: Path) -> Configuration | None:
    """The contents of the nearest pyproject.toml upwards that has a `[tool.ifgen]` table."""
    for folder in (start, *start.parents):
        path = folder / _FILE
        if path.is_file() and b"ifgen" in (data := _contents(path)):
            from ifgen.config import kept  # not needed if the file never mentions ifgen

            if (found := kept.read(path, data)) is not None:
                return found
    return None


def _is_of_others(path: Path) -> bool:
    """Whether somebody put it there who is neither the user nor the system's owner."""
    return hasattr(os, "getuid") and path.stat().st_uid not in {0, os.getuid()}


def _contents(path: Path) -> bytes:
    try:
        return read_limited(path)
    except OSError:
        return b"ifgen may be in there"  # config.read says what is wrong
