"""Which topics a command is about: by name, type or regular expression, as `ros2 bag` chooses them."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass

from ifgen_tools.types import message_name

SERVICE_EVENTS = "/_service_event"
"""The end of the topic on which the calls of a service are told."""


def is_hidden(topic: str) -> bool:
    """Whether a topic is left out of lists: a part of its name begins with `_`."""
    return any(part.startswith("_") for part in topic.split("/"))


def is_service_event(topic: str) -> bool:
    """Whether a topic tells of the calls of a service."""
    return topic.endswith(SERVICE_EVENTS)


def absolute(name: str) -> str:
    """A topic or a service as the graph has it."""
    return name if name.startswith("/") else f"/{name}"


@dataclass(frozen=True, slots=True)
class Selection:
    """The choice of topics and services.

    `regex` chooses besides what is named, and each `exclude...` takes away from all of that. With
    `all_topics` or `all_services`, the names do not matter.
    """

    topics: frozenset[str] = frozenset()
    services: frozenset[str] = frozenset()
    types: frozenset[str] = frozenset()
    regex: re.Pattern[str] | None = None
    all_topics: bool = False
    all_services: bool = False
    include_hidden: bool = False
    exclude_topics: frozenset[str] = frozenset()
    exclude_services: frozenset[str] = frozenset()
    exclude_types: frozenset[str] = frozenset()
    exclude_regex: re.Pattern[str] | None = None

    def takes(self, topic: str, type_name: str) -> bool:
        """Whether a topic is chosen."""
        name = topic.removesuffix(SERVICE_EVENTS) if is_service_event(topic) else topic
        if self.exclude_regex is not None and self.exclude_regex.search(name):
            return False
        if is_service_event(topic):
            return name not in self.exclude_services and (
                self.all_services or name in self.services or self._fits_regex(name)
            )
        if topic in self.exclude_topics or type_name in self.exclude_types:
            return False
        if topic in self.topics:
            return True
        if is_hidden(topic) and not self.include_hidden:
            return False
        return self.all_topics or type_name in self.types or self._fits_regex(topic)

    def _fits_regex(self, name: str) -> bool:
        return self.regex is not None and self.regex.search(name) is not None


def selection(
    *,
    topics: Sequence[str] = (),
    services: Sequence[str] = (),
    types: Sequence[str] = (),
    regex: re.Pattern[str] | None = None,
    exclude_topics: Sequence[str] = (),
    exclude_services: Sequence[str] = (),
    exclude_types: Sequence[str] = (),
    exclude_regex: re.Pattern[str] | None = None,
    all_topics: bool = False,
    all_services: bool = False,
    include_hidden: bool = False,
) -> Selection:
    """The choice that options make, with names as users write them."""
    return Selection(
        frozenset(map(absolute, topics)),
        frozenset(map(absolute, services)),
        frozenset(map(message_name, types)),
        regex,
        all_topics,
        all_services,
        include_hidden,
        frozenset(map(absolute, exclude_topics)),
        frozenset(map(absolute, exclude_services)),
        frozenset(map(message_name, exclude_types)),
        exclude_regex,
    )
