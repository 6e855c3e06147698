"""The work of ifgen, from files to files: read -> parse -> resolve -> plan -> render -> write."""

from __future__ import annotations

from collections.abc import Callable, Generator, Iterable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from functools import partial
from itertools import chain
from pathlib import Path

from ifgen import resources
from ifgen.config.customization import Customization
from ifgen.definition.interfaces import Registry
from ifgen.diagnostics import Diagnostic, UsageError
from ifgen.pipeline import earlier, provision, remarks
from ifgen.pipeline.freshness.comparison import Unchanged
from ifgen.pipeline.freshness.run import unless_fresh
from ifgen.pipeline.values import Condition, Inputs, LeftOut, Made, Progress
from ifgen.reading.packages import find_packages
from ifgen.reading.search_path import SearchPath, WithDeps
from ifgen.writing import transaction, write
from ifgen.writing.write import Drift, OutputPackage, Written

# Late imports: parsers, planners and jinja2, none of which a run needs if nothing has changed.

GENERATOR = f"ifgen {resources.VERSION}"


@dataclass(frozen=True, slots=True)
class Generated:
    """The effects of `generate` on files, and the diagnostics about its input and the user's modules.

    `kept` are files that nothing generates any more, but which were edited since ifgen wrote them. Errors
    among the `diagnostics` are about the user's modules: what was generated is right, but cannot start.
    """

    written: tuple[Path, ...]
    unchanged: tuple[Path, ...]
    removed: tuple[Path, ...]
    kept: tuple[Path, ...]
    diagnostics: tuple[Diagnostic, ...]
    left_out: tuple[LeftOut, ...] = ()


@dataclass(frozen=True, slots=True)
class Drifted:
    """The differences between an output folder and what `generate` would write, and the diagnostics."""

    drifts: tuple[Drift, ...]
    diagnostics: tuple[Diagnostic, ...]
    left_out: tuple[LeftOut, ...] = ()


def generate(  # noqa: PLR0913 - one for each option
    *paths: Path | str,
    output: Path | str,
    include: Sequence[Path | str] = (),
    with_deps: WithDeps = False,
    templates: Path | str | Customization | None = None,
    progress: Progress | None = None,
    condition: Condition | None = None,
    exclude: Sequence[str] = (),
    keep_going: bool = False,
) -> Generated:
    """Write Python packages for the interfaces and nodes at `paths` into the folder `output`.

    A path is a package's folder, a folder of packages, or a single file, which adds to the files that earlier
    runs generated for its package. Dependencies are looked for in `paths`, `include`, AMENT_PREFIX_PATH, the
    interpreter's own share/ and the packages that come with ifgen. With `with_deps` they are written too, or
    with "own" those of them that are in `include`. `templates` is a folder of templates that replace ours, or
    all of the user's additions. What the patterns in `exclude` name is left out, and what needs that.

    Raises InputError with all mistakes, also if the interfaces do not meet the `condition`, and OSError; then
    nothing has been written. If it is to `keep_going`, it leaves out what is wrong and what needs that. The
    mistakes are then among the diagnostics.
    """
    with transaction.locked(Path(output)):
        inputs = _read(
            paths,
            Path(output),
            include,
            with_deps,
            templates,
            condition,
            exclude=exclude,
            keep_going=keep_going,
        )
        return unless_fresh(inputs, partial(_make, progress=progress), _prepared)


def drift(  # noqa: PLR0913 - one for each option
    *paths: Path | str,
    output: Path | str,
    include: Sequence[Path | str] = (),
    with_deps: WithDeps = False,
    templates: Path | str | Customization | None = None,
    progress: Progress | None = None,
    condition: Condition | None = None,
    exclude: Sequence[str] = (),
    keep_going: bool = False,
) -> Drifted:
    """The differences between `output` and the result of `generate`. Writes nothing.

    Everything is rendered, so that neither a cache nor an edited manifest can hide a difference.
    """
    inputs = _read(
        paths, Path(output), include, with_deps, templates, condition, exclude=exclude, keep_going=keep_going
    )
    made = _make(inputs, Unchanged(), progress)
    left: list[Path] = []
    packages, missing = _with_those_that_go(inputs, made, left)
    drifts = write.drift(packages, inputs.output)
    return Drifted(drifts, (*map(remarks.left_behind, sorted(left)), *made.told, *missing), made.left_out)


def check(*paths: Path | str, include: Sequence[Path | str] = ()) -> tuple[Diagnostic, ...]:
    """The diagnostics about the interfaces and nodes at `paths`, and about the packages they need."""
    from ifgen.pipeline.inspection import inspect

    return inspect(*paths, include=include).diagnostics


def load(*paths: Path | str, include: Sequence[Path | str] = ()) -> Registry:
    """Read the interfaces at `paths` and what they need of other packages. Raises InputError."""
    from ifgen.definition.resolve import resolve

    packages = find_packages(paths)
    return resolve(packages, SearchPath(packages, include))


