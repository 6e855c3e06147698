"""Rules about what a launch file starts: names, programs, lifecycles, time, frames, recordings."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from itertools import pairwise

from ifgen.diagnostics import Diagnostic, Span
from ifgen.nodl.model import NodeDescription
from ifgen.nodl.syntax.tree import ListNode, ScalarNode

from ifgen_tools.system.build import full_name
from ifgen_tools.system.model import Command, NodeInstance, Parameter, Remap
from ifgen_tools.system.view import ALWAYS_THERE, SOURCES, View, at, finding, nearest, suggestion

_KIND = {"msg": "a topic", "srv": "a service", "action": "an action"}


def unused_remaps(view: View) -> Iterator[Diagnostic]:
    """Remaps of names that a node does not have."""
    used_globally: set[tuple[str, str]] = set()
    for node, _ in view.described:
        used_globally |= {(e.remap.old, e.remap.new) for e in node.endpoints if e.remap and e.remap.is_global}
    reported: set[Remap] = set()
    for node, _ in view.described:
        used = [end.remap for end in node.endpoints if end.remap]
        for remap in node.remaps:
            if remap in used or _may_be_inside(node, remap) or remap in reported:
                continue
            if remap.is_global and ((remap.old, remap.new) in used_globally or view.is_open):
                continue
            if remap.is_global:
                reported.add(remap)
            who = "no node has" if remap.is_global else f"{node.name} has"
            own = [end for end in node.endpoints if not end.is_of_framework]
            names = {name for end in own for name in (end.written, end.expanded)}
            near = nearest(remap.old, names)
            meant = next((end for end in own if near in {end.written, end.expanded}), None)
            what = "a name" if remap.is_global else "no name"
            yield finding(
                rule="system-unused-remap",
                message=f"{who} {what} `{remap.old}`, which is renamed to `{remap.new}`",
                labels=(at(remap.span), at(meant.span if meant else None, "not this?")),
                help=suggestion(remap.old, names) or _listed(names),
                severity="warning" if remap.is_global else "error",
            )


def remap_kinds(view: View) -> Iterator[Diagnostic]:
    """Remaps of a topic to the name of a service, and the like."""
    for endpoint in view.system.endpoints:
        if endpoint.remap is None or len(view.names[endpoint.name, endpoint.category.folder].ends) > 1:
            continue
        for folder, what in _KIND.items():
            other = view.names.get((endpoint.name, folder))
            if folder == endpoint.category.folder or other is None:
                continue
            own = _KIND[endpoint.category.folder]
            yield finding(
                rule="system-remap-kind",
                message=f"`{endpoint.written}` of {endpoint.node} is {own}, and `{endpoint.name}` is {what}",
                labels=(*view.about(endpoint, own), *view.about(other.ends[0], what)),
                help="the two never meet: rename it to the name of its own kind",
            )
            break


def same_nodes(view: View) -> Iterator[Diagnostic]:
    """Nodes that have the same full name."""
    first: dict[str, NodeInstance] = {}
    for node in view.system.nodes:
        other = first.setdefault(node.name, node)
        if other is not node:
            yield finding(
                rule="system-same-node",
                message=f"there are two nodes named {node.name}",
                labels=(at(node.span, "again"), at(other.span, "first here")),
                help="give one of them another name or namespace",
            )


def programs(view: View) -> Iterator[Diagnostic]:
    """Programs and packages that are not there, and with `complete` nodes without a document."""
    for node in view.system.nodes:
        if node.problem is not None:
            yield node.problem
        elif view.complete and node.is_open:
            yield finding(
                rule="system-no-document",
                message=f"nothing describes {node.name}: {node.package or 'no package'}/{node.executable}",
                labels=(at(node.span),),
                help=f"run it, and write its document: `ifgen nodl describe {node.name}`",
            )


def lifecycles(view: View) -> Iterator[Diagnostic]:
    """Managed nodes that nothing configures, and managers whose lists do not fit."""
    managed: set[str] = set()
    for manager, given, names in _managers(view):
        full = [full_name(name, manager.name) for name in names]
        managed |= set(full)
        yield from _of_manager(view, manager, given, full)
    called = {end.name for end in view.system.endpoints if end.category.singular == "service client"}
    for node, description in view.described:
        changes = {e.name for e in node.endpoints if e.expanded == f"{node.name}/change_state"}
        if not _is_lifecycle(description) or node.is_managed or node.name in managed or changes & called:
            continue
        if node.kind == "running" or (view.is_open and not view.complete and not managed):
            continue
        yield finding(
            rule="system-lifecycle",
            message=f"nothing configures {node.name}, which has a managed lifecycle",
            labels=(at(node.span, "stays unconfigured"), at(description.span, "lifecycle")),
            help="start it by LifecycleNode with `autostart`, or name it in a lifecycle manager",
        )


def _of_manager(
    view: View, manager: NodeInstance, given: Parameter, names: list[str]
) -> Iterator[Diagnostic]:
    known = [node.name for node, description in view.described if _is_lifecycle(description)]
    for name in names:
        node = view.nodes.get(name)
        if node is None or (node.description and name not in known):
            what = "is not started" if node is None else "has no managed lifecycle"
            if node is None and view.is_open and suggestion(name, known) is None and not view.complete:
                continue
            yield finding(
                rule="system-lifecycle",
                message=f"{manager.name} manages {name}, which {what}",
                labels=(at(given.span, "listed here"), at(node.span if node else None, "started here")),
                help=suggestion(name, known),
            )
    for position, name in enumerate(names):
        later = set(names[position + 1 :])
        node = view.nodes.get(name)
        for end in node.endpoints if node else ():
            needs = end.category.singular.endswith("client") or (end.terms and end.terms.required)
            meeting = view.names[end.name, end.category.folder]
            servers = {provider.node for provider in meeting.providers}
            if end.category in SOURCES or end.is_of_framework or not needs or not servers & later:
                continue
            if servers <= later:
                yield finding(
                    rule="system-lifecycle",
                    message=f"{manager.name} activates {name} before {min(servers)}, whose `{end.name}` "
                    f"it needs",
                    labels=(at(given.span, "in this order"), *view.about(end, "needed here")),
                    help="list providers before those that use them",
                    severity="warning",
                )
                break


def sim_time(view: View) -> Iterator[Diagnostic]:
    """Nodes that wait for a simulated time that nobody sends, or that differ in the time that they use."""
    clock = view.names.get(("/clock", "msg"))
    senders = {end.node for end in clock.providers} if clock else set[str]()
    simulated = [(node, given) for node, _ in view.described if (given := _uses_sim_time(node)) is not None]
    on = [(node, given) for node, given in simulated if given.value and _truth(given)]
    if on and not senders and not view.is_open and not any(map(_may_simulate, view.system.commands)):
        node, given = on[0]
        yield finding(
            rule="system-sim-time",
            message=f"{node.name} waits for simulated time, and nobody publishes /clock",
            labels=(at(given.span), at(node.span, f"{node.name} starts here")),
        )
    others = [
        node for node, _ in view.described if node.name not in senders and node not in [n for n, _ in on]
    ]
    if on and others:
        node, given = on[0]
        odd = others[0]
        yield finding(
            rule="system-sim-time",
            message=f"{node.name} uses simulated time, and {odd.name} does not",
            labels=(at(odd.span, "by the clock of the machine"), at(given.span, "simulated")),
            help="set `use_sim_time` for all nodes alike: SetUseSimTime does",
            severity="warning",
        )


def frames(view: View) -> Iterator[Diagnostic]:
    """Coordinate frames without a broadcaster, and frames with two parents."""
    parents: dict[str, tuple[str, NodeInstance]] = {}
    known: set[str] = set()
    for node, child, parent in _transforms(view):
        known |= {child, parent}
        first_parent, first = parents.setdefault(child, (parent, node))
        if first is not node:
            yield finding(
                rule="system-two-parents",
                message=f"{first.name} and {node.name} both broadcast the frame `{child}`, "
                f"in `{first_parent}` and in `{parent}`",
                labels=(
                    *(at(place, "again") for place in _frame_places(node)),
                    *(at(place, "first here") for place in _frame_places(first)),
                ),
                help="a frame has one parent, and one node that says where it is",
            )
    for node, description in view.described:
        for frame in description.frames.uses:
            if frame in known or (view.is_open and not view.complete and not suggestion(frame, known)):
                continue
            yield finding(
                rule="system-no-frame",
                message=f"{node.name} asks for the frame `{frame}`, which nobody broadcasts",
                labels=(at(description.frames.span), at(node.span, f"{node.name} starts here")),
                help=suggestion(frame, known),
                severity=view.severity,
            )


def recordings(view: View) -> Iterator[Diagnostic]:
    """Topics that a launch file records, and nobody publishes."""
    published = {m.name for m in view.meetings if m.folder == "msg" and m.providers}
    for command in view.system.commands:
        for topic in _recorded(command.words):
            near = suggestion(topic, published)
            if topic in published or topic in ALWAYS_THERE or (view.is_open and not near):
                continue
            yield finding(
                rule="system-recording",
                message=f"`{topic}` is recorded, and nobody publishes it",
                labels=(at(command.span),),
                help=near,
                severity="warning",
            )


def _may_be_inside(node: NodeInstance, remap: Remap) -> bool:
    """Whether a remap is of what nodes have through their libraries, or of a part of an action."""
    old = full_name(remap.old.rpartition(":")[2], node.name)
    if f"/{old.rpartition('/')[2]}" in ALWAYS_THERE or old.endswith("/robot_description"):
        return True
    is_of_other = ":" in remap.old and remap.old.partition(":")[0] != node.name.rpartition("/")[2]
    return is_of_other or remap.old.startswith("__") or "/_action/" in old


def _listed(names: Iterable[str]) -> str | None:
    known = ", ".join(sorted(names)[:8])
    return f"it has {known}" if known else None


def _is_lifecycle(description: NodeDescription) -> bool:
    return description.style == "lifecycle" or bool(description.base and description.base.is_lifecycle)


def _managers(view: View) -> Iterator[tuple[NodeInstance, Parameter, list[str]]]:
    """The nodes that manage others: those of nav2 get their names as the parameter `node_names`."""
    for node in view.system.nodes:
        given = node.value("node_names")
        if given is not None and isinstance(given.value, ListNode) and "lifecycle" in node.executable:
            items = given.value.items
            yield node, given, [str(each.value) for each in items if isinstance(each, ScalarNode)]


def _may_simulate(command: Command) -> bool:
    """Whether a program that is no node may be a simulator: those of ROS are none."""
    return bool(command.words) and command.words[0].rpartition("/")[2] not in {"ros2", "ifgen"}


def _uses_sim_time(node: NodeInstance) -> Parameter | None:
    return node.value("use_sim_time")


def _truth(given: Parameter) -> bool:
    return isinstance(given.value, ScalarNode) and given.value.value is True


def _transforms(view: View) -> Iterator[tuple[NodeInstance, str, str]]:
    """Each frame that a node broadcasts, with its parent."""
    for node in view.system.nodes:
        if node.description is not None:
            yield from ((node, child, parent) for child, parent in node.description.frames.broadcasts)
        elif node.kind == "transforms":
            named = dict(pairwise(node.arguments))
            if "--child-frame-id" in named and "--frame-id" in named:
                yield node, named["--child-frame-id"], named["--frame-id"]
            elif len(node.arguments) in {8, 9}:  # x y z and angles before ROS 2 Humble
                yield node, node.arguments[-1], node.arguments[-2]


def _frame_places(node: NodeInstance) -> Iterator[Span | None]:
    yield node.description.frames.span if node.description else None
    yield node.span


def _recorded(words: tuple[str, ...]) -> Iterator[str]:
    """The topics of `ros2 bag record`, by their names."""
    for position, word in enumerate(words[:-1]):
        if word == "bag" and words[position + 1] == "record":
            yield from (each for each in words[position + 2 :] if each.startswith("/"))


def set_later(command: Command) -> tuple[str, str, str] | None:
    """The node, the parameter and the value of `ros2 param set`; None for another command."""
    words = command.words
    for position, word in enumerate(words[:-4]):
        if word == "param" and words[position + 1] == "set":
            return words[position + 2], words[position + 3], words[position + 4]
    return None
