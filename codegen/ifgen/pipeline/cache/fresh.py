"""Builds what an earlier run did not leave as it has to be; nothing is parsed to find that out."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from contextlib import AbstractContextManager, suppress
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TypeVar

from ifgen import signals
from ifgen.definition.interfaces import Interface, Registry
from ifgen.diagnostics import Diagnostic
from ifgen.pipeline import previous_output
from ifgen.pipeline.cache.fingerprints import Fingerprints
from ifgen.pipeline.cache.record import BuildRecord, read_record, save_record
from ifgen.pipeline.values import BuildResult, Request, ResolvedInput
from ifgen.reading import manifest
from ifgen.reading.manifest import Manifest
from ifgen.reading.storage import MAX_GENERATED, read_limited
from ifgen.writing import write

Done = TypeVar("Done")


@dataclass(frozen=True, slots=True)
class UpToDate:
    """Results of earlier runs that would not change: packages, each with its manifest, and single modules.

    `result` is that of the whole run, if nothing else is asked for.
    """

    packages: Mapping[str, Manifest] = field(default_factory=dict[str, Manifest])
    state: _State | None = None
    result: BuildResult | None = None

    def module(self, interface: Interface, registry: Registry, path: str) -> str | None:
        """The text of an interface's module at a path in its package; None if it has to be rendered."""
        return self.state.module(interface, registry, path) if self.state else None


def unless_up_to_date(
    request: Request,
    build: Callable[[Request, UpToDate], BuildResult],
    prepare: Callable[[Request, BuildResult], AbstractContextManager[Callable[[], Done]]],
) -> Done:
    """Build what an earlier run did not leave as it has to be, write that, and record it for the next run.

    `prepare` does all but the last step, during which an interruption waits.
    """
    state = _State(request, read_record(request.output), Fingerprints(request))
    up_to_date = state.up_to_date()
    result = up_to_date.result or build(request, up_to_date)
    with prepare(request, result) as finish, signals.delay_interrupt("all files had been written"):
        done = finish()
        if result.resolved is not None:
            save_record(state.updated(result.resolved, result.diagnostics), request.output)
        return done


@dataclass(frozen=True, slots=True)
class _State:
    """The input of a run as it was before anything was parsed, beside the record of earlier runs.

    What users save from then on is not taken for what was read.
    """

    request: Request
    record: BuildRecord
    fingerprints: Fingerprints

    def up_to_date(self) -> UpToDate:
        """The part of what is recorded that building would not change."""
        request, search = self.request, self.request.search
        sources = {package.name: request.source_of(package) for package in request.packages}
        names, pending = set(sources), list(sources)
        current: dict[str, Manifest] = {}
        needed: set[str] = set()
        while pending:
            name = pending.pop()
            recorded, found = self.record.packages.get(name), request.previous.get(name)
            # Another ifgen may have generated there since.
            if recorded is None or (found.digest if found else "") != recorded.manifest:
                continue
            if found is None and request.custom.python:
                continue
            is_same = found is None or found.source == sources.get(name)
            if is_same and self.fingerprints.match(name, recorded):
                current[name] = found or Manifest()
                needs = {type_name.partition("/")[0] for type_name in recorded.needed}
                along = {n for n in needs - names if search.comes_along(n, request.with_deps)}
                needed |= needs
                names |= along
                pending += along
        root, targets = self._root(request.previous), self._targets()
        intact = {
            name: found
            for name, found in {**current, **root}.items()
            if write.is_intact(found, request.output / name, request.output)
        }
        result = None
        if intact.keys() == names | root.keys() and targets is not None:
            records = [self.record.packages[name] for name in sorted(names)]
            inputs = self.fingerprints.of_run(records, [*root.values(), *targets.values()])
            diagnostics = self.record.diagnostics_of(self.fingerprints.request, inputs)
            if diagnostics is not None:
                generated = intact if request.custom.python else {}
                missing = needed - intact.keys() if request.custom.python else ()
                result = BuildResult(
                    (), generated.keys(), missing, diagnostics, generated, skipped_targets=targets
                )
        return UpToDate({name: m for name, m in intact.items() if name != write.ROOT}, self, result)

    def module(self, interface: Interface, registry: Registry, path: str) -> str | None:
        """The text of an interface's module, as `UpToDate.module` has it."""
        package, name = interface.package, interface.type_name
        recorded, found = self.record.packages.get(package), self.request.previous.get(package)
        if recorded is None or found is None or found.digest != recorded.manifest:
            return None
        if recorded.modules.get(name) == self.fingerprints.of_modules(registry)[name]:
            with suppress(OSError):
                data = read_limited(self.request.output / package / path, MAX_GENERATED)
                if manifest.digest(data) == found.files.get(path):
                    return data.decode()
        return None

    def updated(self, resolved: ResolvedInput, diagnostics: Sequence[Diagnostic]) -> BuildRecord:
        """The record with the packages of a run, which have been written just now."""
        # The digests of what was parsed count, not the current state of the files.
        fingerprints = self.fingerprints.as_read(resolved)
        manifests = previous_output.manifests_in(self.request.output)
        records = {
            name: replace(sources, manifest=manifests[name].digest if name in manifests else "")
            for name, sources in fingerprints.records(resolved).items()
        }
        others = [*self._root(manifests).values(), *(self._targets() or {}).values()]
        inputs = fingerprints.of_run([records[name] for name in sorted(records)], others)
        after = replace(self.record, packages={**self.record.packages, **records})
        return after.with_run(fingerprints.request, inputs, diagnostics)

    def _targets(self) -> dict[Path, Manifest] | None:
        """The manifests of the folders of targets; None if one of them is not as it was written."""
        custom, found = self.request.custom, dict[Path, Manifest]()
        for target in () if custom.partial else custom.targets:
            with suppress(OSError, ValueError):
                read = manifest.read(target.out, manifest.TARGETS)
                if read is not None and write.is_intact(read, target.out, target.out):
                    found[target.out] = read
            if target.out not in found:
                return None
        return found

    def _root(self, manifests: Mapping[str, Manifest]) -> dict[str, Manifest]:
        """The manifest of what is made once in a run, if this run makes that."""
        custom = self.request.custom
        makes_it = not custom.partial and any(output.per == "run" for output in custom.outputs)
        return {write.ROOT: manifests[write.ROOT]} if makes_it and write.ROOT in manifests else {}