def registries(
    *paths: Path | str,
    output: Path | str,
    include: Sequence[Path | str] = (),
    with_deps: WithDeps = False,
    exclude: Sequence[str] = (),
) -> tuple[Registry, ...]:
    """All interfaces that `generate` would read for these paths, those that nodes need included.

    Writes nothing. Raises InputError with all mistakes.
    """
    from ifgen.pipeline.leaving_out import resolve_what_can_be

    job, _, _ = resolve_what_can_be(_read(paths, Path(output), include, with_deps, None, exclude=exclude))
    return job.registries


def type_hash(type_name: str, *paths: Path | str, include: Sequence[Path | str] = ()) -> str:
    """The type hash (`RIHS01_...`) of a type such as `std_msgs/msg/String`, derived types included.

    It is looked for where `generate` looks for dependencies. Raises InputError.
    """
    from ifgen.definition import type_description
    from ifgen.pipeline import lookup

    described, registry = lookup.find_type(type_name, SearchPath(find_packages(paths), include))
    return type_description.type_hash(described, registry)


def _read(  # noqa: PLR0913 - the options of the functions above
    paths: Sequence[Path | str],
    output: Path,
    include: Sequence[Path | str],
    with_deps: WithDeps,
    templates: Path | str | Customization | None,
    condition: Condition | None = None,
    *,
    exclude: Sequence[str] = (),
    keep_going: bool = False,
) -> Inputs:
    packages = tuple(earlier.with_siblings(package, output) for package in find_packages(paths))
    excluded: tuple[str, ...] = ()
    if exclude:
        from ifgen.pipeline.leaving_out import without_excluded

        packages, excluded = without_excluded(packages, exclude)
    problems = [
        remarks.into_its_source(p) for p in packages if (output / p.name).resolve() == p.root.resolve()
    ]
    if problems:
        raise UsageError(problems)
    if not isinstance(templates, Customization):
        templates = Customization(Path(templates) if templates else None)
    search = SearchPath(packages, include)
    roots = tuple(map(Path, paths))
    return Inputs(roots, packages, search, output, with_deps, templates, condition, excluded, keep_going)


def _make(inputs: Inputs, unchanged: Unchanged, progress: Progress | None) -> Made:
    """Resolve -> plan -> render what is not as it has to be."""
    from ifgen.pipeline.leaving_out import resolve_what_can_be
    from ifgen.pipeline.planning import plan
    from ifgen.pipeline.rendering import render

    job, left_out, mistakes = resolve_what_can_be(inputs)
    if inputs.condition is not None:
        inputs.condition.check(job.registries)
    modules = unchanged.modules(job.registry)
    planned = plan(job, inputs.custom, unchanged.packages, modules, progress)
    packages = render(planned, inputs.custom)
    generated = {target.name for target in job.targets}
    told = (*mistakes, *job.warnings())
    return Made(packages, generated, job.needed, told, unchanged.packages, job, modules, left_out)


@contextmanager
def _prepared(inputs: Inputs, made: Made) -> Generator[Callable[[], Generated]]:
    left: list[Path] = []
    packages, missing = _with_those_that_go(inputs, made, left)
    with write.prepared(packages, inputs.output, GENERATOR) as finish:
        yield lambda: _generated(inputs, made, finish(), (*map(remarks.left_behind, sorted(left)), *missing))


def _generated(inputs: Inputs, made: Made, done: Written, found: Iterable[Diagnostic]) -> Generated:
    output = inputs.output
    skipped = (
        path
        for name, record in made.skipped.items()
        for path in write.files_of(output / name, output, record)
    )
    unchanged = tuple(sorted((*done.unchanged, *skipped)))
    edited = (*map(remarks.edited, done.kept), *remarks.overwritten(done.edited, output))
    diagnostics = (*edited, *made.told, *found)
    return Generated(done.written, unchanged, done.removed, done.kept, diagnostics, made.left_out)


def _with_those_that_go(
    inputs: Inputs, made: Made, left: list[Path]
) -> tuple[Iterator[OutputPackage], tuple[Diagnostic, ...]]:
    """The packages to write and to remove, and what will be missing.

    Each of these packages adds the user's files that nothing uses any more to `left`.
    """
    going = list(earlier.gone(inputs.paths, inputs.packages, made.generated, inputs.output))
    left_out = {
        name for name in (*inputs.excluded, *(each.name for each in made.left_out)) if "/" not in name
    }
    left_out |= {package.name for package in inputs.packages} - {*made.generated, write.ROOT}
    known = {package.name for package in going}
    going += [
        OutputPackage(name, {})
        for name in sorted(left_out - known)
        if earlier.record_of(inputs.output / name) is not None
    ]
    gone = {package.name for package in going}

    def packages() -> Iterator[OutputPackage]:
        for package in chain(going, made.packages):
            left.extend(write.left_behind([package], inputs.output))
            yield package

    return packages(), provision.missing(made.needed, inputs.search, inputs.output, gone)
