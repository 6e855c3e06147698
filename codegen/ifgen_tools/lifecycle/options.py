"""The options of the verbs of `ifgen lifecycle`."""

from __future__ import annotations

from dataclasses import dataclass

from ifgen_tools.verbs import GraphOptions, NodeOptions


@dataclass(frozen=True, slots=True, kw_only=True)
class GetOptions(GraphOptions):
    """The options of `lifecycle get`; without a node it is about all of them."""

    node: str | None
    include_hidden: bool = False


@dataclass(frozen=True, slots=True, kw_only=True)
class TransitionsOptions(NodeOptions):
    """The options of `lifecycle list`."""

    all_: bool = False


@dataclass(frozen=True, slots=True, kw_only=True)
class SetOptions(NodeOptions):
    """The options of `lifecycle set`; the transition is its label or number."""

    transition: str
