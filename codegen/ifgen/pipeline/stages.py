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
from ifgen.pipeline import previous_output
from ifgen.pipeline.cache.fresh import UpToDate, unless_up_to_date
from ifgen.pipeline.values import BuildResult, Condition, LeftOut, Progress, Request
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
    targets = templates.targets if isinstance(templates, Customization) else ()
    with transaction.all_locked((Path(output), *(target.out for target in targets))):
        request = _read(
            paths,
            Path(output),
            include,
            with_deps,
            templates,
            condition,
            exclude=exclude,
            keep_going=keep_going,
        )
        return unless_up_to_date(request, partial(_build, progress=progress), _prepared)


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
    request = _read(
        paths, Path(output), include, with_deps, templates, condition, exclude=exclude, keep_going=keep_going
    )
    change = _Change(request, _build(request, UpToDate(), progress))
    drifts = write.drift(change.packages(), request.output, change.result.targets)
    return Drifted(drifts, change.diagnostics(), change.result.left_out)


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
    from ifgen.pipeline.resolution import resolve_what_can_be

    request = _read(paths, Path(output), include, with_deps, exclude=exclude)
    return resolve_what_can_be(request).registries


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
    templates: Path | str | Customization | None = None,
    condition: Condition | None = None,
    *,
    exclude: Sequence[str] = (),
    keep_going: bool = False,
) -> Request:
    previous = previous_output.manifests_in(output)
    packages = tuple(previous_output.with_siblings(package, previous) for package in find_packages(paths))
    excluded: tuple[str, ...] = ()
    if exclude:
        from ifgen.pipeline.resolution import without_excluded

        packages, excluded = without_excluded(packages, exclude)
    if problems := [
        previous_output.into_its_source(package)
        for package in packages
        if (output / package.name).resolve() == package.root.resolve()
    ]:
        raise UsageError(problems)
    return Request(
        paths=tuple(map(Path, paths)),
        packages=packages,
        search=SearchPath(packages, include),
        output=output,
        previous=previous,
        with_deps=with_deps,
        custom=templates
        if isinstance(templates, Customization)
        else Customization(Path(templates) if templates else None),
        condition=condition,
        excluded=excluded,
        keep_going=keep_going,
    )


def _build(request: Request, up_to_date: UpToDate, progress: Progress | None) -> BuildResult:
    """Resolve -> plan -> render what is not up to date."""
    from ifgen.pipeline.planning import plan, render
    from ifgen.pipeline.resolution import resolve_what_can_be

    resolved = resolve_what_can_be(request)
    if request.condition is not None:
        request.condition.check(resolved.registries)
    custom, targets = request.custom, None
    if custom.targets and not custom.partial:
        from ifgen.pipeline.generators.run import run_targets  # of use to few
        from ifgen.pipeline.model import build_model

        targets = run_targets(custom.targets, build_model(resolved))
    planned = plan(request, resolved, up_to_date, progress) if custom.python else ()
    return BuildResult(
        packages=render(planned, custom),
        generated={target.name for target in resolved.targets} if custom.python else (),
        needed=resolved.needed if custom.python else (),
        diagnostics=(*resolved.diagnostics(), *(targets.diagnostics if targets else ())),
        skipped=up_to_date.packages if custom.python else {},
        resolved=resolved,
        targets=targets.folders if targets else (),
    )


class _Change:
    """The change that a run makes to its output: packages to write, packages to remove, and diagnostics."""

    def __init__(self, request: Request, result: BuildResult) -> None:
        self.result = result
        self._request, self._output = request, request.output
        self._removed = previous_output.to_remove(request, result)
        self._left_behind: list[Path] = []

    def packages(self) -> Iterator[OutputPackage]:
        """The packages, in which `diagnostics` then knows the user's files that nothing uses any more."""
        for package in chain((OutputPackage(name, {}) for name in self._removed), self.result.packages):
            self._left_behind += write.left_behind(package, self._output)
            yield package

    def diagnostics(self) -> tuple[Diagnostic, ...]:
        """The diagnostics of the run, and about the output after it."""
        left_behind = map(previous_output.left_behind, sorted(self._left_behind))
        missing = previous_output.missing_packages(self.result.needed, self._request, self._removed)
        return (*self.result.diagnostics, *left_behind, *missing)

    def _by_folder(self, paths: Iterable[Path]) -> dict[Path, list[Path]]:
        """Files by the innermost folder of the run that they are in."""
        folders = [self._output, *(target.directory for target in self.result.targets)]
        folders.sort(key=lambda folder: len(folder.parts), reverse=True)
        found: dict[Path, list[Path]] = {}
        for path in paths:
            found.setdefault(next(f for f in folders if path.is_relative_to(f)), []).append(path)
        return found

    def effects(self, written: Written) -> Generated:
        """The effects of the run, after files were written."""
        skipped = (
            path
            for name, manifest in self.result.skipped.items()
            for path in write.files_of(self._output / name, self._output, manifest)
        )
        targets = self.result.skipped_targets
        of_targets = (path for out in targets for path in write.files_of(out, out, targets[out]))
        overwritten = [
            diagnostic
            for folder, paths in self._by_folder(written.edited).items()
            for diagnostic in previous_output.overwritten(paths, folder)
        ]
        return Generated(
            written.written,
            tuple(sorted((*written.unchanged, *skipped, *of_targets))),
            written.removed,
            written.kept,
            (*map(previous_output.edited, written.kept), *overwritten, *self.diagnostics()),
            self.result.left_out,
        )


@contextmanager
def _prepared(request: Request, result: BuildResult) -> Generator[Callable[[], Generated]]:
    change = _Change(request, result)
    with write.prepared(change.packages(), request.output, GENERATOR, result.targets) as finish:
        yield lambda: change.effects(finish())
