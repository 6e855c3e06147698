"""The options of the verbs of `ifgen param`."""

from __future__ import annotations

from dataclasses import dataclass

from ifgen_tools.verbs import GraphOptions, NodeOptions


@dataclass(frozen=True, slots=True, kw_only=True)
class ParamListOptions(GraphOptions):
    """The options of `param list`, about one node or about all."""

    include_hidden: bool = False
    patience: float | None = None
    node: str | None
    param_prefixes: tuple[str, ...]
    with_types: bool
    pattern: str | None


@dataclass(frozen=True, slots=True, kw_only=True)
class GetOptions(NodeOptions):
    """The options of `param get`, and of `param delete`."""

    name: str
    hide_type: bool = False


@dataclass(frozen=True, slots=True, kw_only=True)
class DescribeOptions(NodeOptions):
    """The options of `param describe`."""

    names: tuple[str, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class SetOptions(NodeOptions):
    """The options of `param set`: `pairs` are names, each with its value after it."""

    pairs: tuple[str, ...]
    atomic: bool


@dataclass(frozen=True, slots=True, kw_only=True)
class LoadOptions(NodeOptions):
    """The options of `param load`."""

    file: str
    no_use_wildcard: bool
