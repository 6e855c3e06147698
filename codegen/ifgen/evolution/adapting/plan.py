"""The files of an adapter: the user's module and its tests, and the frozen classes that these need."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from ifgen.definition.interfaces import Interface, Registry
from ifgen.definition.names import snake_case
from ifgen.diagnostics import InputError, UsageError
from ifgen.evolution.adapting.finding import Finder
from ifgen.evolution.adapting.module import adapter_module, part_name
from ifgen.evolution.adapting.steps import Functions
from ifgen.evolution.adapting.tests import adapter_tests
from ifgen.evolution.adapting.versions import Today, TwoVersions
from ifgen.evolution.interfaces import versions as parts_of
from ifgen.generator_py.adapters.context import AdapterPackage, AdapterTests
from ifgen.generator_py.adapters.frozen import plan_frozen, short
from ifgen.generator_py.artifact import Artifact


@dataclass(frozen=True, slots=True)
class Planned:
    """The files of an adapter, in its folder. `module` is the one to read, and `tests` are None if too large.

    `shared` are those that other adapters use, too.
    """

    module: Artifact
    tests: Artifact | None
    shared: tuple[Artifact, ...]
    versions: TwoVersions


def plan(
    type_name: str,
    reference: str,
    paths: Sequence[Path],
    include: Sequence[Path],
    base: Path,
    *,
    downgrade: bool,
) -> Planned:
    """The files of the adapter from the version that `reference` names to a type as it is now.

    `base` is the folder of the project. Raises UsageError and InputError.
    """
    finder = Finder(paths, include, base)
    now = finder.today(type_name)
    earlier = finder.earlier(reference, now)
    versions = TwoVersions(
        earlier.interface,
        now.interface,
        earlier.registry,
        now.registry,
        _today(finder, now.registry),
        earlier.origin,
    )
    parts = list(parts_of(earlier.interface, now.interface))
    functions = Functions(versions)
    for part in parts:
        if part.old is earlier.interface or not versions.is_same(part.old, part.new):
            name = part_name(versions, part.new)
            functions.add(f"upgrade_{name}".rstrip("_"), "upgrade", part.old, part.new)
            if downgrade:
                functions.add(f"downgrade_{name}".rstrip("_"), "downgrade", part.old, part.new)
    module = f"{snake_case(now.interface.name)}_{short(versions.old_hashes.of(versions.old))}"
    variables = {"adapter": adapter_module(versions, parts, functions)}
    tests = adapter_tests(versions, parts, functions, module)
    package = AdapterPackage(
        "Adapters between versions of interfaces: written once by `ifgen adapt`, yours now."
    )
    return Planned(
        Artifact(f"{module}.py", "adapter_package/adapter.py.j2", variables),
        None if tests is None else _tests(f"test_adapt_{module}.py", tests),
        (
            Artifact("__init__.py", "adapter_package/package.py.j2", {"package": package}),
            *(plan_frozen(interface, versions.facts) for interface in versions.frozen),
        ),
        versions,
    )


def _tests(path: str, tests: AdapterTests) -> Artifact:
    return Artifact(path, "adapter_package/tests.py.j2", {"test": tests}, own_package="")


def _today(finder: Finder, registry: Registry) -> Today:
    known: dict[str, tuple[Interface, Registry] | None] = {}

    def today(name: str) -> tuple[Interface, Registry] | None:
        if name not in known:
            known[name] = _found(name)
        return known[name]

    def _found(name: str) -> tuple[Interface, Registry] | None:
        if (interface := registry.get(name)) is not None:
            return interface, registry
        try:
            found = finder.today(name)
        except (InputError, UsageError):
            return None
        return found.interface, found.registry

    return today
