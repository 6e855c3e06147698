"""The changes between two manifests: patch, minor or major for each interface of a system."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, field
from typing import Final, Literal

from ifgen.diagnostics import Diagnostic, Label, Span
from ifgen.nodl.model import QosProfile, qos_mismatch

from ifgen_tools.system.manifest import Manifest
from ifgen_tools.system.model import Endpoint
from ifgen_tools.system.view import SOURCES

Level = Literal["patch", "minor", "major"]
Side = Literal["provided", "required"]
LEVELS: Final = ("patch", "minor", "major")
_KIND: Final = {"msg": "topic", "srv": "service", "action": "action"}


@dataclass(frozen=True, slots=True)
class Change:
    """A difference of one interface of a system, on one side of it, and how much it breaks."""

    level: Level
    side: Side
    kind: str
    name: str
    what: str
    spans: tuple[Span, ...] = field(default=(), compare=False, repr=False)

    def __str__(self) -> str:
        return f"{self.level:5}  {self.side} {self.kind} {self.name}: {self.what}"


def changes(old: Manifest, new: Manifest) -> list[Change]:
    """Every change from an older manifest, the worst first."""
    before, after = _interfaces(old), _interfaces(new)
    found = [change for key in sorted({*before, *after}) for change in _of_one(key, before, after)]
    return sorted(found, key=lambda each: -LEVELS.index(each.level))


def diagnostic(change: Change) -> Diagnostic:
    """A change as a finding, for tools: an error if it breaks others."""
    first, *others = change.spans or (None,)
    rule: dict[Level, str] = {"major": "system-major", "minor": "system-minor", "patch": "system-patch"}
    return Diagnostic(
        rule[change.level],
        f"{change.side} {change.kind} `{change.name}`: {change.what}",
        Label(first, "now") if first else None,
        tuple(Label(each, "before") for each in others if each),
        severity="error" if change.level == "major" else "warning",
    )


_Key = tuple[Side, str, str]
_Maker = Callable[[Level, str], Change]


def _interfaces(manifest: Manifest) -> dict[_Key, list[Endpoint]]:
    found: dict[_Key, list[Endpoint]] = {}
    for end in manifest.endpoints:
        side: Side = "provided" if end.category in SOURCES else "required"
        found.setdefault((side, end.category.folder, end.name), []).append(end)
    return found


def _of_one(
    key: _Key, before: dict[_Key, list[Endpoint]], after: dict[_Key, list[Endpoint]]
) -> Iterator[Change]:
    side, folder, name = key
    old, new = before.get(key, []), after.get(key, [])

    def change(level: Level, what: str) -> Change:
        spans = tuple(end.span for end in (*new[:1], *old[:1]) if end.span)
        return Change(level, side, _KIND[folder], name, what, spans)

    if not old:
        inside = ("provided", folder, name) in after
        is_minor = side == "provided" or inside
        yield change("minor" if is_minor else "major", f"new, of {_nodes(new)}")
        return
    if not new:
        yield change("major" if side == "provided" else "patch", f"gone, of {_nodes(old)}")
        return
    yield from _of_types(old, new, change)
    yield from _of_profiles(side, old, new, change)
    if (one := _nodes(old)) != (other := _nodes(new)):
        yield change("patch", f"of {other}, was of {one}")


def _of_types(old: list[Endpoint], new: list[Endpoint], change: _Maker) -> Iterator[Change]:
    was, now = ({end.type_name for end in ends} for ends in (old, new))
    if was != now:
        yield change("major", f"is {' and '.join(sorted(now))}, was {' and '.join(sorted(was))}")
        return
    hashes_before, hashes = ({end.type_hash for end in ends if end.type_hash} for ends in (old, new))
    if hashes and hashes_before and hashes != hashes_before:
        yield change("major", f"another definition of {' and '.join(sorted(now))}")
    versions_before, versions = (
        {end.terms.version for end in ends if end.terms and end.terms.version} for ends in (old, new)
    )
    if versions != versions_before:
        level = _of_versions(versions_before, versions)
        yield change(level, f"version {_listed(versions)}, was {_listed(versions_before)}")


def _of_profiles(side: Side, old: list[Endpoint], new: list[Endpoint], change: _Maker) -> Iterator[Change]:
    was = {end.node: end.qos for end in old}
    fallback = old[0].qos
    for end in new:
        before, now = was.get(end.node, fallback), end.qos
        if before is None or now is None or before == now:
            continue
        # The most that the old profile satisfied, or the least that it asked for, is the old profile itself.
        offered, requested = (now, before) if side == "provided" else (before, now)
        if why := qos_mismatch(offered, requested):
            yield change("major", f"QoS of {end.node}: {why}")
        elif side == "provided" and qos_mismatch(before, now):
            yield change("minor", f"QoS of {end.node}: a stronger offer")
        else:
            yield change("patch", f"QoS of {end.node}: {_difference(before, now)}")


def _difference(before: QosProfile, now: QosProfile) -> str:
    names = ("history", "depth", "reliability", "durability", "deadline_ns", "lifespan_ns", "liveliness")
    differing = [name for name in names if getattr(before, name) != getattr(now, name)]
    return ", ".join(f"{name} {getattr(before, name)} -> {getattr(now, name)}" for name in differing)


def _of_versions(before: set[str], now: set[str]) -> Level:
    if len(before) != 1 or len(now) != 1:
        return "minor"
    old, new = (next(iter(each)).partition("..")[0].split(".") for each in (before, now))
    if old[0] != new[0]:
        return "major"
    return "minor" if old[1:2] != new[1:2] else "patch"


def _nodes(ends: Iterable[Endpoint]) -> str:
    return _listed({end.node for end in ends})


def _listed(texts: Iterable[str]) -> str:
    return ", ".join(sorted(texts)) or "none"
