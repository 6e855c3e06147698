"""The first and the last value of a run, which it needs even where nothing has changed."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from ifgen.config.customization import Customization
from ifgen.diagnostics import Diagnostic
from ifgen.reading.manifest import Manifest
from ifgen.reading.packages import PackageFiles
from ifgen.reading.search_path import SearchPath, WithDeps
from ifgen.writing.write import OutputPackage

if TYPE_CHECKING:
    from ifgen.definition.interfaces import Registry
    from ifgen.pipeline.freshness.modules import Modules
    from ifgen.pipeline.job import Job

Progress = Callable[[int, int, str], object]
"""Called with the packages done, the packages in all, and the one that is next."""


@dataclass(frozen=True, slots=True)
class Condition:
    """A condition for a run: `check` raises InputError if the interfaces of the run do not meet it.

    `key` is different for conditions that are different: a run that met one need not check it again.
    """

    key: str
    check: Callable[[Iterable[Registry]], None]


@dataclass(frozen=True, slots=True)
class Inputs:
    """The input of a run: the packages at `paths`, and the places to look for others.

    They are generated into the folder `output`, `with_deps` or without, with what the user adds to them.
    A run that does not meet the `condition` writes nothing. `excluded` are the names of packages, interfaces
    and nodes that the user leaves out; a run that is to `keep_going` leaves out what is wrong, too.
    """

    paths: tuple[Path, ...]
    packages: tuple[PackageFiles, ...]
    search: SearchPath
    output: Path
    with_deps: WithDeps
    custom: Customization
    condition: Condition | None = None
    excluded: tuple[str, ...] = ()
    keep_going: bool = False


@dataclass(frozen=True, slots=True)
class LeftOut:
    """The name of an interface, a node or a whole package that a run leaves out, and the reason."""

    name: str
    reason: str


@dataclass(frozen=True, slots=True)
class Made:
    """The files that a run writes, and the diagnostics about their sources.

    `packages` are rendered when they are asked for, which is once: a large run has no room for all of them.
    `generated` are the names of its packages. Those among them that are `skipped` are on disk already, each
    with its manifest, and not in `packages`. `needed` are others that these need. `job` is what was resolved,
    and `modules` knows the digests of its interfaces; None if nothing had to be. `left_out` is not in
    `packages`.
    """

    packages: Iterable[OutputPackage]
    generated: Collection[str]
    needed: Collection[str]
    told: tuple[Diagnostic, ...]
    skipped: Mapping[str, Manifest]
    job: Job | None = None
    modules: Modules | None = None
    left_out: tuple[LeftOut, ...] = ()
