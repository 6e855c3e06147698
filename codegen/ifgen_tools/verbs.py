"""The options of verbs as typed values, which click would pass as loose keywords."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import wraps
from typing import Literal, TypeAlias, TypeVar

TransportChoice: TypeAlias = Literal["local", "rclpy", "auto"]
"""The values of `--transport`."""

_Options = TypeVar("_Options")
_Result = TypeVar("_Result")


@dataclass(frozen=True, slots=True, kw_only=True)
class SessionOptions:
    """The options of a verb that runs a node of its own."""

    transport: TransportChoice = "auto"
    as_json: bool = False


@dataclass(frozen=True, slots=True, kw_only=True)
class GraphOptions(SessionOptions):
    """The options of a verb that looks at the graph, for `spin_time` [s] if that is given."""

    spin_time: float | None = None
    use_sim_time: bool = False


def takes(cls: type[_Options]) -> Callable[[Callable[[_Options], _Result]], Callable[..., _Result]]:
    """Let a command take its options as one dataclass, whose fields have the names of click's parameters."""

    def decorate(command: Callable[[_Options], _Result]) -> Callable[..., _Result]:
        @wraps(command)
        def run(**values: object) -> _Result:
            return command(cls(**values))

        return run

    return decorate
