"""The file in which `ifgen.observing.node_observer` passes its observations to the command that runs it."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from enum import IntEnum
from pathlib import Path
from typing import Any, Final

from ifgen.graph.model import SeenEndpoint
from ifgen.observing import graph_observation


class ParameterType(IntEnum):
    """The numbers of parameter types in rcl_interfaces/msg/ParameterType."""

    NOT_SET = 0
    BOOL = 1
    INTEGER = 2
    DOUBLE = 3
    STRING = 4
    BYTE_ARRAY = 5
    BOOL_ARRAY = 6
    INTEGER_ARRAY = 7
    DOUBLE_ARRAY = 8
    STRING_ARRAY = 9


TYPES: Final[Mapping[int, str]] = {
    ParameterType.BOOL: "bool",
    ParameterType.INTEGER: "int",
    ParameterType.DOUBLE: "double",
    ParameterType.STRING: "string",
    ParameterType.BYTE_ARRAY: "byte_array",
    ParameterType.BOOL_ARRAY: "bool_array",
    ParameterType.INTEGER_ARRAY: "int_array",
    ParameterType.DOUBLE_ARRAY: "double_array",
    ParameterType.STRING_ARRAY: "string_array",
}
"""The types of parameters as NoDL spells them; one that is not set has none."""


@dataclass(frozen=True, slots=True)
class SeenParameter:
    """A parameter with its value, None if it has none, and what its descriptor says; `step` 0 is any step."""

    name: str
    type: str
    value: Any
    description: str
    read_only: bool
    additional_constraints: str
    bounds: tuple[float, float] | None
    step: float


@dataclass(frozen=True, slots=True)
class Seen:
    """All nodes, all endpoints, and the parameters of the chosen node; None if it did not report them."""

    nodes: tuple[str, ...]
    endpoints: tuple[SeenEndpoint, ...]
    parameters: tuple[SeenParameter, ...] | None


def command(file: Path, nodes: int, node: str | None) -> list[str]:
    """The arguments that run the observer by `ifgen.running.run`; it waits for the given number of nodes."""
    return ["-m", "ifgen.observing.node_observer", str(file), str(nodes), *([node] if node else [])]


def choose(nodes: Sequence[str], wanted: str | None) -> str | None:
    """The full name of the node that was asked for, or of the only one; None if it is not clear which."""
    if wanted is None:
        found = list(nodes)
    else:
        found = [name for name in nodes if name == wanted or name.rpartition("/")[2] == wanted]
    return found[0] if len(found) == 1 else None


def write(file: Path, seen: Seen) -> None:
    """Write down what was seen."""
    graph_observation.write(file, seen.nodes, seen.endpoints)
    if seen.parameters is not None:
        parameters = [asdict(parameter) for parameter in seen.parameters]
        _beside(file).write_text(json.dumps(parameters), encoding="utf-8")


def read(file: Path) -> Seen | None:
    """The observations in the file; None if the observer ended before it wrote them."""
    graph = graph_observation.read(file)
    if graph is None:
        return None
    parameters: tuple[SeenParameter, ...] | None = None
    if _beside(file).is_file():
        found = json.loads(_beside(file).read_text(encoding="utf-8"))
        parameters = tuple(_parameter(**each) for each in found)
    return Seen(*graph, parameters)


def _beside(file: Path) -> Path:
    return file.with_suffix(".parameters.json")


def _parameter(bounds: list[float] | None, **others: Any) -> SeenParameter:
    return SeenParameter(**others, bounds=(bounds[0], bounds[1]) if bounds else None)
