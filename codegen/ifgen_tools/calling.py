"""Calls of services and goals for actions: whom to call, with which class, and what if nobody answers."""

from __future__ import annotations

import sys
import time
from collections.abc import Callable
from typing import TYPE_CHECKING, Any, Final, Literal, TypeAlias

import click
from ifgen.command_kit.tool import ToolError, did_you_mean

from ifgen_tools.ros_graph import Named
from ifgen_tools.types import interface_class

if TYPE_CHECKING:
    from rclpy.task import Future

    from ifgen_tools.session import Session

# Late imports: of the toolkit, where types are unusual.

Kind: TypeAlias = Literal["service", "action"]

_FOLDERS: Final = {"service": "srv", "action": "action"}

SEND_GOAL: Final = "_action/send_goal"
"""The service of an action that takes goals, after its name."""

_GONE: Final = 2.0
"""Seconds without the server after which no answer is expected: real rclpy tells nobody that it has gone."""


def values_or_stdin(values: str | None, from_stdin: bool) -> str:
    """The values on the command line, or with --stdin what comes through a pipe until it ends."""
    if not from_stdin:
        return values or ""
    if values is not None:
        raise click.UsageError("--stdin and values exclude each other")
    return sys.stdin.read()


def wait_for_server(
    session: Session, kind: Kind, name: str, type_name: str, look: Callable[[], list[Named]]
) -> None:
    """Wait until somebody serves a service or an action, for ever if nobody does.

    `look` returns all that there are now. If nobody is there, it is said on stderr, with what is spelled like
    `name`. Raises ToolError if it has another type.
    """
    channel = name if kind == "service" else f"{name}/{SEND_GOAL}"

    def is_there() -> bool:
        return session.node.count_services(channel) > 0

    if not is_there():
        session.discover()
    if not is_there():
        near = did_you_mean(name, [each.name for each in look()])
        print(f"waiting for the {kind} {name!r}...{f' {near}' if near else ''}", file=sys.stderr, flush=True)
        session.lookout.tell_of_other()
        session.wait_for(is_there)
    types = [type_ for each in look() if each.name == name for type_ in each.types]
    if types and type_name not in types:
        raise ToolError(
            f"the {kind} {name!r} has the type {' and '.join(types)}, not {type_name}",
            f"see `ifgen {kind} type {name}`",
        )


def full_type_name(type_name: str, kind: Kind) -> str:
    """`pkg/srv/Name` for `pkg/Name`. Raises ToolError for what is no name of a type."""
    package, _, rest = type_name.partition("/")
    folder, _, short = rest.rpartition("/")
    if not package.isidentifier() or not short.isidentifier() or folder not in {"", _FOLDERS[kind]}:
        raise ToolError(f"{type_name!r} names no {kind}", f"write it as package/{_FOLDERS[kind]}/Name")
    return f"{package}/{_FOLDERS[kind]}/{short}"


def known_class(type_name: str, kind: Kind) -> type[Any] | ToolError:
    """The class of a type that is installed, generated or defined here; otherwise the error that says so."""
    try:
        return interface_class(type_name, _FOLDERS[kind])
    except ToolError as error:
        return error


def class_on_the_wire(
    session: Session, kind: Kind, name: str, known: type[Any] | ToolError, timeout: float = 5.0
) -> type[Any]:
    """The class of a service or an action that is there, as its server defines it.

    `known` is what this process has under the name of its type. The server is asked where that is nothing, or
    another definition. Raises ToolError, with the reason, if neither will do.
    """
    if isinstance(known, type) and _fits(session, kind, name, known):
        return known
    from ifgen.dynamic import DescribeError, InputError, class_of

    from ifgen_tools.type_descriptions import describe_action, describe_service

    describe = describe_service if kind == "service" else describe_action
    try:
        return class_of(describe(session.node, name, timeout=timeout))
    except DescribeError as error:
        advice = "generate or install its package here"
        if isinstance(known, type):
            raise ToolError(f"the server has another definition than this process; {error}", advice) from None
        raise ToolError(f"{known.message}; {error}", known.help or advice) from None
    except InputError as error:
        raise ToolError(f"the description of {name!r} is wrong: {error}") from None


def _fits(session: Session, kind: Kind, name: str, known: type[Any]) -> bool:
    """Whether a server has the definition of a class, as far as the graph tells."""
    from ifgen_tools.type_descriptions import servers_of

    part = known if kind == "service" else getattr(known, "Impl").SendGoalService  # noqa: B009 - of any class
    servers = servers_of(session.node, name if kind == "service" else f"{name}/{SEND_GOAL}")
    own = getattr(part, "__type_hash__", None)
    return not servers or own is None or any(server.type_hash == own for server in servers)


def answer(
    session: Session,
    future: Future[Any],
    is_ready: Callable[[], bool],
    what: str,
    stop: Callable[[], bool] = lambda: False,
) -> Any:
    """The result of a future that a server completes, or None once `stop` holds.

    `is_ready` tells whether the server is there. Raises ToolError if that goes away, or fails.
    """
    last_seen = time.monotonic()

    def is_over() -> bool:
        nonlocal last_seen
        if is_ready():
            last_seen = time.monotonic()
        return future.done() or stop() or time.monotonic() - last_seen > _GONE

    session.wait_for(is_over)
    if not future.done():
        if stop():
            return None
        raise ToolError(f"the server of the {what} has gone before it answered")
    error = future.exception()
    if isinstance(error, ConnectionError):  # of our transport, which knows
        raise ToolError(f"the server of the {what} has gone before it answered")
    if error is not None:
        raise ToolError(f"the {what} has failed: {error}")
    return future.result()
