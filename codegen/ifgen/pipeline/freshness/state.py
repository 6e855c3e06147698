"""The state in which a run finds what its output depends on, and the output itself."""

from __future__ import annotations

import hashlib
from collections.abc import Iterable, Iterator, Mapping, Set
from dataclasses import dataclass
from pathlib import Path

from ifgen import resources
from ifgen.pipeline import earlier
from ifgen.pipeline.freshness import fingerprints
from ifgen.pipeline.freshness.digests import Digests
from ifgen.pipeline.freshness.notes import Found, Notes
from ifgen.pipeline.values import Inputs
from ifgen.reading.packages import NODE_FOLDER, PackageFiles
from ifgen.writing.write import ROOT


@dataclass(frozen=True, slots=True)
class State:
    """Everything that the output of a run depends on, as it was before anything was parsed, and the output.

    What users save from then on is not taken for what was read.

    `request` stands for what was asked for. `packages` are those that were, and those that came along in
    earlier runs; `root` is what is made once in a run, and None if that is nothing. `users` are the digests
    of the users' modules of nodes, which are compared with the descriptions. `ours` are all packages in the
    output, if that matters.
    """

    request: str
    output: Path
    packages: Mapping[str, Found]
    root: Found | None
    users: Mapping[str, bytes]
    ours: frozenset[str]
    digests: Digests


def state_of(inputs: Inputs, notes: Notes) -> State:
    """The state that a run finds, as far as the notes on earlier runs say what to look at."""
    output = inputs.output
    request = _request(inputs)
    modules = modules_of_users(inputs.packages, output)
    own = {name: _own(package) for name, package in _packages(inputs, notes).items()}
    sources = {package.name: earlier.source_of(package, output) for package in inputs.packages}
    # Only pip needs to know what is generated beside a package.
    is_for_pip = inputs.custom.distributions is not None
    ours = frozenset({*sources, *earlier.packages_in(output)} if is_for_pip else ())
    manifests = {name: earlier.record_of(output / name) for name in (*own, ROOT)}
    users = fingerprints.of_files(modules)
    descriptions = {
        package.name: fingerprints.of_own_description(package, inputs.search) for package in inputs.packages
    }
    generator = fingerprints.of_generator(resources.templates())
    generator += fingerprints.of_customization(inputs.custom)
    digests = Digests(generator, descriptions, inputs.search)
    noted = {name: note for name, note in notes.packages.items() if own.get(name) == set(note.own)}
    digest_of = {name: digests.of_package(name, note, ours) for name, note in noted.items()}
    makes_once_in_a_run = not inputs.custom.partial and any(
        made.per == "run" for made in inputs.custom.outputs
    )
    return State(
        request,
        output,
        {name: Found(own[name], digest_of.get(name), sources.get(name), manifests[name]) for name in own},
        Found(None, None, None, manifests[ROOT]) if makes_once_in_a_run else None,
        users,
        ours,
        digests,
    )


def modules_of_users(packages: Iterable[PackageFiles], output: Path) -> Iterator[Path]:
    """The users' modules of nodes in the output."""
    for package in packages:
        if package.nodes:
            yield from sorted((output / package.name / package.name).rglob("[!_]*.py"))


def _request(inputs: Inputs) -> str:
    """The digest of what is asked for, and of the working folder: messages name paths relative to that.

    A condition is part of the request: what did not meet another one may not meet this one.
    """
    names = [package.name for package in inputs.packages]
    condition = inputs.condition.key if inputs.condition else ""
    text = repr((names, inputs.with_deps, str(Path().absolute()), condition))
    return hashlib.sha256(text.encode(errors="surrogateescape")).hexdigest()[:32]


def _packages(inputs: Inputs, notes: Notes) -> dict[str, PackageFiles | None]:
    """The packages of the run, and those that come along with one of them as it is noted."""
    search = inputs.search
    found: dict[str, PackageFiles | None] = {package.name: package for package in inputs.packages}
    pending = list(found)
    while pending:
        for name in notes.needed_by(pending.pop()) - found.keys():
            if search.comes_along(name, inputs.with_deps):
                found[name] = search.package(name)
                pending.append(name)
    return found


def _own(package: PackageFiles | None) -> Set[str] | None:
    if package is None:
        return None
    own = [f"{package.name}/{file.folder}/{file.name}" for file in package.files]
    own += (f"{package.name}/{NODE_FOLDER}/{node.name}" for node in package.nodes)
    has_twins = len(set(own)) < len(own)  # an .idl file beside a .msg file
    return None if has_twins else frozenset(own)
