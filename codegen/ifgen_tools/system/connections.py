"""Rules about who meets whom: names, types, definitions, QoS, rates, and terms of the two sides."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Final

from ifgen.definition.meaning.comparison import mismatches
from ifgen.definition.meaning.values import Meaning
from ifgen.diagnostics import Diagnostic
from ifgen.nodl.model import Category, NodeDescription, qos_mismatch

from ifgen_tools.system.model import Endpoint, NodeInstance
from ifgen_tools.system.view import (
    ALWAYS_THERE,
    SOURCES,
    Meeting,
    View,
    at,
    finding,
    is_near,
    nearest,
    suggestion,
)

_VERB = {
    Category.PUBLISHER: "publishes",
    Category.SUBSCRIPTION: "subscribes to",
    Category.SERVICE_SERVER: "serves",
    Category.SERVICE_CLIENT: "calls",
    Category.ACTION_SERVER: "serves",
    Category.ACTION_CLIENT: "calls",
}
_VELOCITIES = ("geometry_msgs/msg/Twist", "geometry_msgs/msg/TwistStamped")
"""Commands of a base: what drives it listens to one writer."""


def near_names(view: View) -> Iterator[Diagnostic]:
    """A topic with one side only, and one of the same type whose name is almost the same."""
    reported: set[str] = set()
    for meeting in _lonely(view, "msg"):
        one = meeting.ends[0]
        others = _others_of(view, one)
        if one.name in reported or _is_namespace_error(view, one, others):
            continue
        near = nearest(one.name, (other.name for other in others))
        for other in (each for each in others if each.name == near):
            reported |= {one.name, other.name}
            yield finding(
                rule="system-near-name",
                message=f"{one.node} {_VERB[one.category]} `{one.name}`, and {other.node} "
                f"{_VERB[other.category]} `{other.name}`: they never meet",
                labels=(*view.about(one, f"as `{one.name}`"), *view.about(other, f"as `{other.name}`")),
                help=f"did you mean `{other.name}`?",
                severity=view.severity,
            )
            break


def namespaces(view: View) -> Iterator[Diagnostic]:
    """A topic with one side only, whose other side is the same but for the namespace of a node."""
    reported: set[str] = set()
    for folder in ("msg", "srv", "action"):
        for meeting in _lonely(view, folder):
            one = meeting.ends[0]
            for other in _others_of(view, one):
                if one.name in reported or not _differ_by_namespace(one, other):
                    continue
                reported |= {one.name, other.name}
                inner = one if one.name.count("/") > other.name.count("/") else other
                yield finding(
                    rule="system-namespace",
                    message=f"{one.node} {_VERB[one.category]} `{one.name}`, and {other.node} "
                    f"{_VERB[other.category]} `{other.name}`: only the namespace differs",
                    labels=(
                        *view.about(one, f"this is `{one.name}`"),
                        *view.about(other, f"this is `{other.name}`"),
                    ),
                    help=f"`{inner.written}` of {inner.node} is `{inner.name}` within its namespace: "
                    "start both in one namespace, or remap one of the two",
                    severity=view.severity,
                )


def servers(view: View) -> Iterator[Diagnostic]:
    """Services and actions with several servers, or with none."""
    for meeting in view.meetings:
        own = [end for end in meeting.providers if not end.is_of_framework]
        if meeting.folder != "msg" and len(own) > 1:
            first, second = own[:2]
            yield finding(
                rule="system-two-servers",
                message=f"{first.node} and {second.node} both serve `{meeting.name}`",
                labels=(*view.about(second, "again"), *view.about(first, "served first here")),
                help="a client gets answers of either: remap one of them",
            )
    for folder in ("srv", "action"):
        for meeting in _lonely(view, folder):
            one = meeting.ends[0]
            if one.category in SOURCES:
                continue
            others = _others_of(view, one, alone=False)
            near = nearest(one.name, (other.name for other in others))
            if _is_namespace_error(view, one, others) or (view.is_open and not near and not view.complete):
                continue
            where = next((other for other in others if other.name == near), None)
            yield finding(
                rule="system-no-server",
                message=f"{one.node} calls `{one.name}`, which nobody serves",
                labels=(
                    *view.about(one, "no server"),
                    *(view.about(where, f"this is `{where.name}`") if where else ()),
                ),
                help=f"did you mean `{near}`?" if near else suggestion(one.name, (e.name for e in others)),
                severity=view.severity,
            )


def required(view: View) -> Iterator[Diagnostic]:
    """Ends that need another side, and have none; with `complete` outputs that nobody takes, too."""
    for endpoint in view.system.endpoints:
        meeting = view.names[endpoint.name, endpoint.category.folder]
        others = meeting.users if endpoint.category in SOURCES else meeting.providers
        if others or endpoint.name in ALWAYS_THERE:
            continue
        if endpoint.terms and endpoint.terms.required:
            candidates = {e.name for e in view.system.endpoints if e.type_name == endpoint.type_name}
            if view.is_open and not view.complete and not nearest(endpoint.name, candidates):
                continue
            yield finding(
                rule="system-required",
                message=f"{endpoint.node} requires `{endpoint.name}`, and nobody is at the other side",
                labels=(*view.about(endpoint, "nobody there"), at(endpoint.terms.span, "required here")),
                help=suggestion(endpoint.name, candidates - {endpoint.name}),
            )
        elif view.complete and endpoint.category is Category.PUBLISHER and not endpoint.is_of_framework:
            yield finding(
                rule="system-unused-output",
                message=f"nobody subscribes to `{endpoint.name}`",
                labels=(at(endpoint.span, f"{endpoint.node} publishes it"),),
                severity="warning",
            )


def types(view: View) -> Iterator[Diagnostic]:
    """Ends of one name with different types, or with different definitions of one type."""
    for meeting in view.meetings:
        first = meeting.ends[0]
        for end in meeting.ends[1:]:
            if end.type_name != first.type_name:
                yield finding(
                    rule="system-type",
                    message=f"`{meeting.name}` is {first.type_name} for {first.node}, "
                    f"and {end.type_name} for {end.node}",
                    labels=(*view.about(end, end.type_name), *view.about(first, first.type_name)),
                    help="ends of different types never meet",
                )
                break
        for provider, user in meeting.pairs():
            if provider.type_hash and user.type_hash and provider.type_hash != user.type_hash:
                yield finding(
                    rule="system-hash",
                    message=f"{provider.node} and {user.node} have different definitions of "
                    f"{user.type_name}, which `{meeting.name}` is of",
                    labels=(
                        *view.about(user, user.type_hash[:15]),
                        *view.about(provider, provider.type_hash[:15]),
                    ),
                    help="`ifgen diff` shows what differs: build both with the same version of its package",
                )
                break


def qos(view: View) -> Iterator[Diagnostic]:
    """Profiles that never fit, and latched topics that late subscribers miss."""
    for meeting in view.meetings:
        for provider, user in meeting.pairs():
            if provider.qos is None or user.qos is None:
                continue
            why = qos_mismatch(provider.qos, user.qos)
            if meeting.folder == "srv":
                why = why or qos_mismatch(user.qos, provider.qos)
            if why is not None:
                yield finding(
                    rule="system-qos",
                    message=f"`{meeting.name}`: {provider.node} and {user.node} never meet: {why}",
                    labels=(
                        at(user.qos.span, "requested here"),
                        at(provider.qos.span, "offered here"),
                        *view.about(user, user.name),
                        *view.about(provider, provider.name),
                    ),
                )
            elif _is_missed(view, provider, user):
                yield finding(
                    rule="system-late-joiner",
                    message=f"{provider.node} keeps `{meeting.name}` for late subscribers, and {user.node} "
                    "does not ask for what was sent before it came",
                    labels=(
                        at(user.qos.span, "VOLATILE"),
                        at(provider.qos.span, "TRANSIENT_LOCAL, and sent by no timer"),
                    ),
                    help="write `durability: TRANSIENT_LOCAL` at the subscription",
                    severity="warning",
                )


def rates(view: View) -> Iterator[Diagnostic]:
    """Publishers that send less often than a subscription needs."""
    for meeting in view.meetings:
        for provider, user in meeting.pairs():
            sent = _rate(view, provider)
            asked, where = _asked(user)
            if sent is None or asked is None or sent * (1 + 1e-9) >= asked:
                continue
            yield finding(
                rule="system-rate",
                message=f"{provider.node} sends `{meeting.name}` at {sent:g} Hz, "
                f"and {user.node} needs {asked:g} Hz",
                labels=(
                    *view.about(user, where),
                    *view.about(provider, f"sent at {sent:g} Hz"),
                ),
            )


def writers(view: View) -> Iterator[Diagnostic]:
    """Topics that one node alone may publish, and several do."""
    for meeting in view.meetings:
        nodes = {end.node: end for end in meeting.providers}
        if meeting.folder != "msg" or len(nodes) < 2:
            continue
        claim = next((end for end in meeting.ends if end.terms and end.terms.exclusive), None)
        is_velocity = meeting.providers[0].type_name in _VELOCITIES
        if claim is None and not (is_velocity and meeting.users):
            continue
        first, second, *_ = nodes.values()
        yield finding(
            rule="system-two-writers",
            message=f"{first.node} and {second.node} both publish `{meeting.name}`"
            + (f", which {claim.node} wants from one node alone" if claim else ", which drives a base"),
            labels=(
                *view.about(second, "again"),
                *view.about(first, "published first here"),
                at(claim.terms.span, "exclusive") if claim and claim.terms else None,
            ),
            help="put a node between them that chooses, such as a mux, and remap both to it",
            severity="error" if claim else "warning",
        )


_RULES_OF_MEANING: Final = {"unit": "system-unit", "frame": "system-frame"}


def meanings(view: View) -> Iterator[Diagnostic]:
    """Units, frames and versions that the two sides say differently."""
    for meeting in view.meetings:
        for provider, user in meeting.pairs():
            if provider.terms is None or user.terms is None:
                continue
            labels = (at(user.terms.span, user.node), at(provider.terms.span, provider.node))
            sent = Meaning(unit=provider.terms.unit or None, frame=provider.terms.frame or None)
            taken = Meaning(unit=user.terms.unit or None, frame=user.terms.frame or None)
            for difference in mismatches(sent, taken):
                yield finding(
                    rule=_RULES_OF_MEANING[difference.aspect],
                    message=f"{provider.node} sends `{meeting.name}` in the {difference.aspect} "
                    f"`{difference.one}`, and {user.node} takes it for `{difference.other}`",
                    labels=labels,
                    help="a factor lies between them" if difference.is_scale else None,
                )
            given, wanted = provider.terms.version, user.terms.version
            if given and wanted and (why := refused_version(given, wanted)):
                yield finding(
                    rule="system-version",
                    message=f"{user.node} accepts {wanted} of `{meeting.name}`, "
                    f"and {provider.node} has {given}",
                    labels=labels,
                    help=why,
                    severity="error" if "major" in why else "warning",
                )


def duplicates(view: View) -> Iterator[Diagnostic]:
    """Ends of one node that have the same name once they are renamed."""
    for node in view.system.nodes:
        first: dict[tuple[Category, str], Endpoint] = {}
        for end in node.endpoints:
            other = first.setdefault((end.category, end.name), end)
            if other is not end and other.written != end.written:
                yield finding(
                    rule="system-duplicate",
                    message=f"{node.name} has two {end.category.singular}s named `{end.name}`",
                    labels=(*view.about(end, "again"), *view.about(other, "first here")),
                    help="their messages cannot be told apart: rename one of them",
                )


def refused_version(given: str, wanted: str) -> str | None:
    """The reason why a version is not accepted: `2.1` accepts 2.1 and later, `2.1..3` up to any 3."""
    low, _, high = wanted.partition("..")
    least = [int(part) for part in low.split(".")]
    has = [int(part) for part in given.partition("..")[0].split(".")]
    if not least[0] <= has[0] <= int(high or least[0]):
        return "another major version: they do not understand each other"
    if has[0] == least[0] and has[1:2] < least[1:2]:
        return "an earlier minor version, which may lack what is needed"
    return None


def _lonely(view: View, folder: str) -> Iterator[Meeting]:
    """The meetings of a kind with one side only, without those that every node has."""
    for meeting in view.meetings:
        if meeting.folder != folder or meeting.name in ALWAYS_THERE:
            continue
        if bool(meeting.providers) != bool(meeting.users) and not meeting.ends[0].is_of_framework:
            yield meeting


def _others_of(view: View, one: Endpoint, *, alone: bool = True) -> list[Endpoint]:
    """The ends of the other side that could have been meant, those that nobody meets first."""
    is_source = one.category in SOURCES
    found: list[Endpoint] = []
    for meeting in view.meetings:
        others = meeting.users if is_source else meeting.providers
        if meeting.folder != one.category.folder or meeting.name == one.name:
            continue
        found += (each for each in others if each.type_name == one.type_name and not each.is_of_framework)
    # A subscriber of a topic that has publishers lacks nothing.
    if is_source and alone:
        found = [each for each in found if not view.names[each.name, each.category.folder].providers] + [
            each for each in found if is_near(each.name, one.name)
        ]
    return sorted(found, key=lambda each: len(view.names[each.name, each.category.folder].ends))


def _is_namespace_error(view: View, one: Endpoint, others: list[Endpoint]) -> bool:
    return any(_differ_by_namespace(one, other) for other in others)


def _differ_by_namespace(one: Endpoint, other: Endpoint) -> bool:
    """Whether the names of two ends are the same but for the namespace that one of their nodes is in."""
    inner, outer = (one, other) if len(one.name) > len(other.name) else (other, one)
    namespace = inner.node.rpartition("/")[0]
    return bool(namespace) and not inner.written.startswith("~") and inner.name == namespace + outer.name


def _is_missed(view: View, provider: Endpoint, user: Endpoint) -> bool:
    assert provider.qos is not None and user.qos is not None
    if provider.qos.durability != "TRANSIENT_LOCAL" or user.qos.durability not in {None, "VOLATILE"}:
        return False
    return _rate(view, provider) is None


def _rate(view: View, publisher: Endpoint) -> float | None:
    """The rate [Hz] at which a topic is sent, as its terms or the timers of its node say."""
    if publisher.terms and publisher.terms.rate:
        return publisher.terms.rate
    node = view.nodes.get(publisher.node)
    if node is None or node.description is None:
        return None
    return _timer_rate(node, node.description, publisher.written)


def _timer_rate(node: NodeInstance, description: NodeDescription, name: str) -> float | None:
    for timer in description.timers:
        if name in timer.publishes:
            period = timer.period
            if timer.period_parameter:
                declared = (p.default for p in description.parameters if p.name == timer.period_parameter)
                given = node.value(timer.period_parameter)
                number = getattr(given.value, "value", None) if given else next(declared, None)
                period = number if isinstance(number, float) else None
            return 1 / period if period else None
    return None


def _asked(user: Endpoint) -> tuple[float | None, str]:
    """The rate [Hz] that a subscription needs, and what says so."""
    if user.terms and user.terms.rate:
        return user.terms.rate, f"needs {user.terms.rate:g} Hz"
    if user.qos and user.qos.deadline_ns:
        return 1e9 / user.qos.deadline_ns, f"its deadline is {user.qos.deadline_ns / 1e6:g} ms"
    return None, ""
