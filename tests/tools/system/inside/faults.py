"""Faults of every class, made by single edits of the files of a sound system."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from ifgen.diagnostics import Span
from ifgen.nodl.model import Category
from ifgen.nodl.syntax.tree import ListNode, ScalarNode
from ifgen_tools.system.build import Built
from ifgen_tools.system.model import Endpoint

SIDES = {
    Category.PUBLISHER: Category.SUBSCRIPTION,
    Category.SUBSCRIPTION: Category.PUBLISHER,
    Category.SERVICE_SERVER: Category.SERVICE_CLIENT,
    Category.SERVICE_CLIENT: Category.SERVICE_SERVER,
    Category.ACTION_SERVER: Category.ACTION_CLIENT,
    Category.ACTION_CLIENT: Category.ACTION_SERVER,
}
OTHER_TYPES = {
    "msg": "std_msgs/msg/UInt8",
    "srv": "example_interfaces/srv/AddTwoInts",
    "action": "tf2_msgs/action/LookupTransform",
}


@dataclass(frozen=True)
class Fault:
    """An edit of a file, and the rule that must tell of it."""

    rule: str
    what: str
    path: Path
    start: int
    end: int
    text: str

    def __str__(self) -> str:
        return f"{self.rule}: {self.what} in {self.path.name}"

    def applied(self) -> str:
        """The text of the file with the fault."""
        text = self.path.read_text()
        return text[: self.start] + self.text + text[self.end :]


def at(rule: str, what: str, span: Span, text: str) -> Fault:
    return Fault(rule, what, Path(span.source.path), span.start, span.end, text)


def in_text(rule: str, path: Path, old: str, new: str) -> Fault:
    """An edit of what a file has once at least."""
    start = path.read_text().index(old)
    return Fault(rule, f"{old!r} -> {new!r}", path, start, start + len(old), new)


def slip(name: str) -> str | None:
    """A name with two letters of its longest word swapped; None if it has none to swap."""
    word = max(re.split(r"[/_~]+", name), key=len)
    places = [i for i in range(1, len(word) - 1) if word[i] != word[i + 1] and word[i : i + 2].isalpha()]
    if len(word) < 4 or not places:
        return None
    i = places[-1]
    return name.replace(word, word[:i] + word[i + 1] + word[i] + word[i + 2 :], 1)


def of_built(built: Built) -> Iterator[Fault]:
    """The faults of a system that can be made wherever it has what they need."""
    ends = [end for end in built.system.endpoints if not end.is_of_framework and end.span]
    seen: set[tuple[object, int]] = set()
    for end in ends:
        place = (end.span.source.path, end.span.start) if end.span else None
        others = [other for other in ends if other.name == end.name and other.category is SIDES[end.category]]
        if place is None or place in seen or not others:
            continue
        seen.add(place)
        yield from _of_endpoint(end, others, ends)
    yield from _of_parameters(built)
    yield from _of_launch(built)


def _of_endpoint(end: Endpoint, others: list[Endpoint], ends: list[Endpoint]) -> Iterator[Fault]:
    assert end.span is not None
    text, span = end.span.source.text, end.span
    same = [each for each in ends if (each.name, each.category) == (end.name, end.category)]
    documents = {each.span.source.path for each in same if each.span}
    is_source = end.category in {Category.PUBLISHER, Category.SERVICE_SERVER, Category.ACTION_SERVER}
    typo = slip(end.written)
    if typo and end.remap is None and not (is_source and len(documents) > 1):
        rule = "system-near-name" if end.category.folder == "msg" else "system-no-server"
        yield at(rule, f"{end.node} {end.name} -> {typo}", span, typo)
    written = re.compile(r"type:\s*([\w/]+)").search(text, span.start)
    if written:
        other = OTHER_TYPES[end.category.folder]
        yield at("system-type", f"{end.node} {end.name}", Span(span.source, *written.span(1)), other)
    if end.qos is None or end.qos.span is None:
        return
    qos = end.qos.span
    profile = text[qos.start : qos.end]
    asked = {each.qos.reliability for each in others if each.qos}
    if is_source and end.qos.reliability == "RELIABLE" and "RELIABLE" in asked:
        yield at("system-qos", f"{end.node} {end.name}", qos, profile.replace("RELIABLE", "BEST_EFFORT"))
    if not is_source and profile.endswith("}"):
        for key in ("deadline_ns: 1000", "liveliness: MANUAL_BY_TOPIC"):
            if key.partition(":")[0] not in profile:
                yield at("system-qos", f"{end.node} {end.name} {key}", qos, f"{profile[:-1]}, {key}}}")
        if "durability" not in profile and all("durability" not in _profile(each) for each in others):
            more = f"{profile[:-1]}, durability: TRANSIENT_LOCAL}}"
            yield at("system-qos", f"{end.node} {end.name} latched", qos, more)


def _profile(end: Endpoint) -> str:
    span = end.qos.span if end.qos else None
    return span.source.text[span.start : span.end] if span else ""


def _of_parameters(built: Built) -> Iterator[Fault]:
    seen: set[tuple[object, int]] = set()
    for node in built.system.nodes:
        known = {each.name: each for each in node.description.parameters} if node.description else {}
        for given in node.parameters:
            declared, span = known.get(given.name), given.span
            if declared is None or span is None or (span.source.path, span.start) in seen:
                continue
            if span.source.text[span.start : span.end] != given.name:
                continue
            seen.add((span.source.path, span.start))
            if (typo := slip(given.name)) and not declared.is_required:
                yield at("system-no-parameter", f"{node.name} {given.name}", span, typo)
            elif typo:
                yield at("system-no-value", f"{node.name} {given.name}", span, typo)
            value = given.value
            if isinstance(value, ScalarNode) and value.span != span and declared.type.base != "string":
                yield at("system-value-type", f"{node.name} {given.name}", value.span, "[wrong]")
            elif isinstance(value, ListNode) and value.span != span:
                yield at("system-value-type", f"{node.name} {given.name}", value.span, "7")


def _of_launch(built: Built) -> Iterator[Fault]:
    seen: set[tuple[object, int]] = set()
    for node in built.system.nodes:
        for remap in node.remaps:
            span = remap.span
            if span is None or (span.source.path, span.start) in seen or not node.description:
                continue
            seen.add((span.source.path, span.start))
            if span.source.text[span.start : span.end] == remap.old:
                yield at("system-unused-remap", f"{node.name} {remap.old}", span, f"{remap.old}x")
    for section in built.system.sections:
        span = section.span
        if span is not None and any(section.pattern == name for name in section.receivers):
            yield at("system-no-receiver", section.pattern, span, f"{section.pattern}s")
