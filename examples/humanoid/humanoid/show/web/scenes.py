"""The scenes that visitors of the page choose: what a scenario asks of each node, and nodes set up for it."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from rcl_interfaces.srv import SetParameters
from rclpy.node import Node
from rclpy.parameter import Parameter

from ..crew import SIMULATOR
from ..scenarios import Parameters, ScenarioFileError, names, read

Answer = Callable[[bool, str], None]

_TASKS, _EVENTS = "high_level_task_manager", "audience"


class Refusal(ValueError):
    """A command is not done; the text says why."""


def require(is_there: bool, node: str) -> None:
    """Raise Refusal unless a node is there."""
    if not is_there:
        raise Refusal(f"{node} is not there")


@dataclass(frozen=True, slots=True)
class Scene:
    """What happens from time 0 on."""

    tasks: list[str] = field(default_factory=list)
    events: list[str] = field(default_factory=list)
    others: Parameters = field(default_factory=dict)  # of all other nodes


class Scenes:
    """The scenarios; `started` is the name or the file of the one that the nodes were started with."""

    def __init__(self, node: Node, started: str) -> None:
        self._started = started
        tuned = {SIMULATOR, *(name for scenario in names() for name in read(scenario))} - {_TASKS, _EVENTS}
        self._set = {name: node.create_client(SetParameters, f"/{name}/set_parameters") for name in tuned}

    def find(self, name: object) -> Scene:
        """A scenario by its name. Where it says nothing of obstacles, the floor is empty. Raises Refusal."""
        is_first = bool(self._started) and name == Path(self._started).stem
        if not isinstance(name, str) or not (is_first or name in names()):
            raise Refusal(f"there is no scenario {name!r}: choose one of {', '.join(names())}")
        try:
            nodes = dict(read(self._started if is_first else name))
        except ScenarioFileError as error:
            raise Refusal(str(error)) from None
        tasks = _texts(nodes.pop(_TASKS, {}).get("tasks"))
        events = _texts(nodes.pop(_EVENTS, {}).get("events"))
        obstacles = nodes.get(SIMULATOR, {}).get("obstacles", [])
        if is_first:  # what else it changes was set when the nodes started, and no scene changes it back
            nodes = {}
        nodes[SIMULATOR] = {**nodes.get(SIMULATOR, {}), "obstacles": obstacles}
        return Scene(tasks, events, nodes)

    def tune(self, nodes: Parameters, then: Callable[[], None], answer: Answer) -> None:
        """Set parameters, node after node, and go on; or answer why one is not set. Raises Refusal."""
        if not nodes:
            then()
            return
        (name, values), *rest = nodes.items()
        client = self._set[name]
        require(client.service_is_ready(), name)

        def end(done: Any) -> None:
            reasons = [
                f"{name}: {result.reason}" for result in done.result().results if not result.successful
            ]
            if reasons:
                answer(False, "; ".join(reasons))
                return
            try:
                self.tune(dict(rest), then, answer)
            except Refusal as refusal:
                answer(False, str(refusal))

        client.call_async(_request(values)).add_done_callback(end)


def _request(values: Mapping[str, Any]) -> SetParameters.Request:
    parameters = []
    for name, value in values.items():
        # Without a type, an empty list could be one of anything.
        kind = Parameter.Type.STRING_ARRAY if value == [] else None
        parameters.append(Parameter(name, kind, value).to_parameter_msg())
    return SetParameters.Request(parameters=parameters)


def _texts(values: Iterable[Any] | None) -> list[str]:
    return [str(value) for value in values or () if value]
