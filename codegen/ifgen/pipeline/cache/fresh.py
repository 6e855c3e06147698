"""Builds what an earlier run did not leave as it has to be; nothing is parsed to find that out."""

from __future__ import annotations

import hashlib
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import AbstractContextManager, suppress
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TypeVar

from ifgen import signals
from ifgen.definition.interfaces import Interface, Registry
from ifgen.pipeline import previous_output
from ifgen.pipeline.cache.fingerprints import Fingerprints, Needs, of_files
from ifgen.pipeline.cache.record import BuildRecord, PackageRecord, read_record, save_record
from ifgen.pipeline.values import BuildResult, Request, ResolvedInput, Target
from ifgen.reading import manifest
from ifgen.reading.manifest import Manifest
from ifgen.reading.packages import NODE_FOLDER, PackageFiles
from ifgen.reading.storage import MAX_GENERATED, read_limited
from ifgen.writing import write

Done = TypeVar("Done")


def _no_module(_: Interface, __: Registry, ___: str) -> str | None:
    return None


@dataclass(frozen=True, slots=True)
class UpToDate:
    """Results of earlier runs that would not change: packages, each with its manifest, and single modules.

    `result` is that of the whole run, if nothing else is asked for.
    """

    packages: Mapping[str, Manifest] = field(default_factory=dict[str, Manifest])
    module: Callable[[Interface, Registry, str], str | None] = _no_module
    result: BuildResult | None = None


def unless_up_to_date(
    request: Request,
    build: Callable[[Request, UpToDate], BuildResult],
    prepare: Callable[[Request, BuildResult], AbstractContextManager[Callable[[], Done]]],
) -> Done:
    """Build what an earlier run did not leave as it has to be, write that, and record it for the next run.

    `prepare` does all but the last step, during which an interruption waits.
    """
    state = _State(request, read_record(request.output))
    up_to_date = state.up_to_date()
    result = up_to_date.result or build(request, up_to_date)
    with prepare(request, result) as finish, signals.delay_interrupt("all files had been written"):
        done = finish()
        if result.resolved is not None:
            save_record(state.record_of(result, result.resolved), request.output)
        return done


