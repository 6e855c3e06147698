"""Completion at TAB: names in a running system, and of what can be run.

A running system is asked for a short time.
"""

from __future__ import annotations

import glob
from collections.abc import Generator, Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Final

import click
from ifgen.command_kit.completion import Items, completing, files

if TYPE_CHECKING:
    from ifgen_tools.session import Session

# Late imports: a shell waits at each TAB, and rclpy is found once the transport has been chosen.

_PATIENCE: Final = 0.8
"""Seconds until a shell gets what is known so far, where nobody says when that is all."""


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
    from ifgen_tools.ros_graph import is_hidden

    return (name for name in names if is_hidden(typed) or not is_hidden(name))


@completing
def nodes(context: click.Context, typed: str) -> Iterator[str]:
    """Full names of nodes."""
    with _looking(context) as session:
        found = session.node.get_node_names_and_namespaces()
    yield from _visible((f"{space.rstrip('/')}/{name}" for name, space in found), typed)


@completing
def topics(context: click.Context, typed: str) -> Iterator[str]:
    """Names of topics."""
    with _looking(context) as session:
        found = session.node.get_topic_names_and_types()
    yield from _visible((name for name, _ in found), typed)


@completing
def services(context: click.Context, typed: str) -> Iterator[str]:
    """Names of services."""
    with _looking(context) as session:
        found = session.node.get_service_names_and_types()
    yield from _visible((name for name, _ in found), typed)


@completing
def actions(context: click.Context, typed: str) -> Iterator[str]:
    """Names of actions."""
    with _looking(context) as session:
        from rclpy.action import get_action_names_and_types

        found = get_action_names_and_types(session.node)
    yield from _visible((name for name, _ in found), typed)


@completing
def parameters(context: click.Context, typed: str) -> Iterator[str]:
    """Names of the parameters of the node that is the argument before."""
    if len(context.params.get("pairs") or ()) % 2:
        return  # the value of one is being typed
    node = str(context.params["node"])
    from ifgen_tools.param.client import remote_parameters

    with _looking(context) as session:
        full_name = node if node.startswith("/") else f"/{node}"
        with remote_parameters(session, full_name, _PATIENCE, _PATIENCE) as remote:
            yield from remote.names()


@completing
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


def programs(context: click.Context, parameter: click.Parameter, typed: str) -> Items:
    """Files and packages, or the nodes of a package that is the word before, for `ifgen run`."""
    from click.shell_completion import CompletionItem

    names = _programs(context, parameter, typed)
    if names and _present(context):
        return names
    # bash completes files itself only where there is nothing else.
    here = sorted(file.name for file in Path().glob(f"{glob.escape(typed)}*") if file.is_file())
    if not here:
        return [*files(context, parameter, typed), *names]
    users = [name for name in names if name.value not in _names_of_demo()]
    return [CompletionItem(name) for name in here] + users if users else files(context, parameter, typed)


def _present(context: click.Context) -> list[str]:
    """The words of the program that is being typed."""
    words: list[str] = list(context.params.get("program") or ())
    while ":" in words:
        words = words[words.index(":") + 1 :]
    return words


@completing
def _programs(context: click.Context, typed: str) -> Iterable[str]:
    from ifgen.config.settings import settle

    from ifgen_tools.running import packages as finding

    output, words = settle().output, _present(context)
    if not words:
        begun = _users_first(name for name in finding.names(output) if name.startswith(typed))
        return [name for name in begun if (found := finding.find(name, output)) and found.executables]
    package = finding.find(words[0], output) if len(words) == 1 and not Path(words[0]).exists() else None
    return sorted(package.executables) if package else ()


@completing
def packages_to_run(_: click.Context, typed: str) -> Iterable[str]:
    """Names of packages that are generated, sources here, or installed."""
    from ifgen.config.settings import settle

    from ifgen_tools.running import packages as finding

    return _users_first(name for name in finding.names(settle().output) if name.startswith(typed))


def _users_first(names: Iterable[str]) -> list[str]:
    """The names of packages without those of our demo, unless there are no others."""
    found = list(names)
    return [name for name in found if name not in _names_of_demo()] or found


def _names_of_demo() -> frozenset[str]:
    from ifgen import resources
    from ifgen.config.settings import settle

    nodes = resources.bundled_nodes()
    if not nodes.is_dir() or settle().output.resolve() == nodes.resolve():
        return frozenset()
    return frozenset(folder.name for folder in nodes.iterdir())


@completing
def launch_files(context: click.Context, _: str) -> Iterator[str]:
    """Names of packages, or the launch files of the package that is the word before."""
    from ifgen.config.settings import settle

    from ifgen_tools.running import packages as finding

    words = [word for word in context.params.get("words") or () if ":=" not in word]
    output = settle().output
    if not words:
        yield from finding.names(output)
    elif len(words) == 1 and not Path(words[0]).is_file() and (package := finding.find(words[0], output)):
        yield from (file.name for file in package.share.rglob("*launch*") if file.is_file())


def words_of_launch(context: click.Context, parameter: click.Parameter, typed: str) -> Items:
    """Files, which the shell completes, and the names of packages and their launch files."""
    if context.params.get("words"):
        return launch_files(context, parameter, typed)
    return [*files(context, parameter, typed), *launch_files(context, parameter, typed)]
