"""From `[tool.ifgen.outputs]` to files: which there are, at which paths, and what is wrong with them."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from fnmatch import fnmatchcase
from pathlib import PurePosixPath, PureWindowsPath
from string import Formatter
from typing import Final

from ifgen.config.customization import Output
from ifgen.definition.names import snake_case
from ifgen.diagnostics import Diagnostic, InputError, did_you_mean
from ifgen.generator_py.artifact import Artifact
from ifgen.model import Package
from ifgen.reading import manifest

FIELDS: Final = {
    "package": ("package", "import_folder"),
    "interface": ("package", "import_folder", "folder", "interface"),
    "node": ("package", "import_folder", "node"),
    "run": (),
}
"""The fields of a path pattern, by the `per` of its output."""

_SNAKE: Final = "snake"


@dataclass(frozen=True, slots=True)
class PlannedOutput:
    """A file of an output; its artifact's path is inside the output folder.

    `package` is the package that it comes and goes with, None for what is made once in a run.
    """

    output: Output
    package: str | None
    artifact: Artifact


def mistakes(outputs: Iterable[Output]) -> list[Diagnostic]:
    """The mistakes in outputs, whatever the packages are."""
    return [problem for output in outputs if (problem := _wrong_pattern(output)) is not None]


def plan_outputs(
    outputs: Sequence[Output],
    packages: Sequence[Package],
    import_folders: Mapping[str, str],
    variables: Mapping[str, object],
    *,
    partial: bool = False,
    own_folder: bool = False,
) -> tuple[PlannedOutput, ...]:
    """The files that outputs are for these packages.

    `import_folders` maps packages to the folders that Python imports, where these are not called as they are.
    All get these `variables`, besides their own. In a `partial` run outputs may match nothing, and those of
    runs are left out. Those of a generator have their `own_folder`, and may match nothing, too. Raises
    InputError for patterns that are wrong, match nothing, or give two files one path.
    """
    planned: list[PlannedOutput] = []
    problems: list[Diagnostic] = []
    for output in outputs:
        if partial and output.per == "run":
            continue
        problem = _wrong_pattern(output)
        if problem is not None:
            problems.append(problem)
            continue
        picked = [view for package in packages if (view := _picked(package, output.only)) is not None]
        files = list(_files(output, picked, import_folders, variables))
        planned += files
        if not partial and not own_folder:
            problems += _idle_patterns(output, packages)
            if not files:
                problems.append(_matches_nothing(output))
        others = () if own_folder else packages
        problems += filter(None, (_wrong_path(file, others) for file in files))
    problems += _collisions(planned)
    if problems:
        raise InputError(problems)
    return tuple(planned)


def _files(
    output: Output,
    packages: Sequence[Package],
    import_folders: Mapping[str, str],
    common: Mapping[str, object],
) -> Iterator[PlannedOutput]:
    if output.per == "run":
        if packages:
            yield _planned(output, None, {}, {**common, "packages": tuple(packages)})
        return
    for package in packages:
        fields = {"package": package.name, "import_folder": import_folders.get(package.name, package.name)}
        match output.per:
            case "package":
                yield _planned(output, package.name, fields, {**common, "package": package})
            case "interface":
                for interface in package.interfaces:
                    named = {**fields, "folder": interface.folder, "interface": interface.name}
                    variables = {**common, "interface": interface, "package": package}
                    yield _planned(output, package.name, named, variables)
            case "node":
                for node in package.nodes:
                    named = {**fields, "node": node.name}
                    yield _planned(output, package.name, named, {**common, "node": node, "package": package})


def _planned(
    output: Output, package: str | None, fields: Mapping[str, str], variables: Mapping[str, object]
) -> PlannedOutput:
    path = "".join(
        text + ("" if field is None else snake_case(fields[field]) if form else fields[field])
        for text, field, form, _ in Formatter().parse(output.path)
    )
    return PlannedOutput(output, package, Artifact(path, output.template, variables, is_output=True))


def _picked(package: Package, only: Sequence[str]) -> Package | None:
    """A package with what the patterns pick of it; None if that is nothing."""
    if not only or any(fnmatchcase(package.name, pattern) for pattern in only):
        return package
    interfaces = tuple(i for i in package.interfaces if _matches(i.type_name, only))
    nodes = tuple(n for n in package.nodes if _matches(f"{n.package}/nodl/{n.name}", only))
    return replace(package, interfaces=interfaces, nodes=nodes) if interfaces or nodes else None


def _matches(name: str, patterns: Iterable[str]) -> bool:
    return any(fnmatchcase(name, pattern) for pattern in patterns)


def _wrong_pattern(output: Output) -> Diagnostic | None:
    known = FIELDS[output.per]
    try:
        fields = [(field, form, way) for _, field, form, way in Formatter().parse(output.path)]
    except ValueError as error:
        return _problem(output, f"its path '{output.path}' is not a pattern: {str(error).lower()}")
    path = PurePosixPath(output.path)  # no field can lead out of its folder
    if path.is_absolute() or PureWindowsPath(output.path).drive or ".." in path.parts:
        problem = f"its path '{output.path}' is outside the output folder"
        return _problem(output, problem, rule="outside-output")
    for field, form, way in fields:
        if field is None:
            continue
        if field not in known:
            listed = ", ".join(f"{{{name}}}" for name in known) or "no fields"
            return _problem(
                output,
                f"its path has an unknown field {{{field}}}",
                did_you_mean(field, known, form="{{{}}}") or f"an output per {output.per} has {listed}",
            )
        if way or form not in {"", _SNAKE}:
            return _problem(
                output, f"its path has an unknown form of {{{field}}}", f"{{{field}:snake}} is one"
            )
    return None


def _wrong_path(planned: PlannedOutput, packages: Sequence[Package]) -> Diagnostic | None:
    text = planned.artifact.path
    path = PurePosixPath(text)
    if not path.name or text.endswith("/") or str(path) != text or "\\" in text or not text.isprintable():
        return _problem(planned.output, f"its path '{text}' is not the plain path of a file")
    if path.name == manifest.NAME:
        return _problem(planned.output, f"its path '{text}' is that of ifgen's own list of files")
    if path.parts[0] != planned.package and path.parts[0] in {package.name for package in packages}:
        message = f"its path '{text}' is in the folder of another package, {path.parts[0]}"
        return _problem(planned.output, message)
    return None


def _collisions(planned: Sequence[PlannedOutput]) -> Iterator[Diagnostic]:
    first: dict[str, PlannedOutput] = {}
    told: set[tuple[str, str]] = set()
    for file in planned:
        path = file.artifact.path.casefold()  # one file on some disks
        other = first.setdefault(path, file)
        names = (other.output.name, file.output.name)
        if other is not file and names not in told:
            told.add(names)
            who = "two of its files" if names[0] == names[1] else f"files of it and of output '{names[0]}'"
            advice = "put a field such as {package} or {interface:snake} into the path"
            yield _problem(
                file.output, f"{who} have the path '{file.artifact.path}'", advice, rule="same-path"
            )


def _idle_patterns(output: Output, packages: Sequence[Package]) -> Iterator[Diagnostic]:
    for pattern in output.only:
        if not any(_picked(package, (pattern,)) for package in packages):
            known = sorted({package.name for package in packages})
            advice = did_you_mean(pattern.partition("/")[0], known, form="{}") or None
            yield _problem(output, f"'{pattern}' matches nothing", advice, rule="unused-output", key="only")


def _matches_nothing(output: Output) -> Diagnostic:
    what = "package" if output.per == "run" else output.per
    picked = " that `only` matches" if output.only else ""
    return _problem(
        output, f"it matches nothing: there is no {what}{picked}", rule="unused-output", key="only"
    )


def _problem(
    output: Output, text: str, help_: str | None = None, *, rule: str = "output-path", key: str = "path"
) -> Diagnostic:
    return Diagnostic(rule, f"output '{output.name}' cannot be made: {text}", output.label(key), help=help_)
