"""The options of the verbs of `ifgen topic`."""

from __future__ import annotations

from dataclasses import dataclass

from ifgen_tools.qos import QosChoice
from ifgen_tools.texts.style import Style
from ifgen_tools.verbs import GraphOptions


@dataclass(frozen=True, slots=True, kw_only=True)
class EchoOptions(GraphOptions):
    """The options of `topic echo`."""

    name: str
    message_type: str | None
    once: bool
    timeout: float | None
    fields: tuple[str, ...]
    filter_expression: str | None
    csv: bool
    raw: bool
    style: Style
    include_message_info: bool
    no_lost_messages: bool
    qos: QosChoice


@dataclass(frozen=True, slots=True, kw_only=True)
class PubOptions(GraphOptions):
    """The options of `topic pub`."""

    name: str
    message_type: str
    values: str | None
    stdin: bool
    rate: float
    once: bool
    times: int | None
    print_every: int
    wait_matching: int | None
    max_wait: float | None
    keep_alive: float
    node_name: str | None
    qos: QosChoice


@dataclass(frozen=True, slots=True, kw_only=True)
class RateOptions(GraphOptions):
    """The options of `topic bw` and `topic delay`."""

    name: str
    window: int


@dataclass(frozen=True, slots=True, kw_only=True)
class HzOptions(GraphOptions):
    """The options of `topic hz`."""

    names: tuple[str, ...]
    window: int
    filter_expression: str | None
    wall_time: bool
