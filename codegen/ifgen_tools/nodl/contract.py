"""The two sides that `ifgen nodl conform` and `diff` compare, read from documents and from running nodes."""

from __future__ import annotations

import time
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path
from typing import TYPE_CHECKING, Final

from ifgen.command_kit.tool import ToolError
from ifgen.definition.type_description import TypeHashes, described_types
from ifgen.diagnostics import Diagnostic, InputError, UsageError
from ifgen.nodl import barriers
from ifgen.nodl.load import Loaded, load_document, registry_of
from ifgen.nodl.model import Category, Interface
from ifgen.nodl.verdict import verdict
from ifgen.reading.search_path import SearchPath

from ifgen_tools import discovery, ros_graph
from ifgen_tools.nodl.conformance import Choices, Report, Side, compare, side_of_document, side_of_node
from ifgen_tools.nodl.parameters import parameters_of

if TYPE_CHECKING:
    from rclpy.node import Node

    from ifgen_tools.session import Session, Transport

# Late imports: `launch` is found once the transport has been chosen.


_STRICT: Final = Choices()
_LATE: Final = 5.0  # [s]
_TURN: Final = 0.2  # [s]


@dataclass(frozen=True, slots=True)
class Contract:
    """A document that a node is to keep to, and where interfaces are looked for."""

    path: Path
    loaded: Loaded
    search: SearchPath

    @property
    def interface(self) -> Interface:
        """All that the document declares, and what each lifecycle node has, if it is one."""
        node = self.loaded.description
        if node.style != "lifecycle" or node.base is not None or node.reserved.endpoints:
            return self.loaded.whole
        base, _ = load_document(barriers.OFFICIAL["nodl_common_interfaces", "lifecycle_node"], SearchPath())
        assert base is not None
        return self.loaded.whole + base.whole

    def side(self, node: str, remaps: Sequence[tuple[str, str]] = ()) -> Side:
        """The side of the document, for a node of this full name that is started with these remaps."""
        return side_of_document(self.interface, node, remaps=remaps, hashes=self._hashes())

    def _hashes(self) -> dict[str, str]:
        """The hashes of the interfaces that can be found, and of what they consist of."""
        found: dict[str, str] = {}
        for type_name in {end.type_name for end in self.interface.endpoints}:
            try:
                registry = registry_of([type_name], self.search)
            except InputError:
                continue
            hashes = TypeHashes(registry)
            own = (each for each in registry if each.type_name == type_name)
            found.update((part.type_name, hashes.of(part)) for each in own for part in described_types(each))
        return found


def read(path: Path, include: Sequence[Path] = ()) -> Contract:
    """A document with its includes. Raises InputError with what is wrong, as `ifgen nodl validate` has it."""
    search = SearchPath((), include)
    found = verdict(path, search)
    if found.errors or found.loaded is None:
        raise InputError(found.errors)
    return Contract(path, found.loaded, search)


def check(
    session: Session,
    node: str,
    contract: Contract,
    choices: Choices = _STRICT,
    remaps: Sequence[tuple[str, str]] = (),
) -> Report:
    """The differences between a running node and its document.

    On a busy machine DDS tells of endpoints late, so what seems to be missing there is looked for again.
    """
    expected = contract.side(node, remaps)
    end = time.monotonic() + (_LATE if session.transport == "rclpy" else 0.0)
    while True:
        report = compare(expected, seen(session, node), choices)
        is_whole = all(each.kind != "missing" for each in report.differences)
        if is_whole or time.monotonic() > end:
            return report
        session.wait_for(lambda: False, _TURN)


def seen(session: Session, node: str) -> Side:
    """The side of a running node."""
    domain = session.context.get_domain_id() if session.transport == "local" else None
    parts = service_definitions(session.node, node, domain)
    return side_of_node(node, session.graph().endpoints, parameters_of(session, node), parts)


def service_definitions(
    observer: Node, node: str, local_domain: int | None
) -> dict[tuple[Category, str], dict[str, str]]:
    """The hashes of the parts of a node's services and actions, by category and name.

    DDS tells those of requests and responses, our transport those of whole services.
    """
    whole = {} if local_domain is None else discovery.service_hashes(local_domain)
    found: dict[tuple[Category, str], dict[str, str]] = {}
    for part in ros_graph.service_parts(observer):
        if part.node != node:
            continue
        action, sign, _ = part.service.partition("/_action/")
        kind = "action" if sign else "service"
        category = Category(f"{kind}_{'servers' if part.is_server else 'clients'}")
        hashes = found.setdefault((category, action), {})
        if (of_service := whole.get(part.gid)) is not None:
            hashes[part.type_name.removesuffix("_Request").removesuffix("_Response")] = of_service
        else:
            hashes[part.type_name] = part.type_hash
    return found


def remaps_of(texts: Iterable[str]) -> list[tuple[str, str]]:
    """Remaps that are written FROM:=TO. Raises UsageError for those that are not."""
    found = [text.partition(":=") for text in texts]
    for (old, sign, new), text in zip(found, texts, strict=True):
        if not (old and sign and new):
            message = f"`{text}` is no remap"
            raise UsageError(
                [Diagnostic("invalid-rule", message, help="write FROM:=TO, such as `scan:=/front/scan`")]
            )
    return [(old, new) for old, _, new in found]


def remaps_of_launch(path: Path, node: str, transport: Transport) -> list[tuple[str, str]]:
    """The remaps that a launch file gives a node of this full name: it is evaluated, but starts nothing.

    Raises ToolError, LaunchError.
    """
    from ifgen.config.settings import settle

    from ifgen_tools.launching.commands import activate

    chosen = activate(transport, settle().output)
    from launch import LaunchService
    from launch.actions import ExecuteLocal, IncludeLaunchDescription
    from launch.launch_context import ProcessToStart

    from ifgen_tools.launching.packages import UserPackages

    commands: list[Sequence[str]] = []

    class Recorder(LaunchService):
        """Notes commands, and starts none."""

        def start(self, actions: Sequence[ExecuteLocal], process: ProcessToStart) -> None:
            commands.append(process.command)

    recorder = Recorder(noninteractive=True)
    recorder.context.packages = UserPackages(settle().output, chosen)
    try:
        recorder.visit([IncludeLaunchDescription(str(path))])
    finally:
        recorder.context.files.close()
    names: list[str] = []
    for command in commands:
        remaps = list(_remaps(command))
        special = dict(remaps)
        own = special.get("__node", "")
        name = f"{special.get('__ns', '').rstrip('/')}/{own}"
        names.append(name)
        if own and name == node:
            return [(old, new) for old, new in remaps if not old.startswith("__")]
    listed = ", ".join(names) or "none"
    raise ToolError(f"{path} starts no node '{node}'", f"the nodes with a name there are {listed}")


def _remaps(command: Sequence[str]) -> Iterator[tuple[str, str]]:
    for flag, word in pairwise(command):
        if flag in {"-r", "--remap"} and ":=" in word:
            old, _, new = word.partition(":=")
            yield old, new
