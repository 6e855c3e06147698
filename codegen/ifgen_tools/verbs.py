"""The options of verbs as typed values, and options with several values after them."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import wraps
from typing import Any, Literal, TypeAlias, TypeVar

import click

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


@dataclass(frozen=True, slots=True, kw_only=True)
class ListOptions(GraphOptions):
    """The options of a verb `list`."""

    include_hidden: bool = False
    show_types: bool = False
    count: bool = False
    verbose: bool = False


@dataclass(frozen=True, slots=True, kw_only=True)
class FindOptions(GraphOptions):
    """The options of a verb `find`."""

    type_name: str
    include_hidden: bool = False
    count: bool = False


@dataclass(frozen=True, slots=True, kw_only=True)
class NameOptions(GraphOptions):
    """The options of the verbs `type` and `info`, which are about one topic, service or action."""

    name: str
    show_types: bool = False
    count: bool = False
    verbose: bool = False


@dataclass(frozen=True, slots=True, kw_only=True)
class NodeOptions(GraphOptions):
    """The options of a verb about one node, which may take `patience` [s] to answer; None is for ever."""

    node: str
    include_hidden: bool = False
    patience: float | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class CallOptions(SessionOptions):
    """The options of `service call` and `action send_goal`; a call is repeated at a `rate` [Hz]."""

    name: str
    type_name: str
    values: str | None = None
    from_stdin: bool = False
    rate: float | None = None
    feedback: bool = False


def takes(cls: type[_Options]) -> Callable[[Callable[[_Options], _Result]], Callable[..., _Result]]:
    """Let a command take its options as one dataclass, whose fields have the names of click's parameters."""

    def decorate(command: Callable[[_Options], _Result]) -> Callable[..., _Result]:
        @wraps(command)
        def run(**values: object) -> _Result:
            return command(cls(**values))

        return run

    return decorate


class ManyOption(click.Option):
    """An option that takes all values up to the next option, as in ROS: `--topics /imu /scan`."""

    def __init__(self, *args: Any, **kwargs: Any) -> None:
        super().__init__(*args, **{**kwargs, "multiple": True})


class ManyCommand(click.Command):
    """A command whose `ManyOption`s may have several values."""

    def parse_args(self, ctx: click.Context, args: list[str]) -> list[str]:
        """Repeat the name of an option before each of its values, which click understands."""
        names = {name for param in self.params if isinstance(param, ManyOption) for name in param.opts}
        spread: list[str] = []
        current = ""
        has_value = True
        for position, argument in enumerate(args):
            if argument == "--":
                spread += args[position:]
                break
            if argument in names:
                current, has_value = argument, False
            elif argument.startswith("-") and argument != "-":
                current = ""
                spread.append(argument)
            elif current:
                spread += [current, argument]
                has_value = True
            else:
                spread.append(argument)
            if not has_value and (position + 1 == len(args) or args[position + 1].startswith("-")):
                raise click.UsageError(f"Option '{current}' requires at least one value.", ctx)
        return super().parse_args(ctx, spread)
