"""Whole systems in pytest: the function behind the fixture `check_system`."""

from __future__ import annotations

from collections.abc import Iterable
from importlib.util import find_spec
from pathlib import Path

from ifgen.command_kit import report
from ifgen.config.settings import settle

from ifgen_tools.system.build import Request, build
from ifgen_tools.system.commands import findings
from ifgen_tools.system.model import System

_WIDTH = 100


def assert_sound(
    *launch_files: str | Path,
    folder: Path,
    packages: Iterable[Path] = (),
    parameter_files: Iterable[Path] = (),
    complete: bool = False,
    ignore: Iterable[str] = (),
    arguments: dict[str, str] | None = None,
) -> System:
    """Fail if anything is wrong with the system that launch files below a folder start, and return it.

    `packages` are in the place of the configured paths, `ignore` names rules of warnings, and `arguments` are
    those of the launch files. Raises AssertionError with all findings, InputError for a launch file that
    cannot be evaluated.
    """
    request = Request(
        launch_files=tuple(folder / file for file in launch_files),
        arguments=arguments or {},
        packages=tuple(packages),
        parameter_files=tuple(parameter_files),
        transport="local" if find_spec("rmw_local") else "auto",
    )
    built = build(request)
    ignored = set(ignore)
    diagnostics = settle(request.packages, None, ()).policy.told(findings(built, complete=complete))
    wrong = [each for each in diagnostics if each.severity == "error" or each.rule not in ignored]
    assert not wrong, "\n" + report.as_plain_text(wrong, _WIDTH)
    return built.system
