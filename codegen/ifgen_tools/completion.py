"""The words that a shell gets at TAB: names of types, nodes, topics, services, actions and parameters.

A running system is asked for a short time. Whatever is wrong is no completion, and nothing is printed.
Use it as `shell_complete=` at the argument that takes such a name.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Generator, Iterable, Iterator
from contextlib import contextmanager
from functools import wraps
from typing import TYPE_CHECKING, Final, TypeAlias

import click

if TYPE_CHECKING:
    from click.shell_completion import CompletionItem

    from ifgen_tools.session import Session

# Late imports: a shell waits at each TAB, and rclpy is found once the transport has been chosen.

_PATIENCE: Final = 0.8
"""Seconds until a shell gets what is known so far, where nobody says when that is all."""

_Complete: TypeAlias = "Callable[[click.Context, click.Parameter, str], list[CompletionItem]]"


def _completing(names: Callable[[click.Context, str], Iterable[str]]) -> _Complete:
    """Turn a function that yields candidates for a text into a completion callback of click."""

    @wraps(names)
    def complete(context: click.Context, _: click.Parameter, typed: str) -> list[CompletionItem]:
        from click.shell_completion import CompletionItem

        try:
            with _silence():
                found = sorted(set(names(context, typed)))
        except (Exception, KeyboardInterrupt):  # in the middle of a line, nobody can do anything about it
            return []
        return [CompletionItem(name) for name in found if name.startswith(typed)]

    return complete


@contextmanager
def _silence() -> Generator[None]:
    """Drop what is written to stderr, also by libraries in C."""
    kept = os.dup(2)
    nowhere = os.open(os.devnull, os.O_WRONLY)
    os.dup2(nowhere, 2)
    os.close(nowhere)
    try:
        yield
    finally:
        os.dup2(kept, 2)
        os.close(kept)


@contextmanager
def _looking(context: click.Context) -> Generator[Session]:
    """A session that knows the graph as far as it is known soon."""
    from ifgen_tools.session import open_session

    with open_session(context.params.get("transport") or "auto") as session:
        session.lookout.say = lambda _: None  # the terminal belongs to the shell
        session.discover(None if session.transport == "local" else _PATIENCE)
        yield session


def _visible(names: Iterable[str], typed: str) -> Iterator[str]:
    """Without hidden names, unless one is being typed."""
    from ifgen_tools.graph.reading import is_hidden

    return (name for name in names if is_hidden(typed) or not is_hidden(name))


@_completing
def nodes(context: click.Context, typed: str) -> Iterator[str]:
    """Full names of nodes."""
    with _looking(context) as session:
        found = session.node.get_node_names_and_namespaces()
    yield from _visible((f"{space.rstrip('/')}/{name}" for name, space in found), typed)


@_completing
def topics(context: click.Context, typed: str) -> Iterator[str]:
    """Names of topics."""
    with _looking(context) as session:
        found = session.node.get_topic_names_and_types()
    yield from _visible((name for name, _ in found), typed)


@_completing
def services(context: click.Context, typed: str) -> Iterator[str]:
    """Names of services."""
    with _looking(context) as session:
        found = session.node.get_service_names_and_types()
    yield from _visible((name for name, _ in found), typed)


@_completing
def actions(context: click.Context, typed: str) -> Iterator[str]:
    """Names of actions."""
    with _looking(context) as session:
        from rclpy.action import get_action_names_and_types

        found = get_action_names_and_types(session.node)
    yield from _visible((name for name, _ in found), typed)


@_completing
def parameters(context: click.Context, typed: str) -> Iterator[str]:
    """Names of the parameters of the node that is the argument before."""
    if len(context.params.get("pairs") or ()) % 2:
        return  # the value of one is being typed
    node = str(context.params["node"])
    with _looking(context) as session:
        from rclpy.parameter_client import AsyncParameterClient

        client = AsyncParameterClient(session.node, node if node.startswith("/") else f"/{node}")
        if not session.wait_for(client.services_are_ready, _PATIENCE):
            return
        future = client.list_parameters()
        session.wait_for(future.done, _PATIENCE)
        answer = future.result() if future.done() else None
    if answer is not None:
        yield from answer.result.names


@_completing
def transitions(context: click.Context, _: str) -> Iterator[str]:
    """The transitions out of the present state of the node that is the argument before."""
    node = str(context.params["node"])
    with _looking(context) as session:
        from lifecycle_msgs.srv import GetAvailableTransitions

        service = f"{node if node.startswith('/') else f'/{node}'}/get_available_transitions"
        client = session.node.create_client(GetAvailableTransitions, service)
        if not session.wait_for(client.service_is_ready, _PATIENCE):
            return
        future = client.call_async(GetAvailableTransitions.Request())
        session.wait_for(future.done, _PATIENCE)
        answer = future.result() if future.done() else None
    if answer is not None:
        yield from (each.transition.label for each in answer.available_transitions)


@_completing
def launch_files(context: click.Context, _: str) -> Iterator[str]:
    """Names of packages, or the launch files of the package that is the word before."""
    from pathlib import Path

    from ifgen.config.settings import settle
    from ifgen.running.finding import packages as finding

    words = [word for word in context.params.get("words") or () if ":=" not in word]
    output = settle().output
    if not words:
        yield from finding.names(output)
    elif len(words) == 1 and not Path(words[0]).is_file() and (package := finding.find(words[0], output)):
        yield from (file.name for file in package.share.rglob("*launch*") if file.is_file())


def words_of_launch(context: click.Context, parameter: click.Parameter, typed: str) -> list[CompletionItem]:
    """Files, which the shell completes, and the names of packages and their launch files."""
    from click.shell_completion import CompletionItem

    files = [] if context.params.get("words") else [CompletionItem(typed, type="file")]
    return [*files, *launch_files(context, parameter, typed)]


def _types(kind: str | None, typed: str) -> Iterator[str]:
    from ifgen_tools.interface import finding

    search = finding.search_path(())
    start = typed.partition("/")[0]
    for package in search.package_names():
        if package.startswith(start):
            yield from (name for of, name in finding.types_of(package, search) if kind in {of, None})


@_completing
def types(_: click.Context, typed: str) -> Iterator[str]:
    """Names of messages, services and actions."""
    yield from _types(None, typed)


@_completing
def packages(_: click.Context, __: str) -> Iterator[str]:
    """Names of packages that have interfaces."""
    from ifgen_tools.interface import finding

    yield from finding.search_path(()).package_names()


@_completing
def message_types(_: click.Context, typed: str) -> Iterator[str]:
    """Names of messages."""
    yield from _types("msg", typed)


@_completing
def service_types(_: click.Context, typed: str) -> Iterator[str]:
    """Names of services' types."""
    yield from _types("srv", typed)


@_completing
def action_types(_: click.Context, typed: str) -> Iterator[str]:
    """Names of actions' types."""
    yield from _types("action", typed)
