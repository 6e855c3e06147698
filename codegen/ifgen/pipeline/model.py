"""The model of what a run resolved, for generators and for `ifgen model`."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from ifgen.diagnostics import Span
from ifgen.generator_py.outputs.interfaces import ModelBuilder
from ifgen.generator_py.outputs.nodes import node_model
from ifgen.model import Model
from ifgen.pipeline.resolution import resolve_what_can_be, without_excluded
from ifgen.pipeline.values import Request, ResolvedInput
from ifgen.reading.packages import find_packages
from ifgen.reading.search_path import SearchPath, WithDeps


@dataclass(frozen=True, slots=True)
class BuiltModel:
    """A model, and the places of its elements by their ids."""

    model: Model
    spans: dict[str, Span]


def build_model(resolved: ResolvedInput) -> BuiltModel:
    """The model of the packages of a run, which are to be generated, and of all that they need."""
    names = {
        i.type_name for target in resolved.targets if target.interfaces for i in target.interfaces.interfaces
    }
    builder = ModelBuilder(resolved.registries, names.__contains__)
    nodes = {
        target.name: tuple(map(node_model, sorted(target.nodes.nodes, key=lambda node: node.name)))
        for target in resolved.targets
        if target.nodes
    }
    model = builder.build([target.name for target in resolved.targets], nodes)
    return BuiltModel(model, builder.spans)


def load_model(
    *paths: Path | str,
    include: Sequence[Path | str] = (),
    with_deps: WithDeps = False,
    exclude: Sequence[str] = (),
) -> Model:
    """The model of the interfaces and nodes at `paths`. Raises InputError with all mistakes."""
    return load_built_model(*paths, include=include, with_deps=with_deps, exclude=exclude).model


def load_built_model(
    *paths: Path | str,
    include: Sequence[Path | str] = (),
    with_deps: WithDeps = False,
    exclude: Sequence[str] = (),
) -> BuiltModel:
    """The same, with the places of its elements."""
    packages, _ = without_excluded(find_packages(paths), exclude)
    search = SearchPath(packages, include)
    request = Request(tuple(map(Path, paths)), packages, search, Path(), {}, with_deps)
    return build_model(resolve_what_can_be(request))
