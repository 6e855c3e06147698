"""Notes on what a run has generated, for the next one."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import replace

from ifgen.definition.interfaces import Interface, Registry
from ifgen.diagnostics import Diagnostic
from ifgen.pipeline import earlier
from ifgen.pipeline.freshness import fingerprints, notes, remembered
from ifgen.pipeline.freshness.modules import Modules
from ifgen.pipeline.freshness.notes import Note, Notes
from ifgen.pipeline.freshness.state import State, modules_of_users
from ifgen.pipeline.job import Job, Target
from ifgen.writing.write import ROOT


def note(job: Job, told: Sequence[Diagnostic], state: State, before: Notes, known: Modules | None) -> None:
    """Note that the packages of a run have been generated just now from what was read for it."""
    names = [target.name for target in job.targets]
    ours = state.ours.union(names) if state.ours else state.ours
    # The digests of what was parsed count, not the current state of the files.
    digests = state.digests.knowing(_as_read(job))
    modules = known.digests if known else fingerprints.of_modules(job.registry, digests.generator)
    packages = dict(before.packages)
    for target in job.targets:
        sources = _note(target, job.registries, modules)
        inputs = digests.of_package(target.name, sources, ours)
        packages[target.name] = replace(sources, inputs=inputs, manifest=_manifest(job, target.name))
    after = Notes(packages, before.runs)
    if state.root is not None:
        of_all = Note(tuple(sorted(names)), inputs=after.of_run(names), manifest=_manifest(job, ROOT))
        after = replace(after, packages={**packages, ROOT: of_all})
    # The users' modules as they were when they were compared, and those that were written since.
    users = {**fingerprints.of_files(modules_of_users(job.packages, job.output)), **state.users}
    after = after.with_run(state.request, [after.of_run(names, users), remembered.as_document(told)])
    if after != before:
        notes.keep(after, job.output)


def _note(target: Target, registries: Sequence[Registry], modules: Mapping[str, str]) -> Note:
    """The sources of a package, without their digests."""
    own: list[str] = []
    uses: set[str] = set()
    of_modules: dict[str, str] = {}
    documents: tuple[str, ...] = ()
    if target.interfaces is not None:
        own += (interface.type_name for interface in target.interfaces.interfaces)
        of_modules = {name: modules[name] for name in own}
        uses.add(target.name)
    if target.nodes is not None:
        own += target.described
        uses.update(e.type_name.partition("/")[0] for node in target.nodes.nodes for e in node.endpoints)
        documents = tuple(str(path.resolve()) for path in target.documents)
    return Note(tuple(own), _needed(target.name, uses, registries), documents, of_modules)


def _needed(package: str, uses: Iterable[str], registries: Sequence[Registry]) -> tuple[str, ...]:
    """The interfaces in the packages that a package uses, and that their fields need, and so on."""
    found = set(uses)
    pending = list(found)
    while pending:
        interfaces = _interfaces(pending.pop(), registries)
        types = (name for interface in interfaces for name in fingerprints.needed_types(interface))
        more = {name.partition("/")[0] for name in types} - found
        found |= more
        pending += more
    others = (interface for name in sorted(found - {package}) for interface in _interfaces(name, registries))
    return tuple(dict.fromkeys(interface.type_name for interface in others))


def _interfaces(package: str, registries: Sequence[Registry]) -> Iterator[Interface]:
    for registry in registries:
        if package in registry.packages:
            yield from registry.packages[package].interfaces


def _as_read(job: Job) -> dict[str, bytes]:
    """Digests of what was parsed for a job, whatever has become of the files since."""
    parsed = (interface for registry in job.registries for interface in registry)
    found = {i.type_name: fingerprints.of_source(i.source) for i in parsed if i.source}
    xmls = (package.declared.source for package in job.packages if package.declared)
    documents = (source for target in job.targets if target.nodes for source in target.nodes.sources)
    found.update((str(s.path.resolve()), fingerprints.of_source(s)) for s in (*xmls, *documents))
    return found


def _manifest(job: Job, package: str) -> str:
    record = earlier.record_of(job.output / package)
    return record.digest if record is not None else ""
