"""The options of the verbs of `ifgen topic`."""

from __future__ import annotations

from dataclasses import dataclass

from ifgen_tools.qos import QosChoice
from ifgen_tools.verbs import GraphOptions


@dataclass(frozen=True, slots=True, kw_only=True)
class ListOptions(GraphOptions):
    """The options of `topic list`."""

    include_hidden: bool = False
    show_types: bool = False
    count_topics: bool = False
    verbose: bool = False


@dataclass(frozen=True, slots=True, kw_only=True)
class TopicOptions(GraphOptions):
    """The options of a verb that is about one topic."""

    topic_name: str


@dataclass(frozen=True, slots=True, kw_only=True)
class InfoOptions(TopicOptions):
    """The options of `topic info`."""

    verbose: bool = False


@dataclass(frozen=True, slots=True, kw_only=True)
class FindOptions(GraphOptions):
    """The options of `topic find`."""

    topic_type: str
    include_hidden: bool = False
    count_topics: bool = False


@dataclass(frozen=True, slots=True, kw_only=True)
class EchoOptions(TopicOptions):
    """The options of `topic echo`."""

    message_type: str | None
    once: bool
    timeout: float | None
    fields: tuple[str, ...]
    filter_expression: str | None
    csv: bool
    raw: bool
    full_length: bool
    truncate_length: int
    no_arr: bool
    no_str: bool
    flow_style: bool
    include_message_info: bool
    no_lost_messages: bool
    qos: QosChoice


@dataclass(frozen=True, slots=True, kw_only=True)
class PubOptions(TopicOptions):
    """The options of `topic pub`."""

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
class RateOptions(TopicOptions):
    """The options of `topic bw` and `topic delay`."""

    window: int


@dataclass(frozen=True, slots=True, kw_only=True)
class HzOptions(GraphOptions):
    """The options of `topic hz`."""

    topic_names: tuple[str, ...]
    window: int
    filter_expression: str | None
    wall_time: bool
