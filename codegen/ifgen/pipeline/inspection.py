"""Looks for everything that is wrong with packages, their interfaces and their nodes, and writes nothing."""

from __future__ import annotations

from collections import deque
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from ifgen.config.customization import Customization
from ifgen.config.suppressions import judged
from ifgen.diagnostics import Diagnostic, InputError, any_errors
from ifgen.reading.packages import find_packages
from ifgen.reading.search_path import SearchPath

if TYPE_CHECKING:
    from ifgen.nodl.model import Nodes
    from ifgen.reading.packages import PackageFiles

# Late imports: a run that inspects interfaces needs no YAML, and one that inspects templates more.


@dataclass(frozen=True, slots=True)
class Findings:
    """All diagnostics, errors first, and the number of files checked."""

    diagnostics: tuple[Diagnostic, ...]
    packages: int = 0
    interfaces: int = 0
    nodes: int = 0


def split_parameter_files(paths: Sequence[Path]) -> tuple[tuple[Path, ...], tuple[Path, ...]]:
    """The paths of packages and definitions, and those of parameter files."""
    if not any(path.suffix in {".yaml", ".yml"} for path in paths):
        return tuple(paths), ()
    from ifgen.nodl.parameter_files import is_parameter_file

    files = tuple(path for path in paths if is_parameter_file(path))
    return tuple(path for path in paths if path not in files), files


def inspect(
    *paths: Path | str,
    include: Sequence[Path | str] = (),
    output: Path | None = None,
    ros_distro: str | None = None,
    exclude: Sequence[str] = (),
    parameter_files: Sequence[Path] = (),
) -> Findings:
    """The diagnostics about the interfaces and nodes at `paths`, and about what they need of other packages.

    In `output`, if it is given, the user's modules of the nodes are looked at too. What a `ros_distro` of
    ROS 2 refuses is an error. Of `parameter_files`, what the nodes do not declare so is one.
    """
    from ifgen.definition.problems import one_for_each_cause

    excluded: tuple[str, ...] = ()
    try:
        packages = find_packages(paths)
        if exclude:
            from ifgen.pipeline.resolution import without_excluded

            packages, excluded = without_excluded(packages, exclude)
        search = SearchPath(packages, include)
    except InputError as error:
        return Findings(error.diagnostics)
    found, loaded = findings_of(packages, search, output)
    has_nodes = any(package.nodes for package in packages)
    if parameter_files and not (has_nodes and loaded is None):
        from ifgen.nodl.parameter_files import check

        described = [node for package in (loaded.packages if loaded else ()) for node in package.nodes]
        found += check(parameter_files, described)
    if excluded:
        from ifgen.pipeline.resolution import about_the_rest

        found = about_the_rest(found, packages, excluded)
    # A node's package has its interfaces looked at twice.
    by_severity = sorted(
        one_for_each_cause(dict.fromkeys(judged(found, ros_distro))),
        key=lambda diagnostic: diagnostic.severity != "error",
    )
    interfaces = sum(len(package.files) for package in packages)
    nodes = sum(len(package.nodes) for package in loaded.packages) if loaded else 0
    return Findings(tuple(by_severity), len(packages), interfaces, nodes)


def findings_of(
    packages: Sequence[PackageFiles], search: SearchPath, output: Path | None
) -> tuple[list[Diagnostic], Nodes | None]:
    """The diagnostics about packages and their nodes, and the nodes if there are any and they can be read.

    In `output`, if it is given, the user's modules of the nodes are looked at too.
    """
    from ifgen.definition.resolve import resolve

    found: list[Diagnostic] = []
    try:
        found += resolve((package for package in packages if package.has_interfaces), search).warnings
    except InputError as error:
        found += error.diagnostics
    if not any(package.nodes for package in packages):
        return found, None
    from ifgen.nodl.load import load  # with a YAML parser, which interfaces do without

    try:
        loaded = load(packages, search)
    except InputError as error:
        return [*found, *error.diagnostics], None
    found += loaded.warnings
    if output is not None:
        try:
            found += _of_users_modules(loaded, output)
        except InputError as error:
            found += error.diagnostics
    return found, loaded


def inspect_templates(
    custom: Customization, paths: Sequence[Path], include: Sequence[Path], output: Path
) -> list[Diagnostic]:
    """The mistakes in the user's templates, filters and outputs. Nothing is written.

    If the check finds no error, everything is rendered for the packages at `paths`. Packages with their own
    mistakes, which `inspect` reports, are left out.
    """
    from ifgen.generator_py.outputs.plan import mistakes
    from ifgen.generator_py.templates.render import look_for_problems
    from ifgen.pipeline.cache.fresh import UpToDate
    from ifgen.pipeline.planning import plan, render
    from ifgen.pipeline.resolution import resolve
    from ifgen.pipeline.values import Request

    found = [*look_for_problems(custom), *mistakes(custom.outputs)]
    if any_errors(found) or not paths:
        return found
    try:
        packages = find_packages(paths)
        request = Request(tuple(paths), packages, SearchPath(packages, include), output, {}, custom=custom)
        resolved = resolve(request)
    except InputError:
        return found
    try:
        deque(render(plan(request, resolved, UpToDate()), custom), maxlen=0)
    except InputError as error:
        found += error.diagnostics
    return found


def _of_users_modules(nodes: Nodes, output: Path) -> Iterator[Diagnostic]:
    from ifgen.pipeline.user_code import compare

    for package in nodes.packages:
        yield from compare(package, output / package.name / package.name)
