"""The settings of a command: options of the command line first, then `[tool.ifgen]`, then defaults."""

from __future__ import annotations

import os
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

from ifgen.config.customization import Customization, Distributions
from ifgen.config.suppressions import Policy
from ifgen.diagnostics import Diagnostic, Label, UsageError
from ifgen.reading.storage import read_limited

# Late imports: the keys of [tool.ifgen], which many commands do without.

if TYPE_CHECKING:
    from ifgen.config.model import Config
    from ifgen.reading.search_path import WithDeps

_FILE = "pyproject.toml"


@dataclass(frozen=True, slots=True)
class Settings:
    """The interfaces, what to do with them, and the configuration for all that no option is about."""

    paths: tuple[Path, ...]
    output: Path
    include: tuple[Path, ...]
    exclude: tuple[str, ...]
    with_deps: WithDeps
    custom: Customization
    policy: Policy
    config: Config

    @property
    def file(self) -> Path | None:
        """The pyproject.toml that was read, if any."""
        return self.config.file

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
        custom = self.custom
        brings_code = custom.filters is not None or bool(custom.folders) or bool(custom.targets)
        if (
            brings_code
            and self.file is not None
            and self.file.parent != Path.cwd()
            and _is_of_others(self.file)
        ):
            message = f"{self.file} belongs to another user, and names templates, filters or generators: code"
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
    config = _config(isolated)
    partial = bool(paths and config.paths)
    if not paths:
        _check_existence(config, "paths", config.paths)
    _check_existence(config, "include", config.include)
    _check_existence(config, "templates", (config.templates,))
    _check_existence(config, "filters", (config.filters,))
    for name, target in config.generate.items():
        _check_existence(config, "templates", (target.templates,), "generate", name)
    policy = Policy(
        rules=config.ignore,
        per_file=config.per_file_ignores,
        base=config.file.parent if config.file else Path(),
        strict=config.strict if strict is None else strict,
    )
    return Settings(
        paths=tuple(paths or config.paths),
        output=output or config.output,
        include=(*(include or ()), *config.include),
        exclude=(*exclude, *(() if partial else config.exclude)),
        with_deps=config.with_deps if with_deps is None else with_deps,
        custom=_customization(config, templates, tests, partial),
        policy=policy,
        config=config,
    )


def _customization(
    config: Config, templates: Path | None, tests: bool | None, partial: bool
) -> Customization:
    """The changes of users to what is generated, each with its place in the file."""
    distributions = config.distributions
    return Customization(
        templates=templates or config.templates,
        filters=config.filters,
        outputs=tuple(
            replace(
                output,
                span=config.place("outputs", name),
                spans={key: config.place("outputs", name, key) for key in ("template", "path", "only")},
            )
            for name, output in config.outputs.items()
        ),
        partial=partial,
        tests=config.tests if tests is None else tests,
        behind=config.templates if templates is not None else None,
        distributions=None
        if distributions is None
        else Distributions(distributions, config.place("distributions")),
        requirements=config.requirements,
        ros_distro=config.ros_distro or os.environ.get("ROS_DISTRO"),
        targets=tuple(
            replace(target, span=config.place("generate", name)) for name, target in config.generate.items()
        ),
        python=config.python,
    )


def configured_paths() -> tuple[Path, ...]:
    """The paths in the configuration that holds here, whether they exist or not."""
    return _config(False).paths


def _config(isolated: bool) -> Config:
    """The configuration in the nearest pyproject.toml upwards that has one; else the defaults."""
    from ifgen.config.model import Config, read_config

    here = Path.cwd()
    for path in (folder / _FILE for folder in (() if isolated else (here, *here.parents))):
        data = _contents(path) if path.is_file() else b""
        if b"ifgen" in data and (found := read_config(path, data)) is not None:
            return found
    return Config()


def _check_existence(config: Config, key: str, paths: Iterable[Path | None], *table: str) -> None:
    """Raise UsageError for the paths of a key that do not exist; it may be in a table of [tool.ifgen]."""
    if missing := [path for path in paths if path is not None and not path.exists()]:
        label = Label(config.place(*table, key))
        advice = "`ifgen new interface demo_msgs/msg/Name` makes it" if key == "paths" else None
        message = f"'{key}' in [{'.'.join(('tool', 'ifgen', *table))}] names {{}}, which does not exist"
        raise UsageError(
            Diagnostic("configuration", message.format(path), label, help=advice) for path in missing
        )


def _is_of_others(path: Path) -> bool:
    """Whether somebody put it there who is neither the user nor the system's owner."""
    return hasattr(os, "getuid") and path.stat().st_uid not in {0, os.getuid()}


def _contents(path: Path) -> bytes:
    try:
        return read_limited(path)
    except OSError:
        return b"ifgen may be in there"  # `read_config` says what is wrong