class _State:
    """The input of a run as it was before anything was parsed, beside the record of earlier runs.

    What users save from then on is not taken for what was read.
    """

    def __init__(self, request: Request, record: BuildRecord) -> None:
        self._request, self._output = request, request.output
        self._record = record
        self._sources = {p.name: previous_output.source_of(p, self._output) for p in request.packages}
        # Only pip needs to know what is generated beside a package.
        is_for_pip = request.custom.distributions is not None
        self._ours = (
            {*self._sources, *previous_output.packages_in(self._output)} if is_for_pip else set[str]()
        )
        self._makes_root = not request.custom.partial and any(o.per == "run" for o in request.custom.outputs)
        self._users = of_files(_users_modules(request.packages, self._output))
        self._fingerprints = Fingerprints(request)
        self._manifests: dict[str, Manifest | None] = {}

    def up_to_date(self) -> UpToDate:
        """The part of what is recorded that building would not change."""
        search, names = self._request.search, set(self._sources)
        current: dict[str, Manifest] = {}
        needed: set[str] = set()
        pending = list(names)
        while pending:
            name = pending.pop()
            if (found := self._current(name)) is not None:
                current[name] = found
                needs = self._record.needed_by(name)
                along = {n for n in needs - names if search.comes_along(n, self._request.with_deps)}
                needed |= needs
                names |= along
                pending += along
        intact = {name: found for name, found in current.items() if self._is_intact(name, found)}
        result = None
        root = previous_output.manifest_of(self._output / write.ROOT) if self._makes_root else None
        if intact.keys() == names and (root is None or self._is_intact(write.ROOT, root)):
            inputs = self._inputs_of_run(self._record, names, self._users)
            diagnostics = self._record.diagnostics_of(self._request_key, inputs)
            if diagnostics is not None:
                skipped = intact if root is None else {**intact, write.ROOT: root}
                result = BuildResult((), skipped.keys(), needed - skipped.keys(), diagnostics, skipped)
        return UpToDate(intact, self._module, result)

    def record_of(self, result: BuildResult, resolved: ResolvedInput) -> BuildRecord:
        """The record with the packages of a run, which have been written just now."""
        names = [target.name for target in resolved.targets]
        ours = self._ours.union(names) if self._ours else self._ours
        # The digests of what was parsed count, not the current state of the files.
        fingerprints = self._fingerprints.as_read(resolved)
        needs = Needs(resolved.registries)
        modules = self._fingerprints.of_modules(resolved.registry)
        packages = dict(self._record.packages)
        for target in resolved.targets:
            sources = _sources(target, needs, modules)
            packages[target.name] = replace(
                sources,
                inputs=fingerprints.of_sources(target.name, sources, ours),
                manifest=previous_output.digest_of(self._output / target.name),
            )
        # The users' modules as they were when they were compared, and those that were written since.
        users = of_files(_users_modules(resolved.packages, self._output)) | self._users
        after = replace(self._record, packages=packages)
        return after.with_run(self._request_key, self._inputs_of_run(after, names, users), result.diagnostics)

    def _current(self, name: str) -> Manifest | None:
        """The manifest of a package, if that and everything that it was generated from are as recorded."""
        recorded = self._record.packages.get(name)
        found = self._manifests[name] = previous_output.manifest_of(self._output / name)
        if recorded is None or found is None or _own(self._request.search.package(name)) != set(recorded.own):
            return None
        current = (self._sources.get(name), self._fingerprints.of_sources(name, recorded, self._ours))
        if (found.source, recorded.inputs) == current and found.digest == recorded.manifest:
            return found
        return None

    def _is_intact(self, name: str, found: Manifest) -> bool:
        return write.is_intact(found, self._output / name, self._output)

    def _module(self, interface: Interface, registry: Registry, path: str) -> str | None:
        """The text of an interface's module at a path in its package; None if it has to be rendered."""
        package, name = interface.package, interface.type_name
        recorded, found = self._record.packages.get(package), self._manifests.get(package)
        # Another ifgen may have generated there since.
        if recorded is None or found is None or found.digest != recorded.manifest:
            return None
        if recorded.modules.get(name) == self._fingerprints.of_modules(registry)[name]:
            with suppress(OSError):
                data = read_limited(self._output / package / path, MAX_GENERATED)
                if manifest.digest(data) == found.files.get(path):
                    return data.decode()
        return None

    @property
    def _request_key(self) -> str:
        """The digest of what is asked for, and of the working folder: messages name paths relative to that.

        A condition is part of the request: what did not meet another one may not meet this one.
        """
        condition = self._request.condition.key if self._request.condition else ""
        text = repr((list(self._sources), self._request.with_deps, str(Path().absolute()), condition))
        return hashlib.sha256(text.encode(errors="surrogateescape")).hexdigest()[:32]

    def _inputs_of_run(self, record: BuildRecord, names: Iterable[str], users: Mapping[str, bytes]) -> str:
        """The digest of the inputs of packages, of users' modules, and of what is made once in a run."""
        hasher = hashlib.sha256("\n".join(record.packages[name].inputs for name in sorted(names)).encode())
        for path, digest in sorted(users.items()):
            hasher.update(path.encode(errors="surrogateescape") + digest)
        if self._makes_root:
            hasher.update(previous_output.digest_of(self._output / write.ROOT).encode())
        return hasher.hexdigest()


def _users_modules(packages: Iterable[PackageFiles], output: Path) -> Iterator[Path]:
    """The users' modules of nodes in the output, which are compared with the descriptions."""
    for package in packages:
        if package.nodes:
            yield from sorted((output / package.name / package.name).rglob("[!_]*.py"))


def _own(package: PackageFiles | None) -> set[str] | None:
    """The interfaces and nodes of a package; None if it is gone, or has a name twice."""
    if package is None:
        return None
    names = [f"{package.name}/{file.folder}/{file.name}" for file in package.files]
    names += (f"{package.name}/{NODE_FOLDER}/{node.name}" for node in package.nodes)
    own = set(names)
    return own if len(own) == len(names) else None  # an .idl file beside a .msg file


def _sources(target: Target, needs: Needs, modules: Mapping[str, str]) -> PackageRecord:
    """The sources of a package, without their digests."""
    interfaces = [i.type_name for i in target.interfaces.interfaces] if target.interfaces else []
    endpoints = [e.type_name for node in target.nodes.nodes for e in node.endpoints] if target.nodes else []
    own = [*interfaces, *target.described]
    needed: Sequence[str] = sorted(needs.by([*interfaces, *endpoints]).difference(own))
    documents = [str(path.resolve()) for path in target.documents]
    return PackageRecord(own, needed, documents, {name: modules[name] for name in interfaces})
